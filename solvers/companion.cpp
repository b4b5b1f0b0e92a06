#include <graze/solvers/companion.hpp>

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Eigenvalues>

#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/polynomial.hpp>

namespace graze {
namespace {

constexpr double kU = 0x1p-53;  // unit roundoff
using Coefficients = std::span<const double>;

/// The companion matrix of c / c_n: ones below the diagonal, -c_i / c_n down the last column.
template <class MatrixType>
MatrixType companion_matrix(Coefficients c) {
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
  constexpr double kWorthwhile = 0.95;  // Parlett and Reinsch: rescale only where it shrinks the sum by 5 %
  bool changed = true;
  for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const double column = matrix.col(i).cwiseAbs().sum() - std::fabs(matrix(i, i));
      const double row = matrix.row(i).cwiseAbs().sum() - std::fabs(matrix(i, i));
      if (column == 0 || row == 0) continue;
      const int k = static_cast<int>(std::lround(0.5 * (std::log2(row) - std::log2(column))));
      if (k == 0 || std::ldexp(column, k) + std::ldexp(row, -k) >= kWorthwhile * (column + row)) continue;
      matrix.col(i) *= std::ldexp(1.0, k);
      matrix.row(i) *= std::ldexp(1.0, -k);
      changed = true;
    }
  }
}

/// Calls visit(eigenvalue) for each; false: entries overflow or no convergence.
template <class MatrixType, class Visit>
bool visit_eigenvalues(Coefficients c, const Visit& visit) {
  MatrixType matrix = companion_matrix<MatrixType>(c);
  if (!matrix.allFinite()) return false;
  balance(matrix);
  const Eigen::EigenSolver<MatrixType> solver(matrix, /*computeEigenvectors=*/false);
  if (solver.info() != Eigen::Success) return false;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) visit(solver.eigenvalues()[i]);
  return true;
}

/// sum |c_i| |x|^i.
double magnitude_sum(Coefficients c, double x) {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * std::fabs(x) + std::fabs(c[i]);
  return sum;
}

/// The polynomial in power basis on [lo, hi], without its zero ends.
struct Problem {
  Coefficients c;
  Coefficients c_error;
  double lo, hi;

  /// What |p(x)| may be for x to count as a root.
  [[nodiscard]] double tolerance(double x) const {
    const auto n = static_cast<double>(c.size() - 1);
    return Companion::kBackward * n * kU * magnitude_sum(c, x) + magnitude_sum(c_error, x);
  }
};

/// Newton steps that shrink |p|, at most 3: from an eigenvalue with relative error 1e-12 two reach rounding.
double polished(const Problem& problem, double x, Counters& counters) {
  constexpr int kSteps = 3;
  auto here = evaluate_with_derivative(problem.c, x);
  for (int step = 0; step < kSteps && here.value != 0 && here.derivative != 0; ++step) {
    const double next = x - here.value / here.derivative;
    const auto there = evaluate_with_derivative(problem.c, next);
    ++counters.evaluations;
    if (!(std::fabs(there.value) < std::fabs(here.value))) break;
    x = next;
    here = there;
  }
  return x;
}

/// Adds the eigenvalue's real part as a root if the criterion of the header holds. A conjugate pair, seen by
/// its member above the axis, is one touching root.
void add_if_real(const Problem& problem, std::complex<double> eigenvalue, bool polish, Roots& roots) {
  if (eigenvalue.imag() < 0) return;
  const bool pair = eigenvalue.imag() > 0;
  double x = eigenvalue.real();
  if (polish && !pair) x = polished(problem, x, roots.counters);
  const auto p = evaluate_with_derivative(problem.c, x);
  ++roots.counters.evaluations;
  const double tolerance = problem.tolerance(x);
  if (pair && std::fabs(p.value) > tolerance) return;
  const double radius = pair ? eigenvalue.imag() + std::sqrt(kU) * std::fabs(x)
                             : (std::fabs(p.value) + tolerance) / std::fabs(p.derivative);
  // A root that leaves the closed interval belongs to the end if the end is one by the same measure.
  const double inside = std::clamp(x, problem.lo, problem.hi);
  if (inside != x) {
    ++roots.counters.evaluations;
    if (std::fabs(evaluate(problem.c, inside).value) > problem.tolerance(inside)) return;
  }
  roots.list.push_back({.x = inside, .others = {}, .radius = radius, .multiplicity = pair ? 2U : 1U});
}

