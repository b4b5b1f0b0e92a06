#include <graze/surfaces/torus.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/expansion.hpp>
#include <graze/surfaces/recentred_ball.hpp>

namespace graze {
namespace {

/// Kinds of equation that `along_ray` poses.
enum Sheet : std::uint32_t { kOuter, kInner };

template <class T>
T inner_product(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
std::array<T, 3> direction(const LocalRay& ray) {
  return {exactly<T>(ray.d.x), exactly<T>(ray.d.y), exactly<T>(ray.d.z)};
}

// ----------------------------------------------------------------------------------------- quartic_recentred

/// f = K^2 + 4 R^2 (y^2 - r^2), K = |x|^2 - R^2 - r^2: half the cancellation of the document's form, and none
/// about the top circle. Ascending in delta, x = p + delta d.
template <class T>
std::array<T, 5> quartic_about(const std::array<T, 3>& p, const std::array<T, 3>& d, T ring, T tube) {
  const T two = exactly<T>(2), four = exactly<T>(4);
  const T a = inner_product(d, d), b = inner_product(p, d);
  const T k = inner_product(p, p) - ring * ring - tube * tube;
  const T weight = four * ring * ring;
  const T height = (p[1] - tube) * (p[1] + tube);
  return {k * k + weight * height, four * b * k + two * weight * p[1] * d[1],
          four * b * b + two * a * k + weight * d[1] * d[1], four * a * b, a * a};
}

using Quartic = std::array<DoubleDoubleBall, 5>;

/// Whether products of the ray's numbers and the torus's are exact as expansions. Lengths and directions
/// enter each coefficient four times.
bool is_exact_range(const TorusProfile& profile, const LocalRay& ray) {
  constexpr int kDegree = 4;
  const std::array numbers{ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z, profile.ring, profile.tube};
  return ray.is_exact && std::all_of(numbers.begin(), numbers.end(),
                                     [](double x) { return Expansion::in_range(x, kDegree); });
}

/// The quartic about the ray's origin in exact numbers of type T, rounded once.
template <class T>
Quartic exact_quartic(const TorusProfile& profile, const LocalRay& ray) {
  const auto exact = quartic_about(origin_as<T>(ray), direction_as<T>(ray), T(profile.ring), T(profile.tube));
  Quartic c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = nearest_ball(exact[i]);
  return c;
}

/// A ray that starts on the surface has the root l = 0, which is no hit: it is to be an exact zero.
Quartic quartic_balls(const TorusProfile& profile, const LocalRay& ray) {
  const Quartic c = quartic_about(recentred_ball(ray), direction_as<DoubleDoubleBall>(ray),
                                  DoubleDoubleBall(profile.ring), DoubleDoubleBall(profile.tube));
  if (ray.centre != 0 || !c[0].contains_zero()) return c;
  return is_exact_range(profile, ray) ? exact_quartic<Expansion>(profile, ray)
                                      : exact_quartic<Dyadic>(profile, ray);
}

// ------------------------------------------------------------------------------------------------- along_ray

/// F(delta) = (rho - ring)^2 + y^2 - r^2 of one ray; ring = -R is the inner sheet.
struct AlongRay {
  double ring;
  double tube;
  LocalRay ray;
  std::array<Interval, 3> p;  ///< the exact point at delta = 0

  AlongRay(const TorusProfile& profile, Sheet sheet, const LocalRay& local)
      : ring(sheet == kOuter ? profile.ring : -profile.ring),
        tube(profile.tube),
        ray(local),
        p(recentred_point<Interval>(local)) {}

  template <class T>
  [[nodiscard]] BasicJet<T> jet(T delta) const {
    const T r = static_cast<T>(tube), centre = static_cast<T>(ring);
    const T dx = static_cast<T>(ray.d.x), dy = static_cast<T>(ray.d.y), dz = static_cast<T>(ray.d.z);
    const auto [x, y, z] = ray.point_at<T>(delta);
    const T rho = std::hypot(x, z);
    const T spread = dx * dx + dz * dz;
    // On the axis rho has a kink: its slope there is taken as 0, between those of both sides.
    const T rho_slope = rho > 0 ? (x * dx + z * dz) / rho : 0;
    const T rho_bend = rho > 0 ? std::max(spread - rho_slope * rho_slope, T{0}) / rho : 0;
    const T out = rho - centre;
    BasicJet<T> jet;
    jet.f = out * out + (y - r) * (y + r);
    jet.df = 2 * (out * rho_slope + y * dy);
    jet.ddf = 2 * (rho_slope * rho_slope + out * rho_bend + dy * dy);
    // Four roundings of rho, one of each coordinate, three of each square.
    const T u = std::numeric_limits<T>::epsilon() / 2;
    const T size = rho + std::fabs(centre);
    jet.f_error = u * (8 * std::fabs(out) * size + 4 * (y * y + r * r) + 2 * std::fabs(y * y));
    return jet;
  }

  [[nodiscard]] Interval coordinate(std::size_t i, double d, Interval x) const { return p[i] + d * x; }
  [[nodiscard]] Interval f(Interval delta) const {
    const Interval x = coordinate(0, ray.d.x, delta), y = coordinate(1, ray.d.y, delta);
    const Interval rho = sqrt(sqr(x) + sqr(coordinate(2, ray.d.z, delta)));
    return sqr(rho - point(ring)) + (sqr(y) - sqr(point(tube)));
  }
  /// The generalised slope where rho vanishes: |rho'| <= |d_xz|.
  [[nodiscard]] Interval df(Interval delta) const {
    const Interval x = coordinate(0, ray.d.x, delta), y = coordinate(1, ray.d.y, delta);
    const Interval z = coordinate(2, ray.d.z, delta);
    const Interval rho = sqrt(sqr(x) + sqr(z));
    const double steepest = sqrt(sqr(point(ray.d.x)) + sqr(point(ray.d.z))).hi;
    const Interval bound{-steepest, steepest};
    const Interval slope =
        rho.lo > 0 ? intersect((ray.d.x * x + ray.d.z * z) / rho, bound).value_or(bound) : bound;
    return 2.0 * ((rho - point(ring)) * slope + ray.d.y * y);
  }
};

void pose_sheet(const TorusProfile& profile, Sheet sheet, const LocalRay& ray, EquationBlock& block) {
  const AlongRay* const self = block.arena().make(AlongRay(profile, sheet, ray));
  // The inner sheet is convex, the outer one alone is met four times at most.
  const int max_roots = sheet == kInner ? 2 : TorusProfile::max_hits();
  if (block.form() == Form::scalar) {
    pose_scalar(block, sheet, self, ray.lo, ray.hi, max_roots, ray.seed());
    return;
  }
  Epsilons epsilons = sharp_epsilons(block.arena(), 1, 0);
  // |F'| = 2 r |d| cos at a hit: below 2^-9 of its size the ray grazes.
  epsilons.shallow = 0x1p-9 * profile.tube * norm(ray.d);
  pose_interval(block, sheet, self, ray.lo, ray.hi, epsilons);
}

/// A root in delta as a hit.
void append(const Root& root, double shift, std::vector<LocalHit>& hits) {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x + shift, .is_root = shift == 0});
}

/// Outward unit normal of the sheet nearest to x; none on the axis, where the sheets of a spindle cross.
std::optional<Vec3> normal_at(const TorusProfile& profile, Vec3 x) {
  const double rho = std::hypot(x.x, x.z);
  if (rho == 0) return std::nullopt;
  const double outer = std::hypot(rho - profile.ring, x.y) - profile.tube;
  const double inner = std::hypot(rho + profile.ring, x.y) - profile.tube;
  // grad f = F2 grad F1 + F1 grad F2, and F1 < 0 on the inner sheet.
  const bool is_inner = profile.has_inner_sheet() && std::fabs(inner) < std::fabs(outer);
  const double side = is_inner ? -1 : 1;
  const double out = is_inner ? rho + profile.ring : rho - profile.ring;
  return normalized({side * out * x.x / rho, side * x.y, side * out * x.z / rho});
}

}  // namespace

