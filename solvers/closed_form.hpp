// Roots by formula: linear and quadratic equations.
//
// solves    c0 + c1 x + c2 x^2 = 0 on [lo, hi], power or Bernstein basis, in double and float
// needs     finite coefficients, degree at most 2 (leading zeros do not count)
// returns   ok; coincident for the zero polynomial; failed above degree 2; invalid for coefficients that are
//           not finite. A double root, where the discriminant is exactly zero, has multiplicity 2
// error     at most kError ulps of each root for coefficients that are exact numbers (proof:
//           solvers/closed_form.md), also where b^2 and ac nearly cancel: Kahan's discriminant has a relative
//           error of at most 2u. radius = that bound, and what the coefficients' errors leave open
// cost      at most 1 square root, 3 divisions and 2 fused multiply-adds; no allocation
// source    Kahan, "On the cost of floating-point computation without extra-precise arithmetic" (2004), and
//           the error bound of Jeannerod, Louvet, Muller, Math. Comp. 82 (2013), theorem 1.2
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class ClosedForm {
 public:
  /// Largest error of a root, in ulps of the root (asserted in tests/solvers/closed_form_test.cpp).
  static constexpr int kError = 4;

  static SolverInfo info();
  explicit ClosedForm(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;
};

static_assert(Solver<ClosedForm>);

}  // namespace graze
