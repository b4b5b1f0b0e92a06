// Quadratic equations without cancellation.
//
// solves    a x^2 + 2 b x + c = 0 (note the 2), or x^2 + b x + c = 0 with complex roots
// needs     finite coefficients, a != 0; `quadratic` alone: no product of two of them under- or overflows
// returns   real roots ascending with their count (0, 1: double, 2); or both complex roots
// error     real roots at most 4u relatively (solvers/closed_form.md); of a pair, real part exact and
//           imaginary part 2u; so long as nothing underflows
// cost      1 square root, 2 divisions, 2 fused multiply-adds; no allocation
// source    Kahan, "On the cost of floating-point computation without extra-precise arithmetic" (2004);
//           Jeannerod, Louvet, Muller, Math. Comp. 82 (2013), theorem 1.2
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace graze {

/// re + i im, over any scalar (std::complex is defined for built-in ones only).
template <class T>
struct ComplexRoot {
  T re{}, im{};
};

/// The built-in type whose precision T has: T itself, or T::value_type of a scalar that wraps one.
template <class T>
struct BuiltIn {
  using type = T;
};
template <class T>
requires requires { typename T::value_type; }
struct BuiltIn<T> {
  using type = typename T::value_type;
};

/// a b - c d with a relative error of at most 2u (Kahan), if nothing under- or overflows.
template <class T>
T difference_of_products(T a, T b, T c, T d) {
  using std::fma;
  const T cd = c * d;
  const T error = fma(-c, d, cd);
  return fma(a, b, -cd) + error;
}

/// Roots of a x^2 + 2 b x + c, a != 0, ascending; the count is returned: 0, 1 (double root) or 2.
template <class T>
int quadratic(T a, T b, T c, std::array<T, 2>& x) {
  using std::sqrt;
  const T discriminant = difference_of_products(b, b, a, c);
  if (discriminant < T(0)) return 0;
  if (discriminant == T(0)) {
    x[0] = -b / a;
    return 1;
  }
  // The larger root by addition of equal signs, the smaller one from the product of both.
  const T root = sqrt(discriminant);
  const T q = b < T(0) ? root - b : -(b + root);
  x = {q / a, c / q};
  if (x[1] < x[0]) std::swap(x[0], x[1]);
  return 2;
}

/// The exponent of x: |x| = 2^k m, 1 <= m < 2; a very small one for zero.
template <class T>
int exponent_or_least(T x) {
  return x == 0 ? -4 * std::numeric_limits<T>::max_exponent : std::ilogb(x);
}

/// `quadratic` with powers of two taken out first, so that no product leaves the range: x = 2^m y with |a|
/// and |c| alike, then the largest coefficient near 1. Exact, short of parts 2^-1000 below the largest.
template <class T>
int scaled_quadratic(T a, T b, T c, std::array<T, 2>& x) {
  if (b == 0 && c == 0) return 1;  // x = 0, twice
  const auto exponent = [](T v) { return exponent_or_least(v); };
  const int m = c == 0 ? exponent(b) - exponent(a) : (exponent(c) - exponent(a)) / 2;
  const int largest = std::max({exponent(a) + 2 * m, exponent(b) + m, exponent(c)});
  const auto scaled = [](T v, int k) { return v == 0 ? v : std::ldexp(v, k); };
  const int count = quadratic(scaled(a, 2 * m - largest), scaled(b, m - largest), scaled(c, -largest), x);
  for (T& root : x) root = std::ldexp(root, m);
  return count;
}

/// Both roots of x^2 + b x + c: real ones, or a pair, its member above the axis first.
template <class T>
std::array<ComplexRoot<T>, 2> monic_quadratic_roots(T b, T c) {
  using std::sqrt;
  const T half = b / T(2);
  std::array<T, 2> x{};
  const int count = quadratic(T(1), half, c, x);
  if (count == 1) return {ComplexRoot<T>{x[0], T(0)}, ComplexRoot<T>{x[0], T(0)}};
  if (count == 2) return {ComplexRoot<T>{x[0], T(0)}, ComplexRoot<T>{x[1], T(0)}};
  const T im = sqrt(-difference_of_products(half, half, T(1), c));
  return {ComplexRoot<T>{-half, im}, ComplexRoot<T>{-half, -im}};
}

}  // namespace graze
