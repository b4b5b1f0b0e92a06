#include <graze/solvers/sphere_tracing.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <graze/solvers/bracket_methods.hpp>
#include <graze/solvers/from_starts.hpp>
#include <graze/solvers/interval_search.hpp>

namespace graze {
namespace {

using inclusion::InclusionFunction;
using inclusion::sign;
using inclusion::Sign;

// ------------------------------------------------------------------------------------------ form interval

class Marching : public inclusion::IntervalSearch<Marching, InclusionFunction> {
 public:
  using IntervalSearch::IntervalSearch;

  /// Steps from the low end to the high one; never passes a root unseen.
  void march(Interval domain) {
    double x = domain.lo, trial = domain.hi - domain.lo;
    // The last point with a proved sign, or the low end.
    double known = x;
    while (x < domain.hi) {
      if (roots_.counters.evaluations >= budget_) {
        roots_.status = Status::uncertain;
        return;
      }
      const Interval at_x = value(point(x));
      const double eps = part_epsilon(point(x));
      ++roots_.counters.iterations;
      double step = 0;
      if (sign(at_x) != Sign::unknown) {
        known = x;
        step = safe_step(x, at_x, std::min(2 * trial, domain.hi - x));
      }
      if (step > eps && add_down(x, step) > x) {
        x = std::min(add_down(x, step), domain.hi);
        trial = step;
      } else {
        const std::size_t listed = roots_.list.size();
        x = settle(known, x, eps, domain.hi);
        // A root that is listed is left behind; without one x may have no sign yet.
        if (roots_.list.size() > listed || roots_.status != Status::ok) known = x;
        trial = std::max(trial, eps);
      }
    }
    settle_end(domain.hi);
  }

 private:
  /// A length h such that |f| cannot reach zero on [x, x + h): |f(x)| over the largest rate at which |f|
  /// may fall, bounded over no more than four times what is stepped over.
  double safe_step(double x, Interval at_x, double longest) {
    constexpr int kTrials = 6;        // each brings the range a factor of 4 or more nearer to the step
    constexpr double kEnough = 0.25;  // on a range four times the step the slope is known well enough
    double best = 0;
    for (int i = 0; i < kTrials && longest > 0; ++i) {
      const Interval slope = derivative({x, add_up(x, longest)});
      const double fall = at_x.lo > 0 ? -slope.lo : slope.hi;
      const double reach = fall > 0 ? div_down(mig(at_x), fall) : detail::kInfinity;
      best = std::max(best, std::min(reach, longest));
      if (best >= kEnough * longest) break;
      longest = std::max(best * 4, longest / 16);
    }
    return best;
  }

  /// A root may be within eps of x: counts the roots in windows from the last known sign on, each larger
  /// until its far end has a sign. Returns where to go on; uncertain if the window would exceed the grazing
  /// epsilon.
  double settle(double known, double x, double eps, double hi) {
    const double widest = std::max(eps, grazing_epsilon());
    // An epsilon that has underflowed would never grow.
    const double first = std::max(eps, std::numeric_limits<double>::min());
    for (double size = first; size <= widest; size *= 4) {
      const double end = std::min(std::max(x + size, std::nextafter(x, detail::kInfinity)), hi);
      // All before x is known to be free of roots: the low end is there for its sign.
      const Interval window{std::max(known, x - size), end};
      const Interval slope = derivative(window);
      if (contains_zero(slope)) break;
      if (settle_monotone(window, slope)) return end;
      if (end == hi) break;
    }
    roots_.status = Status::uncertain;
    return std::min(std::max(x + widest, std::nextafter(x, detail::kInfinity)), hi);
  }

