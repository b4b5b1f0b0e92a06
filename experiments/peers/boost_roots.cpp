#include <graze/experiments/peers/boost_roots.hpp>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <tuple>
#include <utility>

#include <boost/math/tools/roots.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include <graze/solvers/from_starts.hpp>
#include <graze/solvers/math/polynomial.hpp>

namespace graze::boost_roots {

namespace {

constexpr int kDigits = std::numeric_limits<double>::digits;
/// Evaluations for one root: as many as our own `bracketed` may take.
constexpr std::uintmax_t kBudget = 300;

/// A point of the curve.
struct Sample {
  double x;
  Jet jet;
};

/// Where a method ended: the root lies in [lo, hi].
using Bracket = std::pair<double, double>;

/// Boost's manual: the last bits cost steps and are rarely right, so three fewer are asked of a bracket.
constexpr int kBracketDigits = kDigits - 3;
using BracketTolerance = boost::math::tools::eps_tolerance<double>;
/// The width that this asks for, relative to x.
constexpr double kBracketWidth = 0x1p-49;
static_assert(kBracketDigits == 50);

}  // namespace

struct Toms748 {
  static constexpr std::string_view kSummary = "Boost's toms748_solve on each change of sign";
  template <class F>
  static Bracket refine(const F& f, const Sample& a, const Sample& b) {
    std::uintmax_t steps = kBudget;
    return boost::math::tools::toms748_solve([&](double x) { return f(x).f; }, a.x, b.x, a.jet.f, b.jet.f,
                                             BracketTolerance(kBracketDigits), steps);
  }
};

struct Bisect {
  static constexpr std::string_view kSummary = "Boost's bisect on each change of sign";
  template <class F>
  static Bracket refine(const F& f, const Sample& a, const Sample& b) {
    std::uintmax_t steps = kBudget;
    return boost::math::tools::bisect([&](double x) { return f(x).f; }, a.x, b.x,
                                      BracketTolerance(kBracketDigits), steps);
  }
};

struct NewtonRaphson {
  static constexpr std::string_view kSummary = "Boost's newton_raphson_iterate on each change of sign";
  /// Boost's manual: 0.6 of the digits, since the last step doubles those that are right.
  static constexpr int kAsked = static_cast<int>(0.6 * kDigits);
  template <class F>
  static Bracket refine(const F& f, const Sample& a, const Sample& b) {
    const auto value_and_slope = [&](double x) {
      const Jet jet = f(x);
      return std::make_pair(jet.f, jet.df);
    };
    std::uintmax_t steps = kBudget;
    const double x = boost::math::tools::newton_raphson_iterate(value_and_slope, a.x + (b.x - a.x) / 2, a.x,
                                                                b.x, kAsked, steps);
    return {x, x};
  }
};

struct HalleyIterate {
  static constexpr std::string_view kSummary = "Boost's halley_iterate on each change of sign";
  /// Boost's manual: 0.4 of the digits, since the last step triples those that are right.
  static constexpr int kAsked = static_cast<int>(0.4 * kDigits);
  template <class F>
  static Bracket refine(const F& f, const Sample& a, const Sample& b) {
    const auto value_and_two_slopes = [&](double x) {
      const Jet jet = f(x);
      return std::make_tuple(jet.f, jet.df, jet.ddf);
    };
    std::uintmax_t steps = kBudget;
    const double x = boost::math::tools::halley_iterate(value_and_two_slopes, a.x + (b.x - a.x) / 2, a.x, b.x,
                                                        kAsked, steps);
    return {x, x};
  }
};

namespace {

/// The peer's root of one change of sign.
template <class Method, class F>
void add_change_of_sign(const F& f, const Sample& a, const Sample& b, double reach, Roots& roots) {
  try {
    const auto [lo, hi] = Method::refine(f, a, b);
    if (!(hi - lo <= kBracketWidth * reach)) roots.status = Status::failed;
    roots.list.push_back(found_root(lo + (hi - lo) / 2, (hi - lo) / 2, 1));
  } catch (const std::exception&) {  // how Boost says that it found none
    roots.status = Status::failed;
  }
}

/// Roots of f in [lo, hi], both finite, ascending; `max_roots` > 0: no more than those.
template <class Method, class F>
void search(const F& f, double lo, double hi, int pieces, int max_roots, Roots& roots) {
  const auto is_complete = [&] {
    return max_roots > 0 && roots.list.size() >= static_cast<std::size_t>(max_roots);
  };
  const double reach = std::max(std::fabs(lo), std::fabs(hi));
  const auto add_if_zero = [&](const Sample& at) {
    if (at.jet.f == 0) roots.list.push_back(found_root(at.x, 0.0, 1));
  };
  Sample a{lo, f(lo)};
  add_if_zero(a);
  for (int i = 1; i <= pieces && !is_complete() && lo < hi; ++i) {
    const double x = i == pieces ? hi : lo + (hi - lo) * i / pieces;
    const Sample b{x, f(x)};
    if ((a.jet.f < 0 && b.jet.f > 0) || (a.jet.f > 0 && b.jet.f < 0))
      add_change_of_sign<Method>(f, a, b, reach, roots);
    add_if_zero(b);
    a = b;
  }
}

}  // namespace

template <class Method>
SolverInfo BoostSearch<Method>::info() {
  SolverInfo info;
  info.summary = Method::kSummary;
  info.source = "Boost.Math 1.81, root finding";
  info.page = "experiments/peers/README.md";
  info.options = {{"pieces", "32", "uniform pieces in which changes of sign are looked for"}};
  info.claims = {.finds_touching_roots = false, .certified = false, .deterministic = true};
  info.forms = {Form::scalar, Form::polynomial};
  return info;
}

template <class Method>
BoostSearch<Method>::BoostSearch(const Parameters& options)
    : pieces_(options.integer("pieces", 32, 1, 1000000)) {}

template <class Method>
void BoostSearch<Method>::solve(const PolynomialEquation& equation, Roots& roots) const {
  power_basis::solve(equation, roots, [this](const power_basis::Problem<double>& problem, Roots& found) {
    const double bound = root_bound(problem.c);
    const double lo = std::max(problem.lo, -bound), hi = std::min(problem.hi, bound);
    if (!std::isfinite(lo) || !std::isfinite(hi)) found.status = Status::failed;
    if (!(lo <= hi) || found.status != Status::ok) return;
    const auto f = [&](double x) {
      ++found.counters.evaluations;
      return from_starts::polynomial_jet(problem.c, problem.c_error, x);
    };
    search<Method>(f, lo, hi, pieces_, 0, found);
  });
}

template <class Method>
void BoostSearch<Method>::solve(const ScalarEquation& equation, Roots& roots) const {
  if (!std::isfinite(equation.lo) || !std::isfinite(equation.hi) || !(equation.lo <= equation.hi)) {
    roots.status = Status::invalid;
    return;
  }
  const auto f = [&](double x) {
    ++roots.counters.evaluations;
    return equation(x);
  };
  search<Method>(f, equation.lo, equation.hi, pieces_, equation.max_roots, roots);
}

template class BoostSearch<Toms748>;
template class BoostSearch<Bisect>;
template class BoostSearch<NewtonRaphson>;
template class BoostSearch<HalleyIterate>;

}  // namespace graze::boost_roots
