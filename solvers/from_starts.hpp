// What newton and halley share: start values, safeguards and how roots are told apart. A method brings
// its step.
//
// solves    p(x) = 0: from outside all roots, one root after the other from both ends, the ones already
//           found divided out by Maehly's trick, that is without new coefficients; then, if roots may be
//           left, and always for f(x) = 0: from `starts` equidistant points of [lo, hi]
// needs     `method(local)` gives the step from x by f/f', f''/f' and the sums over known roots
// returns   the distinct roots found; nothing says that there are no others
// source    Maehly, "Zur iterativen Aufloesung algebraischer Gleichungen", Z. angew. Math. Phys. 5
//           (1954); Stoer, Bulirsch, "Introduction to Numerical Analysis", 3rd ed., section 5.5 (monotone
//           convergence from outside where all roots are real)
#pragma once

#include <algorithm>
#include <cmath>

#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/slices.hpp>

namespace graze::from_starts {

using power_basis::Coefficients;
using power_basis::kU;

/// Steps from one start: a double root halves its error a step, 53 steps to sqrt(u) from 2^26 of it, and
/// the way in from the root bound takes a few n.
inline constexpr int kSteps = 120;
/// Halvings of a step while |f| does not shrink: past 2^-10 the point sits in a valley of |f|.
inline constexpr int kHalvings = 10;

/// f at a point, by ratios that neither over- nor underflow when f is scaled.
template <class T>
struct Local {
  T ratio = 0;      ///< f / f'
  T curvature = 0;  ///< f'' / f'
  T sum = 0;        ///< sum 1 / (x - r) over the known roots r
  T squares = 0;    ///< sum 1 / (x - r)^2
};

/// Newton's step for f / prod (x - r).
template <class T>
T newton_step(const Local<T>& local) {
  return -local.ratio / (1 - local.ratio * local.sum);
}

/// Halley's step for f / prod (x - r) = g: -2 g g' / (2 g'^2 - g g''). At most twice Newton's: where
/// Halley's denominator is smaller than that its parabola has no root on this side.
template <class T>
T halley_step(const Local<T>& local) {
  const T r = local.ratio, deflation = 1 - r * local.sum;
  // (g'/g)' / (g'/g)^2.
  const T bend = (r * local.curvature - 1 + r * r * local.squares) / (deflation * deflation);
  return newton_step(local) / std::max((1 - bend) / 2, T{1} / 2);
}

template <class T>
Local<T> local_of(const BasicJet<T>& jet) {
  return {.ratio = jet.f / jet.df, .curvature = jet.ddf / jet.df};
}

/// Radius and multiplicity as slices::root_of_scalar gives them, the radius kept finite where f' and f''
/// both vanish; a touching root goes to the vertex of its parabola.
template <class T>
Root root_at(T x, const BasicJet<T>& jet, T lo, T hi) {
  Root root = slices::root_of_scalar(x, jet);
  const double widest = static_cast<double>(std::cbrt(kU<T>) * (hi - lo));
  if (!(root.radius <= widest)) root.radius = widest;
  if (root.multiplicity == 2 && jet.ddf != 0) {
    const T vertex = x - jet.df / jet.ddf;
    if (lo <= vertex && vertex <= hi) root.x = static_cast<double>(vertex);
  }
  return root;
}

/// From x by steps that shrink |f|, in [lo, hi]. True if it ended at a root.
template <class T, class F, class Method>
bool descend(const F& f, T x, T lo, T hi, const Method& method, Root& root, Counters& counters) {
  BasicJet<T> jet = f(x);
  for (int step = 0; step < kSteps && jet.f != 0; ++step) {
    const T move = method(local_of(jet));
    if (!std::isfinite(move)) break;
    T next = slices::step_inside(x, move, lo, hi);
    BasicJet<T> there = f(next);
    for (int i = 0; i < kHalvings && !(std::fabs(there.f) < std::fabs(jet.f)) && next != x; ++i) {
      if (slices::is_root(x, jet)) break;
      next = x + (next - x) / 2;
      there = f(next);
    }
    ++counters.iterations;
    if (!(std::fabs(there.f) < std::fabs(jet.f))) break;
    x = next;
    jet = there;
  }
  if (!slices::is_root(x, jet)) return false;
  root = root_at(x, jet, lo, hi);
  return std::isfinite(root.x);
}

/// Adds the distinct roots that `starts` equidistant points, ends included, lead to.
template <class T, class F, class Method>
void search(const F& f, T lo, T hi, int starts, int max_roots, const Method& method, Roots& roots) {
  for (int i = 0; i < starts; ++i) {
    const T part = starts > 1 ? static_cast<T>(i) / static_cast<T>(starts - 1) : T{1} / 2;
    ++roots.counters.starts;
    Root root;
    const T start = std::clamp(lo + part * (hi - lo), lo, hi);
    if (descend(f, start, lo, hi, method, root, roots.counters)) slices::add_distinct(roots, root);
    if (max_roots > 0 && roots.list.size() >= static_cast<std::size_t>(max_roots)) break;
  }
  std::sort(roots.list.begin(), roots.list.end(), [](const Root& a, const Root& b) { return a.x < b.x; });
}

/// The whole of form scalar.
template <class T, class Method>
void solve_scalar(const BasicScalarEquation<T>& equation, int starts, const Method& method, Roots& roots) {
  if (!std::isfinite(equation.lo) || !std::isfinite(equation.hi) || !(equation.lo <= equation.hi)) {
    roots.status = Status::invalid;
    return;
  }
  const auto f = [&](T x) {
    ++roots.counters.evaluations;
    return equation(x);
  };
  search(f, equation.lo, equation.hi, starts, equation.max_roots, method, roots);
}

// ------------------------------------------------------------------------------------------- polynomials

/// p with two derivatives and its running error bound (Higham, algorithm 5.1).
template <class T>
BasicJet<T> polynomial_jet(Coefficients<T> c, Coefficients<T> c_error, T x) {
  BasicJet<T> jet;
  T mu = 0;
  for (std::size_t i = c.size(); i-- > 0;) {
    jet.ddf = jet.ddf * x + 2 * jet.df;
    jet.df = jet.df * x + jet.f;
    const T product = jet.f * x;
    jet.f = product + c[i];
    mu = mu * std::fabs(x) + (std::fabs(product) + std::fabs(jet.f));
  }
  jet.f_error = kU<T> * mu + power_basis::magnitude_sum(c_error, x);
  return jet;
}

/// The search for all real roots of one polynomial, in an unknown in which its coefficients are of one
/// size.
template <class T, class Method>
class MaehlySearch {
 public:
  MaehlySearch(Coefficients<T> c, Coefficients<T> c_error, T bound, const Method& method, Counters& counters)
      : c_(c), c_error_(c_error), bound_(bound), method_(method), known_(c.size()) {
    all_.counters = counters;
  }