/// Are two neighbouring real roots one that rounding has split? A double root x splits by about sqrt(u):
/// between the two |p| is then no more than the rounding of its own coefficients.
bool is_split(const Problem& problem, const Root& a, const Root& b, Counters& counters) {
  if (a.x == b.x) return true;
  constexpr double kRounding = 4;
  const double middle = a.x + 0.5 * (b.x - a.x);
  ++counters.evaluations;
  return std::fabs(evaluate(problem.c, middle).value) <= kRounding * kU * magnitude_sum(problem.c, middle);
}

/// Sorts, and makes one root of those that cannot be told apart.
void sort_and_merge(const Problem& problem, Roots& roots) {
  std::vector<Root>& list = roots.list;
  std::sort(list.begin(), list.end(), [](const Root& a, const Root& b) { return a.x < b.x; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (kept > 0 && is_split(problem, list[kept - 1], list[i], roots.counters)) {
      Root& merged = list[kept - 1];
      const double apart = list[i].x - merged.x;
      merged.x += 0.5 * apart;
      merged.radius = apart + std::sqrt(kU) * std::fabs(merged.x);
      merged.multiplicity += list[i].multiplicity;
    } else {
      list[kept++] = list[i];
    }
  }
  list.resize(kept);
}

void solve_power(Problem problem, bool polish, Roots& roots) {
  const int degree = effective_degree(problem.c);
  if (degree < 0) {
    roots.status = Status::coincident;
    return;
  }
  const auto cut = [](Coefficients c, std::size_t from, std::size_t count) {
    return c.empty() ? c : c.subspan(from, count);
  };
  std::size_t zeros = 0;
  while (problem.c[zeros] == 0) ++zeros;
  const std::size_t count = static_cast<std::size_t>(degree) + 1 - zeros;
  problem.c = cut(problem.c, zeros, count);
  problem.c_error = cut(problem.c_error, zeros, count);
  if (zeros > 0 && problem.lo <= 0 && 0 <= problem.hi) {
    roots.list.push_back({.x = 0, .others = {}, .multiplicity = static_cast<std::uint32_t>(zeros)});
  }
  if (count < 2) return;

  const auto visit = [&](std::complex<double> value) { add_if_real(problem, value, polish, roots); };
  constexpr int kSmall = 8;
  using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSmall, kSmall>;
  const bool solved = count <= kSmall + 1 ? visit_eigenvalues<Small>(problem.c, visit)
                                          : visit_eigenvalues<Eigen::MatrixXd>(problem.c, visit);
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

void Companion::solve(const PolynomialEquation& equation, Roots& roots) const {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
    return;
  }
  if (equation.basis == Basis::power) {
    solve_power({equation.c, equation.c_error, equation.lo, equation.hi}, polish_, roots);
    return;
  }
  // Bernstein on [lo, hi]: power basis in s = (x - lo) / (hi - lo), then back.
  std::vector<double> c(equation.c.size());
  std::vector<double> c_error(equation.c.size());
  bernstein_to_power(equation.c, equation.c_error, c, c_error);
  solve_power({c, c_error, 0, 1}, polish_, roots);
  const double length = equation.hi - equation.lo;
  for (Root& root : roots.list) {
    root.x = root.x == 1 ? equation.hi : std::fma(root.x, length, equation.lo);
    root.radius *= length;
  }
}

}  // namespace graze
