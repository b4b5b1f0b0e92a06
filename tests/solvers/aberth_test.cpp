// Ehrlich-Aberth: the published hard cases, its discs, the bounds its header states, and why it starts where
// it does.
#include <graze/solvers/aberth.hpp>

#include "solvers/complex_roots_cases.hpp"

namespace graze {
namespace {

using complex_cases::solve;

TEST(Aberth, PublishedHardCasesAreRightOrTheirRootsCannotBeToldApartInDouble) {
  complex_cases::expect_hard_cases<Aberth>({});
}

TEST(Aberth, EveryRootItListsIsARootOfANearbyPolynomial) {
  EXPECT_LE(complex_cases::worst_backward_error<Aberth>(), Aberth::kMeasuredBackward);
}

TEST(Aberth, PowersOfTwoInPolynomialAndUnknownChangeNoBit) {
  complex_cases::expect_scaling_is_exact<Aberth>();
}

TEST(Aberth, TheDiscOfEverySimpleRootHoldsIt) {
  std::size_t held = 0;
  for (const HardPolynomial& hard : hard_polynomials()) {
    const Roots roots = solve<Aberth>(hard.c);
    if (roots.list.size() != hard.roots.size()) continue;
    for (std::size_t i = 0; i < hard.roots.size(); ++i) {
      if (roots.list[i].multiplicity > 1) continue;
      const long double error = std::fabs(static_cast<long double>(roots.list[i].x) - hard.wide_roots[i]);
      EXPECT_LE(error, static_cast<long double>(roots.list[i].radius)) << hard.origin << " " << i;
      ++held;
    }
  }
  EXPECT_GT(held, 50U);
}

TEST(Aberth, CoefficientErrorsWidenTheDiscs) {
  const std::vector<double> c{-1, 2}, error{0x1p-20, 0};
  PolynomialEquation equation;
  equation.c = c;
  equation.c_error = error;
  Roots roots;
  Aberth({}).solve(equation, roots);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_GE(roots.list[0].radius, 0x1p-21);
  EXPECT_LE(roots.list[0].radius, 0x1p-20);
}

TEST(Aberth, RootsOfVeryDifferentMagnitudesTakeNoMoreSweeps) {
  std::vector<double> spread;
  for (int k = -6; k <= 6; ++k) spread.push_back(std::pow(10.0, k));
  const std::vector<double> c = complex_cases::with_roots(spread);
  const Roots roots = solve<Aberth>(c);
  ASSERT_EQ(roots.list.size(), spread.size());
  for (std::size_t i = 0; i < spread.size(); ++i) {
    EXPECT_NEAR(roots.list[i].x / spread[i], 1, 1e-13);
  }
  std::printf("%u sweeps for 13 roots from 1e-6 to 1e6\n", roots.counters.iterations);
  EXPECT_LE(roots.counters.iterations, 20U);
}

TEST(Aberth, RatiosThatOverflowAreNoTrouble) {
  EXPECT_EQ(solve<Aberth>({1e300, 1, 1e-300}).status, Status::ok);
  EXPECT_TRUE(solve<Aberth>({1e300, 1, 1e-300}).list.empty());
  const Roots roots = solve<Aberth>({-1e300, 1, 1e-300});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_NEAR(roots.list[1].x / 6.180339887498949e299, 1, 1e-14);
}

TEST(Aberth, APairOffTheAxisIsNoRootAndADoubleRootIsOne) {
  EXPECT_TRUE(solve<Aberth>({1 + 0x1p-30, -2, 1}).list.empty());
  const Roots touch = solve<Aberth>({1, -2, 1});
  ASSERT_EQ(touch.list.size(), 1U);
  EXPECT_EQ(touch.list[0].multiplicity, 2U);
  EXPECT_NEAR(touch.list[0].x, 1, 1e-7);
}

TEST(Aberth, TwoAndThreeFoldRootsComeWithTheirMultiplicity) {
  // (x - 1)^3 (x + 2)^2
  const Roots roots = solve<Aberth>({-4, 8, -1, -5, 1, 1});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_EQ(roots.list[1].multiplicity, 3U);
  EXPECT_LE(std::fabs(roots.list[0].x + 2), roots.list[0].radius);
  EXPECT_LE(std::fabs(roots.list[1].x - 1), roots.list[1].radius);
}

}  // namespace
}  // namespace graze
