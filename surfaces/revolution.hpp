// What surfaces of revolution about the y axis share: bounding cylinder, circles, normals, and the document's
// system F(l, t, theta) = ray(l) - S(t, theta) (document 003).
//
// A Profile is a plain struct with the curve (R(t), Y(t)), t in [0, 1], in local units:
//   template <class T> BasicProfilePoint<T> at(T t) const; // R, Y and their first derivatives
//   double t_of_height(double y, double u) const;          // a t with Y(t) near y; u in [0,1) picks of
//   several Cylinder bounds() const;                               // encloses the surface, rounded outward
//   int max_hits() const;                                  // most distinct hits of a ray; 0 = not known
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <graze/surfaces/coefficients.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

template <class T>
struct BasicProfilePoint {
  T r = 0, y = 0;    ///< R(t), Y(t)
  T dr = 0, dy = 0;  ///< R'(t), Y'(t)
};
using ProfilePoint = BasicProfilePoint<double>;

/// x^2 + z^2 <= radius^2, y_lo <= y <= y_hi.
struct Cylinder {
  double radius = 0, y_lo = 0, y_hi = 0;
};

namespace revolution {

/// A relative margin that covers every rounding of the clip: fewer than 16 operations, each within u = 2^-53.
inline constexpr double kMargin = 32 * std::numeric_limits<double>::epsilon();

/// Squared distance from the axis.
inline double axis_distance2(Vec3 p) { return p.x * p.x + p.z * p.z; }

/// Intersects [lo, hi] with the delta range for which p_y + delta d_y lies in [y_lo, y_hi]. Outward rounded
/// by kMargin. Returns false when nothing is left.
inline bool clip_slab(const LocalRay& ray, const Cylinder& bounds, double& lo, double& hi) {
  const double below = bounds.y_lo - ray.p.y;
  const double above = bounds.y_hi - ray.p.y;
  if (ray.d.y == 0) return below <= 0 && above >= 0;
  const double a = below / ray.d.y;
  const double b = above / ray.d.y;
  const double near = std::min(a, b);
  const double far = std::max(a, b);
  lo = std::max(lo, near - kMargin * std::fabs(near));
  hi = std::min(hi, far + kMargin * std::fabs(far));
  return lo <= hi;
}

/// Intersects [lo, hi] with the delta range of the infinite cylinder. u = |p_x d_z - p_z d_x| / |d_xz| is the
/// ray's distance from the axis (this form needs no division by d_y).
inline bool clip_cylinder(const LocalRay& ray, const Cylinder& bounds, double& lo, double& hi) {
  const double radius2 = bounds.radius * bounds.radius * (1 + kMargin);
  const double direction2 = axis_distance2(ray.d);
  if (direction2 == 0) return axis_distance2(ray.p) <= radius2;
  const double cross = ray.p.x * ray.d.z - ray.p.z * ray.d.x;
  const double cross_error = kMargin * (std::fabs(ray.p.x * ray.d.z) + std::fabs(ray.p.z * ray.d.x));
  const double nearest = std::max(0.0, std::fabs(cross) - cross_error);
  const double chord2 = radius2 * direction2 - nearest * nearest;
  if (chord2 < 0) return false;
  const double middle_error = kMargin * (std::fabs(ray.p.x * ray.d.x) + std::fabs(ray.p.z * ray.d.z));
  const double middle = -(ray.p.x * ray.d.x + ray.p.z * ray.d.z);
  const double half = std::sqrt(chord2) * (1 + kMargin) + middle_error;
  const double a = (middle - half) / direction2;
  const double b = (middle + half) / direction2;
  lo = std::max(lo, a - kMargin * std::fabs(a));
  hi = std::min(hi, b + kMargin * std::fabs(b));
  return lo <= hi;
}

/// Recentres the ray and bounds delta by the cylinder and l >= 0; false: certainly no hit. A ray whose
/// coordinates leave the range of double keeps an unbounded range and is left to the formulation.
inline bool clip(LocalRay& ray, const Cylinder& bounds) {
  const double height = bounds.y_hi - bounds.y_lo;
  const double reach = std::max(bounds.radius, height);
  recentre(ray, {0, 0.5 * (bounds.y_lo + bounds.y_hi), 0}, 4 * reach);
  double lo = -ray.centre;
  double hi = std::numeric_limits<double>::infinity();
  if (!clip_slab(ray, bounds, lo, hi) || !clip_cylinder(ray, bounds, lo, hi)) return false;
  ray.lo = lo;
  ray.hi = hi;
  return true;
}

/// A clipped ray whose numbers are usable: finite, with a finite range.
inline bool is_usable(const LocalRay& ray) {
  return is_finite(ray.p) && is_finite(ray.d) && std::isfinite(ray.centre) && std::isfinite(ray.lo) &&
         std::isfinite(ray.hi);
}

/// |p_xz + delta d_xz|^2 - radius^2, ascending in delta: where a ray in the plane of a circle about the axis
/// meets it.
template <class T>
std::array<T, 3> circle_coefficients(T px, T pz, T dx, T dz, T radius) {
  return {sqr(px) + sqr(pz) - sqr(radius), exactly<T>(2) * (px * dx + pz * dz), sqr(dx) + sqr(dz)};
}

/// The hit at height y of the surface, for a ray that climbs: delta from the height over `from`, a coordinate
/// of the ray that is known to within its own rounding. For flat rays that rounding is all there is.
inline LocalHit hit_at_height(double y, double from, double d_y, double t) {
  const double error = 0x1p-51 * (std::fabs(y) + std::fabs(from)) / std::fabs(d_y);
  return {.delta = (y - from) / d_y, .t = t, .error = error};
}

/// Normal and theta at a hit of a profile point. `orientation` is the sign of the enclosed volume
/// pi * integral R^2 dY: +1 when the profile runs upward around the solid. On the axis, where a pole may be a
/// cone's tip without a tangent plane, the normal is (0, pole_direction, 0).
inline LocalPoint describe(const LocalRay& ray, const LocalHit& hit, const ProfilePoint& profile,
                           double orientation, double pole_direction) {
  const Vec3 x = ray.at(hit.delta);
  const double distance = std::hypot(x.x, x.z);
  LocalPoint point;
  point.params = {hit.t, distance == 0 ? 0.0 : std::atan2(x.z, x.x)};
  if (profile.r == 0 || distance == 0) {
    point.normal = {0, pole_direction, 0};
    return point;
  }
  // In the half plane (rho, y), rho = |R|, the profile's right-hand normal is (Y', -rho').
  const double radial = orientation * profile.dy;
  const double vertical = -orientation * std::copysign(1.0, profile.r) * profile.dr;
  point.normal = normalized({radial * x.x / distance, vertical, radial * x.z / distance});
  return point;
}

/// A point of the surface in object space: t = u, theta = 2 pi v; lengths are 2^unit times the profile's.
template <class Profile>
SurfaceSample sample(const Profile& profile, double orientation, int unit, double u, double v) {
  const ProfilePoint c = profile.at(u);
  const double theta = 2 * std::numbers::pi * v;
  const Vec3 radial{std::cos(theta), 0, std::sin(theta)};
  const Vec3 normal = c.dy * orientation * radial + Vec3{0, -orientation * c.dr, 0};
  return {scale_by_power(Vec3{c.r * radial.x, c.y, c.r * radial.z}, unit), normalized(normal)};
}

/// The box of the bounding cylinder in object space.
template <class Profile>
Bounds box(const Profile& profile, int unit) {
  const Cylinder c = profile.bounds();
  const Vec3 half{c.radius, 0.5 * (c.y_hi - c.y_lo), c.radius};
  return box_about({0, scale_by_power(0.5 * (c.y_lo + c.y_hi), unit), 0}, scale_by_power(half, unit));
}

/// Bounds and poles in object space.
template <class Profile>
Landmarks landmarks(const Profile& profile, int unit) {
  const Cylinder bounds = profile.bounds();
  const auto length = [unit](double x) { return scale_by_power(x, unit); };
  Landmarks marks;
  marks.has_axis = true;
  marks.centre = {0, length(0.5 * (bounds.y_lo + bounds.y_hi)), 0};
  marks.half = scale_by_power(Vec3{bounds.radius, 0.5 * (bounds.y_hi - bounds.y_lo), bounds.radius}, unit);
  for (const double t : {0.0, 1.0}) {
    const ProfilePoint end = profile.at(t);
    if (end.r == 0) marks.poles.push_back({0, length(end.y), 0});
  }
  return marks;
}

/// The document's system in (delta, t, theta): three unknowns, analytic Jacobian. The columns for t and theta
/// carry the minus sign that document 003 drops. theta has no bounds and period 2 pi.
template <class Profile>
struct System {
  const Profile* profile;
  LocalRay ray;

