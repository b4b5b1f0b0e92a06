// Real numbers known through proved enclosures: interval arithmetic on MPFR, and decimals and doubles from
// it.
//
// Precision is a property of each interval and travels with it; nothing here has thread or global state.
#pragma once

#include <mpfr.h>

#include <functional>
#include <graze/experiments/truth.hpp>
#include <graze/experiments/truth_polynomial.hpp>
#include <utility>

namespace graze::truth {

/// [lo, hi] with ends rounded outward. Results take the higher precision of their arguments.
class Interval {
 public:
  explicit Interval(mpfr_prec_t precision) {
    mpfr_init2(lo_, precision);
    mpfr_init2(hi_, precision);
  }
  Interval(const Interval& other) : Interval(other.precision()) { assign(other); }
  Interval(Interval&& other) noexcept { take(other); }
  Interval& operator=(Interval other) noexcept {
    std::swap(owns_, other.owns_);
    mpfr_swap(lo_, other.lo_);
    mpfr_swap(hi_, other.hi_);
    return *this;
  }
  ~Interval() {
    if (!owns_) return;
    mpfr_clear(lo_);
    mpfr_clear(hi_);
  }

  /// [lo, hi] 2^e.
  static Interval of(const Integer& lo, const Integer& hi, long e, mpfr_prec_t precision);
  static Interval of(const Integer& value, mpfr_prec_t precision) { return of(value, value, 0, precision); }
  static Interval of(double value, mpfr_prec_t precision);
  static Interval of(const Rational& value, mpfr_prec_t precision);

  [[nodiscard]] mpfr_srcptr lo() const { return lo_; }
  [[nodiscard]] mpfr_srcptr hi() const { return hi_; }
  [[nodiscard]] mpfr_prec_t precision() const { return mpfr_get_prec(lo_); }
  /// 1 or -1 when proved, else 0.
  [[nodiscard]] int sign() const;
  [[nodiscard]] bool contains_zero() const { return mpfr_sgn(lo_) <= 0 && mpfr_sgn(hi_) >= 0; }
  [[nodiscard]] bool is_zero() const { return mpfr_zero_p(lo_) != 0 && mpfr_zero_p(hi_) != 0; }
  /// The width is at most 2^-bits times the magnitude; exact zero qualifies.
  [[nodiscard]] bool is_relative(long bits) const;
  /// The width is at most 2^-bits.
  [[nodiscard]] bool is_absolute(long bits) const;
  [[nodiscard]] double middle() const;

  friend Interval operator+(const Interval& a, const Interval& b);
  friend Interval operator-(const Interval& a, const Interval& b);
  friend Interval operator-(const Interval& a);
  friend Interval operator*(const Interval& a, const Interval& b);
  /// b must not contain zero.
  friend Interval operator/(const Interval& a, const Interval& b);
  friend Interval square(const Interval& a);
  /// The part below zero is cut off.
  friend Interval sqrt(const Interval& a);
  friend Interval times_power_of_two(Interval a, long e);
  /// Proved a < b.
  friend bool below(const Interval& a, const Interval& b) { return mpfr_less_p(a.hi_, b.lo_) != 0; }

 private:
  void assign(const Interval& other) {
    mpfr_set(lo_, other.lo_, MPFR_RNDN);
    mpfr_set(hi_, other.hi_, MPFR_RNDN);
  }
  void take(Interval& other) {
    *lo_ = *other.lo_;
    *hi_ = *other.hi_;
    other.owns_ = false;
  }

  bool owns_ = true;
  mpfr_t lo_, hi_;
};

/// A real number that gives enclosures of any width and decides equality with a rational.
class Number {
 public:
  /// `enclose(b)`: an interval no wider than about 2^-b of the number (absolutely, where the number is zero).
  /// `equals(q)`: exact.
  Number(std::function<Interval(long)> enclose, std::function<bool(const Rational&)> equals)
      : enclose_(std::move(enclose)), equals_(std::move(equals)) {}

  /// Remembers the narrowest enclosure so far.
  [[nodiscard]] const Interval& enclosure(long bits) {
    if (bits > known_bits_) {
      known_ = enclose_(bits);
      known_bits_ = bits;
    }
    return known_;
  }
  /// The last enclosure.
  [[nodiscard]] const Interval& known() const { return known_; }
  [[nodiscard]] bool equals(const Rational& q) const { return equals_(q); }

 private:
  std::function<Interval(long)> enclose_;
  std::function<bool(const Rational&)> equals_;
  Interval known_{2};
  long known_bits_ = 0;
};

/// The rational number of a double.
Rational rational(double x);
/// m / 2^k.
Rational rational(const Integer& m, long k);
/// Working bits for so many decimal digits: log2(10) a digit, and 32 to spare for the double-double.
constexpr long working_bits(int digits) { return static_cast<long>(digits) * 3322 / 1000 + 32; }

/// Digits, proof and double-double of a number, each correctly rounded; ties are decided exactly.
Real to_real(Number& number, int digits);
/// The double nearest to number - offset, ties to even.
double nearest(Number& number, double offset, long bits);

/// An interval that holds f(t) for the root t in [0, 1], `lipschitz` bounding |f'| there.
Interval image(const Root& root, const Polynomial& f, const Integer& lipschitz, mpfr_prec_t precision);
/// f(t), to 2^-bits of its value: f(t) != 0 must be known.
Interval nonzero_image(Root& root, const Polynomial& f, const Integer& lipschitz, long bits);
/// The root itself. It outlives neither `root` nor a copy of it.
Number number_of(Root& root);
/// a < b, a = b, a > b of two answers' numbers as far as their digits tell: -1, 0, 1; 0 when they overlap.
int compare_decimals(const Real& a, const Real& b);

}  // namespace graze::truth
