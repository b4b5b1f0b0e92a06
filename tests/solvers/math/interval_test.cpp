#include <gtest/gtest.h>

#include <array>
#include <boost/numeric/interval.hpp>
#include <graze/solvers/math/interval.hpp>
#include <vector>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

constexpr int kCases = 100'000;
constexpr std::uint64_t kSeed = 20261122;

/// Calls check(a, b) on all pairs of special values and on random pairs of all magnitudes.
template <class Check>
void for_pairs(const Check& check) {
  for (const double a : special_values())
    for (const double b : special_values()) check(a, b);
  std::printf("    seed %llu\n", static_cast<unsigned long long>(kSeed));
  Rng rng(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const double a = log_uniform(rng, -1074, 1023);
    // Near magnitudes make sums interesting, opposite ones products and quotients.
    const int e = std::max(exponent_of(a), -1000);
    const double near = log_uniform(rng, e - 60, std::min(e + 60, 1023));
    const double far = log_uniform(rng, -1074, 1023);
    check(a, i % 2 == 0 ? near : far);
  }
}

Interval random_interval(Rng& rng) {
  const double a = log_uniform(rng, -40, 40), b = log_uniform(rng, -40, 40);
  if (rng.next() % 8 == 0) return point(a);
  if (rng.next() % 8 == 0) return {std::min(a, 0.0), std::max(a, 0.0)};
  return {std::min(a, b), std::max(a, b)};
}

TEST(Interval, SumsAreRoundedOutwardAndNoFurther) {
  for_pairs([](double a, double b) {
    const Exact sum = exact(a) + exact(b);
    ASSERT_TRUE(is_rounded_down(add_down(a, b), sum)) << std::hexfloat << a << " + " << b;
    ASSERT_TRUE(is_rounded_up(add_up(a, b), sum)) << std::hexfloat << a << " + " << b;
  });
}

TEST(Interval, ProductsAreRoundedOutwardAndNoFurther) {
  for_pairs([](double a, double b) {
    const Exact product = exact(a) * exact(b);
    ASSERT_TRUE(is_rounded_down(mul_down(a, b), product)) << std::hexfloat << a << " * " << b;
    ASSERT_TRUE(is_rounded_up(mul_up(a, b), product)) << std::hexfloat << a << " * " << b;
  });
}

TEST(Interval, QuotientsAreRoundedOutwardAndNoFurther) {
  for_pairs([](double a, double b) {
    if (b == 0) return;
    const Exact quotient = exact(a) / exact(b);
    ASSERT_TRUE(is_rounded_down(div_down(a, b), quotient)) << std::hexfloat << a << " / " << b;
    ASSERT_TRUE(is_rounded_up(div_up(a, b), quotient)) << std::hexfloat << a << " / " << b;
  });
}

TEST(Interval, ProductsAndQuotientsInTheSubnormalRangeAreTight) {
  Rng rng(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const double a = log_uniform(rng, -1074, 0);
    const int target = -1080 + static_cast<int>(rng.next() % 130);
    const int e = std::clamp(target - exponent_of(a), -1074, 1023);
    const double b = log_uniform(rng, e, e);
    ASSERT_TRUE(is_tight(point(a) * point(b), exact(a) * exact(b), exact(a) * exact(b)));
    const double d = log_uniform(rng, std::clamp(-e, -1022, 1023), std::clamp(-e, -1022, 1023));
    ASSERT_TRUE(is_tight(point(a) / point(d), exact(a) / exact(d), exact(a) / exact(d)));
  }
}