TorusQuarticRecentred::TorusQuarticRecentred(const Torus& surface) : profile(surface.profile) {}

FormulationInfo TorusQuarticRecentred::info() {
  return {"quartic_recentred",
          "K^2 + 4 R^2 (y^2 - r^2) = 0, K = |x|^2 - R^2 - r^2, in l about the closest approach",
          "document 004, regrouped and recentred; coefficients in double-double",
          {Form::polynomial, Form::scalar, Form::interval},
          4};
}

void TorusQuarticRecentred::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  const Quartic balls = quartic_balls(profile, ray);
  // Roots at the origin are divided out: they are no hits, and a solver could not tell on which side they
  // lie.
  const auto first = std::find_if_not(balls.begin(), balls.end(), [](auto& c) { return c.is_exact_zero(); });
  const auto zeros = static_cast<std::size_t>(first - balls.begin());
  const std::span<const DoubleDoubleBall> c = std::span(balls).subspan(zeros);
  const auto in_float = [&] {
    auto plain = quartic_about(recentred_point<float>(ray), direction<float>(ray),
                               exactly<float>(profile.ring), exactly<float>(profile.tube));
    std::rotate(plain.begin(), plain.begin() + static_cast<std::ptrdiff_t>(zeros), plain.end());
    return plain;
  };
  const auto exact = [this, where = &ray, zeros](std::span<Dyadic> to) {
    const auto all = quartic_about(recentred_point<Dyadic>(*where), direction_as<Dyadic>(*where),
                                   Dyadic(profile.ring), Dyadic(profile.tube));
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(zeros), to.size(), to.begin());
  };
  pose_balls(block, c, ray.centre, ray.lo, ray.hi, 1, ray.seed(), in_float, exact);
}

