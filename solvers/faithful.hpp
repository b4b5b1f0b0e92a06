// Every root, and every l to the last digit: within 1 ulp of the exact l on every ray.
//
// solves    p(x) = 0 (form polynomial, any degree, any basis) or f(x) = 0 by inclusions (form interval) on
//           the closed interval [lo, hi]
// needs     the equation's exact coefficients (PolynomialEquation::exact, or c itself where c_error is empty)
// returns   ok: the roots, all of them and no other, with their multiplicities, each `placed`; uncertain:
//           coefficients that are not exact, or inclusions, leave the count or a digit of l open (the listed
//           roots are proved still); coincident for the zero polynomial; invalid for coefficients that are
//           not finite
// error     |fl(origin + x + tail) - l| <= 1 ulp(l), proved; 1/2 ulp where no other root is as near
// cost      as certified, and in addition integers: microseconds a root
// source    graze; derivation: solvers/faithful.md
#pragma once

#include <graze/solvers/certified.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Faithful {
 public:
  static SolverInfo info();
  explicit Faithful(const Parameters& options);
  void solve(const PolynomialEquation& equation, Roots& roots) const;
  void solve(const IntervalEquation& equation, Roots& roots) const;

 private:
  Certified certified_;
};

static_assert(Solver<Faithful>);

}  // namespace graze
