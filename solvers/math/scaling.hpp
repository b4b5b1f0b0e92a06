// Powers of two: exact scaling, exponents and spacings of doubles.
//
// Needs:  IEEE 754 binary64, rounding to nearest.
// Error:  none, but for the one correct rounding of a result in the subnormal range (or to infinity).
// Cost:   a multiplication and a few integer instructions; a library call for exponents out of the ordinary.
// Source: IEEE Std 754-2019, 5.3.3 (scaleB, logB).
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace graze {

/// 2^k as a double, for -1022 <= k <= 1023.
constexpr double power_of_two(int k) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52U);
}

/// x * 2^k, rounded once: exact where representable; any k. Zeros, infinities and NaN come back as they are.
inline double scale_by_power(double x, int k) {
  // One multiplication by an exact power rounds once, wherever its result lies.
  if (k >= -1022 && k <= 1023) [[likely]]
    return x * power_of_two(k);
  return std::ldexp(x, k);
}

/// floor(log2 |x|) for a finite x != 0, subnormals included: -1074 ... 1023.
constexpr int exponent_of(double x) {
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) & 0x7fff'ffff'ffff'ffffULL;
  const int biased = static_cast<int>(bits >> 52U);
  // A subnormal is its bit pattern times 2^-1074.
  return biased > 0 ? biased - 1023 : static_cast<int>(std::bit_width(bits)) - 1 - 1074;
}

/// The distance from |x| to the next larger double (at the largest double: to the next smaller); the smallest
/// subnormal for 0. NaN for an x that is not finite.
constexpr double ulp(double x) {
  if (!(x - x == 0)) return std::numeric_limits<double>::quiet_NaN();
  if (x == 0) return std::numeric_limits<double>::denorm_min();
  const int exponent = std::max(exponent_of(x), -1022) - 52;
  if (exponent >= -1022) return power_of_two(exponent);
  return std::bit_cast<double>(std::uint64_t{1} << static_cast<unsigned>(exponent + 1074));
}

}  // namespace graze
