#include <graze/surfaces/implicit_polynomial.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/coefficients.hpp>
#include <graze/surfaces/recentred_ball.hpp>

namespace graze {
namespace {

using Term = PolynomialTerms::Term;

int total_degree(const std::array<int, 3>& powers) { return powers[0] + powers[1] + powers[2]; }

int whole_exponent(double value) {
  constexpr double kMost = 1024;  // terms beyond the highest degree may still cancel; these are a mistake
  if (!(value >= 0 && value <= kMost) || value != std::floor(value))
    throw std::invalid_argument("parameter 'terms' has an exponent that is no whole number from 0 to 1024");
  return static_cast<int>(value);
}

// ------------------------------------------------------------------------------------------- f along a line

/// A polynomial in delta of at most the highest degree, ascending; size 0 is the zero polynomial.
template <class T>
struct Univariate {
  std::array<T, PolynomialTerms::kMaxDegree + 1> c{};
  std::size_t size = 0;

  /// Times o + delta d, from the highest coefficient down.
  void multiply(const T& o, const T& d) {
    if (size == 0) return;
    c[size] = c[size - 1] * d;
    for (std::size_t i = size - 1; i > 0; --i) c[i] = c[i] * o + c[i - 1] * d;
    c[0] = c[0] * o;
    ++size;
  }
  void add(const Univariate& other) {
    for (std::size_t i = 0; i < other.size; ++i) c[i] = i < size ? c[i] + other.c[i] : other.c[i];
    size = std::max(size, other.size);
  }
};

/// f(o + delta d): Horner's rule in x, whose coefficients are polynomials in y, and so on.
template <class T>
class Restriction {
 public:
  Restriction(std::span<const Term> terms, const std::array<T, 3>& o, const std::array<T, 3>& d)
      : terms_(terms), o_(o), d_(d) {}
  [[nodiscard]] Univariate<T> operator()() const { return nested(terms_, 0); }

 private:
  /// Terms that agree in the powers before `axis`, without those powers.
  [[nodiscard]] Univariate<T> nested(std::span<const Term> terms, std::size_t axis) const {
    Univariate<T> sum;
    if (axis == 3) {
      sum.c[0] = exactly<T>(terms[0].c);
      for (const Term& part : terms.subspan(1)) sum.c[0] = sum.c[0] + exactly<T>(part.c);
      sum.size = 1;
      return sum;
    }
    while (!terms.empty()) {
      const int power = terms[0].powers[axis];
      std::size_t count = 1;
      while (count < terms.size() && terms[count].powers[axis] == power) ++count;
      sum.add(nested(terms.first(count), axis + 1));
      terms = terms.subspan(count);
      const int next = terms.empty() ? 0 : terms[0].powers[axis];
      for (int i = power; i > next; --i) sum.multiply(o_[axis], d_[axis]);
    }
    return sum;
  }

