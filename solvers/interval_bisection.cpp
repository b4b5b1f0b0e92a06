#include <graze/solvers/interval_bisection.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/polynomial.hpp>

namespace graze {
namespace {

enum class Sign : int { negative = -1, unknown = 0, positive = 1 };

Sign sign(Interval f) { return f.lo > 0 ? Sign::positive : f.hi < 0 ? Sign::negative : Sign::unknown; }

/// The search for one equation. `Function` gives value(Interval) and derivative(Interval).
template <class Function>
class Search {
 public:
  Search(const Function& function, Epsilons epsilons, double scale, std::uint32_t budget, Roots& roots)
      : function_(function), epsilons_(epsilons), scale_(scale), budget_(budget), roots_(roots) {}

  /// Depth first from the left, so that roots come out in ascending order.
  void run(Interval domain) {
    push(domain);
    while (depth_ > 0) {
      if (roots_.counters.evaluations >= budget_) {
        roots_.status = Status::uncertain;
        return;
      }
      examine(stack_[--depth_]);
    }
  }

 private:
  static constexpr std::size_t kDepth = 256;  // a split adds one interval: enough for 2^-255 of the domain

  void push(Interval x) {
    if (depth_ < kDepth) {
      stack_[depth_++] = x;
    } else {
      roots_.status = Status::uncertain;
    }
  }

  Interval value(Interval x) {
    ++roots_.counters.evaluations;
    return function_.value(x);
  }

  /// Proves x empty, finds its one root, splits it, or gives it up as undecided.
  void examine(Interval x) {
    if (!contains_zero(value(x))) return;
    const Interval slope = function_.derivative(x);
    ++roots_.counters.evaluations;
    if (!contains_zero(slope)) {
      if (settle_monotone(x, slope)) return;
    } else if (mean_value_excludes(x, slope)) {
      return;
    }
    if (width(x) <= epsilon(x, slope)) {
      roots_.status = Status::uncertain;
      return;
    }
    split(x);
  }

  /// Zero is outside f(m) + f'(X)(X - m): sharper than f(X) on short intervals.
  bool mean_value_excludes(Interval x, Interval slope) {
    const double m = mid(x);
    return !contains_zero(value(point(m)) + slope * (x - point(m)));
  }

  /// f is strictly monotone on x: the signs at the ends decide. False if they cannot be told.
  bool settle_monotone(Interval x, Interval slope) {
    const Interval at_lo = value(point(x.lo));
    const Interval at_hi = value(point(x.hi));
    if (at_lo == Interval{} || at_hi == Interval{}) {
      add_end_root(at_lo == Interval{} ? x.lo : x.hi);
      return true;
    }
    const Sign lo = sign(at_lo);
    const Sign hi = sign(at_hi);
    // Rising from above zero or falling from below it leaves no room for a root; one end is enough to know.
    const Sign rising = slope.lo > 0 ? Sign::positive : Sign::negative;
    if (lo == rising || (hi != Sign::unknown && hi != rising)) return true;
    if (lo == Sign::unknown || hi == Sign::unknown) return false;
    refine(x, lo);
    return true;
  }

  /// f vanishes exactly at a double that two neighbouring intervals may share: one root.
  void add_end_root(double x) {
    if (!roots_.list.empty() && roots_.list.back().x == x) return;
    roots_.list.push_back({.x = x, .others = {}, .radius = 0, .multiplicity = 1, .certified = true});
  }

