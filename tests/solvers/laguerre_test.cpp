// Laguerre's method: the published hard cases, deflation in any order, and the convergence that is known.
#include <graze/solvers/laguerre.hpp>

#include "solvers/complex_roots_cases.hpp"

namespace graze {
namespace {

using complex_cases::solve;

Parameters polish(bool on) {
  Parameters options;
  options.set("polish", on);
  return options;
}

TEST(Laguerre, PublishedHardCasesAreRightOrTheirRootsCannotBeToldApartInDouble) {
  complex_cases::expect_hard_cases<Laguerre>({
      {"Jenkins, Traub 1975, TOMS 1(1), p5", 4, "rounding parts the roots of multiplicity 4 and 3"},
      {"Zeng 2004, TOMS 30(2), after Uhlig: (x+1)^6", 3, "rounding parts the root of multiplicity 6"},
  });
}

TEST(Laguerre, EveryRootItListsIsARootOfANearbyPolynomial) {
  EXPECT_LE(complex_cases::worst_backward_error<Laguerre>(), Laguerre::kMeasuredBackward);
}

TEST(Laguerre, WithoutThePolishDeflationAloneStaysBackwardStable) {
  // n divisions, each an error of some n u: 64 (measured 39.2).
  EXPECT_LE(complex_cases::worst_backward_error<Laguerre>(polish(false)), 64);
}

TEST(Laguerre, PowersOfTwoInPolynomialAndUnknownChangeNoBit) {
  complex_cases::expect_scaling_is_exact<Laguerre>();
}

// Peters and Wilkinson 1971: division by descending powers ruins the small roots if large ones go first.
TEST(Laguerre, DeflationKeepsRootsOfVeryDifferentMagnitudes) {
  std::vector<double> spread;
  for (int k = -6; k <= 6; ++k) spread.push_back((k % 2 == 0 ? 1 : -1) * std::pow(10.0, k));
  const std::vector<double> c = complex_cases::with_roots(spread);
  std::sort(spread.begin(), spread.end());
  const Roots roots = solve<Laguerre>(c, polish(false));
  ASSERT_EQ(roots.list.size(), spread.size());
  for (std::size_t i = 0; i < spread.size(); ++i) EXPECT_NEAR(roots.list[i].x / spread[i], 1, 1e-12);
}

// All roots real: Laguerre's steps from any real start never pass the next root, and are of third order.
TEST(Laguerre, LegendresPolynomialTakesFewStepsARoot) {
  const std::vector<double> c{-63, 0, 3465, 0, -30030, 0, 90090, 0, -109395, 0, 46189};  // 256 P_10
  const Roots roots = solve<Laguerre>(c);
  ASSERT_EQ(roots.list.size(), 10U);
  std::printf("%u steps, %u evaluations\n", roots.counters.iterations, roots.counters.evaluations);
  EXPECT_LE(roots.counters.iterations, 60U);
  EXPECT_NEAR(roots.list[9].x, 0.9739065285171717, 1e-14);
  EXPECT_NEAR(roots.list[5].x, 0.1488743389816312, 1e-15);
}

// G = H = 0 at the start: the method needs its new start.
TEST(Laguerre, BinomialsAreSolvedThoughTheirDerivativesVanishAtTheStart) {
  for (const int n : {3, 5, 8, 12}) {
    std::vector<double> c(static_cast<std::size_t>(n) + 1);
    c.front() = -1;
    c.back() = 1;
    const Roots roots = solve<Laguerre>(c);
    EXPECT_EQ(roots.status, Status::ok);
    ASSERT_EQ(roots.list.size(), n % 2 == 0 ? 2U : 1U) << n;
    EXPECT_NEAR(roots.list.back().x, 1, 1e-15);
  }
}

TEST(Laguerre, MultipleRootsComeWithTheirMultiplicity) {
  // (x - 1)^3 (x + 2)^2
  const Roots roots = solve<Laguerre>({-4, 8, -1, -5, 1, 1});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_EQ(roots.list[1].multiplicity, 3U);
  EXPECT_NEAR(roots.list[0].x, -2, 1e-7);
  EXPECT_NEAR(roots.list[1].x, 1, 1e-4);
}

TEST(Laguerre, RatiosThatOverflowAreNoTrouble) {
  const Roots roots = solve<Laguerre>({-1e300, 1, 1e-300});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_NEAR(roots.list[1].x / 6.180339887498949e299, 1, 1e-14);
}

TEST(Laguerre, APairOffTheAxisIsNoRoot) { EXPECT_TRUE(solve<Laguerre>({1 + 0x1p-30, -2, 1}).list.empty()); }

TEST(Laguerre, OptionsAreChecked) {
  Parameters options;
  options.set("polish", 3.0);
  EXPECT_THROW(Laguerre{options}, std::invalid_argument);
}

}  // namespace
}  // namespace graze
