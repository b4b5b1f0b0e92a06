// Cubic equations: one root by a monotone Newton iteration, the other two by a stable division.
//
// solves    c0 + c1 x + c2 x^2 + c3 x^3 = 0, c3 != 0, all three complex roots
// needs     finite coefficients whose products of four stay in range (power_basis::scale_coefficients)
// returns   the real root that lies farthest from the mean of all three, then the other two; false if a
//           number left the range or the iteration its budget
// error     measured (tests/solvers/math/cubic_test.cpp): the three roots are those of a cubic whose every
//           coefficient differs by at most kCubicBackward u of the sum of its terms' moduli
// cost      counted, on average over random coefficients in (-1, 1): 121 operations, of them a cube root,
//           2 square roots and 16 divisions, in 6 Newton steps (at most kCubicSteps); no allocation
// source    Kahan, "To solve a real cubic equation" (1986), procedures EVAL and QBC. Changed: a budget of
//           steps; the quadratic factor is divided by c3 first
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <graze/solvers/math/quadratic.hpp>

namespace graze {

/// Backward error of the three roots in u, see above (asserted in tests/solvers/math/cubic_test.cpp).
inline constexpr double kCubicBackward = 24;
/// From Kahan's start value every step at least divides the distance by 3/2 until it converges
/// quadratically: 11 were the most seen.
inline constexpr int kCubicSteps = 64;

namespace detail::cubic {

/// p = (x - X) (c3 x^2 + b1 x + c0) + value, and p'(X).
template <class T>
struct CubicAt {
  T b1{}, c0{}, slope{}, value{};
};

template <class T>
CubicAt<T> divide_cubic(const std::array<T, 4>& c, T x) {
  const T q = c[3] * x;
  CubicAt<T> at;
  at.b1 = q + c[2];
  at.c0 = at.b1 * x + c[1];
  at.slope = (q + at.b1) * x + at.c0;
  at.value = at.c0 * x + c[0];
  return at;
}

template <class T>
bool in_range(T x) {
  return x - x == T(0);
}

}  // namespace detail::cubic

/// The real root farthest from the inflection point: of three real ones never one of a close pair. `steps`
/// counts evaluations; more than kCubicSteps: no convergence.
template <class T>
T extreme_cubic_root(const std::array<T, 4>& c, int& steps) {
  using std::abs, std::cbrt, std::sqrt;
  const T inflection = -(c[2] / c[3]) / T(3);
  const auto middle = detail::cubic::divide_cubic(c, inflection);
  ++steps;
  // p / c3 = y^3 - down y + rise about the inflection point; the root lies against the sign of `rise`, and
  // not beyond the bound, whose constant is the root of x^3 = x + 1 rounded up (Kahan).
  const T rise = middle.value / c[3], down = -(middle.slope / c[3]);
  T reach = cbrt(abs(rise));
  if (down > T(0)) reach = T(1.324718) * (reach < sqrt(down) ? sqrt(down) : reach);
  const bool is_below = rise > T(0);
  T x = inflection, next = is_below ? inflection - reach : inflection + reach;
  if (next == inflection) return x;
  // Newton's steps, shortened by their own rounding, come back from there without passing the root, until
  // rounding turns one round.
  constexpr auto kEps = std::numeric_limits<typename BuiltIn<T>::type>::epsilon();
  const T shortened = T(1) - T(4 * kEps);
  do {
    x = next;
    const auto at = detail::cubic::divide_cubic(c, x);
    if (++steps > kCubicSteps || at.slope == T(0)) break;
    next = x - shortened * (at.value / at.slope);
  } while (is_below ? next > x : next < x);
  return x;
}

/// All three roots of the cubic. False: see above.
template <class T>
bool cubic_roots(const std::array<T, 4>& c, std::array<ComplexRoot<T>, 3>& roots, int& steps) {
  using std::abs;
  const T x = extreme_cubic_root(c, steps);
  if (!detail::cubic::in_range(x) || steps > kCubicSteps) return false;
  auto at = detail::cubic::divide_cubic(c, x);
  // Division from the other end where the root is large: its rounding is then that of c0 and c1, not of c3.
  if (x != T(0) && abs(c[3]) * x * x > abs(c[0] / x)) {
    at.c0 = -(c[0] / x);
    at.b1 = (at.c0 - c[1]) / x;
  }
  const T b = at.b1 / c[3], c0 = at.c0 / c[3];
  if (!detail::cubic::in_range(b * b) || !detail::cubic::in_range(c0)) return false;
  const auto others = monic_quadratic_roots(b, c0);
  roots = {ComplexRoot<T>{x, T(0)}, others[0], others[1]};
  return true;
}

}  // namespace graze
