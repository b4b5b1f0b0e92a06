// Real roots by Bezier clipping: the control polygon's convex hull says where p may be zero.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree, in double and float
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed past the option `budget`, with what was found,
//           or if no number bounds the roots of an unbounded question; invalid for coefficients that are
//           not finite. A group of pieces on which p cannot be told from zero is one root: simple if the
//           signs on both sides differ, else of multiplicity 2 if p is zero within the backward-error
//           rule of power_basis.hpp
// error     measured: at most kMeasuredBackward n u sum |c_i x^i| / |p'(x)| for simple roots
// cost      a piece: n^2 / 2 steps for its control points, at most (n + 1)^2 / 4 divisions for its hull;
//           4 to 6 pieces a well separated root, one a halving or so towards a touching one; no
//           allocation up to degree 32
// source    Sederberg, Nishita, "Curve intersection using Bezier clipping", CAD 22(9) (1990): clipping by
//           the convex hull, and splitting of what shrinks by less than 20 %. Changed:
//           control points are formed anew on each piece instead of by subdivision, so that their errors do
//           not add up; the hull is of points widened by those errors
#pragma once

#include <cstdint>

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class BezierClipping {
 public:
  /// Largest backward error of a root, in n u, over random polynomials of degree 2 to 20 (asserted in
  /// tests/solvers/bezier_clipping_test.cpp).
  static constexpr double kMeasuredBackward = 1;

  static SolverInfo info();
  explicit BezierClipping(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  double split_;
  std::uint32_t budget_;
};

static_assert(Solver<BezierClipping>);

}  // namespace graze
