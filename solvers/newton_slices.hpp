// Newton's method from random slices of the bounding cylinder.
//
// solves    F(t, u, theta) = 0 (form system), or f(x) = 0 from random points of [lo, hi] (form scalar)
// needs     the equation's start-value generator, bounds and residual scale
// returns   ok with the distinct roots it found: nothing says that there are no others
// error     measured; radius = what the residual's rounding leaves open (solvers/slices.hpp)
// cost      `tries` starts (default 30, document 003), at most kSteps Newton steps each
// source    document 003, with the Jacobian's signs corrected; seeded by the equation, so that the same ray
//           gives the same answer in any order and thread
#pragma once

#include <graze/solvers/slices.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class NewtonSlices {
 public:
  /// A touching root halves its error a step: 50 reach sqrt(u) from anywhere.
  static constexpr int kSteps = 50;

  static SolverInfo info();
  explicit NewtonSlices(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicSystemEquation<T>& equation, Roots& roots) const;
  template <class T>
  void solve(const BasicScalarEquation<T>& equation, Roots& roots) const;

 private:
  int tries_;
  std::uint64_t seed_;
};

static_assert(Solver<NewtonSlices>);

}  // namespace graze
