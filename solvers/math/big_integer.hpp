// Integers of any size, and dyadic numbers m 2^e made of them: arithmetic that never rounds.
//
// Solves:  BigInteger: + - * << >> / % gcd and order; Dyadic: + - * and order, from any finite doubles. The
//          same formulas that run in double or Interval run in Dyadic, and give their exact values.
// Needs:   a compiler with 128-bit integers (GCC, clang); doubles that enter are finite. Exponents of
//          dyadics stay within +-2^62: products of fewer than 2^50 doubles do.
// Returns: value types; equal numbers have equal representations. What was moved from may be assigned to.
// Error:   none. to_double() is the nearest double, ties to even, with subnormals and overflow; a
//          double-double is within 2^-106 relatively, or 2^-1075.
// Cost:    schoolbook: m + n limbs of 64 bits for a sum, m n for a product and for a quotient with n + m
//          limbs in the dividend. No allocation up to kInline limbs (512 bits). Measured (AMD EPYC, g++ 12
//          -O3), ns: 5 limbs, sum 15, product 37, 10 by 5 limbs 140, gcd 12 000; dyadics of one double
//          each, sum 21, product 15, from and to double 8 and 5.
// Source:  D. E. Knuth, The Art of Computer Programming 2, 3rd ed., 1997, 4.3.1: algorithms A, S, M and D;
//          4.5.2, algorithm A (Euclid). Changed: D takes trial digits from a division of 128 by 64 bits.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <graze/solvers/math/double_double.hpp>

namespace graze {
namespace detail {

/// Limbs in a fixed array, and in a vector once they are too many; the lowest first.
class LimbBuffer {
 public:
  using Limb = std::uint64_t;
  /// A product of eight doubles, with room for the sum of 2^80 of them.
  static constexpr std::size_t kInline = 8;

  // The array is not set and only its used part is copied: clearing it would cost more than a sum.
  LimbBuffer() {}
  LimbBuffer(const LimbBuffer& other) { assign(other); }
  LimbBuffer(LimbBuffer&& other) noexcept { take(other); }
  LimbBuffer& operator=(const LimbBuffer& other) {
    if (this != &other) assign(other);
    return *this;
  }
  LimbBuffer& operator=(LimbBuffer&& other) noexcept {
    if (this != &other) take(other);
    return *this;
  }
  ~LimbBuffer() = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] Limb* data() { return heap_.empty() ? inline_.data() : heap_.data(); }
  [[nodiscard]] const Limb* data() const { return heap_.empty() ? inline_.data() : heap_.data(); }
  [[nodiscard]] std::span<const Limb> view() const { return {data(), size_}; }
  Limb& operator[](std::size_t i) { return data()[i]; }
  Limb operator[](std::size_t i) const { return data()[i]; }

  /// New limbs are zero.
  void resize(std::size_t size) {
    reserve(size);
    if (size > size_) std::fill(data() + size_, data() + size, Limb{0});
    size_ = size;
  }
  /// Drops leading zeros.
  void trim() {
    const Limb* const limbs = data();
    while (size_ > 0 && limbs[size_ - 1] == 0) --size_;
  }

 private:
  void reserve(std::size_t size) {
    const std::size_t capacity = heap_.empty() ? kInline : heap_.size();
    if (size <= capacity) return;
    std::vector<Limb> larger(std::max(size, 2 * capacity));
    std::copy_n(data(), size_, larger.begin());
    heap_ = std::move(larger);
  }
  void assign(const LimbBuffer& other) {
    size_ = 0;
    reserve(other.size_);
    std::copy_n(other.data(), other.size_, data());
    size_ = other.size_;
  }
  void take(LimbBuffer& other) noexcept {
    heap_ = std::move(other.heap_);
    size_ = std::exchange(other.size_, 0);
    if (heap_.empty()) std::copy_n(other.inline_.data(), size_, inline_.data());
    other.heap_.clear();
  }

  std::array<Limb, kInline> inline_;
  std::vector<Limb> heap_;
  std::size_t size_ = 0;
};

}  // namespace detail

