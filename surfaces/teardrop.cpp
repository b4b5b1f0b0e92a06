#include <graze/surfaces/teardrop.hpp>

#include <cmath>

namespace graze {
namespace {

template <class T>
constexpr T kUnit = std::numeric_limits<T>::epsilon() / 2;  // unit roundoff

// F'' is infinite at the bottom pole; this least t keeps it a number.
template <class T>
constexpr T kLeastT = std::is_same_v<T, double> ? T(0x1p-200) : T(0x1p-30F);

// Kinds of equation that the two sextic formulations pose.
enum Kind : std::uint32_t { kSextic, kAxis, kCircle };

std::array<Region, TeardropRegions::kParts> regions_in_t(const TeardropRegions& regions) {
  std::array<Region, TeardropRegions::kParts> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i] = {TeardropRegions::kEnds[i], regions.eps[i]};
  return parts;
}

/// The widest-circle parameter (sqrt 7 - 1)/3 = 0.548583770354863530... lies inside.
constexpr Interval kEquator{0.5485837703548635, 0.5485837703548636};

// ---------------------------------------------------------------------------------------- the sextics in t

/// R(t)^2 = m^2 (9 t^6 + 18 t^5 - 27 t^4 - 36 t^3 + 36 t^2), minus |a t^2 + b|^2 for plane vectors a and b,
/// ascending; R^2 is weighted by `weight`.
template <class T>
std::array<T, 7> sextic_coefficients(T m, T weight, T ax, T az, T bx, T bz) {
  const auto times = [](double k, T x) { return exactly<T>(k) * x; };
  const T r2 = sqr(m) * weight;
  const T aa = sqr(ax) + sqr(az);
  const T ab = ax * bx + az * bz;
  const T bb = sqr(bx) + sqr(bz);
  return {-bb,           T{},         times(36, r2) - times(2, ab), times(-36, r2), times(-27, r2) - aa,
          times(18, r2), times(9, r2)};
}

/// 3 m t^3 + 3 m t^2 - 6 m t + u, the axis case of document 000 (roots where R(t) = u).
template <class T>
std::array<T, 4> axis_coefficients(T m, T u) {
  const T three_m = exactly<T>(3) * m;
  return {u, exactly<T>(-6) * m, three_m, three_m};
}

/// R at the height y of a horizontal ray, from t = sqrt(y / 6m) and the factored profile.
template <class T>
T radius_at_height(T m, T y) {
  using std::sqrt;
  const T one = exactly<T>(1);
  const T six_m = exactly<T>(6) * m;
  const T t = sqrt(y / six_m);
  const T one_minus_t = (six_m - y) / (six_m * (one + t));
  return exactly<T>(3) * m * t * one_minus_t * (one + one + t);
}

/// The special cases that both sextics share: true if the ray was one of them. `o` is the point from which l
/// is counted (origin or p), `shift` = l of that point minus centre.
bool pose_special_case(const TeardropProfile& profile, const LocalRay& ray, Vec3 o, double shift,
                       const Epsilons& epsilons, EquationBlock& block) {
  if (ray.d.y == 0) {
    pose_polynomial(block, kCircle, Basis::power, ray.lo - shift, ray.hi - shift, {}, [&](auto number) {
      using T = decltype(number);
      const T radius = radius_at_height<T>(exactly<T>(profile.m), exactly<T>(ray.o.y));
      return revolution::circle_coefficients<T>(exactly<T>(o.x), exactly<T>(o.z), exactly<T>(ray.d.x),
                                                exactly<T>(ray.d.z), radius);
    });
    return true;
  }
  if (ray.d.x == 0 && ray.d.z == 0) {
    pose_polynomial(block, kAxis, Basis::power, 0, 1, epsilons, [&](auto number) {
      using T = decltype(number);
      using std::sqrt;
      return axis_coefficients<T>(exactly<T>(profile.m), sqrt(sqr(exactly<T>(o.x)) + sqr(exactly<T>(o.z))));
    });
    return true;
  }
  return false;
}

void lift_from_t(const TeardropProfile& profile, const LocalRay& ray, double y, double shift,
                 const Posed& posed, const Root& root, std::vector<LocalHit>& hits) {
  LocalHit hit{.delta = root.x + shift, .t = profile.t_of_height(ray.o.y, 0)};
  hit.multiplicity = root.multiplicity;
  if (posed.kind != kCircle) {
    hit = revolution::hit_at_height(6 * profile.m * root.x * root.x, y, ray.d.y, root.x);
    hit.delta += shift;
    // In t the bottom pole counts twice what it counts in l, for y = 6 m t^2.
    const bool at_bottom = root.x == 0 && posed.kind == kSextic;
    hit.multiplicity = at_bottom ? std::max(1U, root.multiplicity / 2) : root.multiplicity;
  }
  hits.push_back(hit);
}

// ------------------------------------------------------------------------------------------- F along the ray

/// Enclosures of the profile at a height y in [0, 6m].
struct HeightProfile {
  double m;