  std::span<const Term> terms_;
  const std::array<T, 3>& o_;
  const std::array<T, 3>& d_;
};

template <class T>
Univariate<T> restricted(const PolynomialTerms& f, const std::array<T, 3>& o, const std::array<T, 3>& d) {
  return Restriction<T>(f.list(), o, d)();
}

template <class T>
std::array<T, 3> components(Vec3 v) {
  return {exactly<T>(v.x), exactly<T>(v.y), exactly<T>(v.z)};
}

bool is_exact_zero(double x) { return x == 0; }
bool is_exact_zero(float x) { return x == 0; }
bool is_exact_zero(const Interval& x) { return x == Interval{}; }
bool is_exact_zero(const DoubleDoubleBall& x) { return x.is_exact_zero(); }
bool is_exact_zero(const Expansion& x) { return x.is_zero(); }
bool is_exact_zero(const Dyadic& x) { return x.is_zero(); }

/// Drops leading coefficients that are zero: the degree along this ray.
template <class T>
void trim(Univariate<T>& p) {
  while (p.size > 0 && is_exact_zero(p.c[p.size - 1])) --p.size;
}

// ------------------------------------------------------------------------------------------------- recentred

/// Are polynomials of f's degree in the ray's numbers exact as expansions?
bool is_exact_range(const PolynomialTerms& f, const LocalRay& ray) {
  if (!ray.is_exact) return false;
  const int degree = f.degree() + 1;
  const auto fits = [degree](double x) { return Expansion::in_range(x, degree); };
  const std::array<double, 6> numbers{ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z};
  return std::all_of(numbers.begin(), numbers.end(), fits) &&
         std::all_of(f.list().begin(), f.list().end(), [&](const Term& term) { return fits(term.c); });
}

/// The degree and the leading coefficient are those about any point of the ray, so they are decided about its
/// own origin, where they are exact; if that is the point in use, all coefficients are.
void decide_exactly(const PolynomialTerms& f, const LocalRay& ray, Univariate<DoubleDoubleBall>& p) {
  Univariate<Expansion> exact = restricted(f, components<Expansion>(ray.o), components<Expansion>(ray.d));
  trim(exact);
  p.size = exact.size;
  if (exact.size == 0) return;
  p.c[p.size - 1] = nearest_ball(exact.c[p.size - 1]);
  if (ray.centre != 0) return;
  for (std::size_t i = 0; i < p.size; ++i) p.c[i] = nearest_ball(exact.c[i]);
}

/// The same in integers, where products of the ray's numbers leave the range of double: all coefficients,
/// times a power of two that brings the largest to 1.
void decide_in_integers(const PolynomialTerms& f, const LocalRay& ray, Univariate<DoubleDoubleBall>& p) {
  Univariate<Dyadic> exact = restricted(f, recentred_point<Dyadic>(ray), direction_as<Dyadic>(ray));
  trim(exact);
  p.size = exact.size;
  long highest = std::numeric_limits<long>::min();
  for (const Dyadic& c : exact.c) {
    if (!c.is_zero()) highest = std::max(highest, c.top_exponent());
  }
  for (std::size_t i = 0; i < p.size; ++i) p.c[i] = nearest_ball(scale_by_power(exact.c[i], -highest));
}

Univariate<DoubleDoubleBall> recentred_balls(const PolynomialTerms& f, const LocalRay& ray) {
  auto p = restricted(f, recentred_ball(ray), direction_as<DoubleDoubleBall>(ray));
  trim(p);
  if (p.size == 0) return p;
  // A leading coefficient that may vanish decides the degree; f at an origin on the surface, the root l = 0.
  const bool starts_on_it = ray.centre == 0 && p.c[0].contains_zero();
  const bool is_doubtful = starts_on_it || p.c[p.size - 1].contains_zero();
  if (is_doubtful && is_exact_range(f, ray)) {
    decide_exactly(f, ray, p);
  } else if (is_doubtful) {
    decide_in_integers(f, ray, p);
  }
  return p;
}

/// Every root of every polynomial within the balls is smaller; inf when the leading one may vanish.
double bound_of_roots(const Univariate<DoubleDoubleBall>& p) {
  std::array<double, PolynomialTerms::kMaxDegree + 1> sizes{};
  for (std::size_t i = 0; i < p.size; ++i) {
    const Interval size = abs(p.c[i].enclosure());
    sizes[i] = i + 1 < p.size ? size.hi : size.lo;
  }
  if (!(sizes[p.size - 1] > 0)) return std::numeric_limits<double>::infinity();
  return root_bound({sizes.data(), p.size});
}

/// Poses p / delta^zeros on [lo, hi] in the block's form and arithmetic.
void pose_on(const PolynomialTerms& f, const LocalRay& ray, const Univariate<DoubleDoubleBall>& p,
             std::size_t zeros, double lo, double hi, EquationBlock& block) {
  const std::span<const DoubleDoubleBall> c{p.c.data() + zeros, p.size - zeros};
  const double nearest = std::min(std::fabs(lo), std::fabs(hi)),
               farthest = std::max(std::fabs(lo), std::fabs(hi));
  // The size of the roots that may lie there.
  const double scale = lo <= 0 && hi >= 0 ? std::min(1.0, farthest) : std::max(nearest, farthest / 64);
  const auto in_float = [&] {
    auto plain = restricted(f, recentred_point<float>(ray), components<float>(ray.d)).c;
    std::rotate(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(zeros), plain.end());
    return plain;
  };
  const auto exact = [terms = &f, where = &ray, zeros](std::span<Dyadic> to) {
    const auto all = restricted(*terms, recentred_point<Dyadic>(*where), direction_as<Dyadic>(*where)).c;
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(zeros), to.size(), to.begin());
  };
  pose_balls(block, c, ray.centre, lo, hi, scale, ray.seed(), in_float, exact);
}

/// Far roots come with nearly asymptotic rays. Inclusions are wide on long intervals and epsilons follow the
/// roots' size, so the range is cut in the ratio of kRatio; an odd number, where roots have no reason to be.
double next_cut(double lo) {
  constexpr double kRatio = 0x1.0000f1a2b3c4dp6;
  return lo < -kRatio ? std::min(lo / kRatio, -kRatio) : std::max(kRatio, kRatio * lo);
}

bool is_usable(const LocalRay& ray) {
  return is_finite(ray.p) && is_finite(ray.d) && std::isfinite(ray.centre);
}

// ----------------------------------------------------------------------------------------- values and points

using WidePoint = std::array<DoubleDouble, 3>;

struct WideValue {
  DoubleDouble f;
  WidePoint gradient;
};

/// f and its gradient in double-double.
WideValue evaluate(const PolynomialTerms& f, const WidePoint& x) {
  std::array<std::array<DoubleDouble, PolynomialTerms::kMaxDegree + 1>, 3> power;
  const auto degree = static_cast<std::size_t>(f.degree());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    power[axis][0] = 1;
    for (std::size_t i = 1; i <= degree; ++i) power[axis][i] = power[axis][i - 1] * x[axis];
  }
  WideValue value;
  for (const Term& term : f.list()) {
    std::array<DoubleDouble, 3> factor;
    for (std::size_t axis = 0; axis < 3; ++axis)
      factor[axis] = power[axis][static_cast<std::size_t>(term.powers[axis])];
    value.f += term.c * factor[0] * factor[1] * factor[2];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int n = term.powers[axis];
      if (n == 0) continue;
      const DoubleDouble others = factor[(axis + 1) % 3] * factor[(axis + 2) % 3];
      value.gradient[axis] +=
          term.c * static_cast<double>(n) * power[axis][static_cast<std::size_t>(n - 1)] * others;
    }
  }
  return value;
}

