// Axis-aligned boxes that hold surfaces, and the conservative tests by which they cull: rounded outward, so
// that culling never loses a hit.
#pragma once

#include <cmath>
#include <limits>

#include <graze/surfaces/spec.hpp>

namespace graze {

/// lo <= x <= hi; infinite ends where a surface is not bounded.
struct Bounds {
  Vec3 lo{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity()};
  Vec3 hi{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool is_finite() const { return graze::is_finite(lo) && graze::is_finite(hi); }
};

inline Bounds hull(const Bounds& a, const Bounds& b) {
  return {{std::min(a.lo.x, b.lo.x), std::min(a.lo.y, b.lo.y), std::min(a.lo.z, b.lo.z)},
          {std::max(a.hi.x, b.hi.x), std::max(a.hi.y, b.hi.y), std::max(a.hi.z, b.hi.z)}};
}

/// The box with centre c and half extents h, widened by a few ulps of both: covers the roundings of a surface
/// that computes its own box in at most 8 operations a coordinate.
inline Bounds box_about(Vec3 c, Vec3 h) {
  const auto widen = [](double centre, double half) {
    return half + 0x1p-49 * (std::fabs(centre) + half) + std::numeric_limits<double>::denorm_min();
  };
  const Vec3 wide{widen(c.x, h.x), widen(c.y, h.y), widen(c.z, h.z)};
  return {c - wide, c + wide};
}

/// Beyond this size boxes do not cull: differences of their coordinates could overflow.
inline constexpr double kCullable = 0x1p1000;
inline bool is_cullable(const Bounds& box) {
  return max_abs(box.lo) < kCullable && max_abs(box.hi) < kCullable;
}

/// A box in the world that holds the placed object's box: x_world = M x + T, |M| applied to the half extents,
/// widened by 2^-49 of the terms (each coordinate takes 7 operations, each within 2^-53 of its terms). Boxes
/// too large to cull become unbounded.
inline Bounds placed(const Bounds& box, const Placement& placement) {
  if (!is_cullable(box)) return {};
  if (placement.is_identity()) return box;
  const Vec3 c = 0.5 * box.lo + 0.5 * box.hi;
  const Vec3 h = 0.5 * box.hi - 0.5 * box.lo;
  const auto magnitude = [](Vec3 v) { return Vec3{std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; };
  const auto row = [&](const Vec3& m, double t, double& lo, double& hi) {
    const double centre = dot(m, c) + t;
    const double half = dot(magnitude(m), h);
    const double slack = 0x1p-49 * (dot(magnitude(m), magnitude(c)) + std::fabs(t) + half) +
                         std::numeric_limits<double>::denorm_min();
    lo = centre - half - slack;
    hi = centre + half + slack;
  };
  Bounds world;
  row(placement.matrix[0], placement.translate.x, world.lo.x, world.hi.x);
  row(placement.matrix[1], placement.translate.y, world.lo.y, world.hi.y);
  row(placement.matrix[2], placement.translate.z, world.lo.z, world.hi.z);
  return is_cullable(world) ? world : Bounds{};
}

/// What slab tests against many boxes need of one ray.
class SlabRay {
 public:
  explicit SlabRay(const Ray& ray) : o_(ray.o), d_(ray.d), inverse_{1 / ray.d.x, 1 / ray.d.y, 1 / ray.d.z} {
    const auto usual = [](double o, double d) {
      return std::fabs(o) < kCullable && std::fabs(d) > 1 / kCullable && std::fabs(d) < kCullable;
    };
    is_usual_ = usual(o_.x, d_.x) && usual(o_.y, d_.y) && usual(o_.z, d_.z);
  }

  /// Whether the ray may meet the box at some l in (0, far]; `near` becomes a lower bound of where. Each end
  /// (b - o) * inverse carries three roundings, or is off by less than 2^-1070 where it underflows: kMargin
  /// and kTiny cover them, and the roundings of the margins.
  [[nodiscard]] bool meets(const Bounds& box, double far, double& near) const {
    near = 0;
    if (!is_usual_) {
      return cut(o_.x, d_.x, inverse_.x, box.lo.x, box.hi.x, near, far) &&
             cut(o_.y, d_.y, inverse_.y, box.lo.y, box.hi.y, near, far) &&
             cut(o_.z, d_.z, inverse_.z, box.lo.z, box.hi.z, near, far);
    }
    const Vec3 a{(box.lo.x - o_.x) * inverse_.x, (box.lo.y - o_.y) * inverse_.y,
                 (box.lo.z - o_.z) * inverse_.z};
    const Vec3 b{(box.hi.x - o_.x) * inverse_.x, (box.hi.y - o_.y) * inverse_.y,
                 (box.hi.z - o_.z) * inverse_.z};
    const double entry = std::max({std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)});
    const double exit = std::min({std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)});
    near = std::max(0.0, entry - kMargin * std::fabs(entry) - kTiny);
    return near <= std::min(far, exit + kMargin * std::fabs(exit) + kTiny);
  }

 private:
  static constexpr double kMargin = 0x1p-50;
  static constexpr double kTiny = 0x1p-1060;

  /// Cuts [near, far] to one slab; false: certainly apart. A slab along which the ray runs (d = 0) is decided
  /// by the origin, without 0 * inf; one whose numbers leave the range does not cull.
  static bool cut(double o, double d, double inverse, double lo, double hi, double& near, double& far) {
    if (d == 0) return lo <= o && o <= hi;
    const double a = (lo - o) * inverse;
    const double b = (hi - o) * inverse;
    if (!std::isfinite(a) || !std::isfinite(b) || !(std::fabs(inverse) >= 1 / kCullable)) return true;
    const double entry = std::min(a, b);
    const double exit = std::max(a, b);
    near = std::max(near, entry - kMargin * std::fabs(entry) - kTiny);
    far = std::min(far, exit + kMargin * std::fabs(exit) + kTiny);
    return near <= far;
  }

  Vec3 o_, d_, inverse_;
  bool is_usual_ = false;
};

}  // namespace graze
