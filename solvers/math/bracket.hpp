// One root between two points at which a function has opposite signs: Newton's method that cannot leave.
//
// Solves:  f(x) = 0 on [a, b], f continuous, f(a) and f(b) of opposite sign (neither zero).
// Needs:   f(x) gives {value, derivative}; noise(x) bounds the rounding error of the value: asked for
//          only where a Newton step did not help.
// Returns: a point of [a, b] that is a root within its stop rule, or within the rounding of f; the last
//          derivative seen; converged = false past the budget (kBracketBudget), which halving excludes.
// Error:   the stop rule's; by default the rounding of f over its slope: the end is where Newton steps,
//          which shrink quadratically, would no longer change x.
// Cost:    one call of f a step; a step at least halves the last one or halves the bracket.
// Source:  safeguarding after Dekker 1969 and Brent, "Algorithms for Minimization without Derivatives",
//          Prentice-Hall 1973, chapter 4 (a step that does not halve the last one is replaced by
//          bisection); in place of the secant the tangent. Scaling f or x by a power of two scales every
//          step exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace graze {

/// A root is good enough when the last step was at most relative |x| + absolute, or when the next one would
/// be, by quadratic convergence, at most predicted |x|. Defaults: rounding.
template <class T>
struct BracketStop {
  T relative = std::numeric_limits<T>::epsilon() / 2;
  T predicted = std::numeric_limits<T>::epsilon() / 8;
  T absolute = 0;
};

template <class T>
struct BracketRoot {
  T x = 0;
  T derivative = 0;  ///< at the last point evaluated
  std::uint32_t steps = 0;
  bool converged = true;
};

/// More halvings than a bracket can have (its exponents' range and its digits), twice: every other step may
/// be Newton's.
template <class T>
inline constexpr std::uint32_t kBracketBudget = static_cast<std::uint32_t>(
    2 * (std::numeric_limits<T>::max_exponent - std::numeric_limits<T>::min_exponent +
         2 * std::numeric_limits<T>::digits));

/// `negative_at_a` is the sign of f(a).
template <class T, class Function, class Noise>
BracketRoot<T> newton_in_bracket(const Function& f, const Noise& noise, T a, T b, bool negative_at_a,
                                 BracketStop<T> stop) {
  constexpr T kU = std::numeric_limits<T>::epsilon() / 2;
  BracketRoot<T> root;
  T x = a + (b - a) / 2;
  T last = b - a;  // the last step; Newton's next one must halve it
  bool after_newton = false;
  for (root.steps = 1; root.steps <= kBracketBudget<T>; ++root.steps) {
    const auto here = f(x);
    root.x = x;
    root.derivative = here.derivative;
    if (here.value == 0) return root;
    ((here.value < 0) == negative_at_a ? a : b) = x;
    const T correction = here.value / here.derivative;
    const T next = x - correction;
    const T step = std::fabs(correction);
    if (next > a && next < b && step <= last / 2) {
      // Quadratic convergence: after two Newton steps the next one is about step (step / last)^2.
      const T size = std::fabs(next);
      const T ratio = step / last;
      root.x = next;
      if (step <= stop.relative * size + stop.absolute) return root;
      if (after_newton && step * ratio * ratio <= stop.predicted * size) return root;
      x = next;
      last = step;
      after_newton = true;
      continue;
    }
    // Rounding or the function's shape: where it is rounding there is nothing left to gain.
    if (step <= kU * std::fabs(x) || std::fabs(here.value) < noise(x)) return root;
    const T middle = a + (b - a) / 2;
    if (!(middle > a && middle < b)) return root;
    if (b - a <= stop.relative * std::fabs(middle) + stop.absolute) return root;
    last = b - a;
    x = middle;
    after_newton = false;
  }
  root.converged = false;
  return root;
}

}  // namespace graze
