// sin, cos, exp and log of intervals.
//
// Solves:  inclusions of the four functions, for formulas that are generic over the scalar.
// Needs:   a C library whose functions err by at most kLibraryUlps ulps. glibc documents 1 ulp at most for
//          all four in double; no standard promises it, so this is the one assumption here.
// Returns: an interval that contains { f(v) : v in x, f defined }; the entire line where no v has a value.
//          [-1, 1] for sine and cosine of arguments that are longer than a period or beyond 2^40.
// Error:   each end within 2 kLibraryUlps + 1 doubles of the function's own end.
// Cost:    two calls of the library an interval; no allocation.
// Source:  monotone pieces between k pi/2; see Moore, Kearfott, Cloud, "Introduction to Interval Analysis",
//          SIAM 2009, 5.1.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <graze/solvers/math/interval.hpp>

namespace graze {

namespace detail {

inline constexpr int kLibraryUlps = 2;  ///< twice what glibc documents

inline Interval library(double value) { return inflate_ulps(point(value), kLibraryUlps); }
inline Interval unit_range(const Interval& x) { return {std::max(x.lo, -1.0), std::min(x.hi, 1.0)}; }

/// The whole numbers k for which x may contain (k + offset) pi: from the first to the last.
struct Multiples {
  double first = 0, last = -1;
};
inline Multiples multiples_of_pi(const Interval& x, double offset) {
  constexpr Interval kPi{3.141592653589793, 3.1415926535897936};
  const Interval turns = x / kPi - point(offset);
  return {std::ceil(turns.lo), std::floor(turns.hi)};
}

/// Of a function with extrema cos(k pi) at (k + offset) pi, from its values at the ends of x.
inline Interval wave(const Interval& x, double offset, double at_lo, double at_hi) {
  // Longer than a period, or so far out that neighbouring turns cannot be told apart.
  constexpr double kPeriod = 6.29, kFarthest = 0x1p40;
  if (!(width(x) < kPeriod) || mag(x) > kFarthest) return {-1, 1};
  Interval range = hull(library(at_lo), library(at_hi));
  const Multiples turns = multiples_of_pi(x, offset);
  for (double k = turns.first; k <= turns.last; ++k) {
    const double top = std::fmod(k, 2) == 0 ? 1 : -1;
    range = hull(range, point(top));
  }
  return unit_range(range);
}

}  // namespace detail

inline Interval sin(const Interval& x) { return detail::wave(x, 0.5, std::sin(x.lo), std::sin(x.hi)); }
inline Interval cos(const Interval& x) { return detail::wave(x, 0, std::cos(x.lo), std::cos(x.hi)); }

inline Interval exp(const Interval& x) {
  return {std::max(0.0, detail::library(std::exp(x.lo)).lo), detail::library(std::exp(x.hi)).hi};
}

/// Of the positive part of x.
inline Interval log(const Interval& x) {
  if (!(x.hi > 0)) return entire();
  const double lo = x.lo > 0 ? detail::library(std::log(x.lo)).lo : -detail::kInfinity;
  return {lo, detail::library(std::log(x.hi)).hi};
}

}  // namespace graze
