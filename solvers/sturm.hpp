// Real roots by Sturm's theorem: sign variations of a remainder sequence count roots between two points.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree, in double and float
// needs     finite coefficients
// returns   ok; uncertain if rounding cut the sequence short: a leading coefficient was lost to it, or
//           the last member is no constant and does not divide p to half of the digits; coincident for
//           the zero polynomial; failed past the option `budget`, with what was found, or if no number
//           bounds the roots of an unbounded question; invalid for coefficients that are not finite. A
//           repeated root counts once, with multiplicity 1 where p changes sign and 2 where it does not
// error     of a simple root: measured, at most kMeasuredBackward n u sum |c_i x^i| / |p'(x)|. Of the
//           count: nothing bounds it; remainders lose digits, and below 16 n u of the terms they were
//           subtracted from they count as zero (solvers/sturm.md). A change of sign of p is never passed
//           over
// cost      n^2 operations for the sequence, n^2 / 2 for each count; about log2(length / gap) counts a
//           root, then 3 to 6 Newton steps; no allocation up to degree 32
// source    Sturm 1829; Basu, Pollack, Roy, "Algorithms in Real Algebraic Geometry", 2nd ed., Springer
//           2006, section 2.2. Changed: floating point, remainders scaled by powers of two
#pragma once

#include <cstdint>

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Sturm {
 public:
  /// Largest backward error of a root, in n u, over random polynomials of degree 2 to 20 (asserted in
  /// tests/solvers/sturm_test.cpp).
  static constexpr double kMeasuredBackward = 1;

  static SolverInfo info();
  explicit Sturm(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  std::uint32_t budget_;
};

static_assert(Solver<Sturm>);

}  // namespace graze
