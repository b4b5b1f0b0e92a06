// Closed intervals of doubles with outward rounding, and the directed roundings they are made of.
//
// Solves:  for every operation f and intervals X, Y: a result that contains { f(x, y) : x in X, y in Y }.
// Needs:   the default rounding mode (to nearest, even), which is never changed; no flush to zero.
//          lo <= hi. An infinite end means "unbounded": the sets hold finite reals only, so 0 * [.., inf] is
//          0.
// Returns: never NaN. Where the real operation is undefined, or an operand is NaN, the entire line.
// Error:   + - * / sqrt round each end correctly, in the subnormal range and at overflow too: no end is a
//          double further out than needed, and an exact end stays exact. sqr and abs as well.
// Cost:    a few ns an operation with hardware fma, no allocation; rare operands (results below 2^-960 or
//          not finite) take a slower branch.
// Source:  the sign of the rounding error is read from error-free transformations: TwoSum (Knuth, TAOCP 2,
//          4.2.2, thm. B) and fma residuals (Muller et al., Handbook of Floating-Point Arithmetic, 2nd ed.,
//          4.4 and 5.3). Conventions at infinity and zero follow IEEE Std 1788-2015, 10.5.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace graze {

/// The reals x with lo <= x <= hi.
struct Interval {
  double lo = 0, hi = 0;

  constexpr Interval() = default;
  constexpr Interval(double low, double high) : lo(low), hi(high) {}
  /// [x, x]; for a NaN the entire line, for an infinity what lies beyond the largest double. So that
  /// formulas generic over the scalar can write T(2.0).
  constexpr explicit Interval(double x);

  friend constexpr bool operator==(const Interval&, const Interval&) = default;
};

/// The next double below x; -inf stays, and NaN gives -inf.
inline double next_below(double x) {
  if (!(x > -std::numeric_limits<double>::infinity())) return -std::numeric_limits<double>::infinity();
  if (x == 0) return -std::numeric_limits<double>::denorm_min();
  const auto bits = std::bit_cast<std::int64_t>(x);
  return std::bit_cast<double>(bits < 0 ? bits + 1 : bits - 1);
}

/// The next double above x; +inf stays, and NaN gives +inf.
inline double next_above(double x) { return -next_below(-x); }

namespace detail {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kLargest = std::numeric_limits<double>::max();
/// Above this a product's or a quotient's residual is a multiple of 2^-1074: its last bit lies at most 107
/// places below the leading one, and -960 - 107 > -1074.
inline constexpr double kResidualFloor = 0x1p-960;
/// Below this no intermediate of TwoSum overflows.
inline constexpr double kSumCeiling = 0x1p1022;

/// Moves a normal x one double down if `move`, without a branch: which way a bound goes is unpredictable.
inline double step_down_if(double x, bool move) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t toward_zero = bits >> 63 | 1;
  return std::bit_cast<double>(bits - (toward_zero & -static_cast<std::int64_t>(move)));
}
inline double step_up_if(double x, bool move) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t away = bits >> 63 | 1;
  return std::bit_cast<double>(bits + (away & -static_cast<std::int64_t>(move)));
}

/// The rounding error of s = fl(a + b), by TwoSum.
inline double sum_residual(double a, double b, double s) {
  const double b_part = s - a;
  return (a - (s - b_part)) + (b - b_part);
}

/// Sums near overflow, infinite or NaN.
[[gnu::noinline]] inline double add_down_rare(double a, double b) {
  const double s = a + b;
  if (std::isnan(s)) return -kInfinity;
  if (std::isinf(s)) return s > 0 && std::isfinite(a) && std::isfinite(b) ? kLargest : s;
  // FastTwoSum from the larger operand cannot overflow once the sum did not.
  const double large = std::fabs(a) < std::fabs(b) ? b : a;
  const double small = std::fabs(a) < std::fabs(b) ? a : b;
  return step_down_if(s, small - (s - large) < 0);
}

/// Sign of a b - p for finite a b != 0 whose rounding p is finite, non-zero and below 2^-959.
inline double small_product_residual(double a, double b, double p) {
  // The smaller factor is below 2^-479; raised by 2^600 neither it nor the product leaves the normal range.
  constexpr double kRaise = 0x1p600;
  const double small = std::fabs(a) < std::fabs(b) ? a : b;
  const double large = std::fabs(a) < std::fabs(b) ? b : a;
  return std::fma(small * kRaise, large, -(p * kRaise));
}

