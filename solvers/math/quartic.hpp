// Quartic equations as a product of two quadratics.
//
// solves    c0 + c1 x + ... + c4 x^4 = 0, c4 != 0, all four complex roots
// needs     finite coefficients, c0 and c4 alike (power_basis::scale_coefficients): any magnitudes whose
//           squares, divided by c4^2, stay in range
// returns   the roots, real ones with an imaginary part of exactly zero; false if a number left the range
// error     measured (tests/solvers/math/quartic_test.cpp): the roots are those of a quartic whose every
//           coefficient differs by at most kQuarticBackward u of the sum of its terms' moduli
// cost      counted, on average over random coefficients in (-1, 1): 453 operations, of them a cube root,
//           6 square roots and 52 divisions; a real root of a cubic (cubic.hpp), then 1 or 2 Newton steps on
//           the four coefficients of the factors (at most kQuarticSteps); no allocation
// source    Orellana, De Michele, "Algorithm 1010: Boosting efficiency in solving quartic equations with no
//           compromise in accuracy", ACM TOMS 46(2), 2020; equation numbers below are the paper's.
//           Changed: the cubic is scaled by a power of two and solved by Kahan's iteration; errors are
//           relative to the terms that cancel, not to the coefficient, which may be far smaller; conjugate
//           factors are turned into real ones and refined as well; Newton's equations are solved by
//           elimination, with residuals by fused multiply-adds; factors not near enough are refused
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <graze/solvers/math/cubic.hpp>
#include <graze/solvers/math/quadratic.hpp>

