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
  power_basis::solve(equation, roots, [this](const power_basis::Problem<T>& problem, Roots& found) {
    const auto visit = [&](std::complex<T> value) { add_if_real(problem, value, polish_, found); };
    constexpr int kSmall = 8;
    using Small = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, kSmall, kSmall>;
    const bool solved = problem.degree() <= kSmall ? visit_eigenvalues<Small>(problem.c, visit)
                                                   : visit_eigenvalues<DynamicMatrix<T>>(problem.c, visit);
    if (!solved) found.status = Status::failed;
  });
}

template void Companion::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Companion::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