[[gnu::noinline]] inline double mul_down_rare(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return -kInfinity;
  if (a == 0 || b == 0) return 0;
  const double p = a * b;
  if (std::isinf(p)) return p > 0 && std::isfinite(a) && std::isfinite(b) ? kLargest : p;
  if (p == 0) return std::signbit(p) ? -std::numeric_limits<double>::denorm_min() : 0;
  return small_product_residual(a, b, p) < 0 ? next_below(p) : p;
}

/// Sign of a / b - q for finite non-zero a, b, q with q = fl(a / b).
inline double scaled_quotient_residual(double a, double b, double q) {
  // On significands in [1/2, 1) nothing under- or overflows; the exponents differ by a few units only.
  int a_exponent = 0, b_exponent = 0, q_exponent = 0;
  const double a_part = std::frexp(a, &a_exponent);
  const double b_part = std::frexp(b, &b_exponent);
  const double q_part = std::frexp(q, &q_exponent);
  const double r = std::fma(-q_part, b_part, std::ldexp(a_part, a_exponent - b_exponent - q_exponent));
  return b < 0 ? -r : r;
}

[[gnu::noinline]] inline double div_down_rare(double a, double b) {
  const double q = a / b;
  if (std::isnan(q) || b == 0) return -kInfinity;
  if (a == 0 || std::isinf(b)) return 0;
  if (std::isinf(q)) return q > 0 && std::isfinite(a) ? kLargest : q;
  if (q == 0) return std::signbit(q) ? -std::numeric_limits<double>::denorm_min() : 0;
  return scaled_quotient_residual(a, b, q) < 0 ? next_below(q) : q;
}

/// Square root's residual x - s^2; small arguments are raised by an even power of two first.
inline double root_residual(double x, double s) {
  if (x >= kResidualFloor) return std::fma(-s, s, x);
  return std::fma(-(s * 0x1p100), s * 0x1p100, x * 0x1p200);
}

}  // namespace detail

/// a + b rounded down. NaN (also inf - inf) gives -inf.
inline double add_down(double a, double b) {
  const double s = a + b;
  if (!(std::fabs(s) < detail::kSumCeiling && std::fabs(a) < detail::kSumCeiling)) [[unlikely]]
    return detail::add_down_rare(a, b);
  return detail::step_down_if(s, detail::sum_residual(a, b, s) < 0);
}
/// a + b rounded up. NaN gives +inf.
inline double add_up(double a, double b) {
  const double s = a + b;
  if (!(std::fabs(s) < detail::kSumCeiling && std::fabs(a) < detail::kSumCeiling)) [[unlikely]]
    return -detail::add_down_rare(-a, -b);
  return detail::step_up_if(s, detail::sum_residual(a, b, s) > 0);
}

/// a - b rounded down and up.
inline double sub_down(double a, double b) { return add_down(a, -b); }
inline double sub_up(double a, double b) { return add_up(a, -b); }

/// a b rounded down; 0 * inf is 0 (an infinite end bounds finite numbers). NaN gives -inf.
inline double mul_down(double a, double b) {
  const double p = a * b;
  const double size = std::fabs(p);
  if (!(size >= detail::kResidualFloor && size <= detail::kLargest)) [[unlikely]]
    return detail::mul_down_rare(a, b);
  return detail::step_down_if(p, std::fma(a, b, -p) < 0);
}
/// a b rounded up; 0 * inf is 0. NaN gives +inf.
inline double mul_up(double a, double b) {
  const double p = a * b;
  const double size = std::fabs(p);
  if (!(size >= detail::kResidualFloor && size <= detail::kLargest)) [[unlikely]]
    return -detail::mul_down_rare(-a, b);
  return detail::step_up_if(p, std::fma(a, b, -p) > 0);
}

/// a / b rounded down. Division by zero, inf / inf and NaN give -inf; finite / inf is 0.
inline double div_down(double a, double b) {
  const double q = a / b;
  const double size = std::fabs(q);
  if (!(size >= detail::kResidualFloor && size <= detail::kLargest &&
        std::fabs(a) >= detail::kResidualFloor && std::fabs(a) <= detail::kLargest)) [[unlikely]]
    return detail::div_down_rare(a, b);
  const double r = std::fma(-q, b, a);
  return detail::step_down_if(q, (b < 0 ? -r : r) < 0);
}
/// a / b rounded up. Division by zero, inf / inf and NaN give +inf; finite / inf is 0.
inline double div_up(double a, double b) { return -div_down(-a, b); }