  /// No step looks at the high end itself.
  void settle_end(double hi) {
    const bool is_listed = !roots_.list.empty() && roots_.list.back().x + roots_.list.back().radius >= hi;
    const Interval at_hi = value(point(hi));
    if (sign(at_hi) != Sign::unknown || is_listed) return;
    if (at_hi == Interval{}) {
      add_end_root(hi);
    } else {
      roots_.status = Status::uncertain;
    }
  }
};

// -------------------------------------------------------------------------------------------- form scalar

struct NewtonStep {
  template <class T>
  T operator()(const from_starts::Local<T>& local) const {
    return from_starts::newton_step(local);
  }
};

template <class T>
class ScalarMarching {
 public:
  ScalarMarching(const BasicScalarEquation<T>& equation, T tolerance, T relaxation, Roots& roots)
      : equation_(equation),
        tolerance_(tolerance * std::max(std::fabs(equation.lo), std::fabs(equation.hi))),
        longest_((equation.hi - equation.lo) * kLongest),
        relaxation_(relaxation),
        roots_(roots) {}

  void run() {
    Point here = point_at(equation_.lo);
    while (!is_complete()) {
      if (roots_.counters.evaluations >= SphereTracing::kSteps) {
        roots_.status = Status::failed;
        break;
      }
      if (slices::is_root(here.x, here.jet)) here = pass_root(here);
      if (here.x >= equation_.hi) break;
      here = advance(here);
    }
    sort_and_clip();
  }

 private:
  /// Longest step, in parts of the interval: where f' and f'' nearly vanish together they say nothing.
  static constexpr T kLongest = T{1} / 8;

  struct Point {
    T x;
    BasicJet<T> jet;
    T radius;  // no root nearer, by f, f' and f''
  };

  BasicJet<T> jet_at(T x) {
    ++roots_.counters.evaluations;
    return equation_(x);
  }

  /// |f| - |f'| r - |f''| r^2 = 0: Taylor's remainder with twice its f'', for f'' changes on the way.
  Point point_at(T x) {
    const BasicJet<T> jet = jet_at(x);
    const T slope = std::fabs(jet.df / jet.f), curvature = std::fabs(jet.ddf / jet.f);
    const T radius = 2 / (slope + std::sqrt(slope * slope + 4 * curvature));
    return {x, jet, radius >= 0 ? std::min(radius, longest_) : T{0}};
  }

  /// x + step, at least a little further than x, at most hi.
  [[nodiscard]] T ahead(T x, T step) const {
    const T least = std::max(tolerance_, 2 * std::numeric_limits<T>::epsilon() * std::fabs(x));
    return std::min(std::max(x + step, std::nextafter(x + least, equation_.hi)), equation_.hi);
  }
  [[nodiscard]] bool is_complete() const {
    return equation_.max_roots > 0 && roots_.list.size() >= static_cast<std::size_t>(equation_.max_roots);
  }

  /// One step, longer than the bound by `relaxation` as long as the spheres of both ends overlap (Keinert).
  Point advance(const Point& here) {
    ++roots_.counters.iterations;
    Point next = point_at(ahead(here.x, relaxation_ * here.radius));
    const bool overlap = next.x - here.x <= here.radius + next.radius;
    if (!overlap && !changes_sign(here, next)) next = point_at(ahead(here.x, here.radius));
    if (changes_sign(here, next) && !slices::is_root(next.x, next.jet)) add_between(here, next);
    return next;
  }

  static bool changes_sign(const Point& a, const Point& b) {
    return (a.jet.f < 0 && b.jet.f > 0) || (a.jet.f > 0 && b.jet.f < 0);
  }

  /// The step passed a root: a bracket.
  void add_between(const Point& a, const Point& b) {
    const auto f = [this](T x) { return jet_at(x).f; };
    const auto resolution = [this](T x) {
      return std::max(tolerance_, 2 * std::numeric_limits<T>::epsilon() * std::fabs(x));
    };
    constexpr int kBudget = 400;  // more than bisection of any bracket to neighbouring numbers near its end
    const auto end =
        bracket::chandrupatla(f, bracket::Bracket<T>{a.x, b.x, a.jet.f, b.jet.f}, resolution, kBudget);
    const T x = end.best();
    Root root = from_starts::root_at(x, jet_at(x), equation_.lo, equation_.hi);
    root.radius += static_cast<double>(end.b - end.a);
    slices::add_distinct(roots_, root);
  }

