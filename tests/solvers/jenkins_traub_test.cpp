// The three-stage algorithm: the classes of polynomials on which Jenkins tested it, the published hard cases,
// and what its header states.
#include <graze/solvers/jenkins_traub.hpp>

#include "solvers/complex_roots_cases.hpp"

namespace graze {
namespace {

using complex_cases::solve;
using complex_cases::with_roots;

Parameters polish(bool on) {
  Parameters options;
  options.set("polish", on);
  return options;
}

TEST(JenkinsTraub, PublishedHardCasesAreRightOrTheirRootsCannotBeToldApartInDouble) {
  complex_cases::expect_hard_cases<JenkinsTraub>({});
}

TEST(JenkinsTraub, EveryRootItListsIsARootOfANearbyPolynomial) {
  EXPECT_LE(complex_cases::worst_backward_error<JenkinsTraub>(), JenkinsTraub::kMeasuredBackward);
}

TEST(JenkinsTraub, AsPublishedItIsBackwardStableToAFewHundredUnits) {
  // Measured 161.
  EXPECT_LE(complex_cases::worst_backward_error<JenkinsTraub>(polish(false)), 256);
}

TEST(JenkinsTraub, PowersOfTwoInPolynomialAndUnknownChangeNoBit) {
  complex_cases::expect_scaling_is_exact<JenkinsTraub>();
}

/// Largest relative error of the roots listed, in the order of `expected`.
double worst_relative(const Roots& roots, std::vector<double> expected) {
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(roots.status, Status::ok);
  EXPECT_EQ(roots.list.size(), expected.size());
  double worst = 0;
  for (std::size_t i = 0; i < std::min(expected.size(), roots.list.size()); ++i) {
    worst = std::max(worst, std::fabs(roots.list[i].x / expected[i] - 1));
  }
  return worst;
}

// Jenkins' classes (1975): well separated, of different magnitudes, multiple, clustered, all on a circle.
TEST(JenkinsTraubClass, WellSeparatedZerosAreFoundToRounding) {
  const std::vector<double> x{1, -2, 3, -4, 5, -6, 7, -8};
  EXPECT_LE(worst_relative(solve<JenkinsTraub>(with_roots(x)), x), 1e-13);
  EXPECT_LE(worst_relative(solve<JenkinsTraub>(with_roots(x), polish(false)), x), 1e-11);
}

TEST(JenkinsTraubClass, ZerosOfDifferentMagnitudesAreFoundToRounding) {
  std::vector<double> x;
  for (int k = -8; k <= 8; k += 2) x.push_back((k % 4 == 0 ? 1 : -1) * std::pow(10.0, k));
  EXPECT_LE(worst_relative(solve<JenkinsTraub>(with_roots(x)), x), 1e-14);
  EXPECT_LE(worst_relative(solve<JenkinsTraub>(with_roots(x), polish(false)), x), 1e-13);
}

TEST(JenkinsTraubClass, DefectivePolynomialsKeepTheMultiplicityOfTheirZeros) {
  // (x - 1)^3 (x + 2)^2
  const Roots roots = solve<JenkinsTraub>({-4, 8, -1, -5, 1, 1});
  EXPECT_EQ(roots.status, Status::ok);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_EQ(roots.list[1].multiplicity, 3U);
  EXPECT_NEAR(roots.list[0].x, -2, 1e-6);
  EXPECT_NEAR(roots.list[1].x, 1, 1e-4);
}

TEST(JenkinsTraubClass, ClusteredZerosAreFoundAsFarAsTheirConditionAllows) {
  const std::vector<double> x{0.125, 0.1875, 0.25, 2, -3};
  EXPECT_LE(worst_relative(solve<JenkinsTraub>(with_roots(x)), x), 1e-12);
}

TEST(JenkinsTraubClass, ZerosOfOneModulusAreTheHardestForTheStagesAndStillFound) {
  for (const int n : {3, 4, 5, 8, 11, 12, 20}) {
    std::vector<double> c(static_cast<std::size_t>(n) + 1);
    c.front() = -1;
    c.back() = 1;
    const Roots roots = solve<JenkinsTraub>(c);
    EXPECT_EQ(roots.status, Status::ok) << n;
    ASSERT_EQ(roots.list.size(), n % 2 == 0 ? 2U : 1U) << n;
    EXPECT_NEAR(roots.list.back().x, 1, 1e-15) << n;
  }
}

TEST(JenkinsTraubClass, ConjugatePairsAreTakenTogetherAndAreNoRealRoots) {
  // (x^2 + 1)(x^2 + 4)(x - 1/2)
  const Roots roots = solve<JenkinsTraub>({-2, 4, -2.5, 5, -0.5, 1});
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_NEAR(roots.list[0].x, 0.5, 1e-15);
  EXPECT_TRUE(solve<JenkinsTraub>({1 + 0x1p-30, -2, 1}).list.empty());
}

TEST(JenkinsTraub, RatiosThatOverflowAreNoTrouble) {
  const Roots roots = solve<JenkinsTraub>({-1e300, 1, 1e-300});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_NEAR(roots.list[1].x / 6.180339887498949e299, 1, 1e-14);
}

TEST(JenkinsTraub, OptionsAreChecked) {
  Parameters options;
  options.set("polish", 3.0);
  EXPECT_THROW(JenkinsTraub{options}, std::invalid_argument);
}

}  // namespace
}  // namespace graze