void TorusQuarticRecentred::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                                 std::vector<LocalHit>& hits) const {
  append(root, 0, hits);
}

TorusAlongRay::TorusAlongRay(const Torus& surface) : profile(surface.profile) {}

FormulationInfo TorusAlongRay::info() {
  return {"along_ray",
          "F(l) = (hypot(x, z) -+ R)^2 + y^2 - r^2 in l, recentred, one equation a sheet",
          "graze (surfaces/torus.md)",
          {Form::scalar, Form::interval}};
}

void TorusAlongRay::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  pose_sheet(profile, kOuter, ray, block);
  if (profile.has_inner_sheet()) pose_sheet(profile, kInner, ray, block);
}

/// The two sheets meet on the axis only: off it hits are apart, also where they round to one l.
void TorusAlongRay::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                         std::vector<LocalHit>& hits) const {
  append(root, 0, hits);
  const std::array<Interval, 3> p = recentred_point<Interval>(ray), d = direction_as<Interval>(ray);
  const Interval delta{sub_down(root.x, root.radius), add_up(root.x, root.radius)};
  hits.back().is_apart =
      root.certified && (!contains_zero(p[0] + d[0] * delta) || !contains_zero(p[2] + d[2] * delta));
}

TorusSystem::TorusSystem(const Torus& surface) : profile(surface.profile) {}

FormulationInfo TorusSystem::info() {
  return {"system",
          "o + l d = S(u, v): three equations in (l, v / 2 pi, u), recentred",
          "document 003 with the torus for its profile",
          {Form::system}};
}

void TorusSystem::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  using System = revolution::System<TorusProfile>;
  const auto* const self = block.arena().make(System{&profile, ray});
  const auto pose_in = [&](auto number) {
    using T = decltype(number);
    BasicSystemEquation<T> equation = self->equation<T>();
    // The tube closes upon itself: t has no ends.
    equation.lo[1] = -std::numeric_limits<T>::infinity();
    equation.hi[1] = std::numeric_limits<T>::infinity();
    equation.period[1] = 1;
    block.pose(equation);
  };
  if (block.precision() == Precision::binary32) return pose_in(float{});
  pose_in(double{});
}

void TorusSystem::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                       std::vector<LocalHit>& hits) const {
  append(root, 0, hits);
}

TorusQuartic::TorusQuartic(const Torus& surface) : profile(surface.profile) {}

FormulationInfo TorusQuartic::info() {
  return {"quartic",
          "(|x|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + z^2) = 0 in l, about the ray's own origin",
          "document 004",
          {Form::polynomial},
          4};
}

void TorusQuartic::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  pose_polynomial(block, 0, Basis::power, ray.lo + ray.centre, ray.hi + ray.centre, {}, [&](auto number) {
    using T = decltype(number);
    const T two = exactly<T>(2), four = exactly<T>(4);
    const std::array<T, 3> o{exactly<T>(ray.o.x), exactly<T>(ray.o.y), exactly<T>(ray.o.z)};
    const std::array<T, 3> d = direction<T>(ray);
    const T ring = exactly<T>(profile.ring), tube = exactly<T>(profile.tube);
    const T a = inner_product(d, d), b = inner_product(o, d);
    const T g = inner_product(o, o) + ring * ring - tube * tube;
    const T weight = four * ring * ring;
    return std::array<T, 5>{g * g - weight * (o[0] * o[0] + o[2] * o[2]),
                            four * b * g - two * weight * (o[0] * d[0] + o[2] * d[2]),
                            four * b * b + two * a * g - weight * (d[0] * d[0] + d[2] * d[2]), four * a * b,
                            a * a};
  });
}