TEST(Interval, SquareRootsAreRoundedOutwardAndNoFurther) {
  const auto check = [](double x) {
    const Exact q = exact(x);
    const double lo = sqrt_down(x), hi = sqrt_up(x);
    ASSERT_TRUE(exact(lo) * exact(lo) <= q && exact(hi) * exact(hi) >= q) << std::hexfloat << x;
    ASSERT_GT(exact(next_above(lo)) * exact(next_above(lo)), q) << std::hexfloat << x;
    if (hi > 0) {
      ASSERT_LT(exact(next_below(hi)) * exact(next_below(hi)), q) << std::hexfloat << x;
    }
  };
  for (const double x : special_values()) check(std::fabs(x));
  Rng rng(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const double x = std::fabs(log_uniform(rng, -1074, 1023));
    check(x);
    const double root = std::floor(rng.uniform(0, 0x1p26));
    check(root * root);
  }
}

TEST(Interval, OperatorsGiveTheSmallestIntervalOfDoubles) {
  Rng rng(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const Interval a = random_interval(rng), b = random_interval(rng);
    const Exact al = exact(a.lo), ah = exact(a.hi), bl = exact(b.lo), bh = exact(b.hi);
    ASSERT_TRUE(is_tight(a + b, al + bl, ah + bh));
    ASSERT_TRUE(is_tight(a - b, al - bh, ah - bl));
    const auto product = std::minmax({al * bl, al * bh, ah * bl, ah * bh});
    ASSERT_TRUE(is_tight(a * b, product.first, product.second))
        << a.lo << ' ' << a.hi << ' ' << b.lo << ' ' << b.hi;
    ASSERT_EQ(point(a.lo) * b, a.lo * b);
    const Exact far = std::max(abs(al), abs(ah)),
                near = contains_zero(a) ? Exact(0) : std::min(abs(al), abs(ah));
    ASSERT_TRUE(is_tight(sqr(a), near * near, far * far));
    if (contains_zero(b)) continue;
    const auto quotient = std::minmax({al / bl, al / bh, ah / bl, ah / bh});
    ASSERT_TRUE(is_tight(a / b, quotient.first, quotient.second));
  }
}

TEST(Interval, EndsEqualThoseOfBoostInterval) {
  using boost::numeric::interval;
  Rng rng(kSeed);
  for (int i = 0; i < 10'000; ++i) {
    const Interval a = random_interval(rng), b = random_interval(rng);
    const interval<double> x(a.lo, a.hi), y(b.lo, b.hi);
    // Boost's default rounding for double changes the mode: its ends are correctly rounded, as ours are.
    const auto same = [](const Interval& mine, const interval<double>& theirs) {
      return mine.lo == theirs.lower() && mine.hi == theirs.upper();
    };
    ASSERT_TRUE(same(a + b, x + y) && same(a - b, x - y) && same(a * b, x * y));
    if (!contains_zero(b)) {
      ASSERT_TRUE(same(a / b, x / y));
    }
    if (a.lo >= 0) {
      ASSERT_TRUE(same(sqrt(a), boost::numeric::sqrt(x)));
    }
  }
}

TEST(Interval, DivisionByAnIntervalWithZeroGivesALineOrAHalfLine) {
  EXPECT_EQ((Interval{1, 2} / Interval{-1, 1}), entire());
  EXPECT_EQ((Interval{1, 2} / Interval{0, 0}), entire());
  EXPECT_EQ((Interval{0, 0} / Interval{0, 0}), entire());
  EXPECT_EQ((Interval{1, 2} / Interval{0, 4}), (Interval{0.25, kInfinity}));
  EXPECT_EQ((Interval{1, 2} / Interval{-4, 0}), (Interval{-kInfinity, -0.25}));
  EXPECT_EQ((Interval{-2, -1} / Interval{0, 4}), (Interval{-kInfinity, -0.25}));
  EXPECT_EQ((Interval{-2, -1} / Interval{-4, 0}), (Interval{0.25, kInfinity}));
  EXPECT_EQ((Interval{-2, 1} / Interval{0, 4}), entire());
  EXPECT_EQ((Interval{0, 1} / Interval{0, kInfinity}), (Interval{0, kInfinity}));
}

