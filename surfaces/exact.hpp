// Decisions and numbers that are right whatever the rounding: a formula generic over the number type is tried
// in intervals first, and in exact expansions where those cannot tell.
//
// A formula is called with a number of the type to compute in, and forms its operands by exactly<T>:
//   exact_sign([&](auto number) { using T = decltype(number); return exactly<T>(a) * exactly<T>(b) - ...; })
// Range: exact as long as no product leaves the range that solvers/math/expansion.hpp states.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/surfaces/coefficients.hpp>

namespace graze {

/// The sign of a number within x, where x tells.
inline std::optional<int> sign_of(const Interval& x) {
  if (x.lo > 0) return 1;
  if (x.hi < 0) return -1;
  if (x == Interval{}) return 0;
  return std::nullopt;
}

/// The sign of the number that `quick` encloses: by it where it tells, else by `exact()`, its Expansion, if
/// that is `in_range` of exact sums; else none.
template <class Exact>
std::optional<int> sign_of(const Interval& quick, bool in_range, const Exact& exact) {
  if (const std::optional<int> told = sign_of(quick)) return told;
  if (!in_range) return std::nullopt;
  return exact().sign();
}

/// The sign of the formula's exact value: -1, 0, 1.
template <class Formula>
int exact_sign(const Formula& formula) {
  if (const std::optional<int> told = sign_of(formula(Interval{}))) return *told;
  return formula(Expansion{}).sign();
}

/// Within 1 ulp of its value; a point where that is a double.
inline Interval enclose(const Expansion& x) {
  const double value = x.value();
  return x.parts().size() <= 1 ? point(value) : Interval{next_below(value), next_above(value)};
}

/// An enclosure of the formula no wider than `relative` times its magnitude, or than 2 ulps, where the
/// formula is `in_range` of exact sums; else as wide as intervals make it.
template <class Formula>
Interval sharp_enclosure(const Formula& formula, bool in_range, double relative) {
  const Interval quick = formula(Interval{});
  if (width(quick) <= relative * mig(quick) || !in_range) return quick;
  return enclose(formula(Expansion{}));
}

/// A number is a multiple of 2^low and below 2^high; zero leaves every range as it is.
struct Bits {
  int low = std::numeric_limits<int>::max() / 8;
  int high = std::numeric_limits<int>::min() / 8;

  Bits() = default;
  Bits(int lowest, int highest) : low(lowest), high(highest) {}
  explicit Bits(double x) {
    if (x == 0) return;
    // A double is its significand times 2^(exponent - 52), and its low zero bits count upwards from there.
    const int scale = std::max(exponent_of(x), -1022) - 52;
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) & ((std::uint64_t{1} << 52U) - 1);
    low = scale + (bits == 0 ? 52 : std::countr_zero(bits));
    high = exponent_of(x) + 1;
  }
  explicit Bits(Vec3 v) : Bits(Bits(v.x) | Bits(v.y) | Bits(v.z)) {}

  /// Of a sum's terms.
  friend Bits operator|(Bits a, Bits b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }
  friend Bits operator*(Bits a, Bits b) { return {a.low + b.low, a.high + b.high}; }
  /// Sums of up to 2^sum such numbers are exact: no bit is lost below, and nothing overflows.
  [[nodiscard]] bool is_exact(int sum = 20) const { return low >= -1074 && high + sum <= 1023; }
};

/// An enclosure as a number of type T: itself, or its middle rounded.
template <class T>
T middle_as(const Interval& x) {
  if constexpr (std::is_same_v<T, Interval>) {
    return x;
  } else {
    return static_cast<T>(mid(x));
  }
}

}  // namespace graze
