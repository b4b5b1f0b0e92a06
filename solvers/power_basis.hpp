// What methods for polynomials share: the equation in the power basis without its zero ends, and the rule by
// which an approximation counts as a real root.
//
// solves    nothing by itself: `solve` hands a Problem to a method and files what the method finds
// needs     an equation in any basis; a Bernstein one is changed to the power basis on [0, 1], a Chebyshev
//           one (of degree up to kMaxChebyshevDegree) to that on [-1, 1], with the rounding of the change
//           added to c_error
// returns   invalid for coefficients that are not finite; coincident for the zero polynomial; roots at zero
//           that the zero end stands for; everything else is the method's
// error     of a root: what `Problem::tolerance` says (a relative change of every coefficient by
//           kBackward n u); another basis adds the rounding of the change
// cost      no allocation up to degree kInline, except for another basis
// source    the backward-error rule: Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed.
//           (2002), section 5.1
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/chebyshev.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/solvers/roots.hpp>

namespace graze::power_basis {

/// Unit roundoff.
template <class T>
inline constexpr T kU = std::numeric_limits<T>::epsilon() / 2;

/// An approximation a + ib counts as the real root a if p(a) is zero within what a relative change of every
/// coefficient by kBackward n u can do: |p(a)| <= kBackward n u sum |c_i a^i| (+ coefficient errors).
/// Scale-free in p and in x; no threshold on |b|.
inline constexpr double kBackward = 16;

template <class T>
using Coefficients = std::span<const T>;

template <class T>
struct Value {
  T value = 0, derivative = 0;
};

/// Horner's rule for p and p', x real or complex.
template <class T, class X>
Value<X> evaluate(Coefficients<T> c, X x) {
  Value<X> p;
  for (std::size_t i = c.size(); i-- > 0;) {
    p.derivative = p.derivative * x + p.value;
    p.value = p.value * x + c[i];
  }
  return p;
}

/// sum |c_i| |x|^i.
template <class T>
T magnitude_sum(Coefficients<T> c, T x) {
  T sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * std::fabs(x) + std::fabs(c[i]);
  return sum;
}

/// sum c_i x^i = 0 on [lo, hi], c_0 != 0 != c_n, n = c.size() - 1 >= 1.
template <class T>
struct Problem {
  using Number = T;
  Coefficients<T> c;
  Coefficients<T> c_error;  ///< empty, or as long as c
  T lo, hi;