  /// Lists the root within whose noise x lies, and goes on where f is noise no more.
  Point pass_root(const Point& here) {
    Root root;
    const auto f = [this](T x) { return jet_at(x); };
    const bool found =
        from_starts::descend(f, here.x, equation_.lo, equation_.hi, NewtonStep{}, root, roots_.counters);
    if (found) slices::add_distinct(roots_, root);
    T step = found ? static_cast<T>(root.x + root.radius) - here.x : tolerance_;
    Point next = here;
    while (next.x < equation_.hi && slices::is_root(next.x, next.jet) &&
           roots_.counters.evaluations < SphereTracing::kSteps) {
      next = point_at(ahead(next.x, step));
      step = 2 * std::max(step, next.x - here.x);
    }
    return next;
  }

  void sort_and_clip() {
    std::sort(roots_.list.begin(), roots_.list.end(), [](const Root& a, const Root& b) { return a.x < b.x; });
  }

  const BasicScalarEquation<T>& equation_;
  T tolerance_, longest_, relaxation_;
  Roots& roots_;
};

bool is_interval(double lo, double hi) { return std::isfinite(lo) && std::isfinite(hi) && lo <= hi; }

double checked(const char* name, double value, double lo, double hi) {
  if (!(lo <= value && value < hi))
    throw std::invalid_argument(std::string("sphere_tracing: ") + name + " must be at least " +
                                std::to_string(lo) + " and below " + std::to_string(hi));
  return value;
}

}  // namespace

SolverInfo SphereTracing::info() {
  SolverInfo info;
  info.summary = "steps by a bound of how far the next root must be";
  info.source = "Hart, The Visual Computer 12 (1996); Kalra, Barr 1989; Keinert et al. 2014";
  info.page = "solvers/sphere_tracing.md";
  info.options = {{"tolerance", "2^-44", "width of a root, times the largest |x| asked for"},
                  {"relaxation", "1.2", "step over the bound, scalar form: from 1 to below 2"},
                  {"budget", "20000", "evaluations before it says uncertain, interval form"}};
  info.claims = {.finds_touching_roots = false, .certified = false, .deterministic = true};
  info.forms = {Form::interval, Form::scalar};
  return info;
}

SphereTracing::SphereTracing(const Parameters& options)
    : tolerance_(checked("tolerance", options.number("tolerance", inclusion::kDefaultEps), 0, 1)),
      relaxation_(checked("relaxation", options.number("relaxation", 1.2), 1, 2)),
      budget_(static_cast<std::uint32_t>(options.integer("budget", 20000, 10, 1000000000))) {}

void SphereTracing::solve(const IntervalEquation& equation, Roots& roots) const {
  if (!is_interval(equation.lo, equation.hi)) {
    roots.status = Status::invalid;
    return;
  }
  const double scale = mag({equation.lo, equation.hi});
  const Region whole{detail::kInfinity, tolerance_ * scale};
  Epsilons epsilons = equation.epsilons;
  if (epsilons.parts.empty()) epsilons.parts = {&whole, 1};
  const InclusionFunction function{equation};
  Marching(function, epsilons, scale, budget_, roots).march({equation.lo, equation.hi});
}

template <class T>
void SphereTracing::solve(const BasicScalarEquation<T>& equation, Roots& roots) const {
  if (!is_interval(static_cast<double>(equation.lo), static_cast<double>(equation.hi))) {
    roots.status = Status::invalid;
    return;
  }
  ScalarMarching<T>(equation, static_cast<T>(tolerance_), static_cast<T>(relaxation_), roots).run();
}

template void SphereTracing::solve(const BasicScalarEquation<double>&, Roots&) const;
template void SphereTracing::solve(const BasicScalarEquation<float>&, Roots&) const;

}  // namespace graze
