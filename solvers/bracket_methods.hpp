// Methods that shrink a bracket, a pair of points between which f changes sign, by values of f alone.
//
// solves    f(x) = 0 on [a, b], f(a) f(b) < 0
// needs     f continuous for the answer to be a root; without that it is a point where f changes sign
// returns   the last bracket, whose ends are a == b where f vanished exactly
// error     the bracket is as narrow as `narrow(a, b)` asks for, or `budget` evaluations were spent
// cost      itp: at most one evaluation more than bisection; chandrupatla: rarely more than bisection
// source    itp: Oliveira, Takahashi, "An enhancement of the bisection method average performance
//           preserving minmax optimality", ACM TOMS 47 (2020), section 2.2; chandrupatla: Chandrupatla,
//           "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function
//           without using derivatives", Adv. Eng. Software 28 (1997)
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace graze::bracket {

/// [a, b] with the values at its ends; after an exact zero a == b and both values are 0.
template <class T>
struct Bracket {
  T a, b, fa, fb;

  /// The end where |f| is smaller.
  [[nodiscard]] T best() const { return std::fabs(fa) < std::fabs(fb) ? a : b; }
};

/// Replaces the end on whose side x lies.
template <class T>
void shrink(Bracket<T>& bracket, T x, T fx) {
  if (fx == 0) {
    bracket = {x, x, fx, fx};
  } else if ((fx < 0) == (bracket.fa < 0)) {
    bracket.a = x;
    bracket.fa = fx;
  } else {
    bracket.b = x;
    bracket.fb = fx;
  }
}

template <class T>
T middle(const Bracket<T>& bracket) {
  return bracket.a + (bracket.b - bracket.a) / 2;
}

/// The paper's parameters: kappa_1 = 0.2 / (b - a) is its recommendation for the unit interval made
/// scale-free; kappa_2 = 2 and n_0 = 1 are its choices.
template <class T>
struct ItpParameters {
  T kappa_1;
  T kappa_2 = 2;
  int n_0 = 1;
};

/// Interpolate, truncate, project. Ends when b - a <= 2 epsilon, or as soon as `narrow(a, b)`.
template <class T, class F, class Narrow>
Bracket<T> itp(const F& f, Bracket<T> bracket, T epsilon, ItpParameters<T> parameters, const Narrow& narrow,
               int budget) {
  auto& [a, b, fa, fb] = bracket;
  const int n_half = static_cast<int>(std::ceil(std::log2((b - a) / (2 * epsilon))));
  const int n_max = n_half + parameters.n_0;
  // The steps aim a little below epsilon: what the rounding of x adds does not cost one more.
  const T rounding = 2 * std::numeric_limits<T>::epsilon() * std::max(std::fabs(a), std::fabs(b));
  const T target = std::max(epsilon - rounding, epsilon / 2);
  for (int j = 0; j < budget && b - a > 2 * epsilon && !narrow(a, b); ++j) {
    const T x_half = middle(bracket);
    // Interpolate: the regula falsi point. Truncate: towards the middle by delta.
    const T x_f = a - fa / (fb - fa) * (b - a);
    const T delta = parameters.kappa_1 * std::pow(b - a, parameters.kappa_2);
    const T x_t = delta <= std::fabs(x_half - x_f) ? x_f + std::copysign(delta, x_half - x_f) : x_half;
    // Project: as close to the middle as the minmax bound of bisection plus n_0 evaluations asks.
    const T r = std::max(std::ldexp(target, n_max - j) - (b - a) / 2, T{0});
    const T x_itp = std::fabs(x_t - x_half) <= r ? x_t : x_half - std::copysign(r, x_half - x_t);
    const T x = a < x_itp && x_itp < b ? x_itp : x_half;
    if (!(a < x && x < b)) break;  // neighbouring numbers
    shrink(bracket, x, f(x));
  }
  return bracket;
}

namespace detail {

/// Where the inverse quadratic through the three points, newest first, vanishes, as a fraction of the way
/// from x_1 to x_2; 1/2 where Chandrupatla's criterion says that it is not monotone.
template <class T>
T chandrupatla_fraction(T x_1, T f_1, T x_2, T f_2, T x_3, T f_3) {
  const T xi = (x_1 - x_2) / (x_3 - x_2);
  const T phi = (f_1 - f_2) / (f_3 - f_2);
  if (!(phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi)) return T{1} / 2;
  return f_1 / (f_2 - f_1) * (f_3 / (f_2 - f_3)) +
         (x_3 - x_1) / (x_2 - x_1) * (f_1 / (f_3 - f_1)) * (f_2 / (f_3 - f_2));
}

}  // namespace detail

/// Inverse quadratic interpolation where it can be trusted, else bisection. `resolution(x)` is the width
/// of a bracket at x that ends the iteration.
template <class T, class F, class Resolution>
Bracket<T> chandrupatla(const F& f, const Bracket<T>& start, const Resolution& resolution, int budget) {
  // x_1 is the newest point, x_2 the other end of the bracket, x_3 the point dropped last.
  T x_1 = start.b, f_1 = start.fb, x_2 = start.a, f_2 = start.fa, x_3 = x_1, f_3 = f_1;
  T fraction = T{1} / 2;
  for (int i = 0; i < budget; ++i) {
    const T step = fraction * (x_2 - x_1);
    const T x = x_1 + step;
    const T fx = f(x);
    if ((fx < 0) == (f_1 < 0)) {
      x_3 = x_1, f_3 = f_1;
    } else {
      x_3 = x_2, f_3 = f_2;
      x_2 = x_1, f_2 = f_1;
    }
    x_1 = x, f_1 = fx;
    const T best = std::fabs(f_2) < std::fabs(f_1) ? x_2 : x_1;
    const T least = resolution(best) / std::fabs(x_2 - x_1) / 2;
    if (f_1 == 0) return {x_1, x_1, f_1, f_1};
    if (!(least <= T{1} / 2)) break;
    fraction = detail::chandrupatla_fraction(x_1, f_1, x_2, f_2, x_3, f_3);
    // A step no shorter than the resolution, so that both ends move in.
    fraction = fraction >= least ? std::min(fraction, 1 - least) : least;
  }
  return x_1 < x_2 ? Bracket<T>{x_1, x_2, f_1, f_2} : Bracket<T>{x_2, x_1, f_2, f_1};
}

}  // namespace graze::bracket