  [[nodiscard]] int degree() const { return static_cast<int>(c.size()) - 1; }
  [[nodiscard]] Value<T> at(T x) const { return evaluate(c, x); }
  /// The size of p's terms.
  [[nodiscard]] T magnitude(T x) const { return magnitude_sum(c, x); }
  /// What |p(x)| may be for x to count as a root.
  [[nodiscard]] T tolerance(T x) const {
    const auto n = static_cast<T>(degree());
    return static_cast<T>(kBackward) * n * kU<T> * magnitude_sum(c, x) + magnitude_sum(c_error, x);
  }
};

// What follows asks a problem P for `at`, `magnitude` and `tolerance` only, whatever its basis.

/// Newton steps that shrink |p|, at most 3: from a relative error of 1e-12 two reach rounding.
template <class P, class T = typename P::Number>
T polished(const P& problem, T x, Counters& counters) {
  constexpr int kSteps = 3;
  auto here = problem.at(x);
  for (int step = 0; step < kSteps && here.value != 0 && here.derivative != 0; ++step) {
    const T next = x - here.value / here.derivative;
    const auto there = problem.at(next);
    ++counters.evaluations;
    if (!(std::fabs(there.value) < std::fabs(here.value))) break;
    x = next;
    here = there;
  }
  return x;
}

/// Adds the real root x, found by a change of sign or as a real approximation. A root that leaves the closed
/// interval belongs to the end if the end is one by the same measure.
template <class P, class T = typename P::Number>
void add_real(const P& problem, std::type_identity_t<T> x, std::type_identity_t<T> radius,
              std::uint32_t multiplicity, Roots& roots) {
  const T inside = std::clamp(x, problem.lo, problem.hi);
  if (inside != x) {
    ++roots.counters.evaluations;
    if (std::fabs(problem.at(inside).value) > problem.tolerance(inside)) return;
  }
  roots.list.push_back(found_root(inside, radius, multiplicity));
}

/// Adds a complex approximation's real part if it counts as a root (kBackward). A conjugate pair, seen by its
/// member above the axis, is one touching root; its member below the axis is passed over. `polish`: see
/// above, for approximations on the axis.
template <class P, class T = typename P::Number>
void add_if_real(const P& problem, std::type_identity_t<std::complex<T>> approximation, bool polish,
                 Roots& roots) {
  if (approximation.imag() < 0) return;
  const bool pair = approximation.imag() > 0;
  T x = approximation.real();
  if (polish && !pair) x = polished(problem, x, roots.counters);
  const auto p = problem.at(x);
  ++roots.counters.evaluations;
  const T tolerance = problem.tolerance(x);
  // Beyond the range of T nothing can be told.
  if (pair && !(std::isfinite(tolerance) && std::fabs(p.value) <= tolerance)) return;
  const T radius = pair ? approximation.imag() + std::sqrt(kU<T>) * std::fabs(x)
                        : (std::fabs(p.value) + tolerance) / std::fabs(p.derivative);
  add_real(problem, x, radius, pair ? 2U : 1U, roots);
}

/// Are two neighbouring real roots one that rounding has split? A double root x splits by about sqrt(u):
/// between the two |p| is then no more than the rounding of its own coefficients.
template <class P, class T = typename P::Number>
bool is_split(const P& problem, const Root& a, const Root& b, Counters& counters) {
  if (a.x == b.x) return true;
  constexpr T kRounding = 4;
  const T middle = static_cast<T>(a.x + 0.5 * (b.x - a.x));
  ++counters.evaluations;
  const T size = problem.magnitude(middle);
  return std::isfinite(size) && std::fabs(problem.at(middle).value) <= kRounding * kU<T> * size;
}

/// Sorts, and makes one root of those that cannot be told apart.
template <class P, class T = typename P::Number>
void sort_and_merge(const P& problem, Roots& roots) {
  std::vector<Root>& list = roots.list;
  std::sort(list.begin(), list.end(), [](const Root& a, const Root& b) { return a.x < b.x; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (kept > 0 && is_split(problem, list[kept - 1], list[i], roots.counters)) {
      Root& merged = list[kept - 1];
      const double apart = list[i].x - merged.x;
      merged.x += 0.5 * apart;
      merged.radius = apart + static_cast<double>(std::sqrt(kU<T>)) * std::fabs(merged.x);
      merged.multiplicity += list[i].multiplicity;
    } else {
      list[kept++] = list[i];
    }
  }
  list.resize(kept);
}

/// Memory for the numbers of one equation: on the stack up to degree kInline, beyond it on the heap.
inline constexpr std::size_t kInline = 32;
template <class T>
class Scratch {
 public:
  explicit Scratch(std::size_t size) : size_(size) {
    if (size > inline_.size()) heap_.resize(size);
  }
  [[nodiscard]] std::span<T> span() { return {heap_.empty() ? inline_.data() : heap_.data(), size_}; }

 private:
  std::size_t size_;
  std::array<T, kInline + 1> inline_{};
  std::vector<T> heap_;
};

namespace detail {

/// The problem without its zero ends: k trailing zeros are the root 0 of multiplicity k.
template <class T, class Method>
void solve_without_zero_ends(Problem<T> problem, Roots& roots, const Method& method) {
  std::size_t size = problem.c.size();
  while (size > 0 && problem.c[size - 1] == 0) --size;
  if (size == 0) {
    roots.status = Status::coincident;
    return;
  }
  std::size_t zeros = 0;
  while (problem.c[zeros] == 0) ++zeros;
  const auto cut = [&](Coefficients<T> c) { return c.empty() ? c : c.subspan(zeros, size - zeros); };
  problem.c = cut(problem.c);
  problem.c_error = cut(problem.c_error);
  if (zeros > 0 && problem.lo <= 0 && 0 <= problem.hi) {
    roots.list.push_back({.x = 0, .others = {}, .multiplicity = static_cast<std::uint32_t>(zeros)});
  }
  if (problem.degree() < 1) return;
  method(problem, roots);
  sort_and_merge(problem, roots);
}

/// Roots in s of [0, 1] or [-1, 1] (first = 0 or -1) as roots x of [lo, hi].
template <class T>
void bring_back(const BasicPolynomialEquation<T>& equation, double first, Roots& roots) {
  const auto lo = static_cast<double>(equation.lo), hi = static_cast<double>(equation.hi);
  const double step = (hi - lo) / (1 - first);
  for (Root& root : roots.list) {
    root.x = root.x == 1 ? hi : std::fma(root.x - first, step, lo);
    root.radius *= step;
  }
}

/// A leading coefficient that the roundings of the b alone could have made is noise: on [lo, hi] it counts
/// for nothing, but it would put a root of the polynomial far away, and a method's start values with it.
template <class ToPower>
void drop_noise(const std::vector<double>& b, const ToPower& to_power, std::vector<double>& c,
                std::vector<double>& c_error) {
  constexpr double kSuspect = 0x1p-30;
  const auto size = [](double x) { return std::fabs(x); };
  const double largest = size(*std::ranges::max_element(c, {}, size));
  if (!(size(c.back()) < kSuspect * largest)) return;
  std::vector<double> rounding(b.size()), again(b.size()), noise(b.size());
  std::ranges::transform(b, rounding.begin(), [](double x) { return kU<double> * std::fabs(x); });
  to_power(b, rounding, again, noise);
  while (c.size() > 1 && size(c.back()) <= noise[c.size() - 1]) {
    c.pop_back();
    c_error.pop_back();
  }
}

/// A basis that belongs to [lo, hi]: the power basis in s, changed in double by `to_power`, then back.
template <class T, class Method, class ToPower>
void solve_changed(const BasicPolynomialEquation<T>& equation, double first, const ToPower& to_power,
                   Roots& roots, const Method& method) {
  const std::vector<double> b(equation.c.begin(), equation.c.end());
  const std::vector<double> b_error(equation.c_error.begin(), equation.c_error.end());
  std::vector<double> c(b.size());
  std::vector<double> c_error(b.size());
  to_power(b, b_error, c, c_error);
  drop_noise(b, to_power, c, c_error);
  const auto rounded = [](const std::vector<double>& from) {
    std::vector<T> to;
    for (const double v : from) to.push_back(static_cast<T>(v));
    return to;
  };
  const std::vector<T> c_rounded = rounded(c), error_rounded = rounded(c_error);
  solve_without_zero_ends(Problem<T>{c_rounded, error_rounded, static_cast<T>(first), 1}, roots, method);
  bring_back(equation, first, roots);
}

}  // namespace detail

/// Poses the equation to `method(const Problem<T>&, Roots&)`, which appends real roots by add_real or
/// add_if_real, in any order, and sets a status other than ok where it fails; then sorts and merges them.
template <class T, class Method>
void solve(const BasicPolynomialEquation<T>& equation, Roots& roots, const Method& method) {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
  } else if (equation.basis == Basis::bernstein) {
    detail::solve_changed(equation, 0, bernstein_to_power, roots, method);
  } else if (equation.basis == Basis::chebyshev) {
    if (equation.c.size() > kMaxChebyshevSize) {
      roots.status = Status::failed;
    } else {
      detail::solve_changed(equation, -1, chebyshev_to_power, roots, method);
    }
  } else {
    detail::solve_without_zero_ends(Problem<T>{equation.c, equation.c_error, equation.lo, equation.hi}, roots,
                                    method);
  }
}

/// x = 2^shift y and a common factor 2^-power of the coefficients, such that the first and the last
/// coefficient of q(y) are alike within a factor 2^(n/2 + 1) and the largest one lies in [1, 2): exact, but
/// for parts more than 2^-1000 below the largest (double).
struct PowersOfTwo {
  int shift = 0;
  int power = 0;
};

/// Writes the coefficients of q into `out` (as long as c) and says by which powers. Methods that square or
/// divide coefficients work on these, so that nothing over- or underflows; roots of p are y 2^shift.
template <class T>
PowersOfTwo scale_coefficients(Coefficients<T> c, std::span<T> out) {
  const int n = static_cast<int>(c.size()) - 1;
  const auto exponent = [](T v) { return v == 0 ? std::numeric_limits<int>::min() / 4 : std::ilogb(v); };
  const int first = exponent(c.front()), last = exponent(c.back());
  PowersOfTwo scaling;
  // Rounded down, so that a change of x by a power of two changes the shift by just that.
  const int ratio = first - last;
  if (n > 0 && c.front() != 0 && c.back() != 0)
    scaling.shift = ratio >= 0 ? ratio / n : -((n - 1 - ratio) / n);
  scaling.power = std::numeric_limits<int>::min() / 4;
  for (int i = 0; i <= n; ++i)
    scaling.power = std::max(scaling.power, exponent(c[static_cast<std::size_t>(i)]) + i * scaling.shift);
  for (int i = 0; i <= n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = std::ldexp(c[k], i * scaling.shift - scaling.power);
  }
  return scaling;
}

}  // namespace graze::power_basis
