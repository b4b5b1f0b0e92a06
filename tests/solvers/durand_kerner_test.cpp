// Weierstrass's iteration: the published hard cases, its two starts, and the order that Kerner proves.
#include <graze/solvers/durand_kerner.hpp>

#include "solvers/complex_roots_cases.hpp"

namespace graze {
namespace {

using complex_cases::solve;

Parameters start_from(const std::string& start) {
  Parameters options;
  options.set("start", start);
  return options;
}

class DurandKernerFrom : public testing::TestWithParam<std::string> {};

TEST_P(DurandKernerFrom, PublishedHardCasesAreRightOrTheirRootsCannotBeToldApartInDouble) {
  complex_cases::expect_hard_cases<DurandKerner>({}, start_from(GetParam()));
}

TEST_P(DurandKernerFrom, EveryRootItListsIsARootOfANearbyPolynomial) {
  EXPECT_LE(complex_cases::worst_backward_error<DurandKerner>(start_from(GetParam())),
            DurandKerner::kMeasuredBackward);
}

TEST_P(DurandKernerFrom, PowersOfTwoInPolynomialAndUnknownChangeNoBit) {
  complex_cases::expect_scaling_is_exact<DurandKerner>(start_from(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Starts, DurandKernerFrom, testing::Values("circle", "polygon"),
                         [](const auto& start) { return start.param; });

TEST(DurandKerner, TheNewtonPolygonSavesSweepsWhereRootsDifferInSize) {
  std::vector<double> spread;
  for (int k = -3; k <= 3; ++k) spread.push_back(std::pow(10.0, k));
  const std::vector<double> c = complex_cases::with_roots(spread);
  const Roots circle = solve<DurandKerner>(c, start_from("circle"));
  const Roots polygon = solve<DurandKerner>(c, start_from("polygon"));
  std::printf("sweeps: circle %u, polygon %u\n", circle.counters.iterations, polygon.counters.iterations);
  EXPECT_LT(2 * polygon.counters.iterations, circle.counters.iterations);
  ASSERT_EQ(circle.list.size(), 7U);
  ASSERT_EQ(polygon.list.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_NEAR(circle.list[i].x / spread[i], 1, 1e-13);
    EXPECT_NEAR(polygon.list[i].x / spread[i], 1, 1e-13);
  }
}

// Kerner 1966: quadratic at simple roots, linear with factor 1 - 1/m at roots of multiplicity m.
TEST(DurandKerner, DoubleRootsTakeAtLeastTwiceTheSweepsOfSimpleOnes) {
  const Roots simple = solve<DurandKerner>({6, -5, -2, 1});   // 1, 3, -2
  const Roots twofold = solve<DurandKerner>({-2, 5, -4, 1});  // 1, 1, 2
  std::printf("sweeps: simple %u, double %u\n", simple.counters.iterations, twofold.counters.iterations);
  EXPECT_LE(simple.counters.iterations, 15U);
  EXPECT_GE(twofold.counters.iterations, 2 * simple.counters.iterations);
  EXPECT_LE(twofold.counters.iterations, 45U);
  ASSERT_EQ(twofold.list.size(), 2U);
  EXPECT_EQ(twofold.list[0].multiplicity, 2U);
  EXPECT_NEAR(twofold.list[0].x, 1, 1e-7);
}

TEST(DurandKerner, RatiosThatOverflowAreNoTrouble) {
  EXPECT_EQ(solve<DurandKerner>({1e300, 1, 1e-300}).status, Status::ok);
  const Roots roots = solve<DurandKerner>({-1e300, 1, 1e-300});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_NEAR(roots.list[1].x / 6.180339887498949e299, 1, 1e-14);
}

TEST(DurandKerner, APairOffTheAxisIsNoRoot) {
  EXPECT_TRUE(solve<DurandKerner>({1 + 0x1p-30, -2, 1}).list.empty());
}

TEST(DurandKerner, OptionsAreChecked) {
  EXPECT_THROW(DurandKerner{start_from("square")}, std::invalid_argument);
  Parameters number;
  number.set("start", 3.0);
  EXPECT_THROW(DurandKerner{number}, std::invalid_argument);
}

}  // namespace
}  // namespace graze
