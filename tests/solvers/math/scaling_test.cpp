#include <gtest/gtest.h>

#include <graze/solvers/math/scaling.hpp>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

Exact two_to(int k) {
  using boost::multiprecision::mpz_int;
  const mpz_int power = mpz_int(1) << std::abs(k);
  return k >= 0 ? Exact(power) : 1 / Exact(power);
}

/// Is y the double nearest to q, ties to even, overflow to infinity?
bool is_nearest(double y, const Exact& q) {
  if (std::isinf(y)) return abs(q) >= exact(kMax) + exact(ulp(kMax)) / 2;
  const Exact gap = abs(exact(y) - q), half = exact(ulp(y)) / 2;
  if (gap < half) return true;
  return gap == half && std::bit_cast<std::uint64_t>(y) % 2 == 0;
}

TEST(Scaling, ScalesByAnyPowerWithOneRounding) {
  Rng rng(7);
  for (int i = 0; i < 100'000; ++i) {
    const double x = log_uniform(rng, -1074, 1023);
    // Half of the results are aimed at the subnormal range, where rounding happens.
    const int wide = static_cast<int>(rng.next() % 8401) - 4200;
    const int k = i % 2 == 0 ? wide : -1080 + static_cast<int>(rng.next() % 60) - exponent_of(x);
    ASSERT_TRUE(is_nearest(scale_by_power(x, k), exact(x) * two_to(k))) << std::hexfloat << x << " 2^" << k;
  }
}

TEST(Scaling, ScalingThereAndBackIsTheIdentity) {
  for (const double x : {kTiny, -3 * kTiny, kMin})
    for (const int k : {1, 52, 1023, 2000, 2045}) EXPECT_EQ(scale_by_power(scale_by_power(x, k), -k), x);
  EXPECT_EQ(scale_by_power(kTiny, 2097), 0x1p1023);
  EXPECT_EQ(scale_by_power(kMax, -4200), 0);
  EXPECT_EQ(scale_by_power(-kTiny, 4200), -kInfinity);
  EXPECT_EQ(scale_by_power(kInfinity, -4200), kInfinity);
}

TEST(Scaling, ExponentAndSpacingBracketTheNumber) {
  Rng rng(8);
  for (int i = 0; i < 100'000; ++i) {
    const double x = log_uniform(rng, -1074, 1023);
    const Exact size = abs(exact(x)), power = two_to(exponent_of(x));
    ASSERT_TRUE(power <= size && size < 2 * power) << std::hexfloat << x;
    if (std::fabs(x) < kMax) {
      ASSERT_EQ(exact(ulp(x)), exact(next_above(std::fabs(x))) - size) << std::hexfloat << x;
    }
  }
  EXPECT_EQ(ulp(0), kTiny);
  EXPECT_EQ(ulp(kMax), 0x1p971);
  EXPECT_TRUE(std::isnan(ulp(kInfinity)));
}

}  // namespace
}  // namespace graze
