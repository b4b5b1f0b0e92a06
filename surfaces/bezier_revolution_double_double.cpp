#include <graze/surfaces/bezier_revolution_double_double.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/big_integer.hpp>

namespace graze {
namespace {

using Ball = DoubleDoubleBall;

constexpr std::size_t kSize = 2 * BezierDoubleDouble::kMaxDegree + 1;
constexpr double kLeastPart = 0x1p-900;  // below, low parts of products and quotients may underflow
constexpr double kRelative = 0x1p-103;   // 8 u^2: over the 5 u^2 of a product, the 3 u^2 of a quotient
constexpr double kSlack = 1 + 0x1p-49;   // the bound's own roundings
constexpr double kMostError = 0x1p-54;   // of l, in units of l and the body's size
// A level line's |d_xz| is at least 1 and R at most 2, so that the body lies within 2 of the closest
// approach, and that within 2^-50 |centre| of the centre.
constexpr double kReach = 4, kMostCentre = 0x1p50;

/// a b, exact but for underflow.
Ball exact_product(double a, double b) {
  if (a == 0 || b == 0) return {};
  const DoubleDouble product = two_prod(a, b);
  return {product, std::fabs(product.hi) < kLeastPart ? 0x1p-1000 : 0};
}

Ball quotient(const Ball& x, double y) {
  if (x.is_exact_zero()) return {};
  const DoubleDouble q = x.value() / y;
  const double error = kSlack * (x.error() / std::fabs(y) + kRelative * std::fabs(q.hi));
  return {q, std::fabs(q.hi) < kLeastPart ? std::max(error, 0x1p-900) : error};
}

/// Needs: y apart from zero.
Ball quotient(const Ball& x, const Ball& y) {
  const DoubleDouble q = x.value() / y.value();
  const double size = std::fabs(q.hi), least = std::fabs(y.value().hi) - 2 * y.error();
  // 15 u^2 of the division.
  return {q, kSlack * ((x.error() + size * y.error()) / least + 4 * kRelative * size)};
}

/// Needs: x > 0.
Ball root(const Ball& x) {
  const DoubleDouble r = sqrt(x.value());
  return {r, kSlack * (x.error() / r.hi + kRelative * r.hi)};
}

/// A bound of |x|.
double most(const Ball& x) { return kSlack * (std::fabs(x.value().hi) + x.error()); }

/// -1, 1, or 0 where that is not known.
int sign_of(const Ball& x) { return x.contains_zero() ? 0 : x.value().hi < 0 ? -1 : 1; }

/// sum a_i t^i (1 - t)^(n - i): Bernstein coefficients times their binomials, Horner in 1 - t.
Ball evaluate(std::span<const Ball> a, const Ball& t) {
  const Ball s = Ball(1.0) - t;
  Ball sum = a[0], power = t;
  for (std::size_t i = 1; i < a.size(); ++i) {
    sum = sum * s + a[i] * power;
    power *= t;
  }
  return sum;
}

/// A place s of a cell, counted from the nearer end: 1 - s keeps its digits.
struct Place {
  double from_end = 0.5;
  bool is_left = true;
};

/// A polynomial in s on [0, 1], t = lo + length s.
struct Cell {
  std::array<Ball, kSize> c;
  std::size_t size = 0;
  Ball lo, length;
  int bends = 0;  ///< splits at an extremum since the last one at the middle

