// A scalar that counts its operations: the cost of a formula apart from any machine.
//
// Solves:  run `template <class T> T f(T a, T b)` with T = Counted<double>, and read how many additions,
//          multiplications, divisions, square roots and comparisons the formula took on these inputs.
// Needs:   T = double, float, or any scalar with the operations used. Inputs carry a pointer to the counts,
//          which must outlive every number made from them; constants carry none, and an operation between
//          constants alone is not counted (a compiler would have done it). All counted inputs of one formula
//          share one OperationCount.
// Returns: the values that T gives, bit for bit.
// Counted: a subtraction is an addition; min and max cost the comparison they make; fma is one `fused`; ldexp
//          is a multiplication by a power of two, and a test for finiteness a comparison. sqrt of a complex
//          number and what is no arithmetic (log2, cos, ceil, ...) is one `functions` each, whatever is in
//          it. Negation, abs, copies, and what only reads or moves bits (copysign, ilogb, nextafter) are
//          free: they are no arithmetic, or fold into the next operation. A number that leaves through
//          `static_cast<double>` is a constant from then on.
// Cost:    one increment an operation; no allocation, no shared state, so one OperationCount a thread. Only
//          CountingScope, for numbers without room for a pointer, is a state of its thread.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace graze {

struct OperationCount {
  std::uint64_t additions = 0;  ///< and subtractions
  std::uint64_t multiplications = 0;
  std::uint64_t divisions = 0;
  std::uint64_t square_roots = 0;
  std::uint64_t comparisons = 0;
  std::uint64_t fused = 0;      ///< x y + z with one rounding
  std::uint64_t functions = 0;  ///< calls of elementary functions, and of sqrt for a complex number

  /// Floating-point operations: everything but comparisons, a fused one as two, a function as one.
  [[nodiscard]] constexpr std::uint64_t flops() const {
    return additions + multiplications + divisions + square_roots + 2 * fused + functions;
  }
  constexpr OperationCount& operator+=(const OperationCount& other) {
    additions += other.additions;
    multiplications += other.multiplications;
    divisions += other.divisions;
    square_roots += other.square_roots;
    comparisons += other.comparisons;
    fused += other.fused;
    functions += other.functions;
    return *this;
  }
  friend constexpr bool operator==(const OperationCount&, const OperationCount&) = default;
};

/// Operations of numbers that cannot say where they are counted, as they go through plain arrays
/// (lanes_counting.hpp, counting_double.hpp), are added to `count` on this thread while the scope lives; the
/// innermost one counts.
class CountingScope {
 public:
  explicit CountingScope(OperationCount& count) : outer_(current()) { current() = &count; }
  CountingScope(const CountingScope&) = delete;
  CountingScope& operator=(const CountingScope&) = delete;
  ~CountingScope() { current() = outer_; }

  /// Null: nothing is counted.
  static OperationCount*& current() {
    thread_local OperationCount* count = nullptr;
    return count;
  }

 private:
  OperationCount* outer_;
};

template <class T>
class Counted {
 public:
  using value_type = T;

  constexpr Counted() = default;
  // A constant loses nothing on its way in, so that formulas may write 2.0 * x.
  constexpr Counted(const T& constant) : value_(constant) {}
  /// A constant of another arithmetic type, rounded to T.
  template <class U>
  requires(std::is_arithmetic_v<U> && !std::is_same_v<U, T>) constexpr explicit Counted(U constant)
      : value_(static_cast<T>(constant)) {}
  /// An input: operations on it, and on what is made of it, are counted in *count.
  constexpr Counted(const T& value, OperationCount* count) : value_(value), count_(count) {}

  [[nodiscard]] constexpr const T& value() const { return value_; }
  [[nodiscard]] constexpr OperationCount* count() const { return count_; }
  template <class U>
  requires std::is_arithmetic_v<U>
  constexpr explicit operator U() const { return static_cast<U>(value_); }

  friend constexpr Counted operator-(const Counted& x) { return {-x.value_, x.count_}; }
  friend constexpr Counted operator+(const Counted& x, const Counted& y) {
    return {x.value_ + y.value_, note(&OperationCount::additions, x, y)};
  }
  friend constexpr Counted operator-(const Counted& x, const Counted& y) {
    return {x.value_ - y.value_, note(&OperationCount::additions, x, y)};
  }
  friend constexpr Counted operator*(const Counted& x, const Counted& y) {
    return {x.value_ * y.value_, note(&OperationCount::multiplications, x, y)};
  }
  friend constexpr Counted operator/(const Counted& x, const Counted& y) {
    return {x.value_ / y.value_, note(&OperationCount::divisions, x, y)};
  }
  friend constexpr Counted& operator+=(Counted& x, const Counted& y) { return x = x + y; }
  friend constexpr Counted& operator-=(Counted& x, const Counted& y) { return x = x - y; }
  friend constexpr Counted& operator*=(Counted& x, const Counted& y) { return x = x * y; }
  friend constexpr Counted& operator/=(Counted& x, const Counted& y) { return x = x / y; }

