#include <graze/solvers/exact_roots.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <graze/solvers/math/chebyshev.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/math/scaling.hpp>

namespace graze {
namespace {

/// The coefficients without error, in the equation's basis; false: not known.
bool exact_coefficients(const PolynomialEquation& equation, std::vector<Dyadic>& c) {
  c.resize(equation.c.size());
  if (equation.exact.get != nullptr) {
    equation.exact.get(equation.exact.self, c);
    return true;
  }
  std::transform(equation.c.begin(), equation.c.end(), c.begin(), [](double x) { return Dyadic(x); });
  return effective_degree(equation.c_error) < 0;
}

/// The power coefficients of a polynomial in the Chebyshev basis.
std::vector<Dyadic> from_chebyshev(std::span<const Dyadic> c) {
  std::vector<Dyadic> power(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    for (std::size_t k = i; k < c.size(); ++k) power[i] += Dyadic(chebyshev_power_weight(i, k)) * c[k];
  }
  return power;
}

/// width^n p((x - start) / width) for p of degree n: Horner's rule in x - start.
std::vector<Dyadic> in_powers_of_x(std::span<const Dyadic> p, const Dyadic& start, const Dyadic& width) {
  std::vector<Dyadic> c;
  Dyadic weight(1.0);
  for (std::size_t k = p.size(); k-- > 0; weight *= width) {
    c.insert(c.begin(), Dyadic());
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= start * c[i + 1];
    c[0] += weight * p[k];
  }
  return c;
}

/// A root and the double that its l gets.
struct Placed {
  RealRoot root;
  double l;
  int side;  ///< of the exact l, seen from the double
  std::uint32_t multiplicity;
};

/// Appends a root that is greater than those before it, apart from them in l where an ulp allows it.
void place(RealRoot root, const Dyadic& origin, std::vector<Placed>& placed) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double l = root.to_double_from(origin);
  const int side = std::isfinite(l) ? root.compare_with(Dyadic(l) - origin) : 0;
  const auto multiplicity = static_cast<std::uint32_t>(root.multiplicity());
  Placed next{std::move(root), l, side, multiplicity};
  if (!placed.empty() && l <= placed.back().l) {
    Placed& last = placed.back();
    const double below = std::nextafter(l, -kInfinity);
    const bool is_room = placed.size() == 1 || placed[placed.size() - 2].l < below;
    if (last.l == l && side >= 0) {
      next.l = std::nextafter(l, kInfinity);
      next.side = -1;
    } else if (last.l == l && is_room) {
      last.l = below;
      last.side = 1;
    } else {
      last.multiplicity += multiplicity;
      return;
    }
  }
  placed.push_back(std::move(next));
}

/// x is the double nearest to the root, and the tail what l needs beside it; where l is much smaller than
/// origin and x, x is taken from l, whose digits are the finer ones.
Root root_of(Placed& placed, double origin) {
  const DoubleDouble from_l = two_sum(placed.l, -origin);
  Root root{.x = from_l.hi,
            .others = {},
            .radius = 0,
            .multiplicity = placed.multiplicity,
            .certified = true,
            .tail = from_l.lo,
            .placed = true,
            .side = placed.side};
  if (origin != 0) {
    const double nearest = placed.root.to_double();
    if (ulp(nearest) < ulp(placed.l)) {
      root.x = nearest;
      root.tail = (from_l.hi - nearest) + from_l.lo;
    }
  }
  const bool is_exact = placed.root.is_exact() && placed.root.lo() == Dyadic(root.x);
  root.radius = is_exact ? 0 : 2 * ulp(root.x);
  return root;
}

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

/// Gives the root its tail where one step proves its place.
bool place_by(const Interval& step, const PolynomialEquation& equation, Root& root) {
  const double tail = mid(step);
  const DoubleDouble l = two_sum(equation.exact.origin, root.x);
  const double rounded = l.hi + (l.lo + tail);
  const Interval rest = ((point(l.hi) - point(rounded)) + point(l.lo)) + step;
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

}  // namespace

double place_of(const PolynomialEquation& equation, const Root& root) {
  // As the scene adds them.
  const DoubleDouble l = two_sum(equation.exact.origin, root.x);
  return root.tail == 0 ? l.hi : l.hi + (l.lo + root.tail);
}

bool place_root(const PolynomialEquation& equation, Root& root) {
  if (equation.basis != Basis::power || root.multiplicity != 1) return false;
  constexpr int kSteps = 3;  // each squares the relative error; shallow roots begin with few digits
  Root moved = root;
  for (int i = 0; i < kSteps; ++i) {
    const auto step = step_to_root(equation, moved);
    if (!step) return false;
    if (place_by(*step, equation, moved)) {
      root = moved;
      return true;
    }
    const Interval enclosure = point(moved.x) + *step;
    moved.x = std::clamp(mid(enclosure), equation.lo, equation.hi);
    moved.radius = std::max(sub_up(enclosure.hi, moved.x), sub_up(moved.x, enclosure.lo));
  }
  return false;
}

std::optional<ExactPolynomial> exact_polynomial(const PolynomialEquation& equation) {
  std::vector<Dyadic> c;
  if (!exact_coefficients(equation, c)) return std::nullopt;
  if (equation.basis == Basis::power) return ExactPolynomial(c);
  if (equation.lo == equation.hi) return std::nullopt;  // no basis at all
  const Dyadic lo(equation.lo), width = Dyadic(equation.hi) - lo, half(0.5);
  if (equation.basis == Basis::chebyshev) {
    // T_i over [-1, 1]: x = middle + u width / 2.
    return ExactPolynomial(in_powers_of_x(from_chebyshev(c), lo + half * width, half * width));
  }
  const ExactPolynomial p = ExactPolynomial::from_bernstein(c);
  std::vector<Dyadic> power;
  for (const BigInteger& x : p.coefficients()) power.emplace_back(x);
  return ExactPolynomial(in_powers_of_x(power, lo, width));
}

void add_exact_roots(const ExactPolynomial& p, const PolynomialEquation& equation, Roots& roots) {
  roots.status = p.is_zero() ? Status::coincident : Status::ok;
  const Dyadic origin(equation.exact.origin);
  std::vector<Placed> placed;
  for (RealRoot& root : isolate_roots(p, dyadic_interval(equation.lo, equation.hi)))
    place(std::move(root), origin, placed);
  for (Placed& one : placed) {
    if (std::isfinite(one.l)) roots.list.push_back(root_of(one, equation.exact.origin));
  }
}

}  // namespace graze