/// A built-in integer of at most 64 bits.
template <class I>
concept SmallInteger = std::integral<I> && !std::same_as<I, bool> && sizeof(I) <= sizeof(std::uint64_t);

/// An integer: sign and magnitude.
class BigInteger {
 public:
  using Limb = detail::LimbBuffer::Limb;
  static constexpr std::size_t kLimbBits = 64;
  static constexpr std::size_t kInline = detail::LimbBuffer::kInline;

  BigInteger() = default;  ///< zero
  // A built-in integer is a BigInteger without loss, so the conversion is implicit.
  template <SmallInteger I>
  BigInteger(I x) : BigInteger(std::cmp_less(x, 0), magnitude_of(x)) {}
  /// The integer part of a finite x, toward zero: x itself where x is an integer.
  explicit BigInteger(double x);
  /// The integer with these limbs, the lowest first.
  static BigInteger from_limbs(std::span<const Limb> limbs, bool negative = false);
  static BigInteger power_of_two(std::size_t k);

  /// -1, 0 or 1.
  [[nodiscard]] int sign() const { return is_zero() ? 0 : negative_ ? -1 : 1; }
  [[nodiscard]] bool is_zero() const { return magnitude_.size() == 0; }
  [[nodiscard]] bool is_odd() const { return !is_zero() && (magnitude_[0] & 1U) != 0; }
  /// The number of binary digits of |x|; 0 for zero.
  [[nodiscard]] std::size_t bit_length() const;
  /// The largest k such that 2^k divides x; 0 for zero.
  [[nodiscard]] std::size_t trailing_zeros() const;
  /// The limbs of |x|, the lowest first, the last one not zero.
  [[nodiscard]] std::span<const Limb> limbs() const { return magnitude_.view(); }
  /// The nearest double, ties to even; infinite from 2^1024 - 2^970 on.
  [[nodiscard]] double to_double() const;
  /// As Dyadic's.
  [[nodiscard]] DoubleDouble to_double_double() const;
  explicit operator double() const { return to_double(); }

  BigInteger& operator+=(const BigInteger& y);
  BigInteger& operator-=(const BigInteger& y);
  BigInteger& operator*=(const BigInteger& y) { return *this = *this * y; }
  BigInteger& operator<<=(std::size_t k);
  /// floor(x / 2^k).
  BigInteger& operator>>=(std::size_t k);
  void negate() { negative_ = !negative_ && !is_zero(); }

  friend BigInteger operator-(BigInteger x) {
    x.negate();
    return x;
  }
  friend BigInteger operator+(BigInteger x, const BigInteger& y) { return std::move(x += y); }
  friend BigInteger operator-(BigInteger x, const BigInteger& y) { return std::move(x -= y); }
  friend BigInteger operator*(const BigInteger& x, const BigInteger& y);
  friend BigInteger operator<<(BigInteger x, std::size_t k) { return std::move(x <<= k); }
  friend BigInteger operator>>(BigInteger x, std::size_t k) { return std::move(x >>= k); }
  friend bool operator==(const BigInteger& x, const BigInteger& y);
  friend std::strong_ordering operator<=>(const BigInteger& x, const BigInteger& y);
  friend BigInteger abs(BigInteger x) {
    x.negative_ = false;
    return x;
  }

  struct Division;
  /// x = quotient * y + remainder, the quotient cut toward zero and the remainder with the sign of x, as the
  /// built-in / and %. y = 0 gives quotient 0 and remainder x.
  static Division divide(const BigInteger& x, const BigInteger& y);

 private:
  BigInteger(bool negative, Limb magnitude) : negative_(negative) {
    magnitude_.resize(1);
    magnitude_[0] = magnitude;
    magnitude_.trim();
  }
  // The negative of the smallest integer does not fit its type, but does wrap to the right limb.
  template <SmallInteger I>
  static constexpr Limb magnitude_of(I x) {
    const Limb bits = static_cast<Limb>(x);
    return std::cmp_less(x, 0) ? Limb{0} - bits : bits;
  }
  void add(const BigInteger& y, bool y_negative);

