// Newton from outside and from equidistant starts: order, suppression, safeguards, and what it may miss.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/solvers/newton.hpp>

namespace graze {
namespace {

Newton newton(double starts = 32) {
  Parameters options;
  options.set("starts", starts);
  return Newton(options);
}

Roots solve(Jet (*eval)(const void*, double), double lo, double hi, double starts, int max_roots = 0) {
  Roots roots;
  newton(starts).solve(ScalarEquation{nullptr, eval, lo, hi, max_roots, 0}, roots);
  return roots;
}

/// Newton's own steps from |x| > 1.3917 run away from the root.
Jet arc_tangent(const void* /*self*/, double x) {
  const double d = 1 / (1 + x * x);
  return {std::atan(x), d, -2 * x * d * d, 0x1p-52};
}

// The classic case: from 2 on plain Newton for the arc tangent diverges.
TEST(Newton, HalvedStepsReachTheRootOfTheArcTangentFromAfar) {
  const Roots roots = solve(&arc_tangent, -50, 70, 2);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_NEAR(roots.list[0].x, 0, 1e-15);
}

TEST(Newton, OptionsAreChecked) { EXPECT_THROW(newton(0), std::invalid_argument); }

}  // namespace
}  // namespace graze