namespace graze {

/// Backward error of the four roots in u, see above (asserted in tests/solvers/math/quartic_test.cpp).
inline constexpr double kQuarticBackward = 16;
/// Newton steps on the factors: the paper finds 2 sufficient on average; the best factors seen are kept.
inline constexpr int kQuarticSteps = 8;

namespace detail::quartic {

/// x^4 + a x^3 + b x^2 + c x + d.
template <class T>
struct MonicQuartic {
  T a{}, b{}, c{}, d{};
};

/// (x^2 + alpha1 x + beta1)(x^2 + alpha2 x + beta2).
template <class T>
struct RealFactors {
  T alpha1{}, beta1{}, alpha2{}, beta2{};
};

/// x^2 + alpha x + beta times its conjugate.
template <class T>
struct ConjugateFactor {
  ComplexRoot<T> alpha, beta;
};

/// |is - wanted| relative to the moduli of the `terms` that `is` is made of (eqs. 29, 30, 48-51, 68, 69,
/// where it is relative to |wanted|: noise, where that is far smaller than its terms).
template <class T>
T relative_error(T is, T wanted, T terms) {
  using std::abs;
  if (is == wanted) return T(0);
  return abs(is - wanted) / terms;
}

template <class T>
T error_of_abc(const MonicQuartic<T>& q, const RealFactors<T>& f) {
  using std::abs;
  const T bc = f.beta1 * f.alpha2, ad = f.alpha1 * f.beta2, aa = f.alpha1 * f.alpha2;
  return relative_error(f.alpha1 + f.alpha2, q.a, abs(f.alpha1) + abs(f.alpha2)) +
         relative_error(f.beta1 + aa + f.beta2, q.b, abs(f.beta1) + abs(aa) + abs(f.beta2)) +
         relative_error(bc + ad, q.c, abs(bc) + abs(ad));
}

template <class T>
T error_of(const MonicQuartic<T>& q, const RealFactors<T>& f) {
  using std::abs;
  const T bd = f.beta1 * f.beta2;
  return error_of_abc(q, f) + relative_error(bd, q.d, abs(bd));
}

template <class T>
T error_of(const MonicQuartic<T>& q, const ConjugateFactor<T>& f) {
  using std::abs;
  const auto square = [](const ComplexRoot<T>& z) { return z.re * z.re + z.im * z.im; };
  const T re = f.alpha.re * f.beta.re, im = f.alpha.im * f.beta.im;
  const T aa = square(f.alpha), bb = square(f.beta);
  return relative_error(T(2) * f.alpha.re, q.a, abs(T(2) * f.alpha.re)) +
         relative_error(T(2) * f.beta.re + aa, q.b, abs(T(2) * f.beta.re) + aa) +
         relative_error(T(2) * (re + im), q.c, T(2) * (abs(re) + abs(im))) + relative_error(bb, q.d, bb);
}

/// The dominant root of the resolvent cubic of the quartic shifted by s (eq. 79), by eqs. 83-87. Adds
/// evaluations to `steps`.
template <class T>
T dominant_resolvent_root(const MonicQuartic<T>& q, int& steps) {
  using std::sqrt;
  const auto& [a, b, c, d] = q;
  // s is a zero of the shifted quartic's b, or of its a: it keeps g and h from cancelling (eq. 87).
  const T discriminant = T(9) * a * a - T(24) * b;
  T s = -a / T(4);
  if (discriminant > T(0)) {
    const T root = sqrt(discriminant);
    s = -T(2) * b / (a > T(0) ? T(3) * a + root : T(3) * a - root);
  }
  const T as = a + T(4) * s;
  const T bs = b + T(3) * s * (a + T(2) * s);
  const T cs = c + s * (T(2) * b + s * (T(3) * a + T(4) * s));
  const T ds = d + s * (c + s * (b + s * (a + s)));
  const T bb = bs * bs / T(9), ac = as * cs;
  const T g = ac - T(4) * ds - T(3) * bb;
  const T h = (T(8) * ds + ac - T(2) * bb) * bs / T(3) - cs * cs - ds * as * as;
  return extreme_cubic_root<T>({h, g, T(0), T(1)}, steps);
}

/// d2 and l2 of the decomposition L D L^T (eq. 28 and what follows it).
template <class T>
struct D2L2 {
  T d2{}, l2{};
};

/// The candidate that reproduces b, c and d best (eqs. 29, 30).
template <class T>
D2L2<T> best_d2_l2(const MonicQuartic<T>& q, T l1, T l3, T d2, T delta2) {
  using std::abs;
  std::array<D2L2<T>, 3> candidates;
  std::size_t count = 0;
  if (d2 != T(0)) candidates[count++] = {d2, delta2 / (T(2) * d2)};
  if (delta2 != T(0)) {
    const T l2 = T(2) * (q.d - l3 * l3) / delta2;
    if (l2 != T(0)) candidates[count++] = {delta2 / (T(2) * l2), l2};
    candidates[count++] = {d2, l2};
  }
  D2L2<T> best;
  T least{};
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [d, l] = candidates[i];
    const T ll = l1 * l1, dl = T(2) * d * l, l13 = T(2) * l1 * l3, dll = d * l * l, l33 = l3 * l3;
    const T error = relative_error(d + ll + T(2) * l3, q.b, abs(d) + ll + abs(T(2) * l3)) +
                    relative_error(dl + l13, q.c, abs(dl) + abs(l13)) +
                    relative_error(dll + l33, q.d, abs(dll) + l33);
    if (i > 0 && !(error < least)) continue;
    best = candidates[i];
    least = error;
  }
  return best;
}

/// The smaller one of a product's two factors from the larger one.
template <class T>
void divide_smaller(T product, T& x, T& y) {
  using std::abs;
  if (abs(y) < abs(x)) {
    y = product / x;
  } else if (abs(x) < abs(y)) {
    x = product / y;
  }
}

/// alpha1, of a smaller modulus than alpha2, from whichever of a, b, c gives it best (eqs. 47-51).
template <class T>
T best_alpha1(const MonicQuartic<T>& q, RealFactors<T> f) {
  std::array<T, 3> candidates{q.a - f.alpha2};
  std::size_t count = 1;
  if (f.alpha2 != T(0)) candidates[count++] = (q.b - f.beta2 - f.beta1) / f.alpha2;
  if (f.beta2 != T(0)) candidates[count++] = (q.c - f.beta1 * f.alpha2) / f.beta2;
  T best{}, least{};
  for (std::size_t i = 0; i < count; ++i) {
    f.alpha1 = candidates[i];
    const T error = error_of_abc(q, f);
    if (i > 0 && !(error < least)) continue;
    best = candidates[i];
    least = error;
  }
  return best;
}

/// d2 < 0: two real factors (eqs. 37-40), the small numbers from the large ones.
template <class T>
RealFactors<T> real_factors(const MonicQuartic<T>& q, T l1, T l3, const D2L2<T>& ld) {
  using std::abs, std::sqrt, std::swap;
  const T gamma = sqrt(-ld.d2);
  RealFactors<T> f{l1 + gamma, l3 + gamma * ld.l2, l1 - gamma, l3 - gamma * ld.l2};
  divide_smaller(q.d, f.beta1, f.beta2);
  if (abs(f.alpha2) < abs(f.alpha1)) {
    swap(f.alpha1, f.alpha2);
    swap(f.beta1, f.beta2);
  }
  if (abs(f.alpha1) < abs(f.alpha2)) f.alpha1 = best_alpha1(q, f);
  return f;
}

/// One Newton step on the four coefficients (sec. 2.3): f1 df2 + f2 df1 = q - f1 f2 for df1 and df2 linear.
/// Needs |alpha1| <= |alpha2|: corrections of small numbers are never differences of large ones.
template <class T>
RealFactors<T> refined_once(const MonicQuartic<T>& q, const RealFactors<T>& f) {
  using std::abs, std::fma;
  const T r3 = q.a - f.alpha2 - f.alpha1;
  const T r2 = fma(-f.alpha1, f.alpha2, q.b - f.beta1 - f.beta2);
  const T r1 = fma(-f.beta1, f.alpha2, fma(-f.alpha1, f.beta2, q.c));
  const T r0 = fma(-f.beta1, f.beta2, q.d);
  // The second factor's corrections by the first one's, from the equations of x^3 and x^2; then the other
  // two.
  const T e = f.alpha2 - f.alpha1, k = f.beta2 - f.beta1, m = k - f.alpha1 * e;
  const T rest = r2 - f.alpha1 * r3;
  const T s1 = r1 - f.beta1 * r3 - f.alpha1 * rest, s0 = r0 - f.beta1 * rest;
  const T resultant = m * k + f.beta1 * e * e;
  const T alpha = (k * s1 - e * s0) / resultant;
  const T beta = (m * s0 + f.beta1 * e * s1) / resultant;
  const T beta2 = abs(f.beta1) < abs(f.beta2) ? rest - beta - e * alpha : (r0 - f.beta2 * beta) / f.beta1;
  return {f.alpha1 + alpha, f.beta1 + beta, f.alpha2 + (r3 - alpha), f.beta2 + beta2};
}

/// Newton steps while the error falls; the best factors. False: they are not near enough.
template <class T>
bool refine(const MonicQuartic<T>& q, RealFactors<T>& f, int& steps) {
  using std::abs;
  if (abs(f.alpha2) < abs(f.alpha1)) f = {f.alpha2, f.beta2, f.alpha1, f.beta1};
  T error = error_of(q, f);
  for (int i = 0; i < kQuarticSteps && error != T(0); ++i) {
    const RealFactors<T> next = refined_once(q, f);
    ++steps;
    const T there = error_of(q, next);
    if (!(there < error)) break;
    f = next;
    error = there;
  }
  constexpr auto kEps = std::numeric_limits<typename BuiltIn<T>::type>::epsilon();
  return error <= T(static_cast<typename BuiltIn<T>::type>(kQuarticBackward / 2) * kEps);
}

template <class T>
ComplexRoot<T> product(const ComplexRoot<T>& x, const ComplexRoot<T>& y) {
  return {difference_of_products(x.re, y.re, x.im, y.im), difference_of_products(x.re, y.im, -x.im, y.re)};
}

template <class T>
ComplexRoot<T> quotient(const ComplexRoot<T>& x, const ComplexRoot<T>& y) {
  const ComplexRoot<T> z = product(x, {y.re, -y.im});
  const T size = y.re * y.re + y.im * y.im;
  return {z.re / size, z.im / size};
}

/// The root with a real part >= 0.
template <class T>
ComplexRoot<T> square_root(const ComplexRoot<T>& z) {
  using std::abs, std::sqrt;
  const T larger = abs(z.re) < abs(z.im) ? abs(z.im) : abs(z.re);
  if (larger == T(0)) return {};
  const T x = z.re / larger, y = z.im / larger;
  const T half = sqrt(larger) * sqrt((sqrt(x * x + y * y) + abs(x)) / T(2));
  const T other = abs(z.im) / (T(2) * half);
  const T re = z.re < T(0) ? other : half, im = z.re < T(0) ? half : other;
  return {re, z.im < T(0) ? -im : im};
}

/// The real factors of a complex one times its conjugate: x and y are its roots, each with its conjugate
/// makes one. No cancellation in the roots, as for real ones.
template <class T>
RealFactors<T> real_factors(const ConjugateFactor<T>& f) {
  const ComplexRoot<T> half{f.alpha.re / T(2), f.alpha.im / T(2)};
  const ComplexRoot<T> square = product(half, half);
  const ComplexRoot<T> root = square_root<T>({square.re - f.beta.re, square.im - f.beta.im});
  const bool is_along = half.re * root.re + half.im * root.im > T(0);
  const ComplexRoot<T> x = is_along ? ComplexRoot<T>{-half.re - root.re, -half.im - root.im}
                                    : ComplexRoot<T>{root.re - half.re, root.im - half.im};
  const bool is_zero = x.re == T(0) && x.im == T(0);
  const ComplexRoot<T> y = is_zero ? ComplexRoot<T>{} : quotient(f.beta, x);
  return {-T(2) * x.re, x.re * x.re + x.im * x.im, -T(2) * y.re, y.re * y.re + y.im * y.im};
}

/// d2 = 0: alpha is l1 in both factors and d3 = d - l3^2 parts their betas (eqs. 41-46).
template <class T>
RealFactors<T> factors_of_one_alpha(const MonicQuartic<T>& q, T l1, T l3, T d3) {
  using std::sqrt;
  const T gamma = sqrt(-d3);
  RealFactors<T> f{l1, l3 + gamma, l1, l3 - gamma};
  divide_smaller(q.d, f.beta1, f.beta2);
  return f;
}

/// Two factors, real or conjugate to each other, and how badly they reproduce the coefficients.
template <class T>
struct Factors {
  bool is_real = false;
  RealFactors<T> real;
  ConjugateFactor<T> conjugate;
  T error{};
};

template <class T>
Factors<T> rated(const MonicQuartic<T>& q, const RealFactors<T>& f) {
  return {true, f, {}, error_of(q, f)};
}

template <class T>
Factors<T> rated(const MonicQuartic<T>& q, const ConjugateFactor<T>& f) {
  return {false, {}, f, error_of(q, f)};
}

/// The factors that the decomposition gives for the root phi0 of the resolvent.
template <class T>
Factors<T> decompose(const MonicQuartic<T>& q, T phi0) {
  using std::abs, std::sqrt;
  // Eqs. 16, 18, 20, and delta2 as defined after eq. 27.
  const T l1 = q.a / T(2), l3 = q.b / T(6) + phi0 / T(2), two_thirds = T(2) * q.b / T(3);
  const D2L2<T> ld = best_d2_l2(q, l1, l3, two_thirds - phi0 - l1 * l1, q.c - q.a * l3);
  const T gamma = sqrt(abs(ld.d2));
  Factors<T> found = ld.d2 < T(0) ? rated(q, real_factors(q, l1, l3, ld))
                                  : rated(q, ConjugateFactor<T>{{l1, gamma}, {l3, gamma * ld.l2}});
  // A d2 that may be zero but for the rounding of its three terms: whichever case has the smaller error.
  constexpr auto kEps = std::numeric_limits<typename BuiltIn<T>::type>::epsilon();
  if (abs(ld.d2) <= T(kEps) * (abs(two_thirds) + abs(phi0) + l1 * l1)) {
    const T d3 = q.d - l3 * l3;
    const Factors<T> other = d3 > T(0) ? rated(q, ConjugateFactor<T>{{l1, T(0)}, {l3, sqrt(d3)}})
                                       : rated(q, factors_of_one_alpha(q, l1, l3, d3));
    if (other.error < found.error) found = other;
  }
  return found;
}

/// The dominant root of the resolvent, x scaled by a power of two where its terms, of degree 6, might leave
/// the range.
template <class T>
T scaled_resolvent_root(MonicQuartic<T> q, int& steps) {
  using std::abs;
  using Limits = std::numeric_limits<typename BuiltIn<T>::type>;
  constexpr auto kFourthRoot =
      static_cast<typename BuiltIn<T>::type>(std::uint64_t{1} << (Limits::max_exponent / 32));
  const T root(kFourthRoot), limit = root * root * root * root, step = T(1) / limit;
  const T limit2 = limit * limit, limit3 = limit2 * limit;
  T scale(1);
  while (scale > T(0)) {
    if (abs(q.a) <= limit && abs(q.b) <= limit2 && abs(q.c) <= limit3 && abs(q.d) <= limit3 * limit) break;
    scale = scale * step;
    q = {q.a * step, q.b * step * step, q.c * step * step * step, q.d * step * step * step * step};
  }
  return dominant_resolvent_root(q, steps) / scale / scale;
}

}  // namespace detail::quartic

/// All four roots. `steps` counts evaluations of the resolvent and of the factors' error. False: see above.
template <class T>
bool quartic_roots(const std::array<T, 5>& c, std::array<ComplexRoot<T>, 4>& roots, int& steps) {
  const detail::quartic::MonicQuartic<T> q{c[3] / c[4], c[2] / c[4], c[1] / c[4], c[0] / c[4]};
  const T phi0 = detail::quartic::scaled_resolvent_root(q, steps);
  if (!detail::cubic::in_range(phi0)) return false;
  const detail::quartic::Factors<T> factors = detail::quartic::decompose(q, phi0);
  detail::quartic::RealFactors<T> f =
      factors.is_real ? factors.real : detail::quartic::real_factors(factors.conjugate);
  if (!detail::quartic::refine(q, f, steps)) return false;
  const auto first = monic_quadratic_roots(f.alpha1, f.beta1),
             second = monic_quadratic_roots(f.alpha2, f.beta2);
  roots = {first[0], first[1], second[0], second[1]};
  for (const ComplexRoot<T>& root : roots) {
    if (!detail::cubic::in_range(root.re) || !detail::cubic::in_range(root.im)) return false;
  }
  return true;
}

}  // namespace graze