  template <class T>
  static void eval(const void* self, const BasicVector<T>& x, BasicVector<T>& f, BasicMatrix<T>& jacobian) {
    const auto& system = *static_cast<const System*>(self);
    const BasicProfilePoint<T> c = system.profile->at(x[1]);
    const auto [px, py, pz] = system.ray.template point_at<T>(x[0]);
    const T cosine = std::cos(x[2]);
    const T sine = std::sin(x[2]);
    f = {px - c.r * cosine, py - c.y, pz - c.r * sine};
    const Vec3& d = system.ray.d;
    jacobian[0] = {static_cast<T>(d.x), -c.dr * cosine, c.r * sine};
    jacobian[1] = {static_cast<T>(d.y), -c.dy, 0};
    jacobian[2] = {static_cast<T>(d.z), -c.dr * sine, -c.r * cosine};
  }

  /// A random slice of the bounding cylinder: the point where the ray meets it, uniform in height over the
  /// heights at which the ray is inside the cylinder (uniform in l for a horizontal ray, which meets one
  /// slice only); t from that height, theta from that point.
  template <class T>
  static bool start(const void* self, Rng& rng, BasicVector<T>& x) {
    const auto& system = *static_cast<const System*>(self);
    const double delta = rng.uniform(system.ray.lo, system.ray.hi);
    const Vec3 p = system.ray.at(delta);
    x[0] = static_cast<T>(delta);
    x[1] = static_cast<T>(system.profile->t_of_height(p.y, rng.uniform()));
    x[2] = static_cast<T>(std::atan2(p.z, p.x));
    return true;
  }