Vec3 rounded(const WidePoint& x) { return {x[0].hi, x[1].hi, x[2].hi}; }

/// The point at delta without the rounding of p.
WidePoint wide_point(const LocalRay& ray, double delta) {
  const auto coordinate = [&](double o, double d) {
    return two_prod(ray.centre, d) + DoubleDouble(o) + two_prod(delta, d);
  };
  return {coordinate(ray.o.x, ray.d.x), coordinate(ray.o.y, ray.d.y), coordinate(ray.o.z, ray.d.z)};
}

/// How far from the origin samples and landmarks are looked for, in local units: twice the largest L.
constexpr double kRegion = 4;

/// Sign changes of f along p + t d for |t| <= kRegion, between 64 nodes, each bisected to neighbouring
/// doubles.
std::vector<double> crossings(const PolynomialTerms& f, Vec3 p, Vec3 d) {
  const auto on_line = restricted(f, components<double>(p), components<double>(d));
  const std::span<const double> c{on_line.c.data(), on_line.size};
  constexpr int kNodes = 64;
  // Zero counts as positive, so that a crossing on a node is found.
  const auto is_positive = [&](double t) { return horner(c, t) >= 0; };
  std::vector<double> found;
  double lo = -kRegion;
  for (int i = 1; i <= kNodes; ++i) {
    const double hi = kRegion * (2.0 * i / kNodes - 1);
    const bool side = is_positive(lo);
    if (side != is_positive(hi)) {
      double a = lo, b = hi;
      for (double m = 0.5 * (a + b); m > a && m < b; m = 0.5 * (a + b)) (is_positive(m) == side ? a : b) = m;
      found.push_back(side ? a : b);
    }
    lo = hi;
  }
  return found;
}

