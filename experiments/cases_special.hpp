// Case families that aim at what makes a surface hard: its faces, edges, singular points and asymptotes, its
// own points, and the ends of double's range. Private to cases.cpp.
#pragma once

#include <vector>

#include "cases_aim.hpp"

namespace graze::special {

using aim::log_uniform, aim::random_index, aim::random_sign, aim::reach;

inline bool with_parallels(const Landmarks& marks) { return !marks.parallels.empty(); }
inline bool with_edges(const Landmarks& marks) { return !marks.edges.empty(); }
inline bool with_asymptotes(const Landmarks& marks) { return !marks.asymptotes.empty(); }
/// A flat figure has no inside.
inline bool not_flat(const Landmarks& marks) { return !aim::spans_a_plane(marks.parallels); }
/// A line through two points of a face lies in it.
inline bool without_faces(const Landmarks& marks) { return not_flat(marks) && marks.edges.empty(); }

template <Landmarks::Singular kind>
std::vector<Vec3> singular_points(const Landmarks& marks) {
  std::vector<Vec3> points;
  for (const auto& [point, is] : marks.singular) {
    if (is == kind) points.push_back(point);
  }
  return points;
}

template <Landmarks::Singular kind>
bool with_singular(const Landmarks& marks) {
  return !singular_points<kind>(marks).empty();
}

/// A direction along the surface. Of figures and solids every second one is made of edges, without rounding
/// where their ends have few bits: an edge, or i a + j b for two edges a, b with a common end.
inline Vec3 along_surface(const Landmarks& marks, Rng& rng) {
  const Vec3 parallel = marks.parallels[random_index(rng, marks.parallels.size())];
  if (marks.edges.empty() || rng.uniform() < 0.5) return parallel;
  const std::array<Vec3, 2>& a = marks.edges[random_index(rng, marks.edges.size())];
  const std::array<Vec3, 2>& b = marks.edges[random_index(rng, marks.edges.size())];
  const Vec3 along = aim::near_one(a[1] - a[0]);
  const bool meet = a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
  const auto weight = [&rng] { return static_cast<double>(random_index(rng, 7)) - 3; };
  const double i = weight();
  const Vec3 mixed = i * (a[1] - a[0]) + weight() * (b[1] - b[0]);
  // Nearly opposite edges may cancel: then the edge itself.
  return meet && max_abs(mixed) > 0x1p-10 * max_abs(a[1] - a[0]) ? aim::near_one(mixed) : along;
}

/// The direction, tilted by 0 or 1e-16 to 1e-2; `tilt` says by how much.
inline Vec3 tilted(Vec3 direction, Rng& rng, double& tilt) {
  tilt = aim::is_special(rng) ? 0 : log_uniform(rng, -16, -2);
  return tilt == 0 ? direction : direction + tilt * aim::random_tangent(normalized(direction), rng);
}

/// 0, or 1e-16 to 1e-1.
inline double random_offset(Rng& rng) { return aim::is_special(rng) ? 0 : log_uniform(rng, -16, -1); }

inline CaseRay make_parallel(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  double tilt = 0;
  const Vec3 direction = tilted(along_surface(marks, rng), rng, tilt);
  const SurfaceSample sample = aim::random_sample(surface, rng);
  const double offset = random_sign(rng) * random_offset(rng);
  const Vec3 target = sample.point + offset * surface.size() * sample.normal;
  const double distance = rng.uniform(1, 4) * reach(marks) / norm(direction);
  return {aim::through(target, direction, distance), tilt};
}

inline CaseRay make_edge(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const std::array<Vec3, 2>& edge = marks.edges[random_index(rng, marks.edges.size())];
  const double offset = random_offset(rng);
  // One point in four is a vertex. The others of an exact ray lie at sixteenths of the edge, which few bits
  // hold.
  const double sixteenths = static_cast<double>(1 + random_index(rng, 15)) / 16;
  const double t = rng.uniform() < 0.25 ? 0 : offset == 0 ? sixteenths : rng.uniform();
  const auto [from, to] = rng.uniform() < 0.5 ? edge : std::array<Vec3, 2>{edge[1], edge[0]};
  return {aim::past(from + t * (to - from), offset * surface.size(), reach(marks), rng), offset};
}

inline CaseRay make_on_surface(const AnySurface& surface, Rng& rng) {
  const SurfaceSample sample = aim::random_sample(surface, rng);
  const bool by_ulps = rng.uniform() < 0.5;
  const int steps = aim::random_steps(rng);
  const double offset = random_sign(rng) * log_uniform(rng, -16, -10) * surface.size();
  const Vec3 origin = by_ulps ? aim::moved_by_ulps(sample.point, sample.normal, surface.size(), steps)
                              : sample.point + offset * sample.normal;
  return {{origin, aim::random_direction(rng)}, norm(origin - sample.point) / surface.size()};
}

inline CaseRay make_tangent(const AnySurface& surface, Rng& rng) {
  const SurfaceSample sample = aim::random_sample(surface, rng);
  const int steps = aim::is_special(rng) ? 0 : aim::random_steps(rng);
  const Vec3 target = aim::moved_by_ulps(sample.point, sample.normal, surface.size(), steps);
  const double distance = rng.uniform(1, 4) * reach(surface.landmarks());
  return {aim::through(target, aim::random_tangent(sample.normal, rng), distance), std::abs(steps) * 1.0};
}

/// u + step, or u - step where that leaves [0, 1).
inline double neighbour(double u, double step) {
  const double v = u + step;
  return v >= 0 && v < 1 ? v : u - step;
}

inline CaseRay make_cluster(const AnySurface& surface, Rng& rng) {
  const double u = rng.uniform();
  const double v = rng.uniform();
  const double step = log_uniform(rng, -14, -2);
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const SurfaceSample first = surface.sample(u, v);
  const Vec3 second =
      surface.sample(neighbour(u, step * std::cos(angle)), neighbour(v, step * std::sin(angle))).point;
  const Vec3 chord = second - first.point;
  // Samples that round to one point leave the tangent.
  const Vec3 direction = max_abs(chord) > 0 ? normalized(chord) : aim::random_tangent(first.normal, rng);
  const double distance = rng.uniform(1, 4) * reach(surface.landmarks());
  return {aim::through(first.point, direction, distance), norm(chord) / surface.size()};
}

inline CaseRay make_parabolic(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  double tilt = 0;
  const Vec3 asymptote = random_sign(rng) * marks.asymptotes[random_index(rng, marks.asymptotes.size())];
  const Vec3 direction = tilted(asymptote, rng, tilt);
  return {aim::through(aim::random_target(marks, rng), direction, rng.uniform(1.5, 4) * reach(marks)), tilt};
}

template <Landmarks::Singular kind>
CaseRay make_singular(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const std::vector<Vec3> points = singular_points<kind>(marks);
  const double offset = random_offset(rng);
  const Vec3 point = points[random_index(rng, points.size())];
  return {aim::past(point, offset * surface.size(), reach(marks), rng), offset};
}

// ------------------------------------------------------------------------------------------------- extreme

/// Exponents of the numbers in the family `extreme`: 2^980 is 1e295. The rest of double's range is left to
/// the distance of the hits in units of |d|, so that every exact l is a normal double.
constexpr double kExtremeExponent = 980;

/// 2^k of either kind, 1e-295 to 1e-15 or 1e15 to 1e295.
inline double tiny(Rng& rng) {
  return std::ldexp(rng.uniform(1, 2), -static_cast<int>(rng.uniform(50, kExtremeExponent)));
}
inline double huge(Rng& rng) { return std::ldexp(1.0, static_cast<int>(rng.uniform(50, kExtremeExponent))); }

constexpr std::array<double Vec3::*, 3> kAxes{&Vec3::x, &Vec3::y, &Vec3::z};
/// A coordinate of x, y, z.
inline double Vec3::*random_axis(Rng& rng) { return kAxes[random_index(rng, kAxes.size())]; }

/// A power of two times |d|: l goes the other way.
inline CaseRay with_scaled_direction(Ray ray, const Landmarks& marks, Rng& rng) {
  const double factor = rng.uniform() < 0.5 ? huge(rng) : 1 / huge(rng);
  // |l d| is a few times the reach: what the reach takes of the range is taken from the factor.
  const double r = reach(marks);
  const double fitting = factor > 1 ? factor * std::min(1.0, r) : factor * std::max(1.0, r);
  const double power = std::ldexp(1.0, std::ilogb(fitting));
  return {{ray.o, power * ray.d}, std::fabs(std::log10(power))};
}

/// From very far along a coordinate axis, where the other coordinates keep their bits. No double could tell
/// two hits apart from there: the ray passes the bounds at up to their own size, unless the surface is flat
/// and is hit once.
inline CaseRay from_very_far(Vec3 target, const Landmarks& marks, Rng& rng) {
  const std::size_t along = random_index(rng, kAxes.size());
  double Vec3::*const axis = kAxes[along];
  double Vec3::*const aside = kAxes[(along + 1 + random_index(rng, 2)) % kAxes.size()];
  const double sign = random_sign(rng);
  Ray ray{target, {0, 0, 0}};
  if (not_flat(marks))
    ray.o.*aside = marks.centre.*aside + random_sign(rng) * rng.uniform(1.01, 2) * reach(marks);
  const double distance = std::max(1.0, reach(marks)) * huge(rng);
  ray.o.*axis = -sign * distance;
  ray.d.*axis = sign;
  return {ray, std::log10(distance)};
}

/// One coordinate of the origin is all but zero.
inline CaseRay with_tiny_origin(Ray ray, Rng& rng) {
  const double value = random_sign(rng) * tiny(rng);
  ray.o.*random_axis(rng) = value;
  return {ray, std::fabs(std::log10(std::fabs(value)))};
}

/// One coordinate of the direction is all but zero, in one ray of four subnormal.
inline CaseRay with_tiny_direction(Vec3 target, const Landmarks& marks, Rng& rng) {
  const double subnormal = static_cast<double>(1 + random_index(rng, 1000)) * 0x1p-1074;
  const double value = random_sign(rng) * (aim::is_special(rng) ? subnormal : tiny(rng));
  Vec3 direction = aim::random_direction(rng);
  direction.*random_axis(rng) = value;
  return {aim::through(target, direction, rng.uniform(1.5, 4) * reach(marks)),
          std::fabs(std::log10(std::fabs(value)))};
}

inline CaseRay make_extreme(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const Vec3 target = aim::random_target(marks, rng);
  const Ray plain = aim::through(target, aim::random_direction(rng), rng.uniform(1.5, 4) * reach(marks));
  // A nearly parallel ray may meet an unbounded surface beyond double's range, and from very far one that is
  // not flat meets it twice where no double tells the hits apart: such rays stay out.
  const bool is_bounded = surface.bounds().is_finite();
  const std::size_t kind = random_index(rng, 4);
  if (kind == 0) return with_tiny_origin(plain, rng);
  if (kind == 1 && is_bounded) return with_tiny_direction(target, marks, rng);
  if (kind == 2 && (is_bounded || !not_flat(marks))) return from_very_far(target, marks, rng);
  return with_scaled_direction(plain, marks, rng);
}

}  // namespace graze::special
