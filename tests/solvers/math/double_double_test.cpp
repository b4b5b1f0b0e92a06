#include <gtest/gtest.h>

#include <graze/solvers/math/double_double.hpp>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

constexpr int kCases = 100'000;
constexpr double kU2 = 0x1p-106;  // u^2
constexpr double kU3 = 0x1p-159;  // u^3

/// A normalised pair whose low part is anything from half an ulp of the high one downwards, or zero.
DoubleDouble random_pair(Rng& rng, int low, int high) {
  const double hi = log_uniform(rng, low, high);
  const double lo =
      rng.next() % 10 == 0 ? 0 : log_uniform(rng, -60, -54) * scale_by_power(1, exponent_of(hi));
  return quick_two_sum(hi, lo);
}

/// A y that cancels x to a random depth.
DoubleDouble nearly_opposite(Rng& rng, const DoubleDouble& x) {
  const double shift = log_uniform(rng, -110, 0) * std::fabs(x.hi);
  const DoubleDouble moved = two_sum(-x.hi, shift);
  return two_sum(moved.hi, -x.lo);
}

template <class Operation, class Reference>
void check(const char* name, double bound, const Operation& operation, const Reference& reference) {
  Worst worst(name);
  Rng rng(11);
  for (int i = 0; i < kCases; ++i) {
    const DoubleDouble x = random_pair(rng, -300, 300);
    const DoubleDouble y = i % 3 == 0 ? nearly_opposite(rng, x) : random_pair(rng, -300, 300);
    if (y.hi == 0) continue;
    const DoubleDouble z = operation(x, y);
    const Exact truth = reference(exact(x), exact(y), exact(y.hi));
    ASSERT_EQ(z.hi, z.hi + z.lo) << "not normalised";
    ASSERT_TRUE(truth == 0 ? exact(z) == 0 : worst.within((exact(z) - truth) / truth, bound))
        << std::hexfloat << x.hi << ' ' << x.lo << ' ' << y.hi << ' ' << y.lo;
  }
}

using D = const DoubleDouble&;
using E = const Exact&;

TEST(DoubleDouble, SumsKeepTheirBounds) {
  check(
      "x + y in units of 3u^2+13u^3", 3 * kU2 + 13 * kU3, [](D x, D y) { return x + y; },
      [](E x, E y, E) { return Exact(x + y); });
  check(
      "x - y in units of 3u^2+13u^3", 3 * kU2 + 13 * kU3, [](D x, D y) { return x - y; },
      [](E x, E y, E) { return Exact(x - y); });
  check(
      "x + double in units of 2u^2", 2 * kU2, [](D x, D y) { return x + y.hi; },
      [](E x, E, E y) { return Exact(x + y); });
  check(
      "double - x in units of 2u^2", 2 * kU2, [](D x, D y) { return y.hi - x; },
      [](E x, E, E y) { return Exact(y - x); });
}

TEST(DoubleDouble, ProductsKeepTheirBounds) {
  check(
      "x y in units of 5u^2", 5 * kU2, [](D x, D y) { return x * y; },
      [](E x, E y, E) { return Exact(x * y); });
  check(
      "x double in units of 2u^2", 2 * kU2, [](D x, D y) { return x * y.hi; },
      [](E x, E, E y) { return Exact(x * y); });
  check(
      "x^2 in units of 5u^2", 5 * kU2, [](D x, D) { return sqr(x); }, [](E x, E, E) { return Exact(x * x); });
}

TEST(DoubleDouble, QuotientsKeepTheirBounds) {
  check(
      "x / y in units of 15u^2+56u^3", 15 * kU2 + 56 * kU3, [](D x, D y) { return x / y; },
      [](E x, E y, E) { return Exact(x / y); });
  check(
      "x / double in units of 3u^2", 3 * kU2, [](D x, D y) { return x / y.hi; },
      [](E x, E, E y) { return Exact(x / y); });
}

TEST(DoubleDouble, SquareRootsKeepTheirBound) {
  Worst worst("sqrt(x) in units of 25/8 u^2");
  Rng rng(12);
  for (int i = 0; i < kCases; ++i) {
    const DoubleDouble x = abs(random_pair(rng, -300, 300));
    const DoubleDouble z = sqrt(x);
    // With z = sqrt(x) (1 + e): z^2 / x - 1 = 2e + e^2, and e^2 is of the order u^4.
    const Exact error = (exact(z) * exact(z) / exact(x) - 1) / 2;
    ASSERT_TRUE(worst.within(error, 25.0 / 8 * kU2 + kU3)) << std::hexfloat << x.hi << ' ' << x.lo;
  }
  EXPECT_EQ(sqrt(DoubleDouble(0)), DoubleDouble(0));
}

TEST(DoubleDouble, ErrorFreeTransformationsAreExact) {
  Rng rng(13);
  for (int i = 0; i < kCases; ++i) {
    const double a = log_uniform(rng, -400, 400), b = log_uniform(rng, -400, 400);
    ASSERT_EQ(exact(two_sum(a, b)), exact(a) + exact(b));
    ASSERT_EQ(exact(two_prod(a, b)), exact(a) * exact(b));
    const double large = std::fabs(a) < std::fabs(b) ? b : a, small = std::fabs(a) < std::fabs(b) ? a : b;
    ASSERT_EQ(exact(quick_two_sum(large, small)), exact(a) + exact(b));
  }
}

TEST(DoubleDouble, OrderIsTheOrderOfTheNumbers) {
  Rng rng(14);
  for (int i = 0; i < kCases; ++i) {
    const DoubleDouble x = random_pair(rng, -2, 2);
    const DoubleDouble y = i % 2 == 0 ? random_pair(rng, -2, 2) : DoubleDouble(x.hi, x.lo == 0 ? 0 : -x.lo);
    ASSERT_EQ(x < y, exact(x) < exact(y));
    ASSERT_EQ(x == y, exact(x) == exact(y));
  }
  EXPECT_LT(DoubleDouble(1, -kTiny), 1.0);
  EXPECT_EQ(static_cast<double>(DoubleDouble(1, kTiny)), 1.0);
}

}  // namespace
}  // namespace graze