/// Newton steps along the gradient onto f = 0; nothing where they do not arrive, as next to singular points.
std::optional<SurfaceSample> polished(const PolynomialTerms& f, Vec3 x) {
  constexpr int kSteps = 4;  // from a bisected crossing, two suffice
  for (int i = 0; i < kSteps; ++i) {
    const WideValue at = evaluate(f, {x.x, x.y, x.z});
    const Vec3 g = rounded(at.gradient);
    const double step = at.f.hi / dot(g, g);
    if (!std::isfinite(step)) return std::nullopt;
    x = x - step * g;
    if (std::fabs(step) * max_abs(g) <= 0x1p-51 * max_abs(x)) return SurfaceSample{x, normalized(g)};
  }
  return std::nullopt;
}

Vec3 seeded_direction(Rng& rng) {
  // A point of the cube's boundary is enough: nothing is measured by its distribution.
  Vec3 d{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
  const double size = max_abs(d);
  return size > 0 ? normalized(d) : Vec3{1, 0, 0};
}

/// Half the extent of what the axes and the diagonals through the origin meet.
Vec3 extent_near_origin(const PolynomialTerms& f) {
  Vec3 half;
  for (int i = 14; i < 27; ++i) {
    const auto step = [](int k) { return static_cast<double>(k % 3 - 1); };
    const Vec3 d{step(i), step(i / 3), step(i / 9)};
    for (const double t : crossings(f, {}, d)) {
      half = {std::max(half.x, std::fabs(t * d.x)), std::max(half.y, std::fabs(t * d.y)),
              std::max(half.z, std::fabs(t * d.z))};
    }
  }
  // A surface not met, or flat in a direction, is looked at over the unit length.
  const auto or_unit = [](double x) { return x > 0 ? x : 1; };
  return {or_unit(half.x), or_unit(half.y), or_unit(half.z)};
}

/// What the origin is where f and its gradient vanish there: the tip of a cone where the quadratic terms have
/// full rank, else a cusp.
std::optional<Landmarks::Singular> singularity_at_origin(const PolynomialTerms& f) {
  std::array<std::array<Expansion, 3>, 3> quadratic;
  for (const Term& term : f.list()) {
    const int degree = total_degree(term.powers);
    if (degree < 2) return std::nullopt;
    if (degree > 2) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const bool is_square = i == j && term.powers[i] == 2;
        const bool is_product = i != j && term.powers[i] == 1 && term.powers[j] == 1;
        if (is_square || is_product) quadratic[i][j] += Expansion((is_square ? 2 : 1) * term.c);
      }
    }
  }
  return exact_determinant(quadratic).is_zero() ? Landmarks::Singular::cusp : Landmarks::Singular::apex;
}

}  // namespace

// ----------------------------------------------------------------------------------------------------- terms

PolynomialTerms::PolynomialTerms(std::span<const std::vector<double>> rows) {
  std::map<std::array<int, 3>, Expansion, std::greater<>> sums;
  for (const std::vector<double>& row : rows)
    sums[{whole_exponent(row[1]), whole_exponent(row[2]), whole_exponent(row[3])}] += Expansion(row[0]);
  for (const auto& [powers, sum] : sums) {
    for (const double part : sum.parts()) {
      degree_ = std::max(degree_, total_degree(powers));
      terms_.push_back({part, powers});
    }
  }
  if (terms_.empty()) throw std::invalid_argument("parameter 'terms' adds up to zero");
  if (degree_ < 1) throw std::invalid_argument("parameter 'terms' is a constant: no surface");
  if (degree_ > kMaxDegree) throw std::invalid_argument("parameter 'terms' has a total degree above 32");
  localize();
}

