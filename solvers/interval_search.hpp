// What searches by inclusion functions share: the stack of intervals, epsilons by region, the count of
// roots where f is monotone, and the refinement of a proved root.
//
// solves    nothing by itself: a method derives from IntervalSearch and says how one interval is examined
// needs     `Function` with value(Interval) and derivative(Interval), inclusions of f and f'
// returns   roots that are proved; status uncertain where an interval is given up
// error     radius proved; at most half the epsilon of the root's region, or half the grazing epsilon
//           where rounding hides the signs within the former
// cost      no allocation beyond the answer's own
// source    Moore, Kearfott, Cloud, "Introduction to Interval Analysis", SIAM 2009, ch. 8
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/roots.hpp>

namespace graze::inclusion {

/// Widths below which an interval is given up, times the largest |x| asked for, where the equation brings
/// none of its own: for a simple root, and where the slope may vanish.
inline constexpr double kDefaultEps = 0x1p-44;
inline constexpr double kDefaultGrazingEps = 0x1p-24;

enum class Sign : int { negative = -1, unknown = 0, positive = 1 };

inline Sign sign(Interval f) { return f.lo > 0 ? Sign::positive : f.hi < 0 ? Sign::negative : Sign::unknown; }

/// The search for one equation. `Method` derives from it and gives examine(Interval).
template <class Method, class Function>
class IntervalSearch {
 public:
  IntervalSearch(const Function& function, Epsilons epsilons, double scale, std::uint32_t budget,
                 Roots& roots)
      : function_(function), epsilons_(epsilons), scale_(scale), budget_(budget), roots_(roots) {}

  /// Depth first from the left, so that roots come out in ascending order.
  void run(Interval domain) {
    push(domain);
    while (depth_ > 0) {
      if (roots_.counters.evaluations >= budget_) {
        roots_.status = Status::uncertain;
        return;
      }
      static_cast<Method*>(this)->examine(stack_[--depth_]);
    }
  }

 protected:
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
  Interval derivative(Interval x) {
    ++roots_.counters.evaluations;
    return function_.derivative(x);
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
    // Rising from above zero or falling from below it leaves no room for a root; one end is enough to
    // know.
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

  /// Bisects x, which holds exactly one root, down to its part's epsilon, or as far as the signs can be
  /// told.
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
    add_proved(x, eps);
  }

  /// x holds exactly one root. Uncertain if it is wider than it may be and doubles between remain.
  void add_proved(Interval x, double eps) {
    const double centre = mid(x);
    const double radius = std::max(sub_up(x.hi, centre), sub_up(centre, x.lo));
    roots_.list.push_back(
        {.x = centre, .others = {}, .radius = radius, .multiplicity = 1, .certified = true});
    const bool neighbours = std::nextafter(x.lo, x.hi) >= x.hi;
    if (width(x) > std::max(eps, grazing_epsilon()) && !neighbours) roots_.status = Status::uncertain;
  }

  /// f(m) is zero within rounding: the smallest window about m, from eps up, whose ends have signs that
  /// prove the root inside. Where the slope is shallow rounding hides the signs further out: up to the
  /// grazing eps. Three quarters of the size aimed at, so that the rounding of the ends cannot make it
  /// wider.
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
    double eps = kDefaultEps * scale_;
    for (const Region& part : epsilons_.parts) {
      eps = part.eps;
      if (mid(x) <= part.end) break;
    }
    return eps;
  }
  [[nodiscard]] double grazing_epsilon() const {
    return epsilons_.grazing_eps > 0 ? epsilons_.grazing_eps : kDefaultGrazingEps * scale_;
  }

  const Function& function_;
  Epsilons epsilons_;
  double scale_;
  std::uint32_t budget_;
  Roots& roots_;
  std::size_t depth_ = 0;
  std::array<Interval, kDepth> stack_;
};

/// The functions of form interval.
struct InclusionFunction {
  const IntervalEquation& equation;
  [[nodiscard]] Interval value(Interval x) const { return equation.value(equation.self, x); }
  [[nodiscard]] Interval derivative(Interval x) const { return equation.derivative(equation.self, x); }
};

}  // namespace graze::inclusion
