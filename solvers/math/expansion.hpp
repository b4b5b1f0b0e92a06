// Exact sums and products of doubles: the fallback behind predicates whose filter cannot tell.
//
// Solves:  + - * without any rounding, on numbers held as a sum of doubles whose bits do not overlap
//          ("expansion"); the exact sign of such a number, and the double nearest to it.
// Needs:   rounding to nearest, even; no flush to zero. Range: a polynomial of degree k is exact if its
//          inputs are in_range(x, k), that is zero or 2^(52 - floor(1074/k)) <= |x| <= 2^floor(1000/k) (k =
//          2: 2^-485 ... 2^500, k = 3: 2^-306 ... 2^333), and it has fewer than 2^20 terms. Reason: such an x
//          is a multiple of 2^-floor(1074/k), so no part of a product lies below the smallest subnormal, and
//          sums stay below 2^1022. Outside this range a result may be rounded, and nothing tells, or it
//          leaves the doubles: is_finite() is then false, and of everything computed from it.
// Returns: a value type; parts are non-zero and nonadjacent, the smallest first; zero has none.
// Error:   none in range. value() is the correctly rounded double, ties to even.
// Cost:    m + n additions of 6 flops for a sum of m and n parts, 2mn products for a product, then one
//          compression. No allocation up to kInlineParts parts. Measured, without fma: 0.6 us a
//          3x3 determinant, 0.2 us a dot product of three.
// Source:  J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates,
//          Discrete Comput. Geom. 18, 1997: FAST-EXPANSION-SUM (thm. 13), SCALE-EXPANSION (thm. 19), COMPRESS
//          (thm. 23), with zero elimination. Changed: every result is compressed, so that lengths
//          follow the bits of the number and not its history.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <graze/solvers/math/double_double.hpp>

namespace graze {
namespace detail {

/// Doubles in a fixed array, and in a vector once they are too many.
class PartList {
 public:
  /// What a 3x3 determinant of doubles can need before its compression (6 products of 4 parts), with room.
  static constexpr std::size_t kInlineParts = 32;

