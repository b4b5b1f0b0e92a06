// Double-double numbers: the unevaluated sum of two doubles, about 106 bits.
//
// Solves:  + - * / sqrt with a relative error of a few u^2, u = 2^-53.
// Needs:   |lo| <= ulp(hi)/2 (what every function here returns); rounding to nearest; operands and results
//          between 2^-900 and 2^996 in magnitude, or zero: outside, the low parts under- or overflow. A
//          divisor is not zero, a radicand not negative.
// Error:   stated for each function, relative to the exact result of its double-double operands.
// Cost:    flops in each comment; no allocation. fma is one flop with hardware support.
// Source:  [JMP] Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of
//          double-word arithmetic", ACM TOMS 44(2), 2017, art. 15. Square root: [LLM] Lefevre, Louvet,
//          Muller, Picot, Rideau, "Accurate calculation of Euclidean norms using double-word arithmetic",
//          ACM TOMS 49(1), 2023. Changed: zero numerators and radicands are let through.
#pragma once

#include <cmath>
#include <compare>

namespace graze {

/// hi + lo, hi = fl(hi + lo).
struct DoubleDouble {
  double hi = 0, lo = 0;

  constexpr DoubleDouble() = default;
  // A double is a double-double without loss, so the conversion is implicit.
  constexpr DoubleDouble(double x) : hi(x) {}
  constexpr DoubleDouble(double high, double low) : hi(high), lo(low) {}

  /// The nearest double.
  constexpr explicit operator double() const { return hi; }

  friend constexpr bool operator==(const DoubleDouble&, const DoubleDouble&) = default;
  /// Lexicographic order is the order of the numbers, since the pair is normalised.
  friend constexpr std::partial_ordering operator<=>(const DoubleDouble& a, const DoubleDouble& b) {
    const auto order = a.hi <=> b.hi;
    return order == 0 ? a.lo <=> b.lo : order;
  }
};

/// a + b exactly (6 flops), for any order of a and b (Knuth, TAOCP 2, 4.2.2, thm. B).
inline DoubleDouble two_sum(double a, double b) {
  const double s = a + b;
  const double b_part = s - a;
  return {s, (a - (s - b_part)) + (b - b_part)};
}

/// a + b exactly (3 flops), for |a| >= |b| or a = 0 (Dekker 1971).
inline DoubleDouble quick_two_sum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}

/// a b exactly (2 flops).
inline DoubleDouble two_prod(double a, double b) {
  const double p = a * b;
  return {p, std::fma(a, b, -p)};
}

inline DoubleDouble operator-(const DoubleDouble& x) { return {-x.hi, -x.lo}; }

/// Error <= 2 u^2; 10 flops. [JMP] algorithm 4, DWPlusFP.
inline DoubleDouble operator+(const DoubleDouble& x, double y) {
  const DoubleDouble s = two_sum(x.hi, y);
  return quick_two_sum(s.hi, x.lo + s.lo);
}
inline DoubleDouble operator+(double x, const DoubleDouble& y) { return y + x; }
inline DoubleDouble operator-(const DoubleDouble& x, double y) { return x + -y; }
inline DoubleDouble operator-(double x, const DoubleDouble& y) { return -y + x; }

/// Error <= 3 u^2 + 13 u^3, under cancellation too; 20 flops. [JMP] algorithm 6, AccurateDWPlusDW.
inline DoubleDouble operator+(const DoubleDouble& x, const DoubleDouble& y) {
  const DoubleDouble s = two_sum(x.hi, y.hi);
  const DoubleDouble t = two_sum(x.lo, y.lo);
  const DoubleDouble v = quick_two_sum(s.hi, s.lo + t.hi);
  return quick_two_sum(v.hi, t.lo + v.lo);
}
inline DoubleDouble operator-(const DoubleDouble& x, const DoubleDouble& y) { return x + -y; }

/// Error <= 2 u^2; 6 flops. [JMP] algorithm 9, DWTimesFP3.
inline DoubleDouble operator*(const DoubleDouble& x, double y) {
  const DoubleDouble c = two_prod(x.hi, y);
  return quick_two_sum(c.hi, std::fma(x.lo, y, c.lo));
}
inline DoubleDouble operator*(double x, const DoubleDouble& y) { return y * x; }

/// Error <= 5 u^2; 9 flops. [JMP] algorithm 12, DWTimesDW3.
inline DoubleDouble operator*(const DoubleDouble& x, const DoubleDouble& y) {
  const DoubleDouble c = two_prod(x.hi, y.hi);
  const double low = std::fma(x.lo, y.hi, std::fma(x.hi, y.lo, x.lo * y.lo));
  return quick_two_sum(c.hi, c.lo + low);
}

/// Error <= 3 u^2; 10 flops. [JMP] algorithm 15, DWDivFP3.
inline DoubleDouble operator/(const DoubleDouble& x, double y) {
  const double t = x.hi / y;
  const DoubleDouble p = two_prod(t, y);
  const double remainder = ((x.hi - p.hi) - p.lo) + x.lo;
  return quick_two_sum(t, remainder / y);
}

/// Error <= 15 u^2 + 56 u^3; 18 flops. [JMP] algorithm 17, DWDivDW2, with its DWTimesFP1 (algorithm 7).
inline DoubleDouble operator/(const DoubleDouble& x, const DoubleDouble& y) {
  const double t = x.hi / y.hi;
  const DoubleDouble c = two_prod(y.hi, t);
  const DoubleDouble v = quick_two_sum(c.hi, y.lo * t);
  const DoubleDouble r = quick_two_sum(v.hi, v.lo + c.lo);
  const double remainder = (x.hi - r.hi) + (x.lo - r.lo);
  return quick_two_sum(t, remainder / y.hi);
}
inline DoubleDouble operator/(double x, const DoubleDouble& y) { return DoubleDouble(x) / y; }

inline DoubleDouble& operator+=(DoubleDouble& x, const DoubleDouble& y) { return x = x + y; }
inline DoubleDouble& operator-=(DoubleDouble& x, const DoubleDouble& y) { return x = x - y; }
inline DoubleDouble& operator*=(DoubleDouble& x, const DoubleDouble& y) { return x = x * y; }
inline DoubleDouble& operator/=(DoubleDouble& x, const DoubleDouble& y) { return x = x / y; }

/// x^2; error <= 5 u^2; 7 flops. Algorithm 12 of [JMP] with x = y.
inline DoubleDouble sqr(const DoubleDouble& x) {
  const DoubleDouble c = two_prod(x.hi, x.hi);
  const double cross = x.hi * x.lo;
  return quick_two_sum(c.hi, c.lo + std::fma(x.lo, x.hi, std::fma(x.lo, x.lo, cross)));
}

/// Error <= 25/8 u^2; 8 flops. [LLM], SQRTDWtoDW.
inline DoubleDouble sqrt(const DoubleDouble& x) {
  if (x.hi == 0) return x;
  const double s = std::sqrt(x.hi);
  const double remainder = x.lo + std::fma(-s, s, x.hi);
  return quick_two_sum(s, remainder / (2 * s));
}

inline DoubleDouble abs(const DoubleDouble& x) { return x.hi < 0 ? -x : x; }

/// x * 2^k for a power of two given as a double: exact.
inline DoubleDouble scaled(const DoubleDouble& x, double power) { return {x.hi * power, x.lo * power}; }

}  // namespace graze
