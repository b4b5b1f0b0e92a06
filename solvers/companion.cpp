#include <graze/solvers/companion.hpp>

#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Eigenvalues>

#include <graze/solvers/power_basis.hpp>

namespace graze {
namespace {

using power_basis::Coefficients;

template <class T>
using DynamicMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

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

/// The colleague matrix of sum c_k T_k: row k says x T_k = (T_{k-1} + T_{k+1}) / 2, and the last one T_n by
/// p = 0.
template <class MatrixType, class T>
MatrixType colleague_matrix(Coefficients<T> c) {
  const auto n = static_cast<Eigen::Index>(c.size()) - 1;
  MatrixType matrix = MatrixType::Zero(n, n);
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    matrix(k, k + 1) = k == 0 ? T{1} : T{0.5};
    if (k > 0) matrix(k, k - 1) = T{0.5};
  }
  if (n > 1) matrix(n - 1, n - 2) = T{0.5};
  // x T_0 = T_1 where n = 1: the row is not halved.
  const T lead = n == 1 ? c.back() : 2 * c.back();
  for (Eigen::Index k = 0; k < n; ++k) matrix(n - 1, k) -= c[static_cast<std::size_t>(k)] / lead;
  return matrix;
}

/// Calls visit(eigenvalue) for each; false: entries overflow or no convergence.
template <class MatrixType, class Visit>
bool visit_eigenvalues(MatrixType matrix, const Visit& visit) {
  if (!matrix.allFinite()) return false;
  balance(matrix);
  const Eigen::EigenSolver<MatrixType> solver(matrix, /*computeEigenvectors=*/false);
  if (solver.info() != Eigen::Success) return false;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) visit(solver.eigenvalues()[i]);
  return true;
}

/// The same for the matrix that make(MatrixType*) gives for n unknowns; small ones stay on the stack.
template <class T, class Make, class Visit>
bool visit_eigenvalues_of(int n, const Make& make, const Visit& visit) {
  constexpr int kSmall = 8;
  using Small = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, kSmall, kSmall>;
  if (n <= kSmall) return visit_eigenvalues<Small>(make(static_cast<Small*>(nullptr)), visit);
  return visit_eigenvalues<DynamicMatrix<T>>(make(static_cast<DynamicMatrix<T>*>(nullptr)), visit);
}

/// sum c_k T_k(x) = 0 on [-1, 1], c_n != 0, n >= 1; `error` bounds what was left out and the coefficients'
/// own errors, |T_k| <= 1. Asked by the rule of power_basis.hpp.
template <class T>
struct ChebyshevProblem {
  using Number = T;
  Coefficients<T> c;
  T error;
  T lo = -1, hi = 1;

  [[nodiscard]] power_basis::Value<T> at(T x) const {
    const auto p = chebyshev_value(c, x);
    return {p.value, p.derivative};
  }
  /// |T_k| <= 1 on the interval, and no root is asked for beyond it.
  [[nodiscard]] T magnitude(T /*x*/) const {
    T sum = 0;
    for (const T v : c) sum += std::fabs(v);
    return sum;
  }
  [[nodiscard]] T tolerance(T x) const {
    const auto n = static_cast<T>(c.size() - 1);
    return static_cast<T>(power_basis::kBackward) * n * power_basis::kU<T> * magnitude(x) + error;
  }
};

/// Without the highest coefficients that are rounding: on [-1, 1] they move p by no more than what an ulp of
/// the largest does, but eigenvalues of a matrix with 1 / c_n in it by far more.
template <class T>
ChebyshevProblem<T> without_noise(const BasicPolynomialEquation<T>& equation) {
  ChebyshevProblem<T> problem{equation.c, 0};
  T largest = 0;
  for (const T v : problem.c) largest = std::max(largest, std::fabs(v));
  for (const T e : equation.c_error) problem.error += e;
  while (problem.c.size() > 1 && std::fabs(problem.c.back()) <= power_basis::kU<T> * largest) {
    problem.error += std::fabs(problem.c.back());
    problem.c = problem.c.first(problem.c.size() - 1);
  }
  return problem;
}

template <class T>
void solve_chebyshev(const BasicPolynomialEquation<T>& equation, bool polish, Roots& roots) {
  const ChebyshevProblem<T> problem = without_noise(equation);
  if (problem.c.empty() || (problem.c.size() == 1 && problem.c[0] == 0)) {
    roots.status = Status::coincident;
    return;
  }
  const int n = static_cast<int>(problem.c.size()) - 1;
  if (n == 0) return;
  const auto make = [&]<class MatrixType>(MatrixType*) { return colleague_matrix<MatrixType>(problem.c); };
  // A root farther beyond an end than a double one is known to is not the end's, even if the end is one too.
  const T farthest = 1 + std::sqrt(power_basis::kU<T>);
  const auto visit = [&](std::complex<T> value) {
    if (std::fabs(value.real()) <= farthest) power_basis::add_if_real(problem, value, polish, roots);
  };
  if (!visit_eigenvalues_of<T>(n, make, visit)) roots.status = Status::failed;
  power_basis::sort_and_merge(problem, roots);
  power_basis::detail::bring_back(equation, -1, roots);
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
  if (equation.basis == Basis::chebyshev && is_usable(equation)) {
    return solve_chebyshev(equation, polish_, roots);
  }
  power_basis::solve(equation, roots, [this](const power_basis::Problem<T>& problem, Roots& found) {
    const auto make = [&]<class MatrixType>(MatrixType*) { return companion_matrix<MatrixType>(problem.c); };
    const auto visit = [&](std::complex<T> value) { add_if_real(problem, value, polish_, found); };
    if (!visit_eigenvalues_of<T>(problem.degree(), make, visit)) found.status = Status::failed;
  });
}

template void Companion::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Companion::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
