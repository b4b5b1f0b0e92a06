// How case families aim: random draws, points and directions that they share. Private to cases.cpp.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <graze/solvers/math/rng.hpp>

#include "cases.hpp"

namespace graze::aim {

/// 10^uniform(lo, hi).
inline double log_uniform(Rng& rng, double lo, double hi) { return std::pow(10.0, rng.uniform(lo, hi)); }

inline double random_sign(Rng& rng) { return rng.uniform() < 0.5 ? -1.0 : 1.0; }

/// 0, ..., count - 1.
inline std::size_t random_index(Rng& rng, std::size_t count) {
  return static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
}

/// One ray in four is special: it meets what it aims at exactly.
inline bool is_special(Rng& rng) { return rng.uniform() < 0.25; }

/// Uniform on the unit sphere (Archimedes: height and angle are uniform).
inline Vec3 random_direction(Rng& rng) {
  const double height = rng.uniform(-1, 1);
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - height * height);
  return {radius * std::cos(angle), height, radius * std::sin(angle)};
}

/// A random unit vector orthogonal to n.
inline Vec3 random_tangent(Vec3 n, Rng& rng) {
  while (true) {
    const Vec3 d = random_direction(rng);
    const Vec3 tangent = d - dot(d, n) * n;
    if (norm(tangent) > 0.1) return normalized(tangent);
  }
}

/// Radius of the ball about the bounds.
inline double reach(const Landmarks& marks) { return norm(marks.half); }

/// A point of the bounding box, or cylinder for surfaces with an axis.
inline Vec3 random_target(const Landmarks& marks, Rng& rng) {
  const double up = rng.uniform(-1, 1) * marks.half.y;
  if (!marks.has_axis) {
    return marks.centre + Vec3{rng.uniform(-1, 1) * marks.half.x, up, rng.uniform(-1, 1) * marks.half.z};
  }
  const double radius = marks.half.x * std::sqrt(rng.uniform());
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  return marks.centre + Vec3{radius * std::cos(angle), up, radius * std::sin(angle)};
}

inline SurfaceSample random_sample(const AnySurface& surface, Rng& rng) {
  const double u = rng.uniform();
  return surface.sample(u, rng.uniform());
}

/// A ray through `target` along `direction` that starts `distance` before it.
inline Ray through(Vec3 target, Vec3 direction, double distance) {
  return {target - distance * direction, direction};
}

/// A ray through `point` from 1 to 4 times `reach` away that meets it at l = 1: exactly, if the point's
/// coordinates have about 20 bits to spare. The origin lies on a grid of 2^-20 of the reach, so that point -
/// origin is an exact number, and that is the direction.
inline Ray exactly_through(Vec3 point, double reach, Rng& rng) {
  const Vec3 away = rng.uniform(1, 4) * reach * random_direction(rng);
  const double grid = std::ldexp(1.0, std::ilogb(reach) - 20);
  const auto snapped = [grid](double x) { return grid * std::nearbyint(x / grid); };
  const Vec3 origin{snapped(point.x + away.x), snapped(point.y + away.y), snapped(point.z + away.z)};
  return {origin, point - origin};
}

/// A ray that passes `point` at `offset` in a random direction; through the point itself for offset 0.
inline Ray past(Vec3 point, double offset, double reach, Rng& rng) {
  if (offset == 0) return exactly_through(point, reach, rng);
  const Vec3 direction = random_direction(rng);
  const Vec3 target = point + offset * random_tangent(direction, rng);
  return through(target, direction, rng.uniform(1, 4) * reach);
}

/// The point moved along its normal by `steps` ulps in the coordinate along which n is largest, outward for
/// steps > 0. Ulps of the coordinate, or of the size where that is larger: a coordinate 0 moves too.
inline Vec3 moved_by_ulps(Vec3 point, Vec3 n, double size, int steps) {
  double Vec3::*axis = &Vec3::x;
  if (std::fabs(n.y) > std::fabs(n.*axis)) axis = &Vec3::y;
  if (std::fabs(n.z) > std::fabs(n.*axis)) axis = &Vec3::z;
  const double ulp = std::ldexp(1.0, std::ilogb(std::max(std::fabs(point.*axis), size)) - 52);
  point.*axis += std::copysign(ulp, n.*axis) * steps;
  return point;
}

/// Whole steps -4, ..., 4.
inline int random_steps(Rng& rng) { return static_cast<int>(random_index(rng, 9)) - 4; }

/// v times the power of two that brings its largest coordinate to [1, 2): exact.
inline Vec3 near_one(Vec3 v) { return std::ldexp(1.0, -std::ilogb(max_abs(v))) * v; }

/// Whether the directions span a plane, no line and no space, to rounding: the mark of a flat figure.
inline bool spans_a_plane(const std::vector<Vec3>& directions) {
  constexpr double kRounding = 0x1p-40;  // unit vectors are good to 2^-51; no figure is this slender
  Vec3 normal;
  for (const Vec3& d : directions) {
    const Vec3 n = cross(directions.front(), d);
    if (norm(n) > norm(normal)) normal = n;
  }
  if (norm(normal) <= kRounding) return false;
  return std::all_of(directions.begin(), directions.end(),
                     [n = normalized(normal)](Vec3 d) { return std::fabs(dot(n, d)) <= kRounding; });
}

}  // namespace graze::aim
