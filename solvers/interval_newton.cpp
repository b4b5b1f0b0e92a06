#include <graze/solvers/interval_newton.hpp>

#include <cmath>
#include <optional>
#include <stdexcept>

#include <graze/solvers/interval_search.hpp>

namespace graze {
namespace {

using inclusion::InclusionFunction;
using inclusion::sign;
using inclusion::Sign;

/// N(X) = m - f(m) / F'(X), for a slope without zero: contains every root of X.
Interval newton_image(double m, Interval at_m, Interval slope) { return point(m) - at_m / slope; }

/// K(X) = m - Y f(m) + (1 - Y F'(X)) (X - m) with Y = 1 / mid(F'(X)): contains every root of X, for any
/// slope.
Interval krawczyk_image(Interval x, double m, Interval at_m, Interval slope) {
  const double y = 1 / mid(slope);
  if (!std::isfinite(y)) return entire();
  return point(m) - y * at_m + (point(1) - y * slope) * (x - point(m));
}

class NewtonSearch : public inclusion::IntervalSearch<NewtonSearch, InclusionFunction> {
 public:
  NewtonSearch(bool krawczyk, const InclusionFunction& function, const IntervalEquation& equation,
               std::uint32_t budget, Roots& roots)
      : IntervalSearch(function, equation.epsilons, mag({equation.lo, equation.hi}), budget, roots),
        krawczyk_(krawczyk) {}

  /// Proves x empty, contracts it to its one root, splits it, or gives it up as undecided.
  void examine(Interval x) {
    if (!contains_zero(value(x))) return;
    const Interval slope = derivative(x);
    if (!contains_zero(slope)) return contract(x, slope);
    if (width(x) <= epsilon(x, slope)) {
      if (!mean_value_excludes(x, slope)) roots_.status = Status::uncertain;
      return;
    }
    krawczyk_ ? shrink_or_split(x, slope) : split_at_gap(x, slope);
  }

 private:
  bool mean_value_excludes(Interval x, Interval slope) {
    const double m = mid(x);
    return !contains_zero(value(point(m)) + slope * (x - point(m)));
  }

  /// f is strictly monotone on x: iterates the operator while it helps. Once the image lies inside x there is
  /// exactly one root (theorems 8.1 and 8.2), and it stays in every later image.
  void contract(const Interval whole, const Interval whole_slope) {
    Interval x = whole, slope = whole_slope;
    bool proved = false;
    const double eps = part_epsilon(x);
    for (bool shrinks = true; shrinks && !(proved && width(x) <= eps) && !is_point(x);) {
      const double m = mid(x);
      const Interval at_m = value(point(m));
      const Interval image = krawczyk_ ? krawczyk_image(x, m, at_m, slope) : newton_image(m, at_m, slope);
      const std::optional<Interval> common = intersect(x, image);
      if (!common) return;
      proved = proved || (x.lo < image.lo && image.hi < x.hi);
      shrinks = width(*common) <= 0.5 * width(x);
      x = *common;
      ++roots_.counters.iterations;
      if (shrinks) slope = derivative(x);
    }
    if (proved && width(x) <= eps) return add_proved(x, eps);
    // Where rounding stops the image, or the root is at the end and never inside: the signs at the ends of
    // the whole decide, which are told more easily than those next to the root.
    if (settle_monotone(whole, whole_slope)) return;
    if (proved) return add_proved(x, eps);
    if (width(whole) <= epsilon(whole, whole_slope)) {
      roots_.status = Status::uncertain;
    } else {
      split(whole);
    }
  }

  /// The slope contains zero: f(m) / F'(X) is two half lines, between whose images there is no root.
  void split_at_gap(Interval x, Interval slope) {
    const double m = split_point(x);
    Interval at_m = value(point(m));
    if (sign(at_m) == Sign::unknown) return split(x);
    if (sign(at_m) == Sign::negative) {
      at_m = -at_m;
      slope = -slope;
    }
    ++roots_.counters.iterations;
    // f(m) > 0: a root at distance t needs f to fall by f(m), at a rate of at most -slope.lo or slope.hi.
    const double right = slope.lo < 0 ? add_down(m, div_down(at_m.lo, -slope.lo)) : detail::kInfinity;
    const double left = slope.hi > 0 ? sub_up(m, div_down(at_m.lo, slope.hi)) : -detail::kInfinity;
    if (right <= x.hi) push({std::max(right, x.lo), x.hi});
    if (left >= x.lo) push({x.lo, std::min(left, x.hi)});
  }

  /// Krawczyk's operator takes slopes with zero as well, but only contracts where f is not too curved.
  void shrink_or_split(Interval x, Interval slope) {
    const double m = mid(x);
    const std::optional<Interval> common = intersect(x, krawczyk_image(x, m, value(point(m)), slope));
    if (!common) return;
    ++roots_.counters.iterations;
    if (width(*common) <= 0.5 * width(x)) {
      push(*common);
    } else {
      split(*common);
    }
  }

  bool krawczyk_;
};

bool is_krawczyk(const std::string& name) {
  if (name != "newton" && name != "krawczyk")
    throw std::invalid_argument("interval_newton: operator '" + name + "' is neither newton nor krawczyk");
  return name == "krawczyk";
}

}  // namespace

SolverInfo IntervalNewton::info() {
  SolverInfo info;
  info.summary = "interval Newton with gap splitting, or Krawczyk's operator";
  info.source = "Moore, Kearfott, Cloud, SIAM 2009, ch. 8; Krawczyk, Computing 4 (1969)";
  info.page = "solvers/interval_newton.md";
  info.options = {{"operator", "newton", "newton or krawczyk"},
                  {"budget", "20000", "evaluations before it says uncertain"}};
  info.claims = {.finds_touching_roots = false, .certified = true, .deterministic = true};
  info.forms = {Form::interval};
  return info;
}

IntervalNewton::IntervalNewton(const Parameters& options)
    : krawczyk_(is_krawczyk(options.word("operator", "newton"))),
      budget_(static_cast<std::uint32_t>(options.integer("budget", 20000, 10, 1000000000))) {}

void IntervalNewton::solve(const IntervalEquation& equation, Roots& roots) const {
  if (!std::isfinite(equation.lo) || !std::isfinite(equation.hi) || !(equation.lo <= equation.hi)) {
    roots.status = Status::invalid;
    return;
  }
  const InclusionFunction function{equation};
  NewtonSearch(krawczyk_, function, equation, budget_, roots).run({equation.lo, equation.hi});
}

}  // namespace graze
