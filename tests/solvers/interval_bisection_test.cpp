// Bisection by intervals: epsilons by region, budget, and the radius its header states.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <graze/solvers/interval_bisection.hpp>

namespace graze {
namespace {

/// 16 (x - 1/4)(x - 3/4).
const std::vector<double> kTwoRoots{3, -16, 16};

Roots solve(const std::vector<double>& c, const Epsilons& epsilons = {}, double budget = 20000) {
  Parameters options;
  options.set("budget", budget);
  const PolynomialEquation equation{
      .c = c, .c_error = {}, .basis = Basis::power, .lo = 0, .hi = 1.1, .epsilons = epsilons};
  Roots roots;
  IntervalBisection(options).solve(equation, roots);
  return roots;
}

TEST(IntervalBisection, TheRadiusIsAtMostHalfTheEpsilonOfTheRootsRegion) {
  const std::vector<Region> parts{{0.5, 0x1p-10}, {2, 0x1p-30}};
  const Roots roots = solve(kTwoRoots, {parts, 0x1p-9, 0});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_LE(roots.list[0].radius, 0x1p-11);
  EXPECT_GT(roots.list[0].radius, 0x1p-14) << "a coarse region costs no more than it asks";
  EXPECT_LE(roots.list[1].radius, 0x1p-31);
  EXPECT_NEAR(roots.list[0].x, 0.25, roots.list[0].radius);
  EXPECT_NEAR(roots.list[1].x, 0.75, roots.list[1].radius);
}

TEST(IntervalBisection, ACoarserEpsilonCostsLess) {
  const std::vector<Region> fine{{2, 0x1p-40}};
  const std::vector<Region> coarse{{2, 0x1p-10}};
  EXPECT_LT(solve(kTwoRoots, {coarse, 0x1p-9, 0}).counters.evaluations,
            solve(kTwoRoots, {fine, 0x1p-9, 0}).counters.evaluations);
}

TEST(IntervalBisection, RootsAreCertifiedWithinTheDefaultEpsilon) {
  const Roots roots = solve(kTwoRoots);
  EXPECT_EQ(roots.status, Status::ok);
  for (const Root& root : roots.list) {
    EXPECT_TRUE(root.certified);
    EXPECT_LE(root.radius, IntervalBisection::kDefaultEps * 1.1);
  }
}

TEST(IntervalBisection, RunningOutOfBudgetIsUncertain) {
  EXPECT_EQ(solve(kTwoRoots, {}, 10).status, Status::uncertain);
}

TEST(IntervalBisection, ATouchingRootIsUncertainAndListsNothingUnproved) {
  const Roots roots = solve({1, -4, 4});
  EXPECT_EQ(roots.status, Status::uncertain);
  EXPECT_TRUE(roots.list.empty());
}

TEST(IntervalBisection, RootsCloserThanTheGrazingEpsilonAreUncertainOrBothFound) {
  for (int k = 4; k <= 26; ++k) {
    const double e = std::ldexp(1.0, -k);
    const Roots roots = solve({(1 - e) * (1 + e), -2, 1});
    if (roots.status == Status::ok) {
      EXPECT_EQ(roots.list.size(), e <= 0.1 ? 2U : 1U) << k;
    }
    EXPECT_LE(roots.list.size(), 2U) << k;
    if (k <= 10) {
      EXPECT_EQ(roots.status, Status::ok) << k;
    }
  }
}

TEST(IntervalBisection, OptionsAreChecked) { EXPECT_THROW(solve(kTwoRoots, {}, 3), std::invalid_argument); }

}  // namespace
}  // namespace graze
