// Root after root by Laguerre's method, with stable deflation and a polish on the polynomial as given.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed where a root is not reached in kSteps steps (the
//           list then holds the real roots found before); invalid for coefficients that are not finite
// error     each root is iterated on p itself, not on the deflated polynomial, until |p| is below the bound
//           of its own rounding: the error of a relative change of each coefficient by some n u. `radius` is
//           the first-order estimate of power_basis
// cost      some 4 to 6 evaluations of p, p', p'' for a simple root; no allocation up to degree 32 and for
//           the power basis
// source    Laguerre, Oeuvres 1 (1880), p. 87; Press et al., "Numerical Recipes" (section on roots of
//           polynomials) for the usual driver; stop: Adams, "A stopping criterion for polynomial root
//           finding", Comm. ACM 10 (1967); composite deflation: Peters, Wilkinson, "Practical problems
//           arising in the solution of polynomial equations", J. Inst. Maths Applics 8 (1971). Ours:
//           scaling by powers of two, the test that makes a root real
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Laguerre {
 public:
  /// Budget for one root: simple roots take about 5 steps; an m-fold root is approached by a factor of about
  /// 1 - 1/m a step or better, 80 steps reach u^(1/m) for m = 12.
  static constexpr int kSteps = 80;
  /// Largest backward error, in n u, of the roots of polynomials of degree 1 to 12 with coefficients uniform
  /// in [-1, 1] (measured; asserted in tests/solvers/laguerre_test.cpp).
  static constexpr double kMeasuredBackward = 2;

  static SolverInfo info();
  explicit Laguerre(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  bool polish_;
};

static_assert(Solver<Laguerre>);

}  // namespace graze
