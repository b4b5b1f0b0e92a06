#include <graze/surfaces/bezier_revolution_exact.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace graze {
namespace {

using Form = BezierLength::Form;
using Hits = ExactBezierRevolution::Hits;
using HitList = std::vector<ExactBezierHit>;

ExactPolynomial constant(BigInteger x) { return ExactPolynomial(std::vector<BigInteger>{std::move(x)}); }

ExactPolynomial minus(const ExactPolynomial& p) { return ExactPolynomial() - p; }

DyadicInterval unit_interval() { return {.lo = Dyadic(0.0), .hi = Dyadic(1.0)}; }

/// The least exponent of the numbers that are not zero, or `else_`.
long least_exponent(std::span<const Dyadic> numbers, long else_) {
  long least = else_;
  for (const Dyadic& x : numbers) {
    if (!x.is_zero()) least = std::min(least, x.exponent());
  }
  return least;
}

bool is_end(const RealRoot& t) { return t.is_exact() && (t.lo().is_zero() || t.lo() == Dyadic(1.0)); }

/// Power coefficients C(n, k) (k-th difference) of Bernstein ones.
ExactPolynomial power_basis(std::vector<BigInteger> b) {
  const std::size_t n = b.size() - 1;
  std::vector<BigInteger> c;
  BigInteger binomial = 1;
  for (std::size_t k = 0; k <= n; ++k) {
    c.push_back(binomial * b[0]);
    for (std::size_t i = 0; i + k < n; ++i) b[i] = b[i + 1] - b[i];
    binomial = exact_quotient(binomial * BigInteger(n - k), BigInteger(k + 1));
  }
  return ExactPolynomial(std::move(c));
}

/// Whether p > 0 anywhere on [0, 1]: it changes its sign between the ends, or has one sign and some sample
/// that is no root shows it.
bool takes_positive_value(const ExactPolynomial& p) {
  if (p.is_zero()) return false;
  for (const RealRoot& t : isolate_roots(p, unit_interval())) {
    if (t.multiplicity() % 2 == 1 && !is_end(t)) return true;
  }
  Dyadic sample(1.0);
  while (p.sign_at(sample) == 0) sample *= Dyadic(0.5);
  return p.sign_at(sample) > 0;
}

/// The sign of p beside its root t = 0 or 1, inside [0, 1].
int sign_beside_end(ExactPolynomial p, const Dyadic& end) {
  // The first derivative that is not zero there has it; backwards every other turns.
  for (int sign = 1;; sign = end.is_zero() ? sign : -sign) {
    const int value = p.sign_at(end);
    if (value != 0) return sign * value;
    p = p.derivative();
  }
}

/// floor(sqrt(n)): Newton's method from above, which falls until it is there.
BigInteger floor_sqrt(const BigInteger& n) {
  if (n.sign() <= 0) return 0;
  BigInteger x = BigInteger::power_of_two((n.bit_length() + 1) / 2);
  while (true) {
    BigInteger next = (x + n / x) >> 1U;
    if (next >= x) return x;
    x = std::move(next);
  }
}

/// sqrt of [x.lo, x.hi], to multiples of 2^unit outward; what is below zero counts as zero.
DyadicBounds root_bounds(const DyadicBounds& x, long unit) {
  const auto root = [unit](const Dyadic& w) { return floor_sqrt(w.floor_in_units_of(2 * unit)); };
  return {Dyadic(root(x.lo), unit), Dyadic(root(x.hi) + 1, unit)};
}

/// floor(x / (a 2^unit)).
BigInteger floor_quotient(const Dyadic& x, const BigInteger& a, long unit) {
  const auto [quotient, remainder] = BigInteger::divide(x.floor_in_units_of(unit), a);
  return remainder.sign() < 0 ? quotient - 1 : quotient;
}

}  // namespace

// ---------------------------------------------------------------------------------------------- l

BezierLength::BezierLength(Formula formula, RealRoot t) : formula_(std::move(formula)), t_(std::move(t)) {}

