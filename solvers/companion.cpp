#include <graze/solvers/companion.hpp>

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Eigenvalues>

#include <graze/solvers/math/bernstein.hpp>

namespace graze {
namespace {

template <class T>
constexpr T kU = std::numeric_limits<T>::epsilon() / 2;  // unit roundoff

template <class T>
using Coefficients = std::span<const T>;

template <class T>
using DynamicMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

template <class T>
struct Value {
  T value = 0, derivative = 0;
};

/// Horner's rule for p and p'.
template <class T>
Value<T> evaluate(Coefficients<T> c, T x) {
  Value<T> p;
  for (std::size_t i = c.size(); i-- > 0;) {
    p.derivative = p.derivative * x + p.value;
    p.value = p.value * x + c[i];
  }
  return p;
}

/// The companion matrix of c / c_n: ones below the diagonal, -c_i / c_n down the last column.
template <class MatrixType, class T>
MatrixType companion_matrix(Coefficients<T> c) {
  const auto n = static_cast<Eigen::Index>(c.size()) - 1;
  MatrixType matrix = MatrixType::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    matrix(i, n - 1) = -c[static_cast<std::size_t>(i)] / c.back();
    if (i > 0) matrix(i, i - 1) = 1;
  }
  return matrix;
}

/// Scales rows and columns by powers of two until their sums are within a factor of 2 or so (Parlett,
/// Reinsch 1969): exact, and it makes eigenvalues of badly scaled polynomials accurate.
template <class MatrixType>
void balance(MatrixType& matrix) {
  constexpr int kSweeps = 64;  // each sweep at least halves some row or column; a guard, never reached
  using T = typename MatrixType::Scalar;
  constexpr T kWorthwhile =
      static_cast<T>(0.95);  // Parlett and Reinsch: rescale only where it shrinks the sum by 5 %
  bool changed = true;
  for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const T column = matrix.col(i).cwiseAbs().sum() - std::fabs(matrix(i, i));
      const T row = matrix.row(i).cwiseAbs().sum() - std::fabs(matrix(i, i));
      if (column == 0 || row == 0) continue;
      const int k = static_cast<int>(std::lround((std::log2(row) - std::log2(column)) / 2));
      if (k == 0 || std::ldexp(column, k) + std::ldexp(row, -k) >= kWorthwhile * (column + row)) continue;
      matrix.col(i) *= std::ldexp(T{1}, k);
      matrix.row(i) *= std::ldexp(T{1}, -k);
      changed = true;
    }
  }
}

/// Calls visit(eigenvalue) for each; false: entries overflow or no convergence.
template <class MatrixType, class T, class Visit>
bool visit_eigenvalues(Coefficients<T> c, const Visit& visit) {
  MatrixType matrix = companion_matrix<MatrixType>(c);
  if (!matrix.allFinite()) return false;
  balance(matrix);
  const Eigen::EigenSolver<MatrixType> solver(matrix, /*computeEigenvectors=*/false);
  if (solver.info() != Eigen::Success) return false;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) visit(solver.eigenvalues()[i]);
  return true;
}

/// sum |c_i| |x|^i.
template <class T>
T magnitude_sum(Coefficients<T> c, T x) {
  T sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * std::fabs(x) + std::fabs(c[i]);
  return sum;
}

/// The polynomial in power basis on [lo, hi], without its zero ends.
template <class T>
struct Problem {
  Coefficients<T> c;
  Coefficients<T> c_error;
  T lo, hi;

  /// What |p(x)| may be for x to count as a root.
  [[nodiscard]] T tolerance(T x) const {
    const auto n = static_cast<T>(c.size() - 1);
    return static_cast<T>(Companion::kBackward) * n * kU<T> * magnitude_sum(c, x) + magnitude_sum(c_error, x);
  }
};

/// Newton steps that shrink |p|, at most 3: from an eigenvalue with relative error 1e-12 two reach rounding.
template <class T>
T polished(const Problem<T>& problem, T x, Counters& counters) {
  constexpr int kSteps = 3;
  auto here = evaluate(problem.c, x);
  for (int step = 0; step < kSteps && here.value != 0 && here.derivative != 0; ++step) {
    const T next = x - here.value / here.derivative;
    const auto there = evaluate(problem.c, next);
    ++counters.evaluations;
    if (!(std::fabs(there.value) < std::fabs(here.value))) break;
    x = next;
    here = there;
  }
  return x;
}

/// Adds the eigenvalue's real part as a root if the criterion of the header holds. A conjugate pair, seen by
/// its member above the axis, is one touching root.
template <class T>
void add_if_real(const Problem<T>& problem, std::complex<T> eigenvalue, bool polish, Roots& roots) {
  if (eigenvalue.imag() < 0) return;
  const bool pair = eigenvalue.imag() > 0;
  T x = eigenvalue.real();
  if (polish && !pair) x = polished(problem, x, roots.counters);
  const auto p = evaluate(problem.c, x);
  ++roots.counters.evaluations;
  const T tolerance = problem.tolerance(x);
  if (pair && std::fabs(p.value) > tolerance) return;
  const T radius = pair ? eigenvalue.imag() + std::sqrt(kU<T>) * std::fabs(x)
                        : (std::fabs(p.value) + tolerance) / std::fabs(p.derivative);
  // A root that leaves the closed interval belongs to the end if the end is one by the same measure.
  const T inside = std::clamp(x, problem.lo, problem.hi);
  if (inside != x) {
    ++roots.counters.evaluations;
    if (std::fabs(evaluate(problem.c, inside).value) > problem.tolerance(inside)) return;
  }
  roots.list.push_back(found_root(inside, radius, pair ? 2U : 1U));
}

