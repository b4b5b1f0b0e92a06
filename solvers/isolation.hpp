// What methods share that isolate the real roots of a polynomial in the power basis: a bounded interval,
// a range of magnitudes in which nothing over- or underflows, and the roots at the interval's ends.
//
// solves    nothing by itself: `solve` hands a Problem with a bounded interval to a method
// needs     as power_basis.hpp
// returns   failed where the interval is unbounded and no bound of the roots is a number of type T
// error     of scaling: none (powers of two); of the interval: a root bound
// cost      no allocation up to degree power_basis::kInline; scaling is skipped where it is not needed
// source    power_basis.hpp; root bound: math/polynomial.hpp
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include <graze/solvers/math/bracket.hpp>
#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/solvers/power_basis.hpp>

namespace graze::isolation {

using power_basis::Coefficients;
using power_basis::Problem;

/// The rounding error of p(x) by Horner's rule is at most 2 n u sum |c_i x^i| (Higham 2002, section 5.1).
template <class T>
T horner_noise(Coefficients<T> c, T x) {
  return static_cast<T>(2 * (c.size() - 1)) * power_basis::kU<T> * power_basis::magnitude_sum(c, x);
}

/// A closed end at which p is zero within what a relative change of the coefficients can do (tolerance) while
/// the root by Newton's step lies beyond it: the end is the root. A root inside shows itself to the method.
template <class T>
void add_end_roots(const Problem<T>& problem, Roots& roots) {
  const auto add = [&](T end, int outward) {
    const auto p = power_basis::evaluate(problem.c, end);
    ++roots.counters.evaluations;
    const T tolerance = problem.tolerance(end);
    const bool beyond = outward * (p.value < 0 ? 1 : -1) * (p.derivative < 0 ? -1 : 1) > 0;
    if (std::fabs(p.value) > tolerance || (p.value != 0 && (p.derivative == 0 || !beyond))) return;
    const T radius = p.derivative == 0 ? 0 : tolerance / std::fabs(p.derivative);
    roots.list.push_back(found_root(end, radius, p.derivative == 0 ? 2U : 1U));
  };
  add(problem.lo, -1);
  if (problem.hi > problem.lo) add(problem.hi, 1);
}

/// Where a piece is split: the middle, a little beside it, then nearer and nearer to the ends. All exact.
template <class T>
inline constexpr std::array<T, 11> kSplits{T(0.5),   T(0.4375), T(0.578125), T(0.25),    T(0.75),   T(0.125),
                                           T(0.875), T(0.0625), T(0.9375),   T(0.03125), T(0.96875)};

/// p, p' and p'' / 2.
template <class T>
struct Curve {
  T value = 0, derivative = 0, half_curvature = 0;
};
template <class T>
Curve<T> evaluate_curve(Coefficients<T> c, T x) {
  Curve<T> p;
  for (std::size_t i = c.size(); i-- > 0;) {
    p.half_curvature = p.half_curvature * x + p.derivative;
    p.derivative = p.derivative * x + p.value;
    p.value = p.value * x + c[i];
  }
  return p;
}

/// Bernstein coefficients of p on [a, b], formed from the power basis: Horner's rule, in which multiplying by
/// x = a (1 - t) + b t raises the degree by one. `out` is as long as c; n^2 / 2 steps of 5 operations.
/// Returns a bound of every coefficient's error: at most 6 roundings a step of terms that sum |c_i| m^i
/// dominates, m = max(|a|, |b|), and the coefficients' own errors.
template <class T>
T bernstein_on(const Problem<T>& problem, T a, T b, std::span<T> out) {
  const std::size_t n = problem.c.size() - 1;
  out[0] = problem.c[n];
  for (std::size_t k = 1; k <= n; ++k) {
    const T c = problem.c[n - k];
    const T weight = 1 / static_cast<T>(k);
    out[k] = b * out[k - 1] + c;
    for (std::size_t j = k - 1; j > 0; --j) {
      const T t = static_cast<T>(j) * weight;
      out[j] = (1 - t) * (a * out[j]) + t * (b * out[j - 1]) + c;
    }
    out[0] = a * out[0] + c;
  }
  const T reach = std::max(std::fabs(a), std::fabs(b));
  return static_cast<T>(6 * n) * power_basis::kU<T> * power_basis::magnitude_sum(problem.c, reach) +
         power_basis::magnitude_sum(problem.c_error, reach);
}

/// The root between two points of opposite sign, refined to rounding.
template <class T>
void add_bracketed(const Problem<T>& problem, T a, T b, bool negative_at_a, Roots& roots) {
  const auto p = [&](T x) { return power_basis::evaluate(problem.c, x); };
  const auto noise = [&](T x) { return horner_noise(problem.c, x); };
  const auto root = newton_in_bracket(p, noise, a, b, negative_at_a, BracketStop<T>{});
  roots.counters.evaluations += root.steps;
  roots.counters.iterations += root.steps;
  if (!root.converged) roots.status = Status::failed;
  add_real(problem, root.x, std::min(problem.tolerance(root.x) / std::fabs(root.derivative), b - a), 1U,
           roots);
}

/// How far beyond a piece, on which p cannot be told from zero, its sign must be clear again: where the
/// linear or the quadratic term exceeds the tolerance; at most a piece's width more where both vanish.
template <class T>
T cluster_margin(const Problem<T>& problem, T a, T b) {
  const T x = a + (b - a) / 2;
  const auto p = evaluate_curve(problem.c, x);
  const T tolerance = problem.tolerance(x);
  const T least = 4 * power_basis::kU<T> * std::max(std::fabs(a), std::fabs(b));
  const T linear = tolerance / std::fabs(p.derivative);
  const T quadratic = std::sqrt(tolerance / std::fabs(p.half_curvature));
  const T clear = 2 * std::min(linear, quadratic);
  return std::isfinite(clear) ? std::max(least, clear) : std::max(least, b - a);
}

/// Files what a piece [a, b] on which p cannot be told from zero stands for: a simple root if the signs on
/// both sides of it differ; if they do not, by p at its extremum: a touching one, two or none.
template <class T>
void add_cluster(const Problem<T>& problem, T a, T b, Roots& roots) {
  const T margin = cluster_margin(problem, a, b);
  const T left = power_basis::evaluate(problem.c, a - margin).value;
  const T right = power_basis::evaluate(problem.c, b + margin).value;
  T x = a + (b - a) / 2;
  roots.counters.evaluations += 4;
  if ((left < 0) != (right < 0)) {
    x = std::clamp(power_basis::polished(problem, x, roots.counters), a - margin, b + margin);
    const T slope = std::fabs(power_basis::evaluate(problem.c, x).derivative);
    return add_real(problem, x, std::min(problem.tolerance(x) / slope, 3 * margin), 1U, roots);
  }
  // Two Newton steps for p' = 0: the piece is a noise region's, much wider than its extremum is uncertain.
  constexpr int kSteps = 2;
  for (int step = 0; step < kSteps; ++step) {
    const auto p = evaluate_curve(problem.c, x);
    ++roots.counters.evaluations;
    const T next = x - p.derivative / (2 * p.half_curvature);
    if (next > a - margin && next < b + margin) x = next;
  }
  const auto p = evaluate_curve(problem.c, x);
  const T tolerance = problem.tolerance(x);
  if (std::fabs(p.value) > tolerance) {
    if ((p.value < 0) == (left < 0)) return;
    add_bracketed(problem, a - margin, x, left < 0, roots);
    return add_bracketed(problem, x, b + margin, p.value < 0, roots);
  }
  add_real(problem, x, std::min(std::sqrt(tolerance / std::fabs(p.half_curvature)), 3 * margin), 2U, roots);
}

/// Collects pieces in ascending order, joins those that all but touch, and files each group as one cluster.
template <class T>
class Clusters {
 public:
  Clusters(const Problem<T>& problem, Roots& roots) : problem_(problem), roots_(roots) {}