/// From what is known of t; rounded to some digits more than asked for.
DyadicBounds BezierLength::enclosure(long digits) const {
  constexpr long kMore = 8;
  const DyadicBounds p = bounds_at(*formula_.p, t_);
  const auto size = [](const Dyadic& x) { return x.is_zero() ? 0 : x.top_exponent(); };
  const Dyadic c(formula_.c);
  DyadicBounds top{p.lo + c, p.hi + c};
  if (formula_.form != Form::value) {
    const DyadicBounds root = root_bounds(p, size(p.hi) / 2 - digits - kMore);
    const bool negative = formula_.form == Form::minus_root;
    top = negative ? DyadicBounds{c - root.hi, c - root.lo} : DyadicBounds{c + root.lo, c + root.hi};
  }
  const long unit = size(top.hi) - static_cast<long>(formula_.a.bit_length()) - digits - kMore;
  const auto quotient = [&](const Dyadic& x) { return floor_quotient(x, formula_.a, unit); };
  const long scaled = unit + formula_.e;
  return {Dyadic(quotient(top.lo), scaled), Dyadic(quotient(top.hi) + 1, scaled)};
}

void BezierLength::refine(long digits) {
  const auto is_narrow = [&] {
    return is_known_ && lo_.sign() > 0 && hi_ - lo_ <= scale_by_power(lo_, -digits);
  };
  // Cancellation and small values may take more digits of t than of l.
  for (long bits = digits; !is_narrow(); bits += bits / 2 + 1) {
    t_.refine(-bits);
    DyadicBounds bounds = enclosure(bits);
    if (is_known_) bounds = {std::max(bounds.lo, lo_), std::min(bounds.hi, hi_)};
    lo_ = bounds.lo.sign() > 0 ? bounds.lo : Dyadic();
    hi_ = bounds.hi;
    is_known_ = true;
  }
}

int BezierLength::compare_with(const Dyadic& x) const {
  // The sign of f(p(t)) - w with w = a x 2^-e - c = m 2^unit, in integers.
  const Dyadic w = scale_by_power(Dyadic(formula_.a) * x, -formula_.e) - Dyadic(formula_.c);
  const auto sign_of_difference = [&](const Dyadic& from) {
    const long unit = std::min(from.exponent(), 0L);
    const BigInteger factor = BigInteger::power_of_two(static_cast<std::size_t>(-unit));
    return sign_at(*formula_.p * factor - constant(from.floor_in_units_of(unit)), t_);
  };
  if (formula_.form == Form::value) return sign_of_difference(w);
  const int side = formula_.form == Form::root ? 1 : -1;
  if (w.sign() != side) return side;
  return side * sign_of_difference(sqr(w));
}

double BezierLength::to_double() {
  constexpr long kFirst = 64, kSecond = 128;
  for (const long digits : {kFirst, kSecond}) {
    refine(digits);
    if (lo_.to_double() == hi_.to_double()) return hi_.to_double();
  }
  // Only one place where the rounding changes is that near: the middle between two doubles.
  const double below = lo_.to_double();
  const double above = std::nextafter(below, std::numeric_limits<double>::infinity());
  constexpr long kEnd = std::numeric_limits<double>::max_exponent;
  const Dyadic next = std::isinf(above) ? Dyadic::power_of_two(kEnd) : Dyadic(above);
  const Dyadic middle = scale_by_power(Dyadic(below) + next, -1);
  const int side = compare_with(middle);
  return side < 0 ? below : side > 0 ? above : middle.to_double();
}

// ------------------------------------------------------------------------------------------- hits

/// A ray and the profile in one unit of length, 2^length_unit; l in units of 2^e.
struct ExactBezierRevolution::Line {
  std::array<BigInteger, 3> o, d;
  ExactPolynomial r, y, r_squared, y_squared;
  long e = 0;
  bool y_is_monotone = false;

  Line(const ExactBezierRevolution& profile, const Ray& ray);
  /// |d_xz|^2, o_xz.d_xz and |o_xz|^2.
  [[nodiscard]] BigInteger a() const { return d[0] * d[0] + d[2] * d[2]; }
  [[nodiscard]] BigInteger b() const { return o[0] * d[0] + o[2] * d[2]; }
  [[nodiscard]] BigInteger c() const { return o[0] * o[0] + o[2] * o[2]; }
  [[nodiscard]] ExactPolynomial equation() const;
  /// Y(t) - o_y, with the sign of l.
  [[nodiscard]] ExactPolynomial rise() const;
};

