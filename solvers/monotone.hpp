// Real roots by a cascade of derivatives: the roots of p' cut the interval into pieces on which p is
// monotone.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree, in double and float
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed if no number bounds the roots of an unbounded
//           question, or past the steps' budget (halving excludes it); invalid for coefficients that are
//           not finite. Simple roots have opposite signs of the computed p beside them; with `touching` a
//           critical point at which p is zero within the backward-error rule of power_basis.hpp is a root
//           of multiplicity 2
// error     measured: at most kMeasuredBackward n u sum |c_i x^i| / |p'(x)| for simple roots; with
//           `tolerance` > 0 that fraction of the interval's width. radius: 16 n u sum |c_i x^i| / |p'(x)|
// cost      Horner's rule and one division a step, 3 to 6 steps for each real root of each derivative in
//           the interval, 2 evaluations a piece; no allocation up to degree 32
// source    Yuksel, "High-performance polynomial root finding for graphics", Proc. ACM Comput. Graph.
//           Interact. Tech. 5(3) (HPG 2022): the derivatives' roots bound monotone pieces, Newton's method
//           with bisection in each. Changed: steps end at rounding instead of a fixed width
//           (tolerance gives his back), critical points end at u^(1/3) |x|, tangent roots are reported
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Monotone {
 public:
  /// Largest backward error of a root, in n u, over random polynomials of degree 2 to 20 (asserted in
  /// tests/solvers/monotone_test.cpp).
  static constexpr double kMeasuredBackward = 1;

  static SolverInfo info();
  explicit Monotone(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  double tolerance_;
  bool touching_;
};

static_assert(Solver<Monotone>);

}  // namespace graze