  void add(T a, T b) {
    // Pieces of one cluster may be parted by what a clip has cut off within rounding.
    if (open_ &&
        a - b_ <= (b - a) + (b_ - a_) + 8 * power_basis::kU<T> * std::max(std::fabs(a_), std::fabs(b))) {
      b_ = b;
      return;
    }
    close();
    open_ = true;
    a_ = a;
    b_ = b;
  }
  void close() {
    if (open_) add_cluster(problem_, a_, b_, roots_);
    open_ = false;
  }

 private:
  const Problem<T>& problem_;
  Roots& roots_;
  bool open_ = false;
  T a_ = 0, b_ = 0;
};

namespace detail {

/// Of the exponents of T an eighth: x^n may use 3 of them, a coefficient 2, so that Horner sums, derivatives
/// and products of two coefficients stay clear of over- and underflow.
template <class T>
inline constexpr int kEighth = std::numeric_limits<T>::max_exponent / 8;

template <class T>
bool has_tame_coefficients(Coefficients<T> c) {
  T largest = 0, least = std::numeric_limits<T>::max();
  for (const T value : c) {
    const T size = std::fabs(value);
    largest = std::max(largest, size);
    least = size == 0 ? least : std::min(least, size);
  }
  constexpr auto kHigh = static_cast<T>(power_of_two(2 * kEighth<T>));
  return largest <= kHigh && least >= 1 / kHigh;
}

/// Ends are clipped to the root bound where they are infinite or their powers could overflow.
template <class T>
bool bound_interval(Problem<T>& problem) {
  const T reach = std::max(std::fabs(problem.lo), std::fabs(problem.hi));
  if (reach <= static_cast<T>(power_of_two(3 * kEighth<T> / problem.degree()))) return true;
  power_basis::Scratch<double> wide(problem.c.size());
  std::transform(problem.c.begin(), problem.c.end(), wide.span().begin(),
                 [](T c) { return static_cast<double>(c); });
  // One part in 2^20 pays for the rounding to float.
  const T bound = static_cast<T>(root_bound(wide.span()) * (1 + 0x1p-20));
  problem.lo = std::max(problem.lo, -bound);
  problem.hi = std::min(problem.hi, bound);
  return std::isfinite(problem.lo) && std::isfinite(problem.hi);
}

template <class T, class Method>
void solve_bounded(Problem<T> problem, Roots& roots, const Method& method) {
  if (!bound_interval(problem)) {
    roots.status = Status::failed;
  } else if (problem.lo <= problem.hi) {
    method(static_cast<const Problem<T>&>(problem), roots);
  }
}

/// The same problem in y = x / 2^shift with coefficients about 1, and its roots brought back.
template <class T, class Method>
void solve_scaled(const Problem<T>& problem, Roots& roots, const Method& method) {
  power_basis::Scratch<T> c(problem.c.size()), c_error(problem.c_error.size());
  const auto by = power_basis::scale_coefficients(problem.c, c.span());
  for (std::size_t i = 0; i < problem.c_error.size(); ++i)
    c_error.span()[i] = std::ldexp(problem.c_error[i], static_cast<int>(i) * by.shift - by.power);
  const std::size_t before = roots.list.size();
  solve_bounded(Problem<T>{c.span(), c_error.span(), std::ldexp(problem.lo, -by.shift),
                           std::ldexp(problem.hi, -by.shift)},
                roots, method);
  for (std::size_t i = before; i < roots.list.size(); ++i) {
    Root& root = roots.list[i];
    const T x = std::ldexp(static_cast<T>(root.x), by.shift);
    root.x = static_cast<double>(std::clamp(x, problem.lo, problem.hi));
    root.radius = std::ldexp(root.radius, by.shift);
  }
}

}  // namespace detail

/// As power_basis::solve; what `method(const Problem<T>&, Roots&)` gets has finite ends lo <= hi.
template <class T, class Method>
void solve(const BasicPolynomialEquation<T>& equation, Roots& roots, const Method& method) {
  power_basis::solve(equation, roots, [&](const Problem<T>& problem, Roots& found) {
    if (detail::has_tame_coefficients(problem.c)) {
      detail::solve_bounded(problem, found, method);
    } else {
      detail::solve_scaled(problem, found, method);
    }
  });
}

}  // namespace graze::isolation
