// Real roots by Descartes' rule in the Bernstein basis, every sign decided with its rounding error.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis with the coefficients' error bounds, degree at
//           most 64, in double and float; unbounded questions within their root bound (exact
//           coefficients)
// needs     finite coefficients
// returns   in double: ok: the listed roots are proved, each simple and alone in [x - radius, x +
//           radius], and there is no other; uncertain: on some piece the signs could not be told
//           (touching roots always end here), or the option `budget` was spent; the listed roots are
//           proved still; coincident for the zero polynomial; failed above degree 64; invalid for
//           coefficients that are not finite. In float nothing is proved: a piece on which p cannot be
//           told from zero is a root as in bezier_clipping.hpp
//           An equation with ExactCoefficients::near is searched further: what doubles leave open is
//           computed in double-double, down to pieces of 2^-36 of the interval, and the search ends at the
//           first that is open still
// error     radius, proved (double): the nearest points on both sides at which the sign of p is certain
// cost      a piece: n^2 / 2 steps of 60 operations; 1 to 2 pieces a bisection until the roots are apart,
//           then 3 to 6 Newton steps and 2 or more signs a root; no allocation up to degree 32
// source    Collins, Akritas, SYMSAC 1976; in the Bernstein basis Lane, Riesenfeld, BIT 21 (1981); that a
//           piece with exactly one sign variation holds exactly one root, a simple one: Basu, Pollack,
//           Roy, "Algorithms in Real Algebraic Geometry", 2nd ed., Springer 2006, chapter 10. Changed:
//           coefficients with error bars, formed anew on each piece so that the bars do not grow
#pragma once

#include <cstdint>

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Descartes {
 public:
  static SolverInfo info();
  explicit Descartes(const Parameters& options);
  void solve(const BasicPolynomialEquation<double>& equation, Roots& roots) const;
  void solve(const BasicPolynomialEquation<float>& equation, Roots& roots) const;

 private:
  std::uint32_t budget_;
};

static_assert(Solver<Descartes>);

}  // namespace graze