  static void pose(const Profile& profile, const LocalRay& ray, EquationBlock& block) {
    if (!is_usable(ray)) return block.settle(Status::failed);
    const auto* const self = block.arena().make(System{&profile, ray});
    if (block.precision() == Precision::binary32) {
      block.pose(self->template equation<float>());
    } else {
      block.pose(self->template equation<double>());
    }
  }

  template <class T>
  [[nodiscard]] BasicSystemEquation<T> equation() const {
    const Cylinder bounds = profile->bounds();
    constexpr T kInfinity = std::numeric_limits<T>::infinity();
    BasicSystemEquation<T> equation;
    equation.self = this;
    equation.unknowns = 3;
    equation.eval = &System::template eval<T>;
    equation.start = &System::template start<T>;
    equation.lo = {detail::lower_end<T>(ray.lo), 0, -kInfinity};
    equation.hi = {detail::upper_end<T>(ray.hi), 1, kInfinity};
    equation.period = {0, 0, 2 * std::numbers::pi_v<T>};
    equation.residual_scale = static_cast<T>(
        std::max({bounds.radius, std::fabs(bounds.y_lo), std::fabs(bounds.y_hi), max_abs(ray.p)}));
    equation.max_roots = profile->max_hits();
    equation.seed = ray.seed();
    return equation;
  }
};

}  // namespace revolution
}  // namespace graze