void TorusQuartic::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                        std::vector<LocalHit>& hits) const {
  append(root, -ray.centre, hits);
}

// ----------------------------------------------------------------------------------------------------- torus

SurfaceInfo Torus::info() {
  SurfaceInfo info;
  info.summary = "torus about y: tube radius r about a circle of radius R";
  info.source = "document 004";
  info.page = "surfaces/torus.md";
  info.parameters = {"R", "r"};
  info.params = {"u", "v"};
  info.varieties = {"ring torus", "horn torus", "spindle torus"};
  return info;
}

Parameters Torus::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"R"}, Length{"r"}};
  return scale_lengths(parameters, kLengths, factor);
}

Torus::Torus(const SurfaceSpec& spec) {
  const double ring = spec.parameters.number("R"), tube = spec.parameters.number("r");
  if (ring <= 0) throw std::invalid_argument("parameter 'R' must be positive");
  if (tube <= 0) throw std::invalid_argument("parameter 'r' must be positive");
  size_ = ring + tube;
  if (!std::isfinite(size_))
    throw std::invalid_argument("parameter 'R' plus 'r' is beyond the range of double");
  unit_ = exponent_of(size_);
  profile.ring = scale_by_power(ring, -unit_);
  profile.tube = scale_by_power(tube, -unit_);
  // The local frame must hold both numbers exactly.
  if (scale_by_power(profile.ring, unit_) != ring || scale_by_power(profile.tube, unit_) != tube)
    throw std::invalid_argument("parameter 'R' and 'r' differ by more than the range of double");
}

bool Torus::clip(LocalRay& ray) const {
  const Cylinder bounds = profile.bounds();
  // Origins on the surface stay the origin, so that the root l = 0 is exact; all others are recentred, for a
  // quartic loses half its digits per bounding radius of shift.
  recentre(ray, {}, bounds.radius);
  // Hits on the outermost circles lie on the bounds: a solver needs some room beyond them to prove a root.
  const double room = 0x1p-10 * profile.tube;
  const Cylinder roomy{bounds.radius + room, bounds.y_lo - room, bounds.y_hi + room};
  double lo = -ray.centre;
  double hi = std::numeric_limits<double>::infinity();
  if (!revolution::clip_slab(ray, roomy, lo, hi) || !revolution::clip_cylinder(ray, roomy, lo, hi))
    return false;
  ray.lo = lo;
  ray.hi = hi;
  return true;
}

LocalPoint Torus::describe(const LocalRay& ray, const LocalHit& hit) const {
  const Vec3 x = ray.at(hit.delta);
  const double rho = std::hypot(x.x, x.z);
  LocalPoint point;
  const std::optional<Vec3> normal = normal_at(profile, x);
  point.normal = normal.value_or(normalized(-ray.d));
  point.is_singular = !normal.has_value();
  point.params = {rho == 0 ? 0.0 : std::atan2(x.z, x.x), std::atan2(x.y, rho - profile.ring)};
  return point;
}

SurfaceSample Torus::sample(double u, double v) const {
  const double theta = 2 * std::numbers::pi * u, phi = 2 * std::numbers::pi * v;
  const double rho = profile.ring + profile.tube * std::cos(phi);
  const Vec3 point{rho * std::cos(theta), profile.tube * std::sin(phi), rho * std::sin(theta)};
  // Beyond the axis the point lies on the inner sheet, whose outward side is its inside.
  const Vec3 normal{std::cos(phi) * std::cos(theta), std::sin(phi), std::cos(phi) * std::sin(theta)};
  return {scale_by_power(point, unit_), normalized(rho < 0 ? -normal : normal)};
}

Landmarks Torus::landmarks() const {
  const auto length = [this](double x) { return scale_by_power(x, unit_); };
  Landmarks marks;
  marks.has_axis = true;
  marks.half = {size_, length(profile.tube), size_};
  if (profile.ring > profile.tube) return marks;
  const double height = length(std::sqrt((profile.tube - profile.ring) * (profile.tube + profile.ring)));
  const bool is_horn = profile.ring == profile.tube;
  for (const double y : {height, -height}) {
    marks.poles.push_back({0, y, 0});
    marks.singular.emplace_back(Vec3{0, y, 0},
                                is_horn ? Landmarks::Singular::cusp : Landmarks::Singular::crossing);
    if (is_horn) break;
  }
  return marks;
}

std::string_view Torus::variety() const {
  if (profile.ring > profile.tube) return "ring torus";
  return profile.ring == profile.tube ? "horn torus" : "spindle torus";
}

}  // namespace graze