  // The array is not set and only its used part is copied: clearing it would cost more than the sums.
  PartList() {}
  PartList(const PartList& other) : heap_(other.heap_), size_(other.size_) { copy_inline(other); }
  PartList(PartList&& other) noexcept : heap_(std::move(other.heap_)), size_(other.size_) {
    copy_inline(other);
    other.size_ = 0;
  }
  PartList& operator=(const PartList& other) { return *this = PartList(other); }
  PartList& operator=(PartList&& other) noexcept {
    heap_ = std::move(other.heap_);
    size_ = other.size_;
    copy_inline(other);
    other.size_ = 0;
    return *this;
  }
  ~PartList() = default;
  explicit PartList(std::size_t capacity) {
    if (capacity > kInlineParts) heap_.resize(capacity);
  }
  /// Appends, unless x is zero. Needs: fewer parts than the capacity asked for.
  void append_nonzero(double x) {
    if (x != 0) data()[size_++] = x;
  }
  [[nodiscard]] std::span<const double> view() const {
    return {heap_.empty() ? inline_.data() : heap_.data(), size_};
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void copy_inline(const PartList& other) {
    if (heap_.empty()) std::copy_n(other.inline_.begin(), size_, inline_.begin());
  }
  double* data() { return heap_.empty() ? inline_.data() : heap_.data(); }

  std::array<double, kInlineParts> inline_;
  std::vector<double> heap_;
  std::size_t size_ = 0;
};

/// e + f (FAST-EXPANSION-SUM): both strongly nonoverlapping, and so is the sum.
inline PartList sum_of(std::span<const double> e, std::span<const double> f) {
  // One more than finite numbers need: the first remainder is zero unless a part is not finite.
  PartList sum(e.size() + f.size() + 1);
  std::size_t i = 0, j = 0;
  double q = 0;
  while (i < e.size() || j < f.size()) {
    // Parts of both enter by ascending magnitude: the theorem rests on that order.
    const bool from_e = j == f.size() || (i < e.size() && std::fabs(e[i]) < std::fabs(f[j]));
    const DoubleDouble next = two_sum(q, from_e ? e[i++] : f[j++]);
    sum.append_nonzero(next.lo);
    q = next.hi;
  }
  sum.append_nonzero(q);
  return sum;
}

/// e k (SCALE-EXPANSION): nonadjacent if e is.
inline PartList product_of(std::span<const double> e, double k) {
  // One more than finite numbers need: the first remainder is zero unless a part is not finite.
  PartList product(2 * e.size() + 1);
  if (e.empty()) product.append_nonzero(0 * k);
  double q = 0;
  for (const double part : e) {
    const DoubleDouble t = two_prod(part, k);
    const DoubleDouble low = two_sum(q, t.lo);
    const DoubleDouble high = quick_two_sum(t.hi, low.hi);
    product.append_nonzero(low.lo);
    product.append_nonzero(high.lo);
    q = high.hi;
  }
  product.append_nonzero(q);
  return product;
}

/// The same number in few parts (COMPRESS): nonadjacent, for any nonoverlapping e.
inline PartList compressed(std::span<const double> e) {
  if (e.empty()) return {};
  // Downwards: collect what fits into one double; the remainders start the next.
  PartList descending(e.size());
  double q = e.back();
  for (std::size_t i = e.size() - 1; i-- > 0;) {
    const DoubleDouble s = quick_two_sum(q, e[i]);
    if (s.lo == 0) {
      q = s.hi;
    } else {
      descending.append_nonzero(s.hi);
      q = s.lo;
    }
  }
  // Upwards: round each part against what lies below it.
  PartList ascending(e.size());
  const std::span<const double> g = descending.view();
  for (std::size_t i = g.size(); i-- > 0;) {
    const DoubleDouble s = quick_two_sum(g[i], q);
    ascending.append_nonzero(s.lo);
    q = s.hi;
  }
  ascending.append_nonzero(q);
  return ascending;
}

/// The double nearest to the sum of nonoverlapping parts, the smallest first.
inline double rounded(std::span<const double> e) {
  if (e.empty()) return 0;
  double value = e.back(), rest = 0;
  std::size_t i = e.size() - 1;
  while (i > 0 && rest == 0) {
    const DoubleDouble s = quick_two_sum(value, e[--i]);
    value = s.hi;
    rest = s.lo;
  }
  // `value` is the rounding of the leading parts. Only a tie there can be broken otherwise by what is left.
  if (i == 0 || (rest < 0) != (e[i - 1] < 0)) return value;
  const double moved = value + 2 * rest;
  return moved - value == 2 * rest ? moved : value;
}

}  // namespace detail

/// An exact number.
class Expansion {
 public:
  static constexpr std::size_t kInlineParts = detail::PartList::kInlineParts;

  Expansion() = default;  ///< zero
  explicit Expansion(double x) { parts_.append_nonzero(x); }
  explicit Expansion(const DoubleDouble& x) {
    parts_.append_nonzero(x.lo);
    parts_.append_nonzero(x.hi);
    parts_ = detail::compressed(parts_.view());
  }

  /// Is a polynomial of this degree in such numbers exact? See "Needs" above.
  static bool in_range(double x, int degree = 2) {
    if (x == 0) return true;
    const double size = std::fabs(x);
    return size >= std::ldexp(1.0, 52 - 1074 / degree) && size <= std::ldexp(1.0, 1000 / degree);
  }