  /// Bisects x, which holds exactly one root, down to its part's epsilon, or as far as the signs can be told.
  void refine(Interval x, Sign lo) {
    const double eps = part_epsilon(x);
    while (width(x) > eps) {
      const double m = mid(x);
      if (m <= x.lo || m >= x.hi) break;  // neighbouring doubles
      ++roots_.counters.iterations;
      const Sign at_m = sign(value(point(m)));
      if (at_m == Sign::unknown) {
        x = window(m, eps, x, lo);
        break;
      }
      (at_m == lo ? x.lo : x.hi) = m;
    }
    const double centre = mid(x);
    const double radius = std::max(sub_up(x.hi, centre), sub_up(centre, x.lo));
    roots_.list.push_back(
        {.x = centre, .others = {}, .radius = radius, .multiplicity = 1, .certified = true});
    const bool neighbours = std::nextafter(x.lo, x.hi) >= x.hi;
    if (width(x) > std::max(eps, grazing_epsilon()) && !neighbours) roots_.status = Status::uncertain;
  }

  /// f(m) is zero within rounding: the smallest window about m, from eps up, whose ends have signs that prove
  /// the root inside. Where the slope is shallow rounding hides the signs further out: up to the grazing eps.
  /// Three quarters of the size aimed at, so that the rounding of the ends cannot make it wider.
  Interval window(double m, double eps, Interval x, Sign lo) {
    const double widest = std::max(eps, grazing_epsilon());
    // An epsilon that has underflowed would never grow.
    const double first = std::max(eps, std::numeric_limits<double>::min());
    for (double size = first; size <= widest; size *= 4) {
      const double a = m - 0.375 * size;
      const double b = m + 0.375 * size;
      if (a > x.lo && sign(value(point(a))) == lo) x.lo = a;
      const Sign at_b = b < x.hi ? sign(value(point(b))) : Sign::unknown;
      if (at_b != Sign::unknown && at_b != lo) x.hi = b;
      if (width(x) <= size) break;
    }
    return x;
  }

  void split(Interval x) {
    ++roots_.counters.iterations;
    const double m = split_point(x);
    if (m <= x.lo || m >= x.hi) {  // no double between
      roots_.status = Status::uncertain;
      return;
    }
    push({m, x.hi});
    push({x.lo, m});
  }

  /// A point where f is clearly not zero, so that no root is cut: the middle, or a little beside it.
  double split_point(Interval x) {
    constexpr std::array<double, 3> kFractions{0.5, 0.4375, 0.578125};  // exact, and unlike each other
    for (const double fraction : kFractions) {
      const double m = x.lo + fraction * (x.hi - x.lo);
      if (sign(value(point(m))) != Sign::unknown) return m;
    }
    return mid(x);
  }

  /// The width below which x is given up: its part's, or the grazing one where the slope may vanish.
  [[nodiscard]] double epsilon(Interval x, Interval slope) const {
    const double eps = part_epsilon(x);
    return mig(slope) > epsilons_.shallow ? eps : std::max(eps, grazing_epsilon());
  }
  [[nodiscard]] double part_epsilon(Interval x) const {
    double eps = IntervalBisection::kDefaultEps * scale_;
    for (const Region& part : epsilons_.parts) {
      eps = part.eps;
      if (mid(x) <= part.end) break;
    }
    return eps;
  }
  [[nodiscard]] double grazing_epsilon() const {
    return epsilons_.grazing_eps > 0 ? epsilons_.grazing_eps : IntervalBisection::kDefaultGrazingEps * scale_;
  }

  const Function& function_;
  Epsilons epsilons_;
  double scale_;
  std::uint32_t budget_;
  Roots& roots_;
  std::size_t depth_ = 0;
  std::array<Interval, kDepth> stack_;
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

struct InclusionFunction {
  const IntervalEquation& equation;
  [[nodiscard]] Interval value(Interval x) const { return equation.value(equation.self, x); }
  [[nodiscard]] Interval derivative(Interval x) const { return equation.derivative(equation.self, x); }
};

/// Runs the search with the unknown's scale: the largest |x| asked for.
template <class Function>
void search(const Function& function, const Epsilons& epsilons, Interval domain, std::uint32_t budget,
            Roots& roots) {
  Search<Function>(function, epsilons, mag(domain), budget, roots).run(domain);
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
  search(InclusionFunction{equation}, equation.epsilons, {equation.lo, equation.hi}, budget_, roots);
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