  friend constexpr auto operator<=>(const Counted& x, const Counted& y) {
    note(&OperationCount::comparisons, x, y);
    return x.value_ <=> y.value_;
  }
  friend constexpr bool operator==(const Counted& x, const Counted& y) {
    note(&OperationCount::comparisons, x, y);
    return x.value_ == y.value_;
  }

  friend Counted sqrt(const Counted& x) {
    using std::sqrt;
    return {sqrt(x.value_), note(&OperationCount::square_roots, x, x)};
  }
  friend Counted abs(const Counted& x) {
    using std::abs;
    return {abs(x.value_), x.count_};
  }
  friend Counted fma(const Counted& x, const Counted& y, const Counted& z) {
    using std::fma;
    return {fma(x.value_, y.value_, z.value_), note(&OperationCount::fused, x, y, z)};
  }

  friend Counted fabs(const Counted& x) { return abs(x); }
  friend Counted ldexp(const Counted& x, int k) {
    using std::ldexp;
    return {ldexp(x.value_, k), note(&OperationCount::multiplications, x)};
  }
  friend bool isfinite(const Counted& x) {
    note(&OperationCount::comparisons, x);
    using std::isfinite;
    return isfinite(x.value_);
  }
  friend bool isnan(const Counted& x) {
    note(&OperationCount::comparisons, x);
    using std::isnan;
    return isnan(x.value_);
  }
  friend int ilogb(const Counted& x) {
    using std::ilogb;
    return ilogb(x.value_);
  }
  friend Counted copysign(const Counted& x, const Counted& sign) {
    using std::copysign;
    return {copysign(x.value_, sign.value_), x.count_};
  }
  friend Counted nextafter(const Counted& x, const Counted& towards) {
    using std::nextafter;
    return {nextafter(x.value_, towards.value_), x.count_};
  }
  friend Counted ceil(const Counted& x) {
    using std::ceil;
    return {ceil(x.value_), note(&OperationCount::functions, x)};
  }
  friend long lround(const Counted& x) {
    note(&OperationCount::functions, x);
    using std::lround;
    return lround(x.value_);
  }
  friend Counted log2(const Counted& x) {
    using std::log2;
    return {log2(x.value_), note(&OperationCount::functions, x)};
  }
  friend Counted exp2(const Counted& x) {
    using std::exp2;
    return {exp2(x.value_), note(&OperationCount::functions, x)};
  }
  friend Counted sin(const Counted& x) {
    using std::sin;
    return {sin(x.value_), note(&OperationCount::functions, x)};
  }
  friend Counted cos(const Counted& x) {
    using std::cos;
    return {cos(x.value_), note(&OperationCount::functions, x)};
  }
  friend Counted cbrt(const Counted& x) {
    using std::cbrt;
    return {cbrt(x.value_), note(&OperationCount::functions, x)};
  }
  friend Counted pow(const Counted& x, const Counted& y) {
    using std::pow;
    return {pow(x.value_, y.value_), note(&OperationCount::functions, x, y)};
  }

  /// Counts a call of a function of these numbers that this type does not wrap itself; the result's counts.
  template <class... Operands>
  static OperationCount* note_function(const Operands&... operands) {
    return note(&OperationCount::functions, operands...);
  }

 private:
  using Field = std::uint64_t OperationCount::*;

  /// Counts one operation where an operand says so; that operand's counts are the result's.
  template <class... Operands>
  static constexpr OperationCount* note(Field field, const Operands&... operands) {
    OperationCount* count = nullptr;
    ((count = count == nullptr ? operands.count_ : count), ...);
    if (count != nullptr) ++(count->*field);
    return count;
  }

  T value_{};
  OperationCount* count_ = nullptr;
};

}  // namespace graze

/// The limits of T, as constants.
template <class T>
class std::numeric_limits<graze::Counted<T>> : public std::numeric_limits<T> {
 public:
  static constexpr graze::Counted<T> min() { return std::numeric_limits<T>::min(); }
  static constexpr graze::Counted<T> lowest() { return std::numeric_limits<T>::lowest(); }
  static constexpr graze::Counted<T> max() { return std::numeric_limits<T>::max(); }
  static constexpr graze::Counted<T> epsilon() { return std::numeric_limits<T>::epsilon(); }
  static constexpr graze::Counted<T> infinity() { return std::numeric_limits<T>::infinity(); }
  static constexpr graze::Counted<T> quiet_NaN() { return std::numeric_limits<T>::quiet_NaN(); }
  static constexpr graze::Counted<T> denorm_min() { return std::numeric_limits<T>::denorm_min(); }
};
