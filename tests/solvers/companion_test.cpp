// Companion matrix: its own options, and the error its header states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <graze/solvers/companion.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Roots solve(const std::vector<double>& c, bool polish = false, double lo = -kInfinity,
            double hi = kInfinity) {
  Parameters options;
  options.set("polish", polish);
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  Companion(options).solve(equation, roots);
  return roots;
}

TEST(Companion, EveryRootItListsIsARootOfANearbyPolynomial) {
  constexpr std::uint64_t kSeed = 20261122;
  Rng rng(kSeed);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const int degree = 1 + static_cast<int>(rng.uniform() * 12);
    std::vector<double> c;
    for (int k = 0; k <= degree; ++k) c.push_back(rng.uniform(-1, 1));
    for (const Root& root : solve(c).list) {
      long double value = 0, size = 0;
      for (std::size_t k = c.size(); k-- > 0;) {
        value = value * static_cast<long double>(root.x) + static_cast<long double>(c[k]);
        size = size * std::fabs(static_cast<long double>(root.x)) + std::fabs(static_cast<long double>(c[k]));
      }
      worst = std::max(worst, static_cast<double>(std::fabs(value) / size) / (degree * 0x1p-53));
    }
  }
  std::printf("seed %llu: worst backward error %.3g n u\n", static_cast<unsigned long long>(kSeed), worst);
  EXPECT_LE(worst, Companion::kMeasuredBackward);
}

TEST(Companion, PolishingBringsSimpleRootsToRounding) {
  std::vector<double> c{1};
  for (int k = 1; k <= 8; ++k) {
    c.insert(c.begin(), 0);
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= k * c[i + 1];
  }
  const Roots plain = solve(c);
  const Roots polished = solve(c, true);
  ASSERT_EQ(plain.list.size(), 8U);
  ASSERT_EQ(polished.list.size(), 8U);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    before = std::max(before, std::fabs(plain.list[i].x - static_cast<double>(i + 1)));
    after = std::max(after, std::fabs(polished.list[i].x - static_cast<double>(i + 1)));
  }
  std::printf("worst error %.3g, polished %.3g\n", before, after);
  EXPECT_LE(after, before);
  EXPECT_LE(after, 1e-9);
}

TEST(Companion, AnExactZeroKeepsItsMultiplicity) {
  const Roots roots = solve({0, 0, -1, 1});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].x, 0);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_EQ(roots.list[1].x, 1);
}

TEST(Companion, AClosePairOffTheRealLineIsNoRoot) { EXPECT_TRUE(solve({1 + 0x1p-30, -2, 1}).list.empty()); }

TEST(Companion, RatiosThatOverflowAreAFailureAndNoMiss) {
  EXPECT_EQ(solve({1e300, 1, 1e-300}).status, Status::failed);
}

TEST(Companion, OptionsAreChecked) {
  Parameters options;
  options.set("polish", 3.0);
  EXPECT_THROW(Companion{options}, std::invalid_argument);
}

}  // namespace
}  // namespace graze