ExactBezierRevolution::Line::Line(const ExactBezierRevolution& profile, const Ray& ray)
    : y_is_monotone(profile.y_is_monotone_) {
  const std::array<Dyadic, 3> from{Dyadic(ray.o.x), Dyadic(ray.o.y), Dyadic(ray.o.z)};
  const std::array<Dyadic, 3> along{Dyadic(ray.d.x), Dyadic(ray.d.y), Dyadic(ray.d.z)};
  const long length = least_exponent(from, profile.unit_);
  const long direction = least_exponent(along, std::numeric_limits<long>::max());
  for (std::size_t i = 0; i < 3; ++i) {
    o[i] = from[i].floor_in_units_of(length);
    d[i] = along[i].floor_in_units_of(direction);
  }
  const auto shift = static_cast<std::size_t>(profile.unit_ - length);
  const BigInteger factor = BigInteger::power_of_two(shift), square = BigInteger::power_of_two(2 * shift);
  r = profile.r_ * factor;
  y = profile.y_ * factor;
  r_squared = profile.r_squared_ * square;
  y_squared = profile.y_squared_ * square;
  e = length - direction;
}

/// d_y^2 R^2 - |d_xz (Y - o_y) + d_y o_xz|^2, with c = d_y o_xz - o_y d_xz.
ExactPolynomial ExactBezierRevolution::Line::equation() const {
  const BigInteger cx = d[1] * o[0] - o[1] * d[0], cz = d[1] * o[2] - o[1] * d[2];
  return r_squared * (d[1] * d[1]) - y_squared * a() - y * (BigInteger(2) * (d[0] * cx + d[2] * cz)) -
         constant(cx * cx + cz * cz);
}

ExactPolynomial ExactBezierRevolution::Line::rise() const {
  const ExactPolynomial height = y - constant(o[1]);
  return d[1].sign() < 0 ? minus(height) : height;
}

ExactBezierRevolution::ExactBezierRevolution(std::span<const std::array<double, 2>> control_points) {
  std::vector<Dyadic> numbers;
  for (const auto& point : control_points) {
    for (const double x : point) numbers.emplace_back(x);
  }
  unit_ = least_exponent(numbers, std::numeric_limits<long>::max());
  std::vector<BigInteger> r, y;
  for (std::size_t i = 0; i < control_points.size(); ++i) {
    r.push_back(numbers[2 * i].floor_in_units_of(unit_));
    y.push_back(numbers[2 * i + 1].floor_in_units_of(unit_));
  }
  r_ = power_basis(std::move(r));
  y_ = power_basis(std::move(y));
  r_squared_ = r_ * r_;
  y_squared_ = y_ * y_;
  const std::vector<RealRoot> turns = isolate_roots(y_.derivative(), unit_interval());
  y_is_monotone_ = y_.degree() >= 1 && std::all_of(turns.begin(), turns.end(), is_end);
}

namespace {

/// The same point of the ray: only where the enclosures do not part soon is it asked exactly. Of two forms
/// one has a square root that is not zero: they differ.
bool is_one_point(ExactBezierHit& a, ExactBezierHit& b) {
  constexpr long kDigits = 128;
  if (a.l.form() != b.l.form()) return false;
  a.l.refine(kDigits);
  b.l.refine(kDigits);
  if (a.l.hi() < b.l.lo() || b.l.hi() < a.l.lo()) return false;
  return have_equal_images(a.l.t(), b.l.t(), a.l.p());
}

/// One hit for each point: multiplicities of the sheets that pass there add up.
void join(HitList& hits) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    for (std::size_t k = i + 1; k < hits.size();) {
      if (is_one_point(hits[i], hits[k])) {
        hits[i].multiplicity += hits[k].multiplicity;
        hits.erase(hits.begin() + static_cast<std::ptrdiff_t>(k));
      } else {
        ++k;
      }
    }
  }
}

/// Ascending l, of hits that are all apart.
void sort_by_length(HitList& hits) {
  constexpr long kDigits = 64;
  for (long digits = kDigits;; digits *= 2) {
    for (ExactBezierHit& hit : hits) hit.l.refine(digits);
    std::sort(hits.begin(), hits.end(),
              [](const ExactBezierHit& a, const ExactBezierHit& b) { return a.l.lo() < b.l.lo(); });
    const auto meets_next = [](const ExactBezierHit& a, const ExactBezierHit& b) {
      return a.l.hi() >= b.l.lo();
    };
    if (std::adjacent_find(hits.begin(), hits.end(), meets_next) == hits.end()) return;
  }
}

}  // namespace

Hits ExactBezierRevolution::hits(const Ray& ray) const {
  const Line line(*this, ray);
  const bool climbs = !line.d[1].is_zero();
  if (y_.degree() < 1) return climbs ? through_plane(line) : in_plane(line);
  return climbs ? climbing(line) : horizontal(line);
}