/// Square root of max(x, 0) rounded down; NaN gives 0.
inline double sqrt_down(double x) {
  if (!(x > 0)) return 0;
  const double s = std::sqrt(x);
  if (std::isinf(s)) return s;
  return detail::step_down_if(s, detail::root_residual(x, s) < 0);
}
/// Square root of max(x, 0) rounded up; NaN gives +inf.
inline double sqrt_up(double x) {
  if (std::isnan(x)) return detail::kInfinity;
  if (x <= 0) return 0;
  const double s = std::sqrt(x);
  if (std::isinf(s)) return s;
  return detail::step_up_if(s, detail::root_residual(x, s) > 0);
}

/// [-inf, inf].
constexpr Interval entire() {
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
}
/// [x, x]. NaN gives the entire line, and an infinity the half line beyond the largest double.
constexpr Interval point(double x) {
  if (x != x) return entire();
  return {std::min(x, std::numeric_limits<double>::max()),
          std::max(x, std::numeric_limits<double>::lowest())};
}
constexpr Interval::Interval(double x) : Interval(point(x)) {}
/// [center - radius, center + radius], rounded outward; a NaN or negative radius gives the entire line.
inline Interval ball(double center, double radius) {
  if (!(radius >= 0)) return entire();
  return {sub_down(center, radius), add_up(center, radius)};
}

constexpr bool is_point(const Interval& x) { return x.lo == x.hi; }
constexpr bool is_entire(const Interval& x) { return x == entire(); }
constexpr bool contains(const Interval& x, double v) { return x.lo <= v && v <= x.hi; }
/// Is y a subset of x?
constexpr bool contains(const Interval& x, const Interval& y) { return x.lo <= y.lo && y.hi <= x.hi; }
constexpr bool contains_zero(const Interval& x) { return contains(x, 0.0); }

