// Exact reference arithmetic for the tests of solvers/math: rationals, and random doubles of all magnitudes.
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <limits>
#include <span>
#include <vector>

namespace graze::test {

using Exact =
    boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

inline Exact exact(double x) { return Exact(x); }
inline Exact exact(const DoubleDouble& x) { return Exact(x.hi) + Exact(x.lo); }
inline double to_double(const Exact& x) { return x.convert_to<double>(); }

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kMax = std::numeric_limits<double>::max();
inline constexpr double kMin = std::numeric_limits<double>::min();
inline constexpr double kTiny = std::numeric_limits<double>::denorm_min();

/// Zeros, subnormals, ends of the normal range, powers of two and their neighbours, with both signs.
inline std::vector<double> special_values() {
  std::vector<double> values;
  for (const double x :
       {0.0, kTiny, 3 * kTiny, kMin - kTiny, kMin, 0x1.8p-537, 0x1p-484, 0.1, 1 - 0x1p-53, 1.0, 1 + 0x1p-52,
        3.0, 0x1p512, 0x1.fffffffffffffp1021, 0x1p1022, 0x1.8p1022, kMax / 2, kMax}) {
    values.push_back(x);
    values.push_back(-x);
  }
  return values;
}

/// Random sign and significand, exponent uniform in [low, high]; subnormal below -1022.
inline double log_uniform(Rng& rng, int low, int high) {
  const int exponent = low + static_cast<int>(rng.next() % static_cast<std::uint64_t>(high - low + 1));
  const double significand = rng.uniform(1, 2);
  // A fifth of the numbers gets few bits, so that exact results and ties occur.
  const double rounded = rng.next() % 5 == 0 ? std::floor(8 * significand) / 8 : significand;
  return scale_by_power(rng.next() % 2 == 0 ? rounded : -rounded, exponent);
}

/// Is x the greatest double not above q?
inline bool is_rounded_down(double x, const Exact& q) {
  const bool below = x == -kInfinity || (x < kInfinity && exact(x) <= q);
  const double next = next_above(x);
  return below && (next == kInfinity || (next > -kInfinity && exact(next) > q));
}
inline bool is_rounded_up(double x, const Exact& q) { return is_rounded_down(-x, -q); }

/// Is the interval the smallest one of doubles around [lo, hi]?
inline bool is_tight(const Interval& x, const Exact& lo, const Exact& hi) {
  return is_rounded_down(x.lo, lo) && is_rounded_up(x.hi, hi);
}

inline bool holds(const Interval& x, const Exact& q) {
  return (x.lo == -kInfinity || exact(x.lo) <= q) && (x.hi == kInfinity || exact(x.hi) >= q);
}

/// p(x) for power coefficients.
inline Exact power_value(const std::vector<Exact>& c, const Exact& x) {
  Exact y = 0;
  for (std::size_t i = c.size(); i-- > 0;) y = y * x + c[i];
  return y;
}
/// p(t) for Bernstein coefficients.
inline Exact bernstein_value_exact(std::vector<Exact> b, const Exact& t) {
  const Exact s = 1 - t;
  for (std::size_t size = b.size(); size > 1; --size)
    for (std::size_t i = 0; i + 1 < size; ++i) b[i] = s * b[i] + t * b[i + 1];
  return b[0];
}
inline std::vector<Exact> exact(std::span<const double> values) {
  std::vector<Exact> result;
  for (const double x : values) result.push_back(exact(x));
  return result;
}

/// Worst ratio error / bound, printed at the end of a test: near 1 is tight, above 1 is a broken promise.
class Worst {
 public:
  explicit Worst(const char* what) : what_(what) {}
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  ~Worst() { std::printf("    worst %s: %.4g\n", what_, worst_); }
  /// Records |error| / bound and says whether it is at most 1; 0 / 0 counts as 0.
  bool within(const Exact& error, double bound) {
    if (bound == kInfinity || error == 0) return true;
    if (!(bound > 0)) return false;
    const Exact ratio = abs(error) / exact(bound);
    worst_ = std::max(worst_, to_double(ratio));
    return ratio <= 1;
  }

 private:
  const char* what_;
  double worst_ = 0;
};

}  // namespace graze::test