  [[nodiscard]] std::span<const Ball> coefficients() const { return {c.data(), size}; }
};

/// Changes of sign, fewest and most within the bounds.
SignVariations variations(const Cell& cell) {
  int changes = 0, last = 0;
  bool is_sure = true;
  for (const Ball& x : cell.coefficients()) {
    const int sign = sign_of(x);
    is_sure = is_sure && (sign != 0 || x.is_exact_zero());
    if (!is_sure) break;
    if (sign == 0) continue;
    changes += last != 0 && sign != last ? 1 : 0;
    last = sign;
  }
  if (is_sure) return {changes, changes};
  std::array<double, kSize> value, error;
  for (std::size_t i = 0; i < cell.size; ++i) {
    value[i] = cell.c[i].value().hi;
    error[i] = kSlack * (cell.c[i].error() + std::fabs(cell.c[i].value().lo));
  }
  return sign_variations(std::span(value).first(cell.size), std::span(error).first(cell.size));
}

/// Value and slope of Bernstein coefficients in double: de Casteljau, of which no bound is asked.
struct Slope {
  double value = 0, slope = 0;
};
Slope slope_at(std::span<const double> b, double s) {
  std::array<double, kSize> work;
  std::copy(b.begin(), b.end(), work.begin());
  std::size_t size = b.size();
  for (; size > 2; --size) {
    for (std::size_t i = 0; i + 1 < size; ++i) work[i] += s * (work[i + 1] - work[i]);
  }
  if (size == 1) return {work[0], 0};
  const double rise = work[1] - work[0];
  return {work[0] + s * rise, static_cast<double>(b.size() - 1) * rise};
}

/// Where the control polygon crosses zero. Needs: a change of sign between the ends.
double polygon_root(std::span<const double> b) {
  std::size_t k = 0;
  while (k + 2 < b.size() && (b[k] < 0) == (b[k + 1] < 0)) ++k;
  const double share = b[k] / (b[k] - b[k + 1]);
  return (static_cast<double>(k) + share) / static_cast<double>(b.size() - 1);
}

/// The least positive root of the parabola that b osculates at 0, if it is below `most`; else `most`. One of
/// two roots that are close is that near to it, where Newton's method would come down by halves.
double parabola_root(std::span<const double> b, double most) {
  if (b.size() < 3) return most;
  const auto n = static_cast<double>(b.size() - 1);
  const double c0 = b[0], c1 = n * (b[1] - b[0]), c2 = 0.5 * n * (n - 1) * (b[2] - 2 * b[1] + b[0]);
  const double discriminant = c1 * c1 - 4 * c0 * c2;
  if (!(discriminant >= 0)) return most;
  const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
  for (const double s : {q / c2, c0 / q}) {
    if (s > 0 && s < most) most = s;
  }
  return most;
}

/// About the root of b in (0, 1) where its sign changes, by Newton's method within a bracket. Needs: a change
/// of sign between the ends.
double approximate_root(std::span<const double> b) {
  constexpr int kSteps = 60;
  double lo = 0, hi = 1;
  double s = parabola_root(b, polygon_root(b));
  for (int step = 0; step < kSteps; ++step) {
    if (!(s > lo && s < hi)) s = 0.5 * (lo + hi);
    const Slope here = slope_at(b, s);
    if (here.value == 0) return s;
    ((here.value < 0) == (b.front() < 0) ? lo : hi) = s;
    const double next = s - here.value / here.slope;
    if (std::fabs(next - s) <= 0x1p-50 * s) return next > lo && next < hi ? next : s;
    s = next;
  }
  return s;
}

/// The same, from the nearer end. `b` is turned round for the right one.
Place place_of_root(std::span<double> b) {
  constexpr double kMiddle = 0.5, kFar = 0.75;
  Place place{0, polygon_root(b) <= kMiddle};
  if (!place.is_left) std::reverse(b.begin(), b.end());
  place.from_end = approximate_root(b);
  if (place.from_end <= kFar) return place;
  std::reverse(b.begin(), b.end());
  return {approximate_root(b), !place.is_left};
}

/// Where the cell is split: at its extremum if it seems to have one, so that a pair of roots parts, or none
/// is left; at its middle if that does not help.
Place place_to_split(const Cell& cell, int changes) {
  constexpr int kMostBends = 2;
  if (changes != 2 || cell.bends == kMostBends || cell.size < 3) return {};
  std::array<double, kSize> rises;
  for (std::size_t i = 0; i + 1 < cell.size; ++i) rises[i] = (cell.c[i + 1].value() - cell.c[i].value()).hi;
  const auto b = std::span<double>(rises).first(cell.size - 1);
  if ((b.front() < 0) == (b.back() < 0)) return {};
  const Place place = place_of_root(b);
  return place.from_end > 0 && place.from_end < 1 ? place : Place();
}

/// near + share (far - near), 0 < share < 1. Errors are mixed as the values are: 3 and 2 u^2 of the second
/// term, 3 of the sum.
Ball mix(const Ball& near, const Ball& far, double share) {
  const DoubleDouble part = (far.value() - near.value()) * share, sum = near.value() + part;
  const double rounding = kRelative * (std::fabs(part.hi) + std::fabs(sum.hi));
  const double floor = std::fabs(part.hi) < kLeastPart ? 0x1p-1000 : 0;
  return {sum, kSlack * ((1 - share) * near.error() + share * far.error() + rounding) + floor};
}

/// de Casteljau at a place, which is exact: `cell` becomes the right part, `left` the left one.
void split(Cell& cell, const Place& place, Cell& left) {
  const Ball share(place.from_end), other = Ball(1.0) - share;
  left.size = cell.size;
  left.c[0] = cell.c[0];
  for (std::size_t level = 1; level < cell.size; ++level) {
    for (std::size_t i = 0; i + level < cell.size; ++i) {
      const Ball &a = cell.c[i], &b = cell.c[i + 1];
      cell.c[i] = place.is_left ? mix(a, b, place.from_end) : mix(b, a, place.from_end);
    }
    left.c[level] = cell.c[0];
  }
  left.lo = cell.lo;
  left.length = cell.length * (place.is_left ? share : other);
  cell.lo += left.length;
  cell.length *= place.is_left ? other : share;
  left.bends = cell.bends = place.from_end == 0.5 ? 0 : cell.bends + 1;
}

bool is_below(const Ball& a, const Ball& b) { return sign_of(b - a) > 0; }

/// Calls add_root(cell) for cells with one root each, which are all roots in [0, 1]; false where they are not
/// told apart, or a root may be an end.
template <class AddRoot>
bool isolate(const Cell& whole, const AddRoot& add_root) {
  constexpr std::size_t kStack = 24;
  constexpr int kMostCells = 100;
  if (sign_of(whole.c[0]) == 0 || sign_of(whole.c[whole.size - 1]) == 0) return false;
  std::array<Cell, kStack> open;
  open[0] = whole;
  std::size_t count = 1;
  for (int cells = 0; count > 0; ++cells) {
    Cell& cell = open[count - 1];
    const SignVariations changes = variations(cell);
    if (changes.upper == 0) {
      --count;
    } else if (changes.upper == 1 && changes.lower == 1) {
      if (!add_root(cell)) return false;
      --count;
    } else {
      if (count == kStack || cells == kMostCells) return false;
      split(cell, place_to_split(cell, changes.upper), open[count++]);
    }
  }
  return true;
}

/// The cell's only root, between two places of the cell where `equation` has opposite signs. `weight`, of t:
/// about the equation over the cell's polynomial.
template <class Equation, class Weight>
std::optional<Ball> bracket(const Cell& cell, const Equation& equation, const Weight& weight) {
  constexpr int kSteps = 8, kWiden = 24;
  std::array<double, kSize> b;
  for (std::size_t i = 0; i < cell.size; ++i) b[i] = cell.c[i].value().hi;
  const auto coefficients = std::span<double>(b).first(cell.size);
  const Place place = place_of_root(coefficients);
  const Ball end = cell.lo + cell.length, way = cell.length * Ball(place.from_end);
  DoubleDouble t = (place.is_left ? cell.lo + way : end - way).value();
  const double turned = slope_at(coefficients, place.from_end).slope / cell.length.value().hi;
  const double slope = (place.is_left ? turned : -turned) * weight(t);
  double width = 0;
  for (int step = 0; step < kSteps; ++step) {
    const Ball here = equation(Ball(t));
    const double move = here.value().hi / slope;
    t = t - here.value() / slope;
    const double noise = 2 * here.error() / std::fabs(slope) + 0x1p-100 * std::fabs(t.hi);
    width = std::max(noise, 0x1p-20 * std::fabs(move));
    if (!(std::fabs(move) > 16 * noise)) break;
  }
  const int left = slope > 0 ? -1 : 1;
  for (int k = 0; k < kWiden && std::isfinite(width); ++k, width *= 4) {
    const DoubleDouble from = t - width, to = t + width;
    if (!is_below(cell.lo, Ball(from)) || !is_below(Ball(to), end)) return std::nullopt;
    if (sign_of(equation(Ball(from))) != left || sign_of(equation(Ball(to))) != -left) continue;
    // from and to are rounded by less than 2^-5 of the width.
    return Ball(t, 1.0625 * width);
  }
  return std::nullopt;
}

/// Neighbours whose enclosures meet may be one point.
bool are_apart(const BezierDoubleDouble::Hits& hits) {
  for (std::size_t k = 0; k + 1 < hits.count; ++k) {
    const BezierDoubleDouble::Hit &a = hits.list[k], &b = hits.list[k + 1];
    if (!((b.l - a.l).hi > 2 * (a.error + b.error))) return false;
  }
  return true;
}

}  // namespace

BezierDoubleDouble::BezierDoubleDouble(const BezierProfile& profile)
    : degree_(profile.r.size() - 1), middle_(0.5 * (profile.cylinder.y_lo + profile.cylinder.y_hi)) {
  if (degree_ > kMaxDegree) return;
  std::copy(profile.r.begin(), profile.r.end(), r_.begin());
  std::copy(profile.y.begin(), profile.y.end(), y_.begin());
  const auto n = static_cast<int>(degree_);
  for (int i = 0; i <= n; ++i) choose_[static_cast<std::size_t>(i)] = binomial(n, i);
}

/// One line and the profile, recentred.
class BezierDoubleDouble::Line {
 public:
  Line(const BezierDoubleDouble& profile, Vec3 o, Vec3 d, double centre);
  [[nodiscard]] bool climb(Hits& hits);
  [[nodiscard]] bool run_level(Hits& hits) const;