  [[nodiscard]] Interval six_m() const { return point(6) * point(m); }
  [[nodiscard]] Interval parameter(double y) const {
    const Interval v = point(y) / six_m();
    return sqrt(Interval{v.lo, std::min(1.0, v.hi)});
  }
  /// (1 - t)(2 + t) without cancellation: 1 - t = (6m - y) / (6m (1 + t)). Negative above the apex.
  [[nodiscard]] Interval taper(double y, Interval t) const {
    return (six_m() - point(y)) / (six_m() * (point(1) + t)) * (point(2) + t);
  }
  [[nodiscard]] Interval radius(double y) const {
    const Interval t = parameter(y);
    return point(3) * point(m) * t * taper(y, t);
  }
  /// 2 - 2t - 3t^2.
  [[nodiscard]] static Interval turn(Interval t) { return point(2) - t * (point(2) + point(3) * t); }
  /// R between two heights: it rises to the equator and falls behind it.
  [[nodiscard]] Interval radius_between(double lo, double hi, Interval at_lo, Interval at_hi) const {
    Interval r = hull(at_lo, at_hi);
    if (parameter(lo).lo <= kEquator.hi && parameter(hi).hi >= kEquator.lo)
      r.hi = mul_up(TeardropProfile::kWidest, m);
    return r;
  }
};

/// One ray's F(delta) = R^2 - |p_xz|^2, for points and for intervals. See also AlongAxis.
struct AlongRay {
  double m;
  double top;       ///< 6 m rounded
  double top_tail;  ///< 6 m - top
  HeightProfile profile;
  LocalRay ray;
  Interval px, py, pz;  ///< the exact point at delta = 0
  Interval slope;       ///< (p . d)_xz
  Interval curvature;   ///< |d_xz|^2

  AlongRay(const TeardropProfile& curve, const LocalRay& local)
      : m(curve.m), top(6 * m), top_tail(std::fma(6.0, m, -top)), profile{m}, ray(local) {}

  void prepare_intervals() {
    const auto [x, y, z] = recentred_point<Interval>(ray);
    px = x;
    py = y;
    pz = z;
    slope = px * point(ray.d.x) + pz * point(ray.d.z);
    curvature = sqr(point(ray.d.x)) + sqr(point(ray.d.z));
  }

  /// F, F', F''. With t = sqrt(y / 6m): (R^2)' = 3/2 m (1-t)(2+t)(2-2t-3t^2), and
  /// (R^2)'' = -1/4 ((1 + 1/2t)(2-2t-3t^2) + (1-t)(2+t)(3 + 1/t)) in y.
  template <class T>
  [[nodiscard]] BasicJet<T> jet(T delta) const {
    constexpr T kU = kUnit<T>;
    const auto [px_, py_, pz_] = ray.point_at<T>(delta);
    const T s = static_cast<T>(m), height = static_cast<T>(top);
    const T dx = static_cast<T>(ray.d.x), dy = static_cast<T>(ray.d.y), dz = static_cast<T>(ray.d.z);
    const T y = std::clamp(py_, T{0}, height);
    const T t = std::sqrt(y / height);
    const T below_top = std::max(T{0}, (height - y) + static_cast<T>(top_tail)) / height;
    const T one_minus_t = below_top / (1 + t);
    const T r = 3 * s * t * one_minus_t * (2 + t);
    const T turn = 2 - t * (2 + 3 * t);
    const T distance2 = px_ * px_ + pz_ * pz_;
    BasicJet<T> jet;
    jet.f = r * r - distance2;
    jet.df = T{1.5} * s * one_minus_t * (2 + t) * turn * dy - 2 * (px_ * dx + pz_ * dz);
    const T safe_t = std::max(t, kLeastT<T>);
    const T bend = T{-0.25} * ((1 + T{0.5} / safe_t) * turn + one_minus_t * (2 + t) * (3 + 1 / safe_t));
    jet.ddf = bend * dy * dy - 2 * (dx * dx + dz * dz);
    // y carries u |y|, so t carries 3u t and R at most 16 u m t (R <= 6 m t, |dR/dt| <= 6m; 9 operations).
    const T r_error = 16 * kU * s * t;
    jet.f_error = (2 * r + r_error) * r_error + 8 * kU * distance2;
    return jet;
  }

