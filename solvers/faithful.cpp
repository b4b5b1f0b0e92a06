#include <graze/solvers/faithful.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include <graze/solvers/exact_roots.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/polynomial.hpp>

namespace graze {
namespace {

/// As Counters::tier reports them.
enum Tier : std::uint32_t { kDoubleDouble = 2, kExact = 3 };

/// Coefficient i to twice a double's digits; none where nobody knows it.
std::optional<DoubleDoubleBall> near_coefficient(const PolynomialEquation& equation, std::size_t i) {
  if (!equation.exact.near.empty()) return equation.exact.near[i];
  if (!equation.c_error.empty() && equation.c_error[i] != 0) return std::nullopt;
  return DoubleDoubleBall(equation.c[i]);
}

/// p(x) enclosed in double-double; none where the coefficients are not known so well.
std::optional<Interval> residual_at(const PolynomialEquation& equation, double x) {
  DoubleDoubleBall p;
  const DoubleDoubleBall at(x);
  for (std::size_t i = equation.c.size(); i-- > 0;) {
    const auto c = near_coefficient(equation, i);
    if (!c) return std::nullopt;
    p = p * at + *c;
  }
  return p.enclosure();
}

/// root - x for a root that lies alone within its radius: an interval Newton step (mean value theorem).
std::optional<Interval> step_to_root(const PolynomialEquation& equation, const Root& root) {
  const auto residual = residual_at(equation, root.x);
  if (!residual) return std::nullopt;
  const Interval slope = evaluate_derivative(equation.c, equation.c_error, ball(root.x, root.radius));
  const Interval step = -*residual / slope;
  if (!std::isfinite(width(step))) return std::nullopt;
  return step;
}

/// Whether l, which is off by `rest`, is within three quarters of the way to its neighbours: then within 1
/// ulp of the exact l, and on its side of zero.
bool is_faithful(double l, const Interval& rest) {
  constexpr double kShare = 0.75, kInfinity = std::numeric_limits<double>::infinity();
  return std::isfinite(l) && l != 0 && rest.lo >= -kShare * (l - std::nextafter(l, -kInfinity)) &&
         rest.hi <= kShare * (std::nextafter(l, kInfinity) - l);
}

/// Gives the root its tail; false where its place is not proved.
bool place(const PolynomialEquation& equation, Root& root) {
  if (root.multiplicity != 1) return false;
  const auto step = step_to_root(equation, root);
  if (!step) return false;
  const double tail = mid(*step);
  // As the scene adds them.
  const DoubleDouble l = two_sum(equation.exact.origin, root.x);
  const double rounded = l.hi + (l.lo + tail);
  const Interval rest = ((point(l.hi) - point(rounded)) + point(l.lo)) + *step;
  if (!is_faithful(rounded, rest)) return false;
  root.side = rest.lo > 0 ? 1 : rest.hi < 0 ? -1 : 0;
  // A root alone in its equation may share l with another equation's: which neighbour it may move to must be
  // known.
  if (equation.c.size() == 2 && root.side == 0 && rest != Interval{}) {
    const std::optional<ExactPolynomial> exact = exact_polynomial(equation);
    if (!exact || exact->degree() != 1) return false;
    const int sign = exact->sign_at(Dyadic(rounded) - Dyadic(equation.exact.origin));
    root.side = -sign * exact->leading().sign();
  }
  root.tail = tail;
  root.placed = true;
  return true;
}

/// Places every root in double-double; false where one is not proved, or two get the same l.
bool place_all(const PolynomialEquation& equation, std::span<Root> roots) {
  if (equation.basis != Basis::power) return false;
  double last = -std::numeric_limits<double>::infinity();
  for (Root& root : roots) {
    if (!place(equation, root)) return false;
    const DoubleDouble sum = two_sum(equation.exact.origin, root.x);
    const double l = sum.hi + (sum.lo + root.tail);
    if (!(l > last)) return false;
    last = l;
  }
  return true;
}

/// Proved roots whose digits are not proved are no answer.
void doubt_digits(Roots& roots) {
  const auto is_placed = [](const Root& root) { return root.placed || root.radius == 0; };
  if (roots.status == Status::ok && !std::all_of(roots.list.begin(), roots.list.end(), is_placed))
    roots.status = Status::uncertain;
}

}  // namespace

SolverInfo Faithful::info() {
  SolverInfo info = Certified::info();
  info.summary = "every root, its l within 1 ulp: certified, then the digits of the exact root";
  info.source = "graze (solvers/faithful.md)";
  info.page = "solvers/faithful.md";
  info.digits = Digits::placed;
  return info;
}

Faithful::Faithful(const Parameters& options) : certified_(options) {}

void Faithful::solve(const PolynomialEquation& equation, Roots& roots) const {
  certified_.solve(equation, roots);
  if (roots.status == Status::invalid || roots.status == Status::coincident) return;
  if (roots.counters.tier == kExact || (roots.status == Status::ok && roots.list.empty())) return;
  if (roots.status == Status::ok && place_all(equation, roots.list)) {
    roots.counters.tier = kDoubleDouble;
    return;
  }
  const std::optional<ExactPolynomial> exact = exact_polynomial(equation);
  if (!exact) return doubt_digits(roots);
  roots.list.clear();
  roots.counters.tier = kExact;
  add_exact_roots(*exact, equation, roots);
}

void Faithful::solve(const IntervalEquation& equation, Roots& roots) const {
  certified_.solve(equation, roots);
  doubt_digits(roots);
}

}  // namespace graze