/// The smallest interval that contains both.
constexpr Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
/// The common part; none when the intervals are disjoint.
constexpr std::optional<Interval> intersect(const Interval& a, const Interval& b) {
  const Interval common{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
  if (common.lo <= common.hi) return common;
  return std::nullopt;
}

/// hi - lo, rounded up; inf for an unbounded interval.
inline double width(const Interval& x) { return sub_up(x.hi, x.lo); }
/// Largest |v| for v in x.
inline double mag(const Interval& x) { return std::max(std::fabs(x.lo), std::fabs(x.hi)); }
/// Smallest |v| for v in x.
inline double mig(const Interval& x) {
  return contains_zero(x) ? 0 : std::min(std::fabs(x.lo), std::fabs(x.hi));
}
/// A finite double in x, the nearest to the midpoint for a bounded x; 0 or the largest magnitude otherwise.
inline double mid(const Interval& x) {
  // A half line keeps its finite end's side: its middle is as far out as a double goes.
  if (std::isinf(x.lo)) return std::isinf(x.hi) ? 0 : -detail::kLargest;
  if (std::isinf(x.hi)) return detail::kLargest;
  const double sum = x.lo + x.hi;
  return std::isfinite(sum) ? 0.5 * sum : 0.5 * x.lo + 0.5 * x.hi;
}
/// x with each end moved out by n doubles.
inline Interval inflate_ulps(Interval x, int n) {
  for (int i = 0; i < n; ++i) x = {next_below(x.lo), next_above(x.hi)};
  return x;
}

inline Interval operator-(const Interval& x) { return {-x.hi, -x.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return {add_down(a.lo, b.lo), add_up(a.hi, b.hi)};
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return {sub_down(a.lo, b.hi), sub_up(a.hi, b.lo)};
}

/// x times the number k: one product an end.
inline Interval operator*(double k, const Interval& x) {
  if (!(std::fabs(k) <= detail::kLargest)) return k == k && x == Interval{} ? Interval{} : entire();
  return k < 0 ? Interval{mul_down(k, x.hi), mul_up(k, x.lo)} : Interval{mul_down(k, x.lo), mul_up(k, x.hi)};
}
inline Interval operator*(const Interval& x, double k) { return k * x; }

inline Interval operator*(const Interval& a, const Interval& b) {
  // The signs of the operands say which ends to multiply; only two mixed signs need four products.
  if (a.lo >= 0) return {mul_down(b.lo < 0 ? a.hi : a.lo, b.lo), mul_up(b.hi < 0 ? a.lo : a.hi, b.hi)};
  if (a.hi <= 0) return {mul_down(b.hi < 0 ? a.hi : a.lo, b.hi), mul_up(b.lo < 0 ? a.lo : a.hi, b.lo)};
  if (b.lo >= 0) return {mul_down(a.lo, b.hi), mul_up(a.hi, b.hi)};
  if (b.hi <= 0) return {mul_down(a.hi, b.lo), mul_up(a.lo, b.lo)};
  return {std::min(mul_down(a.lo, b.hi), mul_down(a.hi, b.lo)),
          std::max(mul_up(a.lo, b.lo), mul_up(a.hi, b.hi))};
}

/// Quotient; a divisor with zero inside gives the entire line, with zero at one end a half line, and zero by
/// anything but [0, 0] stays zero.
inline Interval operator/(const Interval& a, const Interval& b) {
  if (b.lo > 0) return {div_down(a.lo, a.lo < 0 ? b.lo : b.hi), div_up(a.hi, a.hi < 0 ? b.hi : b.lo)};
  if (b.hi < 0) return {div_down(a.hi, a.hi < 0 ? b.lo : b.hi), div_up(a.lo, a.lo < 0 ? b.hi : b.lo)};
  if (b == Interval{} || !(b.lo <= b.hi)) return entire();
  if (a == Interval{}) return a;
  if ((b.lo < 0 && b.hi > 0) || (a.lo < 0 && a.hi > 0)) return entire();
  // Zero is an end of b: the quotient runs from its smallest magnitude to infinity.
  if (b.lo == 0)
    return a.lo >= 0 ? Interval{div_down(a.lo, b.hi), detail::kInfinity}
                     : Interval{-detail::kInfinity, div_up(a.hi, b.hi)};
  return a.lo >= 0 ? Interval{-detail::kInfinity, div_up(a.lo, b.lo)}
                   : Interval{div_down(a.hi, b.lo), detail::kInfinity};
}

inline Interval operator+(const Interval& x, double v) { return x + point(v); }
inline Interval operator+(double v, const Interval& x) { return x + point(v); }
inline Interval operator-(const Interval& x, double v) { return x - point(v); }
inline Interval operator-(double v, const Interval& x) { return point(v) - x; }
inline Interval operator/(const Interval& x, double v) { return x / point(v); }
inline Interval operator/(double v, const Interval& x) { return point(v) / x; }
inline Interval& operator+=(Interval& a, const Interval& b) { return a = a + b; }
inline Interval& operator-=(Interval& a, const Interval& b) { return a = a - b; }
inline Interval& operator*=(Interval& a, const Interval& b) { return a = a * b; }
inline Interval& operator/=(Interval& a, const Interval& b) { return a = a / b; }

/// { |v| : v in x }.
inline Interval abs(const Interval& x) { return {mig(x), mag(x)}; }
/// { v^2 : v in x }: tighter than x * x, which forgets that both factors are the same number.
inline Interval sqr(const Interval& x) {
  const double near = mig(x), far = mag(x);
  return {mul_down(near, near), mul_up(far, far)};
}
/// { sqrt(v) : v in x, v >= 0 }: the negative part is cut off; [0, 0] when nothing is left.
inline Interval sqrt(const Interval& x) { return {sqrt_down(x.lo), sqrt_up(x.hi)}; }

/// { v^n : v in x } for n >= 0, by repeated squaring of magnitudes: each end within a relative
/// 2 n u, u = 2^-53, of the exact one while powers stay in the normal range.
inline Interval pow_int(const Interval& x, unsigned n) {
  if (n == 0) return {1, 1};
  const bool even = n % 2 == 0;
  if (!even && x.lo < 0 && x.hi > 0) return {-pow_int(point(-x.lo), n).hi, pow_int(point(x.hi), n).hi};
  if (!even && x.lo < 0 && x.hi <= 0) return -pow_int(-x, n);
  // From here on the base is non-negative, where powers grow with it.
  Interval base = abs(x), power{1, 1};
  for (; n > 0; n >>= 1U) {
    if (n & 1U) power = power * base;
    if (n > 1) base = sqr(base);
  }
  return power;
}

}  // namespace graze
