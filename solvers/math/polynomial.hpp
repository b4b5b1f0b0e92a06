// Polynomials in the power basis: values with proven error bounds, inclusions, root bounds.
//
// Solves:  p(x) = sum_i c[i] x^i and p'(x).
// Needs:   coefficients ascending, any number of them (none: the zero polynomial); rounding to nearest.
//          c_error is empty (exact coefficients) or has c's length and bounds |c[i] - true c[i]|.
// Returns: a value with |value - p(x)| <= error, proved: the rounding of the bound itself and underflow are
//          in it. error is inf where something overflows or is not a number.
// Cost:    one pass, no allocation.
// Source:  Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., SIAM 2002, algorithm 5.1
//          (running error bound); changed: written with the rounded products instead of 2 mu - |y|, so that
//          only non-negative terms are added and the bound's own rounding is a factor.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <limits>
#include <span>
#include <type_traits>

namespace graze {

/// A value and a bound on its absolute error.
struct Evaluation {
  double value = 0;
  double error = 0;
};

/// p(x) and p'(x), each with a bound on its absolute error.
struct DerivativeEvaluation {
  double value = 0;
  double derivative = 0;
  double error = 0;
  double derivative_error = 0;
};

/// [value - error, value + error], rounded outward.
inline Interval enclosure(const Evaluation& e) { return ball(e.value, e.error); }

namespace detail {

/// u, half the spacing of doubles at 1.
inline constexpr double kUnitRoundoff = 0x1p-53;
/// What underflow may add in one step, in units of u: the product of a step and those of the two bounds lose
/// at most 2^-1075 each; 2^-1020 u = 2^-1073 covers them.
inline constexpr double kUnderflowPerStep = 0x1p-1020;

/// 1 + 8 (steps + 1) u: at least (1 + u)^(6 steps + 6), the rounding of a bound that grows by non-negative
/// terms with at most six roundings a step, for steps below 2^40. It is a multiple of 2u, so exact.
inline double bound_slack(std::size_t steps) {
  return 1 + 8 * static_cast<double>(steps + 1) * kUnitRoundoff;
}

/// A bound kept in units of u, made absolute and rounded up.
inline double absolute_bound(double units, std::size_t steps) {
  return mul_up(bound_slack(steps) * kUnitRoundoff, units);
}

inline double error_at(std::span<const double> c_error, std::size_t i) {
  return c_error.empty() ? 0 : c_error[i];
}
inline Interval coefficient(std::span<const double> c, std::span<const double> c_error, std::size_t i) {
  return c_error.empty() ? point(c[i]) : ball(c[i], c_error[i]);
}

template <class T>
T constant(double value) {
  if constexpr (std::same_as<T, Interval>)
    return point(value);
  else
    return T(value);
}

}  // namespace detail

/// Index of the last non-zero coefficient; -1 for the zero polynomial.
inline int effective_degree(std::span<const double> c) {
  std::size_t size = c.size();
  while (size > 0 && c[size - 1] == 0) --size;
  return static_cast<int>(size) - 1;
}

/// p(x) by Horner's rule in the arithmetic of T (double, DoubleDouble, Interval, a counting type, ...).
template <class T>
T horner(std::span<const double> c, const T& x) {
  if (c.empty()) return detail::constant<T>(0);
  T y = detail::constant<T>(c.back());
  for (std::size_t i = c.size() - 1; i-- > 0;) y = y * x + c[i];
  return y;
}
/// The same with coefficients of type T.
template <class T>
requires(!std::same_as<T, double>) T horner(std::type_identity_t<std::span<const T>> c, const T& x) {
  if (c.empty()) return detail::constant<T>(0);
  T y = c.back();
  for (std::size_t i = c.size() - 1; i-- > 0;) y = y * x + c[i];
  return y;
}

/// p(x) with a running error bound; about 8 flops a coefficient. For all x.
inline Evaluation evaluate(std::span<const double> c, double x) {
  if (c.empty()) return {};
  const double size = std::fabs(x);
  double y = c.back(), mu = 0;
  // fl(z) differs from z by at most u |fl(z)|, or 2^-1075 in the subnormal range.
  for (std::size_t i = c.size() - 1; i-- > 0;) {
    const double product = x * y;
    y = product + c[i];
    mu = size * mu + (std::fabs(product) + (std::fabs(y) + detail::kUnderflowPerStep));
  }
  return {y, detail::absolute_bound(mu, c.size())};
}

/// p(x) for coefficients known to within c_error.
inline Evaluation evaluate(std::span<const double> c, std::span<const double> c_error, double x) {
  if (c.empty()) return {};
  const Evaluation rounded = evaluate(c, x);
  if (c_error.empty()) return rounded;
  const double size = std::fabs(x);
  double data = 0;
  for (std::size_t i = c.size(); i-- > 0;) data = size * data + c_error[i];
  return {rounded.value, add_up(rounded.error, mul_up(detail::bound_slack(c.size()), data))};
}

/// p(x) and p'(x), each with a running error bound.
inline DerivativeEvaluation evaluate_with_derivative(std::span<const double> c,
                                                     std::span<const double> c_error, double x) {
  if (c.empty()) return {};
  const double size = std::fabs(x);
  const std::size_t n = c.size() - 1;
  double y = c[n], d = 0;
  double mu = 0, nu = 0;                                     // rounding of y and of d, in units of u
  double y_data = detail::error_at(c_error, n), d_data = 0;  // what the coefficients' errors do to y and d
  for (std::size_t i = n; i-- > 0;) {
    const double d_product = x * d;
    d = d_product + y;
    nu = size * nu + mu + (std::fabs(d_product) + (std::fabs(d) + detail::kUnderflowPerStep));
    d_data = size * d_data + y_data;
    const double product = x * y;
    y = product + c[i];
    mu = size * mu + (std::fabs(product) + (std::fabs(y) + detail::kUnderflowPerStep));
    y_data = size * y_data + detail::error_at(c_error, i);
  }
  const double slack = detail::bound_slack(c.size());
  return {y, d, add_up(detail::absolute_bound(mu, c.size()), mul_up(slack, y_data)),
          add_up(detail::absolute_bound(nu, c.size()), mul_up(slack, d_data))};
}
inline DerivativeEvaluation evaluate_with_derivative(std::span<const double> c, double x) {
  return evaluate_with_derivative(c, {}, x);
}

/// p(x) as if computed with 106 bits and rounded; about 25 flops a coefficient. The bound is
/// u |value| + O(u^2) sum |c[i]| |x|^i, with the last addition's rounding measured instead of bounded.
/// Source: Graillat, Langlois, Louvet, "Algorithms for accurate, validated and fast polynomial evaluation",
/// Japan J. Indust. Appl. Math. 26, 2009, algorithm CompHorner; the bound here is a running one.
inline Evaluation evaluate_compensated(std::span<const double> c, double x) {
  if (c.empty()) return {};
  const double size = std::fabs(x);
  double y = c.back(), r = 0, mu = 0;
  // p(x) = y + sum of the steps' own errors times x^i exactly; r is that sum, mu bounds its rounding.
  for (std::size_t i = c.size() - 1; i-- > 0;) {
    const DoubleDouble product = two_prod(x, y);
    const DoubleDouble sum = two_sum(product.hi, c[i]);
    const double step = product.lo + sum.lo;
    const double r_product = r * x;
    r = r_product + step;
    mu = size * mu + (std::fabs(step) + std::fabs(r_product) + (std::fabs(r) + detail::kUnderflowPerStep));
    y = sum.hi;
  }
  const DoubleDouble result = two_sum(y, r);
  const double last = std::isnan(result.lo) ? detail::kInfinity : std::fabs(result.lo);
  return {result.hi, add_up(detail::absolute_bound(mu, c.size()), last)};
}

/// Contains { p(v) : v in x } for every polynomial within c_error of c; Horner's rule.
inline Interval evaluate(std::span<const double> c, std::span<const double> c_error, Interval x) {
  if (c.empty()) return {};
  Interval y = detail::coefficient(c, c_error, c.size() - 1);
  for (std::size_t i = c.size() - 1; i-- > 0;) y = y * x + detail::coefficient(c, c_error, i);
  return y;
}

/// Contains { p'(v) : v in x } for every polynomial within c_error of c.
inline Interval evaluate_derivative(std::span<const double> c, std::span<const double> c_error, Interval x) {
  if (c.size() < 2) return {};
  Interval y{};
  for (std::size_t i = c.size(); i-- > 1;)
    y = y * x + static_cast<double>(i) * detail::coefficient(c, c_error, i);
  return y;
}

/// Coefficients of p', each rounded once: out[i] = (i + 1) c[i + 1]. out has room for c.size() - 1 numbers
/// (none for an empty c) and may be c itself.
inline void derivative(std::span<const double> c, std::span<double> out) {
  for (std::size_t i = 1; i < c.size(); ++i) out[i - 1] = static_cast<double>(i) * c[i];
}

/// The same with bounds on the errors of the result: out_error[i] >= |out[i] - (i + 1) true c[i + 1]|.
inline void derivative(std::span<const double> c, std::span<const double> c_error, std::span<double> out,
                       std::span<double> out_error) {
  for (std::size_t i = 1; i < c.size(); ++i) {
    const double k = static_cast<double>(i);
    const double product = k * c[i];
    out_error[i - 1] =
        add_up(mul_up(k, detail::error_at(c_error, i)), std::fabs(std::fma(k, c[i], -product)));
    out[i - 1] = product;
  }
}

namespace detail {

/// An upper bound, within 2^-45, on (2^power |a / b|)^(1/k) for finite a, b != 0.
inline double root_of_ratio(double a, double b, int power, int k) {
  // Exponents are split off, so that only the root itself can overflow: 2^power |a/b| = ratio 2^(k shift).
  const int exponent = exponent_of(a) - exponent_of(b) + power;
  const int shift = exponent >= 0 ? exponent / k : -((k - 1 - exponent) / k);
  const double a_part = scale_by_power(std::fabs(a), -exponent_of(a));
  const double b_part = scale_by_power(std::fabs(b), -exponent_of(b));
  const double ratio = scale_by_power(div_up(a_part, b_part), exponent - k * shift);
  // The library's pow promises nothing: its result is raised a little and checked.
  double root = std::pow(ratio, 1.0 / k) * (1 + 0x1p-46);
  while (pow_int(point(root), static_cast<unsigned>(k)).lo < ratio) root *= 2;
  const double scaled_root = scale_by_power(root, shift);
  return std::fabs(scaled_root) >= std::numeric_limits<double>::min() ? scaled_root : next_above(scaled_root);
}

}  // namespace detail

/// A number that no root, real or complex, exceeds in magnitude: Fujiwara's 2 max |c[n-k]/c[n]|^(1/k), the
/// last ratio halved; at most 2n times the largest root's magnitude. Scaling p or x by a power of two scales
/// it exactly. inf when it overflows or a coefficient is not finite; 0 for constants, also the zero
/// polynomial. Source: Fujiwara, "Ueber die obere Schranke des absoluten Betrages der Wurzeln einer
/// algebraischen Gleichung", Tohoku Math. J. 10, 1916. Cost: a pow for each non-zero coefficient.
inline double root_bound(std::span<const double> c) {
  const int n = effective_degree(c);
  double bound = 0;
  for (int k = 0; k <= n; ++k) {
    const double a = c[static_cast<std::size_t>(n - k)];
    if (!std::isfinite(a)) return detail::kInfinity;
    if (k == 0 || a == 0) continue;
    const double lead = c[static_cast<std::size_t>(n)];
    bound = std::max(bound, detail::root_of_ratio(a, lead, k == n ? -1 : 0, k));
  }
  return 2 * bound;
}

}  // namespace graze