void PolynomialTerms::localize() {
  std::array<double, kMaxDegree + 1> largest{};
  for (const Term& term : terms_) {
    double& size = largest[static_cast<std::size_t>(total_degree(term.powers))];
    size = std::max(size, std::fabs(term.c));
  }
  // floor(log2(a / b) / n) in whole numbers, so that a power-of-two scale of lengths shifts it exactly.
  const auto significand = [](double x) { return scale_by_power(x, -exponent_of(x)); };
  const double top = largest[static_cast<std::size_t>(degree_)];
  std::optional<int> unit;
  for (int m = 0; m < degree_; ++m) {
    const double size = largest[static_cast<std::size_t>(m)];
    if (size == 0) continue;
    const int ratio = exponent_of(size) - exponent_of(top) - (significand(size) < significand(top) ? 1 : 0);
    const int n = degree_ - m;
    const int quotient = ratio >= 0 ? ratio / n : -((n - 1 - ratio) / n);
    unit = std::max(unit.value_or(quotient), quotient);
  }
  is_homogeneous_ = !unit;
  unit_ = unit.value_or(0);

  int highest = std::numeric_limits<int>::min();
  for (const Term& term : terms_)
    highest = std::max(highest, exponent_of(term.c) + unit_ * total_degree(term.powers));
  for (Term& term : terms_) term.c = scale_by_power(term.c, unit_ * total_degree(term.powers) - highest);
}

// ------------------------------------------------------------------------------------------------- recentred

ImplicitPolynomialRecentred::ImplicitPolynomialRecentred(const ImplicitPolynomial& surface)
    : terms(&surface.terms) {}

FormulationInfo ImplicitPolynomialRecentred::info() {
  return {"recentred",
          "f(p + delta d) = 0 about the point nearest to the origin, coefficients in double-double",
          "graze (surfaces/implicit_polynomial.md)",
          {Form::polynomial, Form::scalar, Form::interval}};
}

void ImplicitPolynomialRecentred::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!is_usable(ray)) return block.settle(Status::failed);
  const Univariate<DoubleDoubleBall> p = recentred_balls(*terms, ray);
  if (p.size == 0) return block.settle(Status::coincident);
  const auto may_vanish = [](const DoubleDoubleBall& c) { return c.contains_zero(); };
  if (std::all_of(p.c.begin(), p.c.begin() + static_cast<std::ptrdiff_t>(p.size), may_vanish))
    return block.settle(Status::uncertain);
  // Roots at the origin are divided out: they are no hits, and a solver could not tell on which side they
  // lie.
  std::size_t zeros = 0;
  while (ray.centre == 0 && p.c[zeros].is_exact_zero()) ++zeros;
  if (p.size - zeros == 1) return;

  // Where all roots are 0 that is one of the range, and not its end.
  const double bound = std::max(bound_of_roots(p), 2 * ulp(ray.centre));
  const double start = std::max(ray.lo, -bound);
  // A solver of polynomials finds all roots at once, whatever the range.
  if (!std::isfinite(bound) || block.form() == Form::polynomial)
    return pose_on(*terms, ray, p, zeros, start, bound, block);
  for (double lo = start; lo < bound;) {
    const double end = std::min(bound, next_cut(lo));
    pose_on(*terms, ray, p, zeros, lo, end, block);
    lo = end;
  }
}

void ImplicitPolynomialRecentred::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                                       std::vector<LocalHit>& hits) const {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x, .is_root = true});
}

// ----------------------------------------------------------------------------------------------------- power

ImplicitPolynomialPower::ImplicitPolynomialPower(const ImplicitPolynomial& surface) : terms(&surface.terms) {}

FormulationInfo ImplicitPolynomialPower::info() {
  return {"power",
          "f(o + l d) = 0 in powers of l, about the ray's own origin",
          "document 004",
          {Form::polynomial}};
}

void ImplicitPolynomialPower::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!is_usable(ray)) return block.settle(Status::failed);
  pose_in_delta(block, 0, 0, std::numeric_limits<double>::infinity(), ray.seed(), terms->degree(),
                [&](auto number) {
                  using T = decltype(number);
                  auto p = restricted(*terms, components<T>(ray.o), components<T>(ray.d));
                  trim(p);
                  const std::span<T> c = block.arena().array<T>(p.size);
                  std::copy_n(p.c.begin(), p.size, c.begin());
                  return c;
                });
}