  /// y over x, cut to the slab.
  [[nodiscard]] Interval height(Interval x) const {
    const Interval y = py + point(ray.d.y) * x;
    const double highest = profile.six_m().hi;
    return {std::clamp(y.lo, 0.0, highest), std::clamp(y.hi, 0.0, highest)};
  }
  [[nodiscard]] Interval f(Interval x) const {
    const Interval y = height(x);
    const Interval r = profile.radius_between(y.lo, y.hi, profile.radius(y.lo), profile.radius(y.hi));
    return sqr(r) - sqr(px + point(ray.d.x) * x) - sqr(pz + point(ray.d.z) * x);
  }
  /// Both factors of (R^2)' fall with t, so each has its range at the ends.
  [[nodiscard]] Interval df(Interval x) const {
    const Interval y = height(x);
    const Interval t_lo = profile.parameter(y.lo);
    const Interval t_hi = profile.parameter(y.hi);
    const Interval tapering = hull(profile.taper(y.lo, t_lo), profile.taper(y.hi, t_hi));
    const Interval turning = hull(HeightProfile::turn(t_lo), HeightProfile::turn(t_hi));
    return point(1.5) * point(m) * tapering * turning * point(ray.d.y) - point(2) * (slope + curvature * x);
  }
};

/// A ray parallel to the axis at distance u. R^2 - u^2 has (nearly) double zeros at the apex, R - u an
/// infinite slope at the bottom. Intervals take R - u, continued beyond the poles with the other sign, so
/// that a root at a pole is a change of sign like any other. Points take (R^2 - u^2) / (9/2 m (1 - v) + u), v
/// = y/6m: like R - u near the apex, like R^2 - u^2 elsewhere, with the same zeros since the divisor is
/// positive.
struct AlongAxis {
  HeightProfile profile;
  LocalRay ray;
  double u;  ///< rounded
  Interval u_enclosed;
  Interval py;

  AlongAxis(const TeardropProfile& curve, const LocalRay& local)
      : profile{curve.m},
        ray(local),
        u(std::hypot(local.o.x, local.o.z)),
        u_enclosed(sqrt(sqr(point(local.o.x)) + sqr(point(local.o.z)))),
        py(recentred_point<Interval>(local)[1]) {}

  template <class T>
  [[nodiscard]] BasicJet<T> jet(T delta) const {
    constexpr T kU = kUnit<T>;
    const T m = static_cast<T>(profile.m), distance = static_cast<T>(u), dy = static_cast<T>(ray.d.y);
    const T y = ray.point_at<T>(delta)[1];
    const T v = y / (6 * m);
    const T below_apex = (6 * m - y) / (6 * m);
    const T t = std::sqrt(std::max(v, T{0}));
    const T taper = below_apex / (1 + t) * (2 + t);
    const T r = 3 * m * t * taper;
    const T turn = 2 - t * (2 + 3 * t);
    const T divisor = T{4.5} * m * std::max(below_apex, T{0}) + distance;
    constexpr T kDivisorSlope = T{-0.75};  // by y: -9/2 m / 6m
    // At the apex on the axis itself 0/0 has the limit 0, with the divisor's own slope.
    if (divisor == 0) return {0, kDivisorSlope * dy, 0, 0};
    const T squares =
        v < 0 ? 9 * m * m * v * taper * taper - distance * distance : (r - distance) * (r + distance);
    const T squares_slope = T{1.5} * m * taper * turn;
    const T safe_t = std::max(t, kLeastT<T>);
    const T squares_bend = T{-0.25} * ((1 + T{0.5} / safe_t) * turn + taper * (3 + 1 / safe_t));
    BasicJet<T> jet;
    jet.f = squares / divisor;
    const T slope = (squares_slope - jet.f * kDivisorSlope) / divisor;
    jet.df = slope * dy;
    jet.ddf = (squares_bend - 2 * slope * kDivisorSlope) / divisor * dy * dy;
    const T r_error = 16 * kU * m * t;
    jet.f_error =
        ((2 * r + r_error) * r_error + 4 * kU * distance * distance + 16 * kU * m * std::fabs(jet.f)) /
        divisor;
    return jet;
  }

