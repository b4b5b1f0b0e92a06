// A number that stands for double in a source that says double: it counts where CountingScope says.
//
// Solves:  a source without templates, compiled with `double` meaning CountingDouble, adds what it does to
//          the count of the scope that is open on its thread (experiments/counted_sources.hpp).
// Needs:   as counting_in_std.hpp, whose remark on overloads in std holds here too: for the counting
//          component alone.
// Returns: what double gives, bit for bit; it has its size and layout.
// Counted: as counting.hpp says; constant expressions are not, but operations on constants at run time are,
//          since no number knows whether it depends on the equation.
// Cost:    one increment an operation; no allocation.
#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <graze/solvers/math/counting.hpp>

namespace graze {

class CountingDouble {
 public:
  constexpr CountingDouble() = default;
  // As other numbers become doubles.
  template <class T>
  requires std::is_arithmetic_v<T>
  constexpr CountingDouble(T value) : value_(static_cast<double>(value)) {}
  template <class T>
  requires std::is_arithmetic_v<T>
  constexpr explicit operator T() const { return static_cast<T>(value_); }
  [[nodiscard]] constexpr double value() const { return value_; }

  friend constexpr CountingDouble operator-(CountingDouble x) { return -x.value_; }
  friend constexpr CountingDouble operator+(CountingDouble x, CountingDouble y) {
    note(&OperationCount::additions);
    return x.value_ + y.value_;
  }
  friend constexpr CountingDouble operator-(CountingDouble x, CountingDouble y) {
    note(&OperationCount::additions);
    return x.value_ - y.value_;
  }
  friend constexpr CountingDouble operator*(CountingDouble x, CountingDouble y) {
    note(&OperationCount::multiplications);
    return x.value_ * y.value_;
  }
  friend constexpr CountingDouble operator/(CountingDouble x, CountingDouble y) {
    note(&OperationCount::divisions);
    return x.value_ / y.value_;
  }
  friend constexpr CountingDouble& operator+=(CountingDouble& x, CountingDouble y) { return x = x + y; }
  friend constexpr CountingDouble& operator-=(CountingDouble& x, CountingDouble y) { return x = x - y; }
  friend constexpr CountingDouble& operator*=(CountingDouble& x, CountingDouble y) { return x = x * y; }
  friend constexpr CountingDouble& operator/=(CountingDouble& x, CountingDouble y) { return x = x / y; }

  friend constexpr auto operator<=>(CountingDouble x, CountingDouble y) {
    note(&OperationCount::comparisons);
    return x.value_ <=> y.value_;
  }
  friend constexpr bool operator==(CountingDouble x, CountingDouble y) {
    note(&OperationCount::comparisons);
    return x.value_ == y.value_;
  }

  static constexpr void note(std::uint64_t OperationCount::*field) {
    if (!std::is_constant_evaluated()) add_one(field);
  }

 private:
  static void add_one(std::uint64_t OperationCount::*field) {
    OperationCount* const count = CountingScope::current();
    if (count != nullptr) ++(count->*field);
  }

  double value_ = 0;
};
static_assert(sizeof(CountingDouble) == sizeof(double) && std::is_trivially_copyable_v<CountingDouble>);

}  // namespace graze

namespace std {  // NOLINT(cert-dcl58-cpp): see above

inline graze::CountingDouble fabs(graze::CountingDouble x) { return fabs(x.value()); }
inline graze::CountingDouble abs(graze::CountingDouble x) { return fabs(x.value()); }
inline graze::CountingDouble copysign(graze::CountingDouble x, graze::CountingDouble sign) {
  return copysign(x.value(), sign.value());
}
inline graze::CountingDouble nextafter(graze::CountingDouble x, graze::CountingDouble towards) {
  return nextafter(x.value(), towards.value());
}
inline int ilogb(graze::CountingDouble x) { return ilogb(x.value()); }
inline graze::CountingDouble frexp(graze::CountingDouble x, int* exponent) {
  return frexp(x.value(), exponent);
}
inline bool signbit(graze::CountingDouble x) { return signbit(x.value()); }

inline graze::CountingDouble ldexp(graze::CountingDouble x, int k) {
  graze::CountingDouble::note(&graze::OperationCount::multiplications);
  return ldexp(x.value(), k);
}
inline graze::CountingDouble sqrt(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::square_roots);
  return sqrt(x.value());
}
inline graze::CountingDouble fma(graze::CountingDouble x, graze::CountingDouble y, graze::CountingDouble z) {
  graze::CountingDouble::note(&graze::OperationCount::fused);
  return fma(x.value(), y.value(), z.value());
}
inline bool isfinite(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::comparisons);
  return isfinite(x.value());
}
inline bool isnan(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::comparisons);
  return isnan(x.value());
}
inline bool isinf(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::comparisons);
  return isinf(x.value());
}
inline graze::CountingDouble log2(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::functions);
  return log2(x.value());
}
inline graze::CountingDouble exp2(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::functions);
  return exp2(x.value());
}
inline graze::CountingDouble ceil(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::functions);
  return ceil(x.value());
}
inline graze::CountingDouble floor(graze::CountingDouble x) {
  graze::CountingDouble::note(&graze::OperationCount::functions);
  return floor(x.value());
}
inline graze::CountingDouble pow(graze::CountingDouble x, graze::CountingDouble y) {
  graze::CountingDouble::note(&graze::OperationCount::functions);
  return pow(x.value(), y.value());
}

// Of a number and a literal, which a template would take for two types.
constexpr graze::CountingDouble max(graze::CountingDouble x, graze::CountingDouble y) {
  return x < y ? y : x;
}
constexpr graze::CountingDouble min(graze::CountingDouble x, graze::CountingDouble y) {
  return y < x ? y : x;
}
constexpr graze::CountingDouble clamp(graze::CountingDouble x, graze::CountingDouble low,
                                      graze::CountingDouble high) {
  return x < low ? low : high < x ? high : x;
}

template <>
class numeric_limits<graze::CountingDouble> : public numeric_limits<double> {
 public:
  static constexpr graze::CountingDouble min() { return numeric_limits<double>::min(); }
  static constexpr graze::CountingDouble lowest() { return numeric_limits<double>::lowest(); }
  static constexpr graze::CountingDouble max() { return numeric_limits<double>::max(); }
  static constexpr graze::CountingDouble epsilon() { return numeric_limits<double>::epsilon(); }
  static constexpr graze::CountingDouble infinity() { return numeric_limits<double>::infinity(); }
  static constexpr graze::CountingDouble quiet_NaN() { return numeric_limits<double>::quiet_NaN(); }
  static constexpr graze::CountingDouble denorm_min() { return numeric_limits<double>::denorm_min(); }
};

}  // namespace std