TEST(Interval, UnboundedAndNanOperandsNeverGiveNan) {
  const std::vector<double> ends{-kInfinity, -kMax, -1, -kTiny, 0, kTiny, 1, kMax, kInfinity};
  std::vector<Interval> all{point(std::nan("")), point(kInfinity), {std::nan(""), 1}, {0, std::nan("")}};
  for (const double lo : ends)
    for (const double hi : ends)
      if (lo <= hi) all.push_back({lo, hi});
  const auto check = [](const Interval& x) { EXPECT_LE(x.lo, x.hi); };
  for (const Interval& a : all) {
    for (const Interval& b : all) {
      for (const Interval& x : {a + b, a - b, a * b, a / b}) check(x);
    }
    if (a.lo <= a.hi)
      for (const Interval& x : {sqr(a), sqrt(a), abs(a), pow_int(a, 3), pow_int(a, 4)}) check(x);
  }
  EXPECT_EQ((Interval{0, 0} * entire()), (Interval{0, 0}));
  EXPECT_EQ((Interval{kMax, kMax} + Interval{kMax, kMax}), (Interval{kMax, kInfinity}));
  EXPECT_EQ(entire() - entire(), entire());
}

TEST(Interval, MidpointIsFiniteAndInside) {
  Rng rng(kSeed);
  std::vector<Interval> all{entire(),      {-kInfinity, -kMax}, {kMax, kInfinity},
                            {-kMax, kMax}, {kTiny, kTiny},      {kTiny, 2 * kTiny}};
  for (int i = 0; i < kCases; ++i) {
    const double a = log_uniform(rng, -1074, 1023),
                 b = i % 2 == 0 ? next_above(a) : log_uniform(rng, -1074, 1023);
    all.push_back({std::min(a, b), std::max(a, b)});
  }
  for (const Interval& x : all)
    ASSERT_TRUE(std::isfinite(mid(x)) && contains(x, mid(x))) << x.lo << ' ' << x.hi;
}

TEST(Interval, PowersContainTheExactPowersWithinTheirBound) {
  Worst worst("power error in units of 2 n u");
  Rng rng(kSeed);
  for (int i = 0; i < 5'000; ++i) {
    const Interval x = random_interval(rng);
    const unsigned n = static_cast<unsigned>(rng.next() % 12);
    for (const double v : {x.lo, x.hi, mid(x)}) {
      Exact power = 1;
      for (unsigned k = 0; k < n; ++k) power *= exact(v);
      ASSERT_TRUE(holds(pow_int(x, n), power)) << v << '^' << n;
      const Interval of_point = pow_int(point(v), n);
      ASSERT_TRUE(worst.within(exact(of_point.hi) - power, to_double(abs(power)) * 0x1p-52 * n))
          << v << '^' << n;
      ASSERT_TRUE(worst.within(exact(of_point.lo) - power, to_double(abs(power)) * 0x1p-52 * n))
          << v << '^' << n;
    }
  }
  EXPECT_EQ(pow_int({-2, 3}, 2), (Interval{0, 9}));
  EXPECT_EQ(pow_int({-2, 3}, 3), (Interval{-8, 27}));
}

TEST(Interval, SetOperationsFollowTheirDefinitions) {
  const Interval a{1, 3}, b{2, 5}, c{4, 6};
  EXPECT_EQ(hull(a, c), (Interval{1, 6}));
  EXPECT_EQ(intersect(a, b), (Interval{2, 3}));
  EXPECT_FALSE(intersect(a, c).has_value());
  EXPECT_TRUE(contains(a, 3.0) && !contains(a, next_above(3.0)) && contains_zero(Interval{-1, 0}));
  EXPECT_EQ(abs(Interval{-3, 2}), (Interval{0, 3}));
  EXPECT_EQ(mig(Interval{-3, -2}), 2);
  EXPECT_EQ(width(Interval{-kMax, kMax}), kInfinity);
  EXPECT_EQ(inflate_ulps(Interval{0, 1}, 1), (Interval{-kTiny, 1 + 0x1p-52}));
}

}  // namespace
}  // namespace graze
