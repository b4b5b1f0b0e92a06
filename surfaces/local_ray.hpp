// A ray in a surface's own frame: object space, unit size, recentred.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// Local frame: lengths in units of 2^unit (the surface's size, rounded down to a power of two), direction
/// scaled by a power of two so that its largest component lies in [1, 2). Both steps are exact (short of
/// underflow below 2^-1022 of the surface's size), so scaling a scene by 2^k changes no bit of what follows.
/// Where a bit is lost all the same, is_exact is false: exact numbers come from the world's ray instead
/// (origin_as, direction_as in coefficients.hpp).
/// Recentred, for far origins: x = p + delta d with delta = l - centre, p = fma(centre, d, o) rounded once
/// a coordinate; centre is a double near the ray's closest approach to the surface, 0 when o is near anyway.
struct LocalRay {
  Vec3 o;                     ///< origin
  Vec3 d;                     ///< direction, max |d_i| in [1, 2)
  double centre = 0;          ///< l of p
  Vec3 p;                     ///< the point of the ray at l = centre
  int l_exponent = 0;         ///< l of the world = l here * 2^l_exponent
  std::uint32_t surface = 0;  ///< which surface of its group it is a ray of
  double lo = 0, hi = 0;      ///< delta range inside the bounds, outward rounded; lo >= -centre (l >= 0)
  bool is_exact = true;       ///< o and d are the world's, scaled, to the last bit
  int unit = 0;               ///< the world's o = o * 2^unit, its d = d * 2^(unit - l_exponent)
  Ray world{};

  /// The point at delta, one rounding a coordinate.
  [[nodiscard]] Vec3 at(double delta) const {
    return {std::fma(delta, d.x, p.x), std::fma(delta, d.y, p.y), std::fma(delta, d.z, p.z)};
  }
  /// The same in the arithmetic of T: direction and p are rounded to it.
  template <class T>
  [[nodiscard]] std::array<T, 3> point_at(T delta) const {
    return {std::fma(delta, static_cast<T>(d.x), static_cast<T>(p.x)),
            std::fma(delta, static_cast<T>(d.y), static_cast<T>(p.y)),
            std::fma(delta, static_cast<T>(d.z), static_cast<T>(p.z))};
  }
  /// Names the ray: equal for rays that differ by a power-of-two scale of the scene or the direction.
  [[nodiscard]] std::uint64_t seed() const {
    std::uint64_t hash = 0;
    for (const double value : {o.x, o.y, o.z, d.x, d.y, d.z}) hash = hash_combine(hash, value);
    return hash;
  }
};

/// Whether x 2^k is `scaled`, no bit lost below the smallest double or above the largest.
inline bool is_same_scaled(Vec3 x, int k, Vec3 scaled) {
  const auto is_same = [k](double own, double other) {
    // A normal number has lost nothing.
    const bool is_normal = std::fabs(own) >= std::numeric_limits<double>::min() && std::isfinite(own);
    return is_normal || scale_by_power(own, k) == other;
  };
  return is_same(x.x, scaled.x) && is_same(x.y, scaled.y) && is_same(x.z, scaled.z);
}

/// The ray in units of 2^unit, not yet recentred or clipped.
inline LocalRay to_unit(const Ray& ray, int unit) {
  const int direction_exponent = exponent_of(max_abs(ray.d));
  LocalRay local;
  local.o = scale_by_power(ray.o, -unit);
  local.d = scale_by_power(ray.d, -direction_exponent);
  local.p = local.o;
  local.l_exponent = unit - direction_exponent;
  local.unit = unit;
  local.world = ray;
  local.is_exact = is_same_scaled(local.o, unit, ray.o) && is_same_scaled(local.d, direction_exponent, ray.d);
  return local;
}

/// Measures l in units 2^shift times as large: that moves from l to d, which need not be in [1, 2) then.
/// Needs: centre = 0.
inline void measure_l(LocalRay& ray, int shift) {
  ray.l_exponent += shift;
  const int exponent = ray.unit - ray.l_exponent;
  ray.d = scale_by_power(ray.world.d, -exponent);
  ray.is_exact = is_same_scaled(ray.o, ray.unit, ray.world.o) && is_same_scaled(ray.d, exponent, ray.world.d);
}

/// Moves p to l = centre.
inline void set_centre(LocalRay& ray, double centre) {
  ray.centre = centre;
  ray.p = {std::fma(centre, ray.d.x, ray.o.x), std::fma(centre, ray.d.y, ray.o.y),
           std::fma(centre, ray.d.z, ray.o.z)};
}

/// Moves p to the closest approach of the ray to `target`, unless the origin is within `near` of it.
inline void recentre(LocalRay& ray, Vec3 target, double near) {
  const Vec3 to_target = target - ray.o;
  if (max_abs(to_target) <= near) return;
  set_centre(ray, dot(to_target, ray.d) / dot(ray.d, ray.d));
}

/// The same, but p stays the origin where the numbers leave the range of double.
inline void recentre_within_range(LocalRay& ray, Vec3 target, double near) {
  recentre(ray, target, near);
  if (std::isfinite(ray.centre) && is_finite(ray.p)) return;
  ray.centre = 0;
  ray.p = ray.o;
}

}  // namespace graze
