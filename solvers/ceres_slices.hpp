// Ceres (Levenberg-Marquardt with bounds), or its TinySolver, from random slices of the bounding cylinder.
//
// solves    min |F(t, u, theta)|^2 (form system) or min f(x)^2 (form scalar); a minimum whose residual is
//           rounding is a root
// needs     as newton_slices
// returns   ok with the distinct roots it found: nothing says that there are no others
// error     measured; radius as newton_slices
// cost      `tries` starts, at most kIterations each; the full solver allocates (about 100 us a start),
//           tiny = true does not
// source    document 003; Ceres Solver 2.1, http://ceres-solver.org
#pragma once

#include <graze/solvers/slices.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class CeresSlices {
 public:
  static constexpr int kIterations = 50;  ///< Ceres' own default

  static SolverInfo info();
  explicit CeresSlices(const Parameters& options);
  void solve(const SystemEquation& equation, Roots& roots) const;
  void solve(const ScalarEquation& equation, Roots& roots) const;

 private:
  template <int N>
  void solve_system(const SystemEquation& equation, Roots& roots) const;

  int tries_;
  std::uint64_t seed_;
  bool tiny_;
};

static_assert(Solver<CeresSlices>);

}  // namespace graze