Hits ExactBezierRevolution::climbing(const Line& line) const {
  const ExactPolynomial equation = line.equation(), rise = line.rise();
  HitList hits;
  if (equation.is_zero()) return takes_positive_value(rise) ? Hits() : hits;
  const BezierLength::Formula formula{std::make_shared<const ExactPolynomial>(rise), 0, abs(line.d[1]),
                                      line.e, Form::value};
  for (const RealRoot& t : isolate_roots(equation, unit_interval())) {
    if (sign_at(rise, t) <= 0) continue;
    auto multiplicity = static_cast<std::uint32_t>(t.multiplicity());
    // At a pole the equation is squared: inside the cone it has one sign on both sides.
    if (is_end(t) && line.r.sign_at(t.lo()) == 0)
      multiplicity = sign_beside_end(equation, t.lo()) > 0 ? 1 : 2;
    hits.push_back({BezierLength(formula, t), multiplicity});
  }
  if (!line.y_is_monotone) {
    join(hits);
    sort_by_length(hits);
  } else if (line.rise().derivative().sign_at(Dyadic(0.5)) < 0) {
    std::reverse(hits.begin(), hits.end());
  }
  return hits;
}

/// |o_xz + l d_xz|^2 = R^2 is a l^2 + 2 b l + c - R^2: discriminant b^2 + a (R^2 - c), and c < R^2 where the
/// origin is inside the circle.
Hits ExactBezierRevolution::horizontal(const Line& line) const {
  const BigInteger a = line.a(), b = line.b(), c = line.c();
  const ExactPolynomial outward = line.r_squared - constant(c);
  const auto discriminant = std::make_shared<const ExactPolynomial>(outward * a + constant(b * b));
  HitList hits;
  for (const RealRoot& t : isolate_roots(line.y - constant(line.o[1]), unit_interval())) {
    const int sign = sign_at(*discriminant, t);
    if (sign < 0) continue;
    const auto multiplicity = static_cast<std::uint32_t>(t.multiplicity());
    const auto add = [&](Form form, std::uint32_t count) {
      hits.push_back({BezierLength({discriminant, -b, a, line.e, form}, t), count});
    };
    if (sign == 0) {
      const bool is_pole = is_end(t) && line.r.sign_at(t.lo()) == 0;
      if (b.sign() < 0) add(Form::value, is_pole ? 2 : 2 * multiplicity);
      continue;
    }
    const int inside = sign_at(outward, t);
    if (b.sign() < 0 && inside < 0) add(Form::minus_root, multiplicity);
    if (b.sign() < 0 || inside > 0) add(Form::root, multiplicity);
  }
  join(hits);
  sort_by_length(hits);
  return hits;
}

/// Y constant: a disk or annulus, which a climbing ray meets in one point.
Hits ExactBezierRevolution::through_plane(const Line& line) const {
  HitList hits;
  const ExactPolynomial rise = line.rise();
  if (rise.is_zero() || rise.leading().sign() < 0) return hits;
  const std::vector<RealRoot> roots = isolate_roots(line.equation(), unit_interval());
  if (roots.empty()) return hits;
  BezierLength::Formula formula{std::make_shared<const ExactPolynomial>(rise), 0, abs(line.d[1]), line.e,
                                Form::value};
  hits.push_back({BezierLength(std::move(formula), roots.front()), 1});
  return hits;
}

/// Inside the rim a ray runs in the surface; one that only touches it has one point.
Hits ExactBezierRevolution::in_plane(const Line& line) {
  HitList hits;
  if (!(line.y - constant(line.o[1])).is_zero()) return hits;
  const BigInteger a = line.a(), b = line.b();
  const ExactPolynomial outward = line.r_squared - constant(line.c());
  const ExactPolynomial discriminant = outward * a + constant(b * b);
  // A ray that leaves the axis is nearest at its origin, which is not part of it.
  if (takes_positive_value(b.sign() < 0 ? discriminant : outward)) return {};
  if (b.sign() >= 0) return hits;
  const std::vector<RealRoot> roots = isolate_roots(discriminant, unit_interval());
  if (roots.empty()) return hits;
  BezierLength::Formula formula{std::make_shared<const ExactPolynomial>(discriminant), -b, a, line.e,
                                Form::value};
  hits.push_back({BezierLength(std::move(formula), roots.front()), 2});
  return hits;
}

}  // namespace graze
