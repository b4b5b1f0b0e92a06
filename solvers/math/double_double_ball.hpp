// Double-doubles with a running bound on their error: coefficients whose rounding is far below a double's.
//
// Solves:  + - * on numbers known as value +- error, starting from exact doubles.
// Needs:   rounding to nearest. Magnitudes up to 2^996; a product below 2^-900 is charged
//          an absolute 2^-1000.
// Returns: a value and a bound with |value - exact| <= error, proved; not finite where something overflows.
// Error:   about 2^-103 of the largest intermediate an operation; enclosure() adds the rounding of its two
//          ends, so that a well-conditioned coefficient is enclosed within one or two doubles.
// Cost:    about 30 flops an addition, 20 a product; no allocation.
// Source:  the relative errors of solvers/math/double_double.hpp, summed as in Higham, "Accuracy and
//          Stability of Numerical Algorithms", 2nd ed., SIAM 2002, 3.3 (running error analysis).
#pragma once

#include <cmath>
#include <type_traits>

#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>

namespace graze {

class DoubleDoubleBall {
 public:
  constexpr DoubleDoubleBall() = default;  ///< zero
  constexpr explicit DoubleDoubleBall(double x) : value_(x) {}
  /// A double-double that is exact, such as a product by two_prod.
  constexpr explicit DoubleDoubleBall(const DoubleDouble& x) : value_(x) {}
  /// Needs: error >= 0.
  constexpr DoubleDoubleBall(const DoubleDouble& value, double error) : value_(value), error_(error) {}

  [[nodiscard]] constexpr const DoubleDouble& value() const { return value_; }
  [[nodiscard]] constexpr double error() const { return error_; }
  [[nodiscard]] constexpr explicit operator double() const { return value_.hi; }
  /// Known to be zero, without doubt.
  [[nodiscard]] bool is_exact_zero() const { return value_.hi == 0 && error_ == 0; }
  [[nodiscard]] bool contains_zero() const { return !(size() > error_); }
  [[nodiscard]] Interval enclosure() const {
    return {add_down(value_.hi, sub_down(value_.lo, error_)), add_up(value_.hi, add_up(value_.lo, error_))};
  }

  friend DoubleDoubleBall operator-(const DoubleDoubleBall& x) { return {-x.value_, x.error_}; }
  friend DoubleDoubleBall operator+(const DoubleDoubleBall& a, const DoubleDoubleBall& b) {
    const DoubleDouble sum = a.value_ + b.value_;
    return {sum, kSlack * (a.error_ + b.error_ + kRelative * std::fabs(sum.hi))};
  }
  friend DoubleDoubleBall operator-(const DoubleDoubleBall& a, const DoubleDoubleBall& b) { return a + -b; }
  friend DoubleDoubleBall operator*(const DoubleDoubleBall& a, const DoubleDoubleBall& b) {
    if (a.is_exact_zero() || b.is_exact_zero()) return {};
    const DoubleDouble product = a.value_ * b.value_;
    const double carried = a.size() * b.error_ + b.size() * a.error_ + a.error_ * b.error_;
    const double floor = std::fabs(product.hi) < kSmall ? kFloor : 0;
    return {product, kSlack * (carried + kRelative * std::fabs(product.hi)) + floor};
  }
  friend DoubleDoubleBall& operator+=(DoubleDoubleBall& a, const DoubleDoubleBall& b) { return a = a + b; }
  friend DoubleDoubleBall& operator*=(DoubleDoubleBall& a, const DoubleDoubleBall& b) { return a = a * b; }

 private:
  /// An upper bound of |value|.
  [[nodiscard]] double size() const { return kSlack * std::fabs(value_.hi); }

  static constexpr double kRelative = 0x1p-103;  ///< 8 u^2: over the 5 u^2 of a product, the 3 u^2 of a sum
  static constexpr double kSlack = 1 + 0x1p-49;  ///< 16 u: the bound's own roundings
  static constexpr double kSmall = 0x1p-900;     ///< below, low parts of a product may underflow
  static constexpr double kFloor = 0x1p-1000;    ///< by a few 2^-1074

  DoubleDouble value_;
  double error_ = 0;
};

/// The ball as a number of type T: its enclosure, or its middle rounded.
template <class T>
T rounded_to(const DoubleDoubleBall& x) {
  if constexpr (std::is_same_v<T, Interval>) {
    return x.enclosure();
  } else {
    return static_cast<T>(static_cast<double>(x));
  }
}

inline DoubleDoubleBall sqr(const DoubleDoubleBall& x) { return x * x; }

}  // namespace graze