  [[nodiscard]] Interval radius(double y) const { return y < 0 ? -profile.radius(-y) : profile.radius(y); }
  [[nodiscard]] Interval f(Interval x) const {
    const Interval y = py + point(ray.d.y) * x;
    return profile.radius_between(std::max(0.0, y.lo), std::max(0.0, y.hi), radius(y.lo), radius(y.hi)) -
           u_enclosed;
  }
  [[nodiscard]] Interval df(Interval x) const {
    const Interval y = abs(py + point(ray.d.y) * x);
    const Interval t = hull(profile.parameter(y.lo), profile.parameter(y.hi));
    return HeightProfile::turn(t) / (point(4) * t) * point(ray.d.y);
  }
};

/// The regions' ends as deltas of this ray, ascending.
Epsilons epsilons_along(const TeardropRegions& regions, const TeardropProfile& profile, const LocalRay& ray,
                        Arena& arena) {
  const double unit = profile.m / norm(ray.d);
  const std::span<Region> parts = arena.array<Region>(TeardropRegions::kParts);
  const bool upward = ray.d.y >= 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t part = upward ? i : parts.size() - 1 - i;
    parts[i].eps = regions.eps[part] * unit;
    if (i + 1 == parts.size()) break;  // the last part has no end
    const double t = TeardropRegions::kEnds[upward ? part : part - 1];
    const double rise = 6 * profile.m * t * t - ray.p.y;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    parts[i].end = ray.d.y != 0 ? rise / ray.d.y : rise >= 0 ? kInfinity : -kInfinity;
  }
  // |F'| = 2 R |d| |grad| cos: below 2^-9 of its size on the body the ray grazes.
  return {parts, regions.eps[TeardropRegions::kParts] * unit, 0x1p-9 * profile.m * norm(ray.d)};
}

}  // namespace

// ------------------------------------------------------------------------------------------------- sextic

TeardropInT::TeardropInT(const Teardrop& surface)
    : profile(surface.profile), regions(regions_in_t(surface.regions)), grazing_eps(surface.regions.eps[5]) {}

FormulationInfo TeardropSextic::info() {
  return {"sextic",
          "R(t)^2 = |A t^2 + B|^2 in t, divided by q_y, about the ray's own origin",
          "document 000; t in [0,1] closed",
          {Form::polynomial},
          6};
}

void TeardropSextic::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  const Epsilons epsilons{regions, grazing_eps, 0};
  if (pose_special_case(profile, ray, ray.o, -ray.centre, epsilons, block)) return;
  pose_polynomial(block, kSextic, Basis::power, 0, 1, epsilons, [&](auto number) {
    using T = decltype(number);
    const T m = exactly<T>(profile.m);
    const T rx = exactly<T>(ray.o.x), ry = exactly<T>(ray.o.y), rz = exactly<T>(ray.o.z);
    const T qx = exactly<T>(ray.d.x), qy = exactly<T>(ray.d.y), qz = exactly<T>(ray.d.z);
    const T six_m = exactly<T>(6) * m;
    const T a = six_m * qx / qy, b = rx - ry * qx / qy;
    const T c = six_m * qz / qy, d = rz - ry * qz / qy;
    return sextic_coefficients<T>(m, exactly<T>(1), a, c, b, d);
  });
}

void TeardropSextic::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                          std::vector<LocalHit>& hits) const {
  lift_from_t(profile, ray, ray.o.y, -ray.centre, posed, root, hits);
}

// -------------------------------------------------------------------------------------- sextic_homogeneous

FormulationInfo TeardropSexticHomogeneous::info() {
  return {"sextic_homogeneous",
          "q_y^2 R(t)^2 = |q_xz (Y(t) - p_y) + q_y p_xz|^2 in t, recentred",
          "document 000 multiplied by q_y^2; recentred about the closest approach",
          {Form::polynomial},
          6};
}

