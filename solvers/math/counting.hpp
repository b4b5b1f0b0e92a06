// A scalar that counts its operations: the cost of a formula apart from any machine.
//
// Solves:  run `template <class T> T f(T a, T b)` with T = Counted<double>, and read how many additions,
//          multiplications, divisions, square roots and comparisons the formula took on these inputs.
// Needs:   T = double, float, or any scalar with the operations used. Inputs carry a pointer to the counts,
//          which must outlive every number made from them; constants carry none, and an operation between
//          constants alone is not counted (a compiler would have done it). All counted inputs of one formula
//          share one OperationCount.
// Returns: the values that T gives, bit for bit.
// Counted: a subtraction is an addition; min and max cost the comparison they make; fma is one `fused`.
//          Negation, abs and copies are free: they move or change a sign bit, or fold into the next
//          operation.
// Cost:    one increment an operation; no allocation, no shared state, so one OperationCount a thread.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <type_traits>

namespace graze {

struct OperationCount {
  std::uint64_t additions = 0;  ///< and subtractions
  std::uint64_t multiplications = 0;
  std::uint64_t divisions = 0;
  std::uint64_t square_roots = 0;
  std::uint64_t comparisons = 0;
  std::uint64_t fused = 0;  ///< x y + z with one rounding

  /// Floating-point operations: everything but comparisons, a fused one as two.
  [[nodiscard]] constexpr std::uint64_t flops() const {
    return additions + multiplications + divisions + square_roots + 2 * fused;
  }
  constexpr OperationCount& operator+=(const OperationCount& other) {
    additions += other.additions;
    multiplications += other.multiplications;
    divisions += other.divisions;
    square_roots += other.square_roots;
    comparisons += other.comparisons;
    fused += other.fused;
    return *this;
  }
  friend constexpr bool operator==(const OperationCount&, const OperationCount&) = default;
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
