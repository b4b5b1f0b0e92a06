// Forward-mode differentiation: a number with its first and second derivative by one variable.
//
// Solves:  f(t), f'(t), f''(t) of a formula that is generic over its number type, by running it on
//          Dual<T>::variable(t); constants enter as Dual<T>(c) or as plain doubles.
// Needs:   T with + - * /; sqrt, sin, cos, exp, log where the formula uses them (found by the name of T's
//          namespace; std's for float and double). For T = Interval the results are inclusions. double,
//          float, Interval and DoubleDouble are tested.
// Returns: value, d and dd by the rules of calculus, in T's arithmetic; where T divides by zero (sqrt at 0)
//          it is T's answer.
// Error:   that of the formulas below in T: a few roundings an operation.
// Cost:    a product 6 multiplications and 4 additions, a function one call of it and 5 operations.
// Source:  Griewank, Walther, "Evaluating Derivatives", 2nd ed., SIAM 2008, 13.2 (Taylor coefficients of
//          degree 2); here the derivatives themselves are carried.
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>

namespace graze {

template <class T>
struct Dual {
  T value{};
  T d{};   ///< first derivative
  T dd{};  ///< second derivative

  constexpr Dual() = default;
  /// A constant.
  constexpr explicit Dual(const T& constant) : value(constant) {}
  constexpr Dual(const T& v, const T& first, const T& second) : value(v), d(first), dd(second) {}
  /// The variable itself, or a linear function of it with this slope.
  static constexpr Dual variable(const T& at, const T& slope = T(1)) { return {at, slope, T(0)}; }

  friend constexpr Dual operator-(const Dual& a) { return {-a.value, -a.d, -a.dd}; }
  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.d + b.d, a.dd + b.dd};
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.d - b.d, a.dd - b.dd};
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    const T cross = a.d * b.d;
    return {a.value * b.value, a.value * b.d + a.d * b.value,
            a.value * b.dd + a.dd * b.value + (cross + cross)};
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    // q b = a, differentiated twice.
    const T q = a.value / b.value;
    const T first = (a.d - q * b.d) / b.value;
    const T cross = first * b.d;
    return {q, first, (a.dd - (cross + cross) - q * b.dd) / b.value};
  }

  friend constexpr Dual& operator+=(Dual& a, const Dual& b) { return a = a + b; }
  friend constexpr Dual& operator-=(Dual& a, const Dual& b) { return a = a - b; }
  friend constexpr Dual& operator*=(Dual& a, const Dual& b) { return a = a * b; }
  friend constexpr Dual& operator/=(Dual& a, const Dual& b) { return a = a / b; }
};

namespace detail {

template <class T>
struct IsDual : std::false_type {};
template <class T>
struct IsDual<Dual<T>> : std::true_type {};

/// A constant of a formula: any number that is not the variable's own type.
template <class C>
concept PlainNumber = std::is_arithmetic_v<C>;

/// outer(a) from outer's value and two derivatives at a.value.
template <class T>
constexpr Dual<T> chain(const Dual<T>& a, const T& f, const T& f1, const T& f2) {
  return {f, f1 * a.d, f2 * (a.d * a.d) + f1 * a.dd};
}

}  // namespace detail

// Constants are plain numbers in formulas: 2.0 * x, x - 1. They are converted to T first, exactly where T
// holds a double.
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator+(const Dual<T>& a, C b) {
  return {a.value + T(b), a.d, a.dd};
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator+(C a, const Dual<T>& b) {
  return b + a;
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator-(const Dual<T>& a, C b) {
  return {a.value - T(b), a.d, a.dd};
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator-(C a, const Dual<T>& b) {
  return {T(a) - b.value, -b.d, -b.dd};
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator*(const Dual<T>& a, C b) {
  return {a.value * T(b), a.d * T(b), a.dd * T(b)};
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator*(C a, const Dual<T>& b) {
  return b * a;
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator/(const Dual<T>& a, C b) {
  return {a.value / T(b), a.d / T(b), a.dd / T(b)};
}
template <class T, detail::PlainNumber C>
constexpr Dual<T> operator/(C a, const Dual<T>& b) {
  return Dual<T>(T(a)) / b;
}

/// a^2 with T's own square, where it has a tighter one.
template <class T>
constexpr Dual<T> sqr(const Dual<T>& a) {
  const T twice = a.value + a.value;
  const T slope = a.d * a.d;
  const T value = [&] {
    if constexpr (requires {
                    { sqr(a.value) } -> std::same_as<T>;
                  }) {
      return sqr(a.value);
    } else {
      return a.value * a.value;
    }
  }();
  return {value, twice * a.d, (slope + slope) + twice * a.dd};
}

template <class T>
Dual<T> sqrt(const Dual<T>& a) {
  using std::sqrt;
  const T root = sqrt(a.value);
  const T slope = T(0.5) / root;
  return detail::chain(a, root, slope, T(-0.5) * slope / a.value);
}
template <class T>
Dual<T> sin(const Dual<T>& a) {
  using std::cos;
  using std::sin;
  const T s = sin(a.value);
  return detail::chain(a, s, T(cos(a.value)), T(-s));
}
template <class T>
Dual<T> cos(const Dual<T>& a) {
  using std::cos;
  using std::sin;
  const T c = cos(a.value);
  return detail::chain(a, c, T(-sin(a.value)), T(-c));
}
template <class T>
Dual<T> exp(const Dual<T>& a) {
  using std::exp;
  const T e = exp(a.value);
  return detail::chain(a, e, e, e);
}
template <class T>
Dual<T> log(const Dual<T>& a) {
  using std::log;
  const T slope = T(1) / a.value;
  return detail::chain(a, T(log(a.value)), slope, T(-(slope * slope)));
}

/// x^n for n >= 0 by repeated squaring, for any number type without a power of its own (Interval has one).
template <class T>
requires(std::is_floating_point_v<T> || detail::IsDual<T>::value) constexpr T pow_int(T x, unsigned n) {
  T power(1);
  for (; n > 0; n >>= 1U) {
    if (n & 1U) power = power * x;
    if (n > 1) x = x * x;
  }
  return power;
}

}  // namespace graze
