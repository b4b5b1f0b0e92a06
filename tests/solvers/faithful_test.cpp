// The digits of l: which double each root's place gets, and which tier says so.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <graze/solvers/faithful.hpp>
#include <graze/solvers/math/exact_polynomial.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/math/scaling.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An equation with exact coefficients of which a solver sees roundings only.
class Posed {
 public:
  explicit Posed(std::vector<Dyadic> c, double origin = 0) : exact_(std::move(c)) {
    for (const Dyadic& x : exact_) {
      c_.push_back(x.to_double());
      error_.push_back(Dyadic(c_.back()) == x ? 0 : ulp(c_.back()));
      const DoubleDouble wide = x.to_double_double();
      near_.emplace_back(wide, 0x1p-105 * std::fabs(wide.hi));
    }
    equation_.c = c_;
    equation_.c_error = error_;
    equation_.exact = {&exact_, &Posed::get, origin};
  }
  [[nodiscard]] PolynomialEquation equation(bool with_near = true) const {
    PolynomialEquation equation = equation_;
    if (with_near) equation.exact.near = near_;
    return equation;
  }

 private:
  static void get(const void* self, std::span<Dyadic> c) {
    const auto& exact = *static_cast<const std::vector<Dyadic>*>(self);
    std::copy(exact.begin(), exact.end(), c.begin());
  }

  std::vector<Dyadic> exact_;
  std::vector<double> c_, error_;
  std::vector<DoubleDoubleBall> near_;
  PolynomialEquation equation_;
};

std::vector<Dyadic> dyadics(std::initializer_list<double> values) {
  std::vector<Dyadic> c;
  for (const double x : values) c.emplace_back(x);
  return c;
}

Roots solve(const PolynomialEquation& equation) {
  Roots roots;
  Faithful(Parameters{}).solve(equation, roots);
  return roots;
}

/// As the scene adds them.
double l_of(const Root& root, double origin) {
  const DoubleDouble sum = two_sum(origin, root.x);
  return sum.hi + (sum.lo + root.tail);
}

TEST(Faithful, ASurdAboutAFarOriginGetsItsNearestDouble) {
  constexpr double kOrigin = 1e6;
  const Posed posed(dyadics({-2, 0, 1}), kOrigin);
  for (const bool near : {true, false}) {
    const Roots roots = solve(posed.equation(near));
    ASSERT_EQ(roots.list.size(), 2U);
    EXPECT_EQ(roots.counters.tier, 2U);
    EXPECT_EQ(l_of(roots.list[1], kOrigin), 0x1.e8482d413ccdp+19);  // 1000001.4142135623730950...
    EXPECT_TRUE(roots.list[1].placed);
  }
}

TEST(Faithful, AnLMuchSmallerThanItsOriginKeepsAllItsDigits) {
  std::vector<Dyadic> c = dyadics({1, 1});
  c[0] -= Dyadic(5 * 0x1p-150);  // x = -1 + 5 2^-150
  const Posed posed(c, 1);
  const Roots roots = solve(posed.equation());
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.counters.tier, 3U);
  EXPECT_EQ(l_of(roots.list[0], 1), 5 * 0x1p-150);
}

TEST(Faithful, OfTwoPlacesWithOneNearestDoubleTheOneOnTheOtherSideMoves) {
  constexpr double kOrigin = 0x1.8p+20;
  const double gap = ulp(kOrigin) / 16;
  const auto both = [&](double a, double b) {  // (x - a)(x - b)
    const Posed posed({Dyadic(a) * Dyadic(b), -(Dyadic(a) + Dyadic(b)), Dyadic(1.0)}, kOrigin);
    const Roots roots = solve(posed.equation());
    EXPECT_EQ(roots.status, Status::ok);
    EXPECT_EQ(roots.list.size(), 2U);
    return std::vector<double>{l_of(roots.list.front(), kOrigin), l_of(roots.list.back(), kOrigin)};
  };
  const double next = std::nextafter(kOrigin, kInfinity), last = std::nextafter(kOrigin, 0);
  EXPECT_EQ(both(-gap, gap), (std::vector<double>{kOrigin, next}));
  EXPECT_EQ(both(gap, 2 * gap), (std::vector<double>{kOrigin, next}));
  EXPECT_EQ(both(-2 * gap, -gap), (std::vector<double>{last, kOrigin}));
}

TEST(Faithful, OfThreePlacesWithOneNearestDoubleTwoAreJoined) {
  constexpr double kOrigin = 0x1.8p+20;
  const double gap = ulp(kOrigin) / 16;
  const Posed posed({Dyadic(), -(Dyadic(gap) * Dyadic(gap)), Dyadic(), Dyadic(1.0)}, kOrigin);
  const Roots roots = solve(posed.equation());
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity + roots.list[1].multiplicity, 3U);
  EXPECT_EQ(l_of(roots.list[1], kOrigin), std::nextafter(l_of(roots.list[0], kOrigin), kInfinity));
}

TEST(Faithful, ADoubleRootTakesIntegersAndKeepsItsMultiplicity) {
  const Posed posed(dyadics({2.25, -3, 1}), 7);
  const Roots roots = solve(posed.equation());
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_EQ(l_of(roots.list[0], 7), 8.5);
}

TEST(Faithful, DigitsThatNothingProvesAreUncertain) {
  const std::vector<double> c{-2, 0, 1}, error{1e-12, 0, 0};
  PolynomialEquation equation;
  equation.c = c;
  equation.c_error = error;
  equation.lo = 0;
  equation.hi = 2;
  const Roots roots = solve(equation);
  EXPECT_EQ(roots.status, Status::uncertain);
  EXPECT_EQ(roots.list.size(), 1U) << "the root is proved, not its digits";
}

/// Against the nearest double of the isolated exact root.
TEST(Faithful, RandomPolynomialsAboutRandomOriginsAreWithinAnUlp) {
  constexpr std::uint64_t kSeed = 20261122;
  Rng rng(kSeed);
  int wide = 0, exact = 0;
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const double origin = std::ldexp(rng.uniform(0, 1), static_cast<int>(rng.uniform(-3, 30)));
    std::vector<Dyadic> c;
    for (int k = static_cast<int>(rng.uniform(2, 8)); k > 0; --k)
      c.push_back(Dyadic(rng.uniform(-1, 1)) + Dyadic(0x1p-54 * rng.uniform(-1, 1)));
    const Posed posed(c, origin);
    PolynomialEquation equation = posed.equation();
    equation.lo = -4;
    equation.hi = 4;
    const Roots roots = solve(equation);
    std::vector<RealRoot> expected = isolate_roots(ExactPolynomial(c), dyadic_interval(-4, 4));
    ASSERT_EQ(roots.status, Status::ok);
    ASSERT_EQ(roots.list.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      const double l = expected[k].to_double_from(Dyadic(origin));
      const double error = std::fabs(l_of(roots.list[k], origin) - l) / ulp(l);
      worst = std::max(worst, error);
      EXPECT_LE(error, 1);
    }
    (roots.counters.tier == 2 ? wide : exact) += roots.list.empty() ? 0 : 1;
  }
  std::printf("seed %d: %d in double-double, %d in integers; worst %g ulp off the nearest\n",
              static_cast<int>(kSeed), wide, exact, worst);
  EXPECT_GT(wide, 20 * exact);
}

}  // namespace
}  // namespace graze