  detail::LimbBuffer magnitude_;
  bool negative_ = false;
};

struct BigInteger::Division {
  BigInteger quotient, remainder;
};

inline BigInteger operator/(const BigInteger& x, const BigInteger& y) {
  return BigInteger::divide(x, y).quotient;
}
inline BigInteger operator%(const BigInteger& x, const BigInteger& y) {
  return BigInteger::divide(x, y).remainder;
}
/// x / y where y != 0 divides x: the quotient, without a remainder to look at.
inline BigInteger exact_quotient(const BigInteger& x, const BigInteger& y) { return x / y; }

/// The greatest common divisor, not negative; gcd(x, 0) = |x|.
BigInteger gcd(BigInteger x, BigInteger y);

/// m 2^e with m odd, or zero.
class Dyadic {
 public:
  Dyadic() = default;  ///< zero
  /// Exactly x, which is finite; subnormals included.
  explicit Dyadic(double x);
  /// Exactly hi + lo.
  explicit Dyadic(const DoubleDouble& x) : Dyadic(Dyadic(x.hi) + Dyadic(x.lo)) {}
  /// Exactly m 2^e.
  explicit Dyadic(BigInteger m, long e = 0) : mantissa_(std::move(m)), exponent_(e) { normalise(); }
  static Dyadic power_of_two(long k) { return Dyadic(BigInteger(1), k); }

  /// -1, 0 or 1.
  [[nodiscard]] int sign() const { return mantissa_.sign(); }
  [[nodiscard]] bool is_zero() const { return mantissa_.is_zero(); }
  /// m, odd; 0 for zero.
  [[nodiscard]] const BigInteger& mantissa() const { return mantissa_; }
  /// e; 0 for zero.
  [[nodiscard]] long exponent() const { return exponent_; }
  /// floor(log2 |x|), for x != 0.
  [[nodiscard]] long top_exponent() const {
    return exponent_ + static_cast<long>(mantissa_.bit_length()) - 1;
  }

  /// The nearest double, ties to even: subnormal, zero or infinite where that is the nearest.
  [[nodiscard]] double to_double() const;
  [[nodiscard]] double value() const { return to_double(); }
  explicit operator double() const { return to_double(); }
  /// The greatest double not above x: -inf below the least double.
  [[nodiscard]] double round_down() const;
  /// The least double not below x: inf above the greatest double.
  [[nodiscard]] double round_up() const { return -(-*this).round_down(); }
  /// The nearest double and the double nearest to the rest, normalised: within 2^-106 relatively; {+-inf, 0}
  /// where the nearest double is infinite.
  [[nodiscard]] DoubleDouble to_double_double() const;
  /// floor(x 2^-k), an integer.
  [[nodiscard]] BigInteger floor_in_units_of(long k) const;

  friend Dyadic operator-(Dyadic x) {
    x.mantissa_.negate();
    return x;
  }
  friend Dyadic operator+(const Dyadic& x, const Dyadic& y) { return Dyadic(x) += y; }
  friend Dyadic operator-(const Dyadic& x, const Dyadic& y) { return Dyadic(x) -= y; }
  friend Dyadic operator*(const Dyadic& x, const Dyadic& y);
  Dyadic& operator+=(const Dyadic& y);
  Dyadic& operator-=(const Dyadic& y) { return *this += -y; }
  Dyadic& operator*=(const Dyadic& y) { return *this = *this * y; }
  friend bool operator==(const Dyadic&, const Dyadic&) = default;
  friend std::strong_ordering operator<=>(const Dyadic& x, const Dyadic& y);
  friend Dyadic sqr(const Dyadic& x) { return x * x; }
  friend Dyadic abs(const Dyadic& x) { return x.sign() < 0 ? -x : x; }
  /// x 2^k.
  friend Dyadic scale_by_power(Dyadic x, long k) {
    if (!x.is_zero()) x.exponent_ += k;
    return x;
  }

 private:
  void normalise();

  BigInteger mantissa_;
  long exponent_ = 0;
};

}  // namespace graze