  /// False once a sum or a product has left the doubles: the last part then is an infinity or no number.
  [[nodiscard]] bool is_finite() const { return is_zero() || std::isfinite(parts_.view().back()); }
  /// -1, 0 or 1: the largest part outweighs the others together. Needs: is_finite().
  [[nodiscard]] int sign() const {
    if (is_zero()) return 0;
    return parts_.view().back() < 0 ? -1 : 1;
  }
  [[nodiscard]] bool is_zero() const { return parts_.size() == 0; }
  /// The nearest double, ties to even.
  [[nodiscard]] double value() const { return detail::rounded(parts_.view()); }
  explicit operator double() const { return value(); }
  /// The double-double within 2^-106 of it, relative to its magnitude.
  [[nodiscard]] DoubleDouble to_double_double() const {
    const double high = value();
    return {high, (*this - high).value()};
  }
  /// The parts, the smallest first.
  [[nodiscard]] std::span<const double> parts() const { return parts_.view(); }

  friend Expansion operator-(const Expansion& x) {
    Expansion negative;
    negative.parts_ = detail::PartList(x.parts_.size());
    for (const double part : x.parts()) negative.parts_.append_nonzero(-part);
    return negative;
  }
  friend Expansion operator+(const Expansion& x, const Expansion& y) { return added(x.parts(), y.parts()); }
  friend Expansion operator+(const Expansion& x, double y) { return x + Expansion(y); }
  friend Expansion operator+(double x, const Expansion& y) { return y + x; }
  friend Expansion operator-(const Expansion& x, const Expansion& y) { return x + -y; }
  friend Expansion operator-(const Expansion& x, double y) { return x + -y; }
  friend Expansion operator-(double x, const Expansion& y) { return x + -y; }

  friend Expansion operator*(const Expansion& x, double y) {
    return Expansion(detail::compressed(detail::product_of(x.parts(), y).view()));
  }
  friend Expansion operator*(double x, const Expansion& y) { return y * x; }
  friend Expansion operator*(const Expansion& x, const Expansion& y) {
    const bool x_longer = x.parts_.size() > y.parts_.size();
    const Expansion& longer = x_longer ? x : y;
    // Zero has no parts to run over; times what is no number it is none either.
    if (x.is_zero() || y.is_zero()) return longer * 0.0;
    Expansion product;
    for (const double part : (x_longer ? y : x).parts()) product += longer * part;
    return product;
  }
  friend Expansion& operator+=(Expansion& x, const Expansion& y) { return x = x + y; }
  friend Expansion& operator-=(Expansion& x, const Expansion& y) { return x = x - y; }
  friend Expansion& operator*=(Expansion& x, const Expansion& y) { return x = x * y; }

  friend std::strong_ordering operator<=>(const Expansion& x, const Expansion& y) {
    return (x - y).sign() <=> 0;
  }
  friend bool operator==(const Expansion& x, const Expansion& y) { return (x - y).is_zero(); }
  friend Expansion abs(const Expansion& x) { return x.sign() < 0 ? -x : x; }

 private:
  explicit Expansion(detail::PartList parts) : parts_(std::move(parts)) {}
  static Expansion added(std::span<const double> e, std::span<const double> f) {
    return Expansion(detail::compressed(detail::sum_of(e, f).view()));
  }

  detail::PartList parts_;
};

/// sum a_i b_i exactly, for entries double or Expansion.
template <class T, std::size_t N>
Expansion exact_dot(const std::array<T, N>& a, const std::array<T, N>& b) {
  Expansion sum;
  for (std::size_t i = 0; i < N; ++i) sum += Expansion(a[i]) * b[i];
  return sum;
}

/// The determinant of a 2x2 or 3x3 matrix of doubles or Expansions, exactly; rows first.
template <class T>
Expansion exact_determinant(const std::array<std::array<T, 2>, 2>& m) {
  return Expansion(m[0][0]) * m[1][1] - Expansion(m[0][1]) * m[1][0];
}
template <class T>
Expansion exact_determinant(const std::array<std::array<T, 3>, 3>& m) {
  // Along the first row; the minors' signs alternate by the cyclic order of columns.
  Expansion sum;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const std::array<std::array<T, 2>, 2> minor{{{m[1][j], m[1][k]}, {m[2][j], m[2][k]}}};
    sum += exact_determinant(minor) * m[0][i];
  }
  return sum;
}

}  // namespace graze