/// Are two neighbouring real roots one that rounding has split? A double root x splits by about sqrt(u):
/// between the two |p| is then no more than the rounding of its own coefficients.
template <class T>
bool is_split(const Problem<T>& problem, const Root& a, const Root& b, Counters& counters) {
  if (a.x == b.x) return true;
  constexpr T kRounding = 4;
  const T middle = static_cast<T>(a.x + 0.5 * (b.x - a.x));
  ++counters.evaluations;
  return std::fabs(evaluate(problem.c, middle).value) <= kRounding * kU<T> * magnitude_sum(problem.c, middle);
}

/// Sorts, and makes one root of those that cannot be told apart.
template <class T>
void sort_and_merge(const Problem<T>& problem, Roots& roots) {
  std::vector<Root>& list = roots.list;
  std::sort(list.begin(), list.end(), [](const Root& a, const Root& b) { return a.x < b.x; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (kept > 0 && is_split(problem, list[kept - 1], list[i], roots.counters)) {
      Root& merged = list[kept - 1];
      const double apart = list[i].x - merged.x;
      merged.x += 0.5 * apart;
      merged.radius = apart + static_cast<double>(std::sqrt(kU<T>)) * std::fabs(merged.x);
      merged.multiplicity += list[i].multiplicity;
    } else {
      list[kept++] = list[i];
    }
  }
  list.resize(kept);
}

template <class T>
void solve_power(Problem<T> problem, bool polish, Roots& roots) {
  std::size_t size = problem.c.size();
  while (size > 0 && problem.c[size - 1] == 0) --size;
  if (size == 0) {
    roots.status = Status::coincident;
    return;
  }
  const auto cut = [](Coefficients<T> c, std::size_t from, std::size_t count) {
    return c.empty() ? c : c.subspan(from, count);
  };
  std::size_t zeros = 0;
  while (problem.c[zeros] == 0) ++zeros;
  const std::size_t count = size - zeros;
  problem.c = cut(problem.c, zeros, count);
  problem.c_error = cut(problem.c_error, zeros, count);
  if (zeros > 0 && problem.lo <= 0 && 0 <= problem.hi) {
    roots.list.push_back({.x = 0, .others = {}, .multiplicity = static_cast<std::uint32_t>(zeros)});
  }
  if (count < 2) return;

  const auto visit = [&](std::complex<T> value) { add_if_real(problem, value, polish, roots); };
  constexpr int kSmall = 8;
  using Small = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, kSmall, kSmall>;
  const bool solved = count <= kSmall + 1 ? visit_eigenvalues<Small>(problem.c, visit)
                                          : visit_eigenvalues<DynamicMatrix<T>>(problem.c, visit);
  if (!solved) roots.status = Status::failed;
  sort_and_merge(problem, roots);
}

}  // namespace

SolverInfo Companion::info() {
  SolverInfo info;
  info.summary = "eigenvalues of the balanced companion matrix";
  info.source = "Edelman, Murakami, Math. Comp. 64 (1995); eigenvalues by Eigen";
  info.page = "solvers/companion.md";
  info.options = {{"polish", "false", "up to 3 Newton steps on each simple root"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Companion::Companion(const Parameters& options) : polish_(options.flag("polish", false)) {}

template <class T>
void Companion::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
    return;
  }
  if (equation.basis == Basis::power) {
    solve_power(Problem<T>{equation.c, equation.c_error, equation.lo, equation.hi}, polish_, roots);
    return;
  }
  // Bernstein on [lo, hi]: power basis in s = (x - lo) / (hi - lo), changed in double, then back.
  const std::vector<double> b(equation.c.begin(), equation.c.end());
  const std::vector<double> b_error(equation.c_error.begin(), equation.c_error.end());
  std::vector<double> c(b.size());
  std::vector<double> c_error(b.size());
  bernstein_to_power(b, b_error, c, c_error);
  const auto rounded = [](const std::vector<double>& from) {
    std::vector<T> to;
    for (const double v : from) to.push_back(static_cast<T>(v));
    return to;
  };
  const std::vector<T> c_rounded = rounded(c), error_rounded = rounded(c_error);
  solve_power(Problem<T>{c_rounded, error_rounded, 0, 1}, polish_, roots);
  const auto lo = static_cast<double>(equation.lo), hi = static_cast<double>(equation.hi);
  for (Root& root : roots.list) {
    root.x = root.x == 1 ? hi : std::fma(root.x, hi - lo, lo);
    root.radius *= hi - lo;
  }
}

template void Companion::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Companion::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
