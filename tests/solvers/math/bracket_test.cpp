// Newton's method in a bracket: it ends at the root, cannot leave, and does not crawl.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/solvers/math/bracket.hpp>

namespace graze {
namespace {

struct Value {
  double value, derivative;
};

constexpr auto kNoNoise = [](double) { return 0.0; };

TEST(Bracket, NewtonReachesTheSquareRootOfTwoToTheLastBits) {
  const auto f = [](double x) { return Value{x * x - 2, 2 * x}; };
  const auto root = newton_in_bracket(f, kNoNoise, 0.0, 2.0, true, BracketStop<double>{});
  EXPECT_TRUE(root.converged);
  EXPECT_NEAR(root.x, std::sqrt(2.0), 0x1p-52);
  EXPECT_LE(root.steps, 7U);
}

// From 5 the tangent of atan leads far outside; only the bracket keeps the steps in.
TEST(Bracket, AStepThatLeavesIsReplacedByTheMiddle) {
  const auto f = [](double x) { return Value{std::atan(x - 1), 1 / (1 + (x - 1) * (x - 1))}; };
  const auto root = newton_in_bracket(f, kNoNoise, -10.0, 20.0, true, BracketStop<double>{});
  EXPECT_TRUE(root.converged);
  EXPECT_NEAR(root.x, 1, 0x1p-51);
}

TEST(Bracket, ATripleRootIsReachedWithoutCrawling) {
  const auto f = [](double x) { return Value{(x - 0.3) * (x - 0.3) * (x - 0.3), 3 * (x - 0.3) * (x - 0.3)}; };
  const auto root = newton_in_bracket(f, kNoNoise, -1.0, 4.0, true, BracketStop<double>{});
  EXPECT_TRUE(root.converged);
  EXPECT_NEAR(root.x, 0.3, 0x1p-50);
  EXPECT_LE(root.steps, 120U);
}

TEST(Bracket, AJumpIsFoundByHalving) {
  const auto f = [](double x) { return Value{x < 0.1 ? -1.0 : 1.0, 0.0}; };
  const auto root = newton_in_bracket(f, kNoNoise, -1e10, 1e10, true, BracketStop<double>{});
  EXPECT_TRUE(root.converged);
  EXPECT_NEAR(root.x, 0.1, 0x1p-52);
}

TEST(Bracket, ALooseStopSavesSteps) {
  const auto f = [](double x) { return Value{std::exp(x) - 5, std::exp(x)}; };
  const auto exact = newton_in_bracket(f, kNoNoise, -4.0, 8.0, true, BracketStop<double>{});
  const auto loose = newton_in_bracket(
      f, kNoNoise, -4.0, 8.0, true, BracketStop<double>{.relative = 0x1p-10, .predicted = 0, .absolute = 0});
  EXPECT_LT(loose.steps, exact.steps);
  EXPECT_NEAR(loose.x, std::log(5.0), 1e-5);
}

TEST(Bracket, AFunctionBelowItsNoiseEndsTheSearch) {
  const auto f = [](double) { return Value{1e-20, 0.0}; };
  const auto root = newton_in_bracket(
      f, [](double) { return 1e-19; }, 0.0, 1.0, true, BracketStop<double>{});
  EXPECT_EQ(root.steps, 1U);
}

TEST(Bracket, PowersOfTwoScaleTheRootExactly) {
  for (const int m : {-700, -3, 5, 400}) {
    const double s = std::ldexp(1.0, m);
    const auto f = [s](double x) { return Value{(x / s) * (x / s) - 3, 2 * (x / s) / s}; };
    const auto plain = newton_in_bracket(
        [](double x) {
          return Value{x * x - 3, 2 * x};
        },
        kNoNoise, 0.0, 4.0, true, BracketStop<double>{});
    const auto root = newton_in_bracket(f, kNoNoise, 0.0, 4.0 * s, true, BracketStop<double>{});
    EXPECT_EQ(root.x, plain.x * s) << m;
  }
}

}  // namespace
}  // namespace graze
