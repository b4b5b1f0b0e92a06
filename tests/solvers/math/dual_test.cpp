// Derivatives by dual numbers, in each number type that formulas are run in; elementary inclusions.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/dual.hpp>
#include <graze/solvers/math/interval_elementary.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze {
namespace {

constexpr std::uint64_t kSeed = 20261122;

TEST(Dual, APolynomialHasItsTextbookDerivatives) {
  // p = 3 t^4 - 2 t + 5 at t = 2: 49, 12 t^3 - 2 = 94, 36 t^2 = 144.
  const auto p = [](const auto& t) { return 3.0 * t * t * t * t - 2.0 * t + 5.0; };
  const Dual<double> f = p(Dual<double>::variable(2));
  EXPECT_EQ(f.value, 49);
  EXPECT_EQ(f.d, 94);
  EXPECT_EQ(f.dd, 144);
  const Dual<float> g = p(Dual<float>::variable(2));
  EXPECT_EQ(g.dd, 144);
  const Dual<DoubleDouble> h = p(Dual<DoubleDouble>::variable(DoubleDouble(2)));
  EXPECT_EQ(static_cast<double>(h.dd), 144);
  EXPECT_EQ(pow_int(Dual<double>::variable(2), 5).dd, 160) << "20 t^3";
  EXPECT_EQ(sqr(Dual<double>::variable(3)).d, 6);
}

TEST(Dual, EveryRuleAgreesWithTheDerivativesByHand) {
  const double t = 0.7;
  const Dual<double> x = Dual<double>::variable(t);
  const auto expect = [](const Dual<double>& f, double value, double d, double dd) {
    EXPECT_NEAR(f.value, value, 1e-15 * std::fabs(value));
    EXPECT_NEAR(f.d, d, 4e-15 * std::fabs(d));
    EXPECT_NEAR(f.dd, dd, 1e-14 * std::fabs(dd));
  };
  expect(sqrt(x), std::sqrt(t), 0.5 / std::sqrt(t), -0.25 / std::pow(t, 1.5));
  expect(sin(x), std::sin(t), std::cos(t), -std::sin(t));
  expect(cos(x), std::cos(t), -std::sin(t), -std::cos(t));
  expect(exp(x), std::exp(t), std::exp(t), std::exp(t));
  expect(log(x), std::log(t), 1 / t, -1 / (t * t));
  expect(1.0 / x, 1 / t, -1 / (t * t), 2 / (t * t * t));
  expect(x / (x * x + 1.0), t / (t * t + 1), (1 - t * t) / std::pow(t * t + 1, 2),
         2 * t * (t * t - 3) / std::pow(t * t + 1, 3));
  expect(sin(x * x), std::sin(t * t), 2 * t * std::cos(t * t),
         2 * std::cos(t * t) - 4 * t * t * std::sin(t * t));
}

TEST(Dual, IntervalsEncloseTheDerivativesOverThem) {
  const auto f = [](const auto& x) {
    using std::exp, std::sin, std::sqrt;
    return exp(sin(3.0 * x)) / sqrt(x * x + 2.0) - x;
  };
  Rng rng(kSeed);
  for (int i = 0; i < 2000; ++i) {
    const double lo = rng.uniform(-3, 3), hi = lo + std::exp2(rng.uniform(-30, 0));
    const Dual<Interval> box = f(Dual<Interval>::variable({lo, hi}));
    const Dual<double> at = f(Dual<double>::variable(lo + rng.uniform() * (hi - lo)));
    // The double evaluation errs by a few ulps itself.
    const auto holds = [](const Interval& range, double v) {
      return v >= range.lo - 1e-13 * (1 + std::fabs(v)) && v <= range.hi + 1e-13 * (1 + std::fabs(v));
    };
    ASSERT_TRUE(holds(box.value, at.value));
    ASSERT_TRUE(holds(box.d, at.d));
    ASSERT_TRUE(holds(box.dd, at.dd));
  }
}

TEST(IntervalElementary, ContainsTheFunctionAndItsExtrema) {
  EXPECT_EQ(sin(Interval{1, 2}).hi, 1) << "pi/2 lies inside";
  EXPECT_EQ(sin(Interval{4, 5}).lo, -1);
  EXPECT_EQ(cos(Interval{-0.1, 0.1}).hi, 1);
  EXPECT_EQ(cos(Interval{3, 3.5}).lo, -1);
  EXPECT_LT(sin(Interval{0.1, 0.2}).hi, 0.2);
  EXPECT_EQ(sin(Interval{0, 100}), (Interval{-1, 1}));
  EXPECT_EQ(sin(entire()), (Interval{-1, 1}));
  EXPECT_EQ(exp(entire()).lo, 0);
  EXPECT_TRUE(is_entire(log(Interval{-2, -1})));
  EXPECT_EQ(log(Interval{0, 1}).lo, -HUGE_VAL);
  Rng rng(kSeed);
  for (int i = 0; i < 20000; ++i) {
    const double lo = rng.uniform(-50, 50), hi = lo + std::exp2(rng.uniform(-50, 3));
    const double at = std::min(hi, lo + rng.uniform() * (hi - lo));
    const auto exact = static_cast<long double>(at);
    const auto holds = [](const Interval& range, long double v) {
      return static_cast<long double>(range.lo) <= v && v <= static_cast<long double>(range.hi);
    };
    ASSERT_TRUE(holds(sin(Interval{lo, hi}), std::sin(exact)));
    ASSERT_TRUE(holds(cos(Interval{lo, hi}), std::cos(exact)));
    ASSERT_TRUE(holds(exp(Interval{lo, hi}), std::exp(exact)));
    if (lo > 0) {
      ASSERT_TRUE(holds(log(Interval{lo, hi}), std::log(exact)));
    }
  }
}

}  // namespace
}  // namespace graze