void ImplicitPolynomialPower::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                                   std::vector<LocalHit>& hits) const {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x - ray.centre});
}

// --------------------------------------------------------------------------------------- implicit_polynomial

SurfaceInfo ImplicitPolynomial::info() {
  SurfaceInfo info;
  info.summary = "sum c x^i y^j z^k = 0";
  info.source = "document 004";
  info.page = "surfaces/implicit_polynomial.md";
  info.parameters = {"terms"};
  return info;
}

Parameters ImplicitPolynomial::scaled(const Parameters& parameters, double factor) {
  auto rows = parameters.table("terms", 4);
  // c x^i y^j z^k -> c k^(m - i - j - k). f has no scale of its own: m halfway keeps the numbers in range.
  const auto degree = [](const std::vector<double>& row) { return row[1] + row[2] + row[3]; };
  double lowest = std::numeric_limits<double>::infinity(), highest = 0;
  for (const auto& row : rows) {
    lowest = std::min(lowest, degree(row));
    highest = std::max(highest, degree(row));
  }
  const double middle = std::floor(0.5 * (lowest + highest));
  for (auto& row : rows) row[0] *= std::pow(factor, middle - degree(row));
  Parameters result = parameters;
  result.set("terms", std::move(rows));
  return result;
}

ImplicitPolynomial::ImplicitPolynomial(const SurfaceSpec& spec) : terms(spec.parameters.table("terms", 4)) {
  const Vec3 half = extent_near_origin(terms);
  marks_.half = scale_by_power(half, unit());
  // Origins on the surface stay the origin, so that the root l = 0 is exact; all others are recentred, for a
  // polynomial of degree n loses n bits by each doubling of the distance. A quarter more than what the axes
  // and diagonals show of the surface. A homogeneous f has no length to measure "near" by.
  near_ = terms.is_homogeneous() ? 0 : 1.25 * max_abs(half);
  if (const auto kind = singularity_at_origin(terms)) marks_.singular.emplace_back(Vec3{}, *kind);
}

double ImplicitPolynomial::size() const { return scale_by_power(1.0, unit()); }

bool ImplicitPolynomial::clip(LocalRay& ray) const {
  recentre(ray, {}, near_);
  ray.lo = -ray.centre;
  ray.hi = std::numeric_limits<double>::infinity();
  return true;
}

LocalPoint ImplicitPolynomial::describe(const LocalRay& ray, const LocalHit& hit) const {
  const Vec3 gradient = rounded(evaluate(terms, wide_point(ray, hit.delta)).gradient);
  const bool is_singular = max_abs(gradient) == 0 || !is_finite(gradient);
  return {normalized(is_singular ? -ray.d : gradient), {}, is_singular};
}

SurfaceSample ImplicitPolynomial::sample(double u, double v) const {
  Rng rng(hash_combine(hash_combine(0, u), v));
  const Vec3 half = scale_by_power(Vec3{1, 1, 1}, unit());
  const Vec3 reach{marks_.half.x / half.x, marks_.half.y / half.y, marks_.half.z / half.z};
  for (int i = 0; i < kSampleLines; ++i) {
    const Vec3 p{rng.uniform(-1, 1) * reach.x, rng.uniform(-1, 1) * reach.y, rng.uniform(-1, 1) * reach.z};
    const Vec3 d = seeded_direction(rng);
    const std::vector<double> found = crossings(terms, p, d);
    if (found.empty()) continue;
    const auto pick = static_cast<std::size_t>(rng.uniform() * static_cast<double>(found.size()));
    if (const auto sample = polished(terms, p + found[pick] * d))
      return {scale_by_power(sample->point, unit()), sample->normal};
  }
  return {{size(), 0, 0}, {1, 0, 0}};
}

static_assert(SurfaceType<ImplicitPolynomial>);
static_assert(Formulation<ImplicitPolynomialRecentred, ImplicitPolynomial> &&
              Formulation<ImplicitPolynomialPower, ImplicitPolynomial>);

}  // namespace graze
