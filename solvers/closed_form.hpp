// Roots by formula: equations of degree 1 to 4.
//
// solves    c0 + c1 x + ... + c4 x^4 = 0 on [lo, hi], power or Bernstein basis, in double and float
// needs     finite coefficients, degree at most 4 (leading zeros do not count)
// returns   ok; coincident for the zero polynomial; failed above degree 4, and where a cubic's or quartic's
//           factors leave the range or do not reproduce its coefficients; invalid for coefficients that are
//           not finite. Degree 1 and 2: a double root, where the discriminant is exactly zero, has
//           multiplicity 2. Degree 3 and 4: what counts as a real root is power_basis.hpp's rule
// error     degree 1 and 2: at most kError ulps of each root for coefficients that are exact numbers
//           (proof: solvers/closed_form.md), also where b^2 and ac nearly cancel; radius = that bound, and
//           what the coefficients' errors leave open. Degree 3 and 4: measured: the roots are exact for
//           coefficients that differ by at most kCubicBackward or kQuarticBackward u of the sum of their
//           terms (solvers/math/cubic.hpp, quartic.hpp); radius = what power_basis.hpp's rule leaves open
// cost      degree 2: at most 1 square root, 3 divisions and 2 fused multiply-adds; degree 3 and 4: about 6
//           steps on a cubic, for degree 4 also 1 or 2 on the factors, and an evaluation a root. No
//           allocation
// source    degree 2: Kahan, "On the cost of floating-point computation without extra-precise arithmetic"
//           (2004), and the error bound of Jeannerod, Louvet, Muller, Math. Comp. 82 (2013), theorem 1.2;
//           degree 3: Kahan, "To solve a real cubic equation" (1986); degree 4: Orellana, De Michele,
//           "Algorithm 1010", ACM TOMS 46(2), 2020
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class ClosedForm {
 public:
  /// Largest error of a root of degree 1 or 2, in ulps of the root (asserted in
  /// tests/solvers/closed_form_test.cpp).
  static constexpr int kError = 4;

  static SolverInfo info();
  explicit ClosedForm(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;
};

static_assert(Solver<ClosedForm>);

}  // namespace graze
