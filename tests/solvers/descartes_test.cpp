// Descartes' rule with certain signs: certificates that hold, honest doubt, the published hard inputs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include <graze/solvers/descartes.hpp>

#include "solvers/realroots_testing.hpp"

namespace graze {
namespace {

using namespace realroots;

const Parameters kNone;

Roots ask(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
  return solve(Descartes(kNone), c, lo, hi);
}

/// Signs of p at both ends of the enclosure, in long double, differ; their own rounding is 2^-11 of what the
/// solver had to overcome.
bool encloses_a_change_of_sign(const std::vector<double>& c, const Root& root) {
  if (root.radius == 0) return evaluate_wide(c, static_cast<long double>(root.x)).value == 0;
  const long double below = evaluate_wide(c, static_cast<long double>(root.x - root.radius)).value;
  const long double above = evaluate_wide(c, static_cast<long double>(root.x + root.radius)).value;
  return (below < 0) != (above < 0);
}

TEST(Descartes, RandomPolynomialsAreCertifiedWithTightEnclosures) {
  constexpr std::uint64_t kSeed = 20261122;
  Rng rng(kSeed);
  double worst = 0;
  for (int degree = 2; degree <= 20; ++degree) {
    double pieces = 0, found = 0;
    int ok = 0;
    constexpr int kCount = 200;
    for (int i = 0; i < kCount; ++i) {
      const std::vector<double> c = random_coefficients(rng, degree);
      const Roots roots = ask(c, -1, 1);
      ok += roots.status == Status::ok ? 1 : 0;
      EXPECT_GE(static_cast<int>(roots.list.size()), sign_changes_on_a_grid(c, -1, 1, 256)) << degree;
      for (const Root& root : roots.list) {
        EXPECT_TRUE(root.certified);
        EXPECT_TRUE(encloses_a_change_of_sign(c, root)) << degree << " " << root.x;
        worst = std::max(worst, root.radius / (condition_unit(c, root.x) + 0x1p-53 * std::fabs(root.x)));
      }
      pieces += roots.counters.iterations;
      found += static_cast<double>(roots.list.size());
    }
    EXPECT_EQ(ok, kCount) << degree;
    std::printf("degree %2d: %.2f roots, %.1f steps\n", degree, found / kCount, pieces / kCount);
  }
  std::printf("seed %llu: widest radius %.3g condition units\n", static_cast<unsigned long long>(kSeed),
              worst);
  EXPECT_LE(worst, 32);
}

/// prod (x - k / 64) over integers k: all coefficients are doubles up to degree 5.
TEST(Descartes, EnclosuresHoldTheKnownRootsOfBuiltPolynomials) {
  Rng rng(3);
  int certified = 0;
  for (int i = 0; i < 2000; ++i) {
    const int degree = 1 + i % 5;
    std::vector<double> c{1}, known;
    for (int k = 0; k < degree; ++k) {
      const double x = std::floor(rng.uniform(-512, 512)) / 64;
      known.push_back(x);
      c.push_back(0);
      for (std::size_t j = c.size(); j-- > 0;) c[j] = (j > 0 ? c[j - 1] : 0) - x * c[j];
    }
    const Roots roots = ask(c, -9, 9);
    for (const Root& root : roots.list) {
      const auto inside = [&](double x) { return std::fabs(x - root.x) <= root.radius; };
      EXPECT_EQ(std::count_if(known.begin(), known.end(), inside), 1) << i;
      ++certified;
    }
    if (roots.status == Status::ok) {
      EXPECT_EQ(roots.list.size(), known.size()) << i;
    }
  }
  EXPECT_GT(certified, 5000);
}

TEST(Descartes, ATouchingRootIsNeverCertifiedAndNeverPassedOver) {
  EXPECT_EQ(ask({0.25, -1, 1}, -1, 2).status, Status::uncertain);
  EXPECT_TRUE(ask({0.25, -1, 1}, -1, 2).list.empty());
  const Roots beside = ask({-2, 5, -4, 1}, 0, 4);  // (x - 1)^2 (x - 2)
  EXPECT_EQ(beside.status, Status::uncertain);
  ASSERT_EQ(beside.list.size(), 1U);
  EXPECT_NEAR(beside.list[0].x, 2, beside.list[0].radius);
}

TEST(Descartes, APairJustOffTheAxisIsProvedToBeNone) {
  const Roots roots = ask({1 + 0x1p-40, -2, 1}, -4, 4);
  EXPECT_EQ(roots.status, Status::ok);
  EXPECT_TRUE(roots.list.empty());
}

TEST(Descartes, ADoubleRootAtAClosedEndIsNoSimpleOne) {
  EXPECT_EQ(ask({0, 0, 1, 1}, 0, 1).status, Status::uncertain);
  const Roots simple = ask({0, -1, 2}, 0, 1);
  EXPECT_EQ(simple.status, Status::ok);
  ASSERT_EQ(simple.list.size(), 2U);
  EXPECT_EQ(simple.list[0].x, 0);
  EXPECT_EQ(simple.list[0].radius, 0);
}

TEST(Descartes, AnEndWithinRoundingOfARootIsUncertain) {
  EXPECT_EQ(ask({-1, 3}, 1.0 / 3, 1).status, Status::uncertain);
  EXPECT_EQ(ask({-1, 3}, 0.3333334, 1).status, Status::ok);
}

TEST(Descartes, CoefficientErrorsAreInTheRadius) {
  const std::vector<double> c{-2, 0, 1}, error{0x1p-30, 0, 0};
  PolynomialEquation equation;
  equation.c = c;
  equation.c_error = error;
  equation.lo = 0;
  equation.hi = 2;
  Roots roots;
  Descartes(kNone).solve(equation, roots);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.status, Status::ok);
  // The root of x^2 = 2 +- e is sqrt(2) +- e / (2 sqrt(2)).
  EXPECT_GE(roots.list[0].radius, 0x1p-30 / 3);
  EXPECT_LE(roots.list[0].radius, 0x1p-30 * 8);
}

TEST(Descartes, BernsteinCoefficientsAreTakenAsTheyAre) {
  const Roots roots = solve(Descartes(kNone), std::vector<double>{-1, 1, -1, 2}, 2, 6, Basis::bernstein);
  EXPECT_EQ(roots.status, Status::ok);
  for (const Root& root : roots.list) EXPECT_TRUE(root.certified && root.x > 2 && root.x < 6);
  EXPECT_EQ(roots.list.size() % 2, 1U);
}

TEST(Descartes, PowersOfTwoScaleTheRootsExactly) {
  Rng rng(7);
  for (int i = 0; i < 300; ++i) {
    const std::vector<double> c = random_coefficients(rng, 1 + i % 14);
    for (const auto& [k, m] : {std::pair{600, 0}, std::pair{-600, 0}, std::pair{3, 20}, std::pair{-5, -20}})
      EXPECT_TRUE(scales_exactly(Descartes(kNone), c, k, m)) << i << " " << k << " " << m;
  }
}

TEST(Descartes, PublishedHardInputsAreCertifiedOrLeftOpen) {
  // Where rounding hides the signs between neighbours, or of a multiple root: said so.
  const std::vector<std::string> open{
      "Wilkinson 1963, degree 20", "cluster 1 +- 2^-26", "cyCodeBase issue 24",
      "multiple roots in the manner of Zeng", "Flocke, Algorithm 954 (2015), cubic of roots 1, 1.000001",
      "Flocke, Algorithm 954 (2015), cubic of roots -1, 1e14", "Jenkins, Traub 1975, TOMS 1(1), p4",
      "Jenkins, Traub 1975, TOMS 1(1), p5", "Jenkins, Traub 1975, TOMS 1(1), p6",
      "Jenkins, Traub 1975, TOMS 1(1), p7", "Jenkins, Traub 1975, TOMS 1(1), p8",
      "Orellana, De Michele 2020, Algorithm 1010, case 14",
      "Orellana, De Michele 2020, Algorithm 1010, case 15",
      "Orellana, De Michele 2020, Algorithm 1010, case 20",
      "Orellana, De Michele 2020, Algorithm 1010, case 21", "Zeng 2004, TOMS 30(2), after Uhlig",
      // sums of terms that leave the doubles
      "Orellana, De Michele 2020, Algorithm 1010, case 22",
      "Flocke, Algorithm 954 (2015), quartic of roots 1e80"};
  const auto all = hard_polynomials();
  ASSERT_GE(all.size(), 21U);
  for (const HardPolynomial& p : all) {
    const Roots roots = ask(p.c);
    const double error = worst_error(p, roots);
    std::printf("%-60.60s %zu certified, %.3g condition units, %u steps%s\n", p.origin.c_str(),
                roots.list.size(), error, roots.counters.iterations,
                roots.status == Status::ok ? "" : ", uncertain");
    for (const Root& root : roots.list) {
      // The stored root is rounded.
      const auto inside = [&](double x) {
        return std::fabs(x - root.x) <= root.radius + 0x1p-53 * std::fabs(x);
      };
      EXPECT_EQ(std::count_if(p.roots.begin(), p.roots.end(), inside), 1) << p.origin << " " << root.x;
    }
    EXPECT_EQ(roots.status, is_one_of(p.origin, open) ? Status::uncertain : Status::ok) << p.origin;
    if (is_one_of(p.origin, open)) continue;
    EXPECT_LE(error, 8) << p.origin;
  }
}

TEST(Descartes, FloatsAreSolvedWithoutCertificates) {
  const Roots roots = solve(Descartes(kNone), std::vector<float>{-2, 5, -4, 1}, 0, 4);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_NEAR(roots.list[1].x, 2, 1e-5);
  EXPECT_FALSE(roots.list[1].certified);
}

TEST(Descartes, DegreesAboveTheBinomialsAreRefused) {
  std::vector<double> c(66, 0.0);
  c.front() = -1;
  c.back() = 1;
  EXPECT_EQ(ask(c, 0, 2).status, Status::failed);
}

}  // namespace
}  // namespace graze