 private:
  /// Two places of a level line at one height: delta = (-+ root(discriminant) - b) / a.
  struct Circle {
    Ball t, r, discriminant;
  };

  [[nodiscard]] bool passes_through(std::size_t end) const;
  [[nodiscard]] bool start(Cell& cell, Hits& hits);
  [[nodiscard]] bool add_hit(const Ball& delta, std::uint32_t multiplicity, Hits& hits) const;
  [[nodiscard]] Ball equation(const Ball& t) const;
  [[nodiscard]] std::optional<Circle> circle(const Cell& cell, const Ball& height) const;
  [[nodiscard]] bool turns_less(const Circle& circle) const;
  [[nodiscard]] Ball delta(const Circle& circle, int side) const;
  [[nodiscard]] bool add_circle(const Cell& cell, Hits& hits) const;
  [[nodiscard]] bool add_crossing(const Cell& cell, Circle here, int side, Hits& hits) const;
  [[nodiscard]] std::span<const Ball> part(const std::array<Ball, kMaxDegree + 1>& a) const {
    return {a.data(), profile_.degree_ + 1};
  }

  const BezierDoubleDouble& profile_;
  Vec3 o_, d_;
  double centre_;
  Ball px_, py_, pz_;
  std::array<Ball, kMaxDegree + 1> r_, x_, z_, rise_;  ///< R, the equation's vector, Y - p_y
  int poles_[2] = {0, 0};                              ///< powers of t and 1 - t taken out
};

BezierDoubleDouble::Line::Line(const BezierDoubleDouble& profile, Vec3 o, Vec3 d, double centre)
    : profile_(profile), o_(o), d_(d), centre_(std::isfinite(centre) ? centre : 0) {
  const auto point = [&](double from, double along) { return exact_product(centre_, along) + Ball(from); };
  px_ = point(o.x, d.x);
  py_ = point(o.y, d.y);
  pz_ = point(o.z, d.z);
  for (std::size_t i = 0; i <= profile.degree_; ++i) {
    const double choose = profile.choose_[i];
    r_[i] = exact_product(choose, profile.r_[i]);
    rise_[i] = Ball(choose) * (Ball(profile.y_[i]) - py_);
  }
}

/// Whether the line meets the profile's end on the axis, exactly.
bool BezierDoubleDouble::Line::passes_through(std::size_t end) const {
  if (profile_.r_[end] != 0 || sign_of(x_[end]) != 0 || sign_of(z_[end]) != 0) return false;
  const Dyadic rise = Dyadic(profile_.y_[end]) - Dyadic(o_.y), dy(d_.y);
  return (dy * Dyadic(o_.x) + rise * Dyadic(d_.x)).is_zero() &&
         (dy * Dyadic(o_.z) + rise * Dyadic(d_.z)).is_zero();
}

/// The equation's coefficients on [0, 1], without the double roots at poles that the line passes through:
/// those are hits.
bool BezierDoubleDouble::Line::start(Cell& cell, Hits& hits) {
  const std::size_t n = profile_.degree_;
  const Ball dx(d_.x), dy(d_.y), dz(d_.z), cx = dy * px_, cz = dy * pz_;
  for (std::size_t i = 0; i <= n; ++i) {
    const Ball choose(profile_.choose_[i]);
    x_[i] = dx * rise_[i] + choose * cx;
    z_[i] = dz * rise_[i] + choose * cz;
  }
  for (const std::size_t end : {std::size_t{0}, n}) {
    if (!passes_through(end)) continue;
    x_[end] = z_[end] = {};
    poles_[end == 0 ? 0 : 1] = 2;
  }
  std::array<Ball, kSize> e;
  const Ball dy_squared = sqr(dy);
  for (std::size_t i = 0; i <= n; ++i) {
    for (std::size_t k = i; k <= n; ++k) {
      const Ball product = dy_squared * (r_[i] * r_[k]) - x_[i] * x_[k] - z_[i] * z_[k];
      e[i + k] += k == i ? product : product + product;
    }
  }
  const auto below = static_cast<std::size_t>(poles_[0]), above = static_cast<std::size_t>(poles_[1]);
  cell.size = 2 * n + 1 - below - above;
  if (cell.size > kSize) return false;
  const auto degree = static_cast<int>(cell.size - 1);
  for (std::size_t k = 0; k < cell.size; ++k)
    cell.c[k] = quotient(e[k + below], binomial(degree, static_cast<int>(k)));
  cell.length = Ball(1.0);
  for (const std::size_t end : {std::size_t{0}, n}) {
    if (poles_[end == 0 ? 0 : 1] == 0) continue;
    // Beside a pole the equation is positive inside the body.
    const int inside = sign_of(end == 0 ? cell.c[0] : cell.c[cell.size - 1]);
    if (inside == 0 || !add_hit(quotient(rise_[end], d_.y), inside > 0 ? 1 : 2, hits)) return false;
  }
  return true;
}

Ball BezierDoubleDouble::Line::equation(const Ball& t) const {
  return sqr(Ball(d_.y) * evaluate(part(r_), t)) - sqr(evaluate(part(x_), t)) - sqr(evaluate(part(z_), t));
}

/// A hit at l = centre + delta, if that is ahead of the origin; false where it is not known well enough.
bool BezierDoubleDouble::Line::add_hit(const Ball& delta, std::uint32_t multiplicity, Hits& hits) const {
  const Ball l = Ball(centre_) + delta;
  const int sign = sign_of(l);
  if (sign < 0) return true;
  if (sign == 0 || !(l.error() <= kMostError * (l.value().hi + 0.25)) || hits.count == kMaxHits) return false;
  std::size_t k = hits.count++;
  for (; k > 0 && l.value() < hits.list[k - 1].l; --k) hits.list[k] = hits.list[k - 1];
  hits.list[k] = {l.value(), l.error(), multiplicity};
  return true;
}

bool BezierDoubleDouble::Line::climb(Hits& hits) {
  Cell whole;
  if (!start(whole, hits)) return false;
  // The cells' polynomials lack the roots at the poles.
  const auto weight = [this](const DoubleDouble& t) {
    const double below = t.hi, above = (1 - t).hi;
    return (poles_[0] == 0 ? 1 : below * below) * (poles_[1] == 0 ? 1 : above * above);
  };
  const auto add_root = [&](const Cell& cell) {
    const std::optional<Ball> t = bracket(
        cell, [this](const Ball& at) { return equation(at); }, weight);
    return t && add_hit(quotient(evaluate(part(rise_), *t), d_.y), 1, hits);
  };
  return isolate(whole, add_root) && are_apart(hits);
}

/// Where the cell's part of the profile is at the height p_y + `height`, and the line's discriminant there.
std::optional<BezierDoubleDouble::Line::Circle> BezierDoubleDouble::Line::circle(const Cell& cell,
                                                                                 const Ball& height) const {
  const auto rise = [&](const Ball& t) { return evaluate(part(rise_), t) - height; };
  const std::optional<Ball> t = bracket(cell, rise, [](const DoubleDouble&) { return 1.0; });
  if (!t) return std::nullopt;
  const Ball dx(d_.x), dz(d_.z), r = evaluate(part(r_), *t);
  return Circle{*t, r, (sqr(dx) + sqr(dz)) * sqr(r) - sqr(px_ * dz - pz_ * dx)};
}

/// |d(R^2)/dl| = |2 R R' / Y' d_y| is less than |d|x_xz|^2/dl| = 2 sqrt(discriminant): what the line meets
/// there is one crossing.
bool BezierDoubleDouble::Line::turns_less(const Circle& circle) const {
  if (d_.y == 0) return true;
  const std::size_t n = profile_.degree_;
  std::array<Ball, kMaxDegree> dr, dy;
  for (std::size_t i = 0; i < n; ++i) {
    const Ball choose(binomial(static_cast<int>(n - 1), static_cast<int>(i)));
    dr[i] = choose * (Ball(profile_.r_[i + 1]) - Ball(profile_.r_[i]));
    dy[i] = choose * (Ball(profile_.y_[i + 1]) - Ball(profile_.y_[i]));
  }
  const Ball climb = evaluate(std::span<const Ball>(dy).first(n), circle.t);
  const double r = most(circle.r) * most(evaluate(std::span<const Ball>(dr).first(n), circle.t));
  const double least = std::fabs(climb.value().hi) - 2 * climb.error();
  const double square = circle.discriminant.value().hi - 2 * circle.discriminant.error();
  return least > 0 && square > 0 && 1.01 * r * std::fabs(d_.y) < least * std::sqrt(square);
}

Ball BezierDoubleDouble::Line::delta(const Circle& circle, int side) const {
  const Ball dx(d_.x), dz(d_.z), half = root(circle.discriminant);
  return quotient((side < 0 ? -half : half) - (px_ * dx + pz_ * dz), sqr(dx) + sqr(dz));
}

/// One of the two crossings: where the line climbs, each place tells the height better than the one before.
bool BezierDoubleDouble::Line::add_crossing(const Cell& cell, Circle here, int side, Hits& hits) const {
  constexpr int kSteps = 8;
  Ball at = delta(here, side);
  for (int step = 0; step < kSteps && at.error() > 0.25 * kMostError * (most(Ball(centre_) + at) + 0.25);
       ++step) {
    const std::optional<Circle> next = circle(cell, Ball(d_.y) * at);
    if (!next || sign_of(next->discriminant) <= 0) return false;
    at = delta(*next, side);
  }
  return add_hit(at, 1, hits);
}

bool BezierDoubleDouble::Line::add_circle(const Cell& cell, Hits& hits) const {
  const std::optional<Circle> here = circle(cell, Ball(DoubleDouble(), kReach * std::fabs(d_.y)));
  if (!here) return false;
  const int sign = sign_of(here->discriminant);
  if (sign <= 0) return sign < 0;
  return turns_less(*here) && add_crossing(cell, *here, -1, hits) && add_crossing(cell, *here, 1, hits);
}

/// A line that climbs little meets the body within `kReach` of the centre, at nearly one height: for each of
/// the heights there Y has one root in each cell, at which it passes a circle.
bool BezierDoubleDouble::Line::run_level(Hits& hits) const {
  if (!(std::fabs(centre_) < kMostCentre)) return false;
  Cell whole;
  whole.size = profile_.degree_ + 1;
  for (std::size_t i = 0; i < whole.size; ++i)
    whole.c[i] = (Ball(profile_.y_[i]) - py_) - Ball(DoubleDouble(), kReach * std::fabs(d_.y));
  whole.length = Ball(1.0);
  return isolate(whole, [&](const Cell& cell) { return add_circle(cell, hits); }) && are_apart(hits);
}

bool BezierDoubleDouble::find(Vec3 o, Vec3 d, Hits& hits) const {
  // Of level lines the heights are nearly one; below 2^-40 the equation in t keeps too few digits.
  constexpr double kLevel = 0x1p-20, kFlat = 0x1p-40;
  if (degree_ > kMaxDegree) return false;
  hits.count = 0;
  if (std::fabs(d.y) < kLevel) {
    const double centre = -(o.x * d.x + o.z * d.z) / (d.x * d.x + d.z * d.z);
    if (Line(*this, o, d, centre).run_level(hits)) return true;
    hits.count = 0;
    if (std::fabs(d.y) < kFlat) return false;
  }
  // Any double near the closest approach will do.
  const Vec3 middle{0, middle_, 0};
  return Line(*this, o, d, dot(middle - o, d) / dot(d, d)).climb(hits);
}

}  // namespace graze
