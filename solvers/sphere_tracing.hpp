// Sphere tracing: steps by a bound of how far the next root must be.
//
// solves    f(x) = 0 on [lo, hi] by inclusion functions (form interval), or with two derivatives at
//           points (form scalar)
// needs     interval: inclusions of f and f'; scalar: f smooth, with its derivatives and error bound
// returns   interval: ok: the listed roots are proved, and there is no other; uncertain: some places
//           could not be decided (touching roots always). Scalar: ok with the roots it met; failed past
//           kSteps evaluations, with those met before. Invalid for an interval that is none
// error     interval: radius proved, at most half the epsilon of the root's region, or half the grazing
//           one; scalar: the tolerance, and what the error bound of f leaves open
// misses    interval: none. Scalar: pairs of roots that one step passes, where f turns faster than f'' at
//           the step's start says
// cost      interval: 2 to 5 evaluations a step; a step is a fixed part of the way to the nearest root
//           until f' is known to 2 digits, then it squares the relative distance; at most `budget`
//           evaluations. Scalar: 1 evaluation a step. No allocation after warm-up
// source    Hart, "Sphere tracing", The Visual Computer 12 (1996), section 2.2 (a Lipschitz bound gives
//           the step); Kalra, Barr, "Guaranteed ray intersections with implicit surfaces", SIGGRAPH 1989
//           (bounds of f and f' over the rest of the ray, refined); Keinert et al., "Enhanced sphere
//           tracing", STAG 2014, section 3.1 (over-relaxation)
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class SphereTracing {
 public:
  static constexpr int kSteps = 20000;  ///< evaluations of a scalar function before it gives up

  static SolverInfo info();
  explicit SphereTracing(const Parameters& options);
  void solve(const IntervalEquation& equation, Roots& roots) const;
  template <class T>  // double, float
  void solve(const BasicScalarEquation<T>& equation, Roots& roots) const;

 private:
  double tolerance_;
  double relaxation_;
  std::uint32_t budget_;
};

static_assert(Solver<SphereTracing>);

}  // namespace graze
