#include <graze/solvers/interval_bisection.hpp>

#include <algorithm>
#include <cmath>

#include <graze/solvers/bernstein_copy.hpp>
#include <graze/solvers/interval_search.hpp>
#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/polynomial.hpp>

namespace graze {
namespace {

using inclusion::IntervalSearch;

template <class Function>
class Bisection : public IntervalSearch<Bisection<Function>, Function> {
 public:
  using IntervalSearch<Bisection, Function>::IntervalSearch;

  /// Proves x empty, finds its one root, splits it, or gives it up as undecided.
  void examine(Interval x) {
    if (!contains_zero(this->value(x))) return;
    const Interval slope = this->derivative(x);
    if (!contains_zero(slope)) {
      if (this->settle_monotone(x, slope)) return;
    } else if (mean_value_excludes(x, slope)) {
      return;
    }
    if (width(x) <= this->epsilon(x, slope)) {
      this->roots_.status = Status::uncertain;
      return;
    }
    this->split(x);
  }

 private:
  /// Zero is outside f(m) + f'(X)(X - m): sharper than f(X) on short intervals.
  bool mean_value_excludes(Interval x, Interval slope) {
    const double m = mid(x);
    return !contains_zero(this->value(point(m)) + slope * (x - point(m)));
  }
};

struct PolynomialFunction {
  const PolynomialEquation& equation;
  [[nodiscard]] Interval value(Interval x) const { return evaluate(equation.c, equation.c_error, x); }
  [[nodiscard]] Interval derivative(Interval x) const {
    return evaluate_derivative(equation.c, equation.c_error, x);
  }
};

/// Bernstein on [lo, hi], through t = (x - lo)/(hi - lo).
struct BernsteinFunction {
  const PolynomialEquation& equation;
  Interval length = point(equation.hi) - point(equation.lo);

  [[nodiscard]] Interval parameter(Interval x) const {
    if (equation.lo == 0 && equation.hi == 1) return x;
    const Interval t = (x - point(equation.lo)) / length;
    return {std::clamp(t.lo, 0.0, 1.0), std::clamp(t.hi, 0.0, 1.0)};
  }
  [[nodiscard]] Interval value(Interval x) const {
    return bernstein_evaluate(equation.c, equation.c_error, parameter(x));
  }
  [[nodiscard]] Interval derivative(Interval x) const {
    return bernstein_evaluate_derivative(equation.c, equation.c_error, parameter(x)) / length;
  }
};

/// Runs the search with the unknown's scale: the largest |x| asked for.
template <class Function>
void search(const Function& function, const Epsilons& epsilons, Interval domain, std::uint32_t budget,
            Roots& roots) {
  Bisection<Function>(function, epsilons, mag(domain), budget, roots).run(domain);
}

}  // namespace

SolverInfo IntervalBisection::info() {
  SolverInfo info;
  info.summary = "interval inclusion and bisection with per-region epsilons";
  info.source = "Moore, Kearfott, Cloud, SIAM 2009; epsilons by region after document 003";
  info.page = "solvers/interval_bisection.md";
  info.options = {{"budget", "20000", "evaluations before it says uncertain"}};
  info.claims = {.finds_touching_roots = false, .certified = true, .deterministic = true};
  info.forms = {Form::interval, Form::polynomial};
  return info;
}

IntervalBisection::IntervalBisection(const Parameters& options)
    : budget_(static_cast<std::uint32_t>(options.integer("budget", 20000, 10, 1000000000))) {}

void IntervalBisection::solve(const IntervalEquation& equation, Roots& roots) const {
  search(inclusion::InclusionFunction{equation}, equation.epsilons, {equation.lo, equation.hi}, budget_,
         roots);
}

void IntervalBisection::solve(const PolynomialEquation& equation, Roots& roots) const {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
    return;
  }
  const bool exact = equation.c_error.empty();
  const int degree = effective_degree(equation.c);
  if (degree < 0) {
    const bool zero = exact || effective_degree(equation.c_error) < 0;
    roots.status = zero ? Status::coincident : Status::uncertain;
    return;
  }
  if (equation.basis == Basis::chebyshev) {
    if (BernsteinCopy::suits(equation)) return solve(BernsteinCopy(equation).equation(), roots);
    roots.status = Status::failed;
    return;
  }
  if (equation.basis == Basis::bernstein) {
    search(BernsteinFunction{equation}, equation.epsilons, {equation.lo, equation.hi}, budget_, roots);
    return;
  }
  // An unbounded question is bounded by the roots; coefficient errors could move them, so it must be exact.
  const double bound = root_bound(equation.c);
  const Interval domain{std::max(equation.lo, -bound), std::min(equation.hi, bound)};
  const bool bounded = std::isfinite(equation.lo) && std::isfinite(equation.hi);
  if (!bounded && (!exact || !std::isfinite(bound))) {
    roots.status = Status::uncertain;
    return;
  }
  const Interval asked = bounded ? Interval{equation.lo, equation.hi} : domain;
  if (asked.lo <= asked.hi) search(PolynomialFunction{equation}, equation.epsilons, asked, budget_, roots);
}

}  // namespace graze