  /// All real roots it finds, ascending.
  Roots& run(int starts) {
    while (left() > 0 && from(bound_)) {
    }
    while (left() > 0 && from(-bound_)) {
    }
    const auto f = [this](T x) { return jet(x); };
    if (left() > 0) search(f, -bound_, bound_, starts, 0, method_, all_);
    return all_;
  }

 private:
  [[nodiscard]] std::size_t left() const { return c_.size() - 1 - count_; }

  BasicJet<T> jet(T x) {
    ++all_.counters.evaluations;
    return polynomial_jet(c_, c_error_, x);
  }

  [[nodiscard]] Local<T> deflated(T x, const BasicJet<T>& jet) {
    Local<T> local = local_of(jet);
    for (const T r : known_.span().first(count_)) {
      const T inverse = 1 / (x - r);
      local.sum += inverse;
      local.squares += inverse * inverse;
    }
    return local;
  }

  /// From outside to the next root; false if the steps lead nowhere. Sees roots with their multiplicity.
  bool from(T x) {
    ++all_.counters.starts;
    BasicJet<T> here = jet(x);
    for (int step = 0; step < kSteps && !slices::is_root(x, here); ++step) {
      const T move = method_(deflated(x, here));
      const T next = x + move;
      if (!(std::fabs(next) <= bound_) || next == x) return false;
      ++all_.counters.iterations;
      x = next;
      here = jet(x);
    }
    if (!slices::is_root(x, here)) return false;
    // Polished without the other roots: what Maehly's sums add in rounding is gone.
    Root root;
    const auto f = [this](T y) { return jet(y); };
    if (!descend(f, x, -bound_, bound_, method_, root, all_.counters)) return false;
    if (is_known(root)) return false;
    root.multiplicity = std::min(root.multiplicity, static_cast<std::uint32_t>(left()));
    for (std::uint32_t i = 0; i < root.multiplicity; ++i) known_.span()[count_++] = static_cast<T>(root.x);
    all_.list.push_back(root);
    return true;
  }

  /// A root that the steps come back to: by rounding, for its factor is divided out.
  [[nodiscard]] bool is_known(const Root& root) const {
    return std::any_of(all_.list.begin(), all_.list.end(),
                       [&](const Root& known) { return known.x == root.x; });
  }

  Coefficients<T> c_, c_error_;
  T bound_;
  const Method& method_;
  power_basis::Scratch<T> known_;
  std::size_t count_ = 0;
  Roots all_;
};

/// A bound of all roots, in T.
template <class T>
T bound_of_roots(Coefficients<T> c) {
  power_basis::Scratch<double> wide(c.size());
  std::transform(c.begin(), c.end(), wide.span().begin(), [](T a) { return static_cast<double>(a); });
  const double largest = static_cast<double>(std::numeric_limits<T>::max() / 4);
  return static_cast<T>(std::min(root_bound(wide.span()) * (1 + 8 * static_cast<double>(kU<T>)), largest));
}

/// The whole of form polynomial.
template <class T, class Method>
void solve_polynomial(const BasicPolynomialEquation<T>& equation, int starts, const Method& method,
                      Roots& roots) {
  power_basis::solve(equation, roots, [&](const power_basis::Problem<T>& problem, Roots& found) {
    power_basis::Scratch<T> c(problem.c.size()), c_error(problem.c_error.size());
    const power_basis::PowersOfTwo powers = power_basis::scale_coefficients(problem.c, c.span());
    for (std::size_t i = 0; i < problem.c_error.size(); ++i)
      c_error.span()[i] = std::ldexp(problem.c_error[i], static_cast<int>(i) * powers.shift - powers.power);
    MaehlySearch<T, Method> maehly(c.span(), c_error.span(), bound_of_roots<T>(c.span()), method,
                                   found.counters);
    const Roots& all = maehly.run(starts);
    found.counters = all.counters;
    for (const Root& root : all.list) {
      const T x = std::ldexp(static_cast<T>(root.x), powers.shift);
      add_real(problem, x, std::ldexp(static_cast<T>(root.radius), powers.shift), root.multiplicity, found);
    }
  });
}

}  // namespace graze::from_starts
