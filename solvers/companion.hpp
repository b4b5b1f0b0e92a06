// Real roots as eigenvalues of the balanced companion matrix.
//
// solves    p(x) = 0 on [lo, hi]: power or Bernstein basis by the companion matrix, Chebyshev basis by the
//           colleague matrix, any degree
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed if the ratios to the leading coefficient overflow
//           or the QR iteration does not converge; invalid for coefficients that are not finite
// error     measured (solvers/companion.md): the eigenvalues are those of a matrix within rounding of the
//           balanced companion matrix, which for badly scaled coefficients may be far from a small relative
//           change of each coefficient; nothing is proved. Two real eigenvalues that a double root may have
//           split into are reported as one of multiplicity 2
// cost      O(n^3): one eigenvalue-only QR; one evaluation an eigenvalue. Allocates above degree 8
// source    Edelman, Murakami, "Polynomial roots from companion matrix eigenvalues", Math. Comp. 64 (1995);
//           colleague matrix: Specht 1957; Good, Quart. J. Math. 12 (1961); balancing after Parlett, Reinsch,
//           Numer. Math. 13 (1969); eigenvalues by Eigen
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Companion {
 public:
  /// Largest backward error, in n u, of the roots of polynomials of degree 1 to 12 with coefficients uniform
  /// in
  /// [-1, 1] (measured: 692; asserted in tests/solvers/companion_test.cpp).
  static constexpr double kMeasuredBackward = 1024;

  static SolverInfo info();
  explicit Companion(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  bool polish_;
};

static_assert(Solver<Companion>);

}  // namespace graze