void TeardropSexticHomogeneous::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  const Epsilons epsilons{regions, grazing_eps, 0};
  if (pose_special_case(profile, ray, ray.p, 0, epsilons, block)) return;
  pose_polynomial(block, kSextic, Basis::power, 0, 1, epsilons, [&](auto number) {
    using T = decltype(number);
    const T m = exactly<T>(profile.m);
    const T qx = exactly<T>(ray.d.x), qy = exactly<T>(ray.d.y), qz = exactly<T>(ray.d.z);
    const auto [px, py, pz] = recentred_point<T>(ray);
    const T six_m = exactly<T>(6) * m;
    return sextic_coefficients<T>(m, sqr(qy), six_m * qx, six_m * qz, qy * px - qx * py, qy * pz - qz * py);
  });
}

void TeardropSexticHomogeneous::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                                     std::vector<LocalHit>& hits) const {
  lift_from_t(profile, ray, ray.p.y, 0, posed, root, hits);
}

// ----------------------------------------------------------------------------------------------- along_ray

TeardropAlongRay::TeardropAlongRay(const Teardrop& surface)
    : profile(surface.profile), regions(surface.regions) {}

FormulationInfo TeardropAlongRay::info() {
  return {"along_ray",
          "F(l) = R(t(y))^2 - |x_xz|^2 in l, recentred: smooth through q_y = 0",
          "graze (surfaces/teardrop.md)",
          {Form::scalar, Form::interval}};
}

void TeardropAlongRay::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  if (ray.d.x == 0 && ray.d.z == 0) {
    pose_function(AlongAxis(profile, ray), ray, block);
  } else {
    AlongRay function(profile, ray);
    if (block.form() == Form::interval) function.prepare_intervals();
    pose_function(function, ray, block);
  }
}

template <class Function>
void TeardropAlongRay::pose_function(const Function& function, const LocalRay& ray,
                                     EquationBlock& block) const {
  const Function* const self = block.arena().make(function);
  if (block.form() == Form::scalar) {
    pose_scalar(block, 0, self, ray.lo, ray.hi, profile.max_hits(), ray.seed());
  } else {
    pose_interval(block, 0, self, ray.lo, ray.hi, epsilons_along(regions, profile, ray, block.arena()));
  }
}

void TeardropAlongRay::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                            std::vector<LocalHit>& hits) const {
  hits.push_back({.multiplicity = root.multiplicity,
                  .delta = root.x,
                  .t = profile.t_of_height(std::fma(root.x, ray.d.y, ray.p.y), 0),
                  .is_root = true});
}

// -------------------------------------------------------------------------------------------------- system

TeardropSystem::TeardropSystem(const Teardrop& surface) : profile(surface.profile) {}

FormulationInfo TeardropSystem::info() {
  return {"system",
          "o + l d = S(t, theta): three equations in (l, t, theta), recentred",
          "document 003 with the sign of its Jacobian corrected",
          {Form::system}};
}

void TeardropSystem::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                          std::vector<LocalHit>& hits) const {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x, .t = root.others[0]});
}

// ------------------------------------------------------------------------------------------------ teardrop

SurfaceInfo Teardrop::info() {
  SurfaceInfo info;
  info.summary = "Bezier profile (0,0), (2s,0), (3s,2s), (0,6s) revolved about y";
  info.source = "document 000";
  info.page = "surfaces/teardrop.md";
  info.parameters = {"s"};
  info.params = {"t", "theta"};
  info.regions = {TeardropRegions::kNames.begin(), TeardropRegions::kNames.end()};
  return info;
}

Parameters Teardrop::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"s"}};
  return scale_lengths(parameters, kLengths, factor);
}

Teardrop::Teardrop(const SurfaceSpec& spec) : s_(spec.parameters.number("s")) {
  if (s_ <= 0) throw std::invalid_argument("parameter 's' must be positive");
  unit_ = exponent_of(s_);
  profile.m = scale_by_power(s_, -unit_);
  // Defaults, measured (surfaces/teardrop.md): above the rounding floor of F in double, region by region.
  regions.eps = {0x1p-40, 0x1p-44, 0x1p-44, 0x1p-44, 0x1p-40, 0x1p-24};
  override_eps(spec, TeardropRegions::kNames, regions.eps);
}

LocalPoint Teardrop::describe(const LocalRay& ray, const LocalHit& hit) const {
  return revolution::describe(ray, hit, profile.at(hit.t), 1.0, hit.t < 0.5 ? -1.0 : 1.0);
}

}  // namespace graze
