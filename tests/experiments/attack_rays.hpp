// Rays for the adversarial search: structured ones, on which decisions are ties or nearly so, and the moves
// by which a search goes from ray to ray.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze::test {

/// The six numbers of a ray: o.x, o.y, o.z, d.x, d.y, d.z.
inline constexpr std::size_t kNumbers = 6;
inline double& number(Ray& ray, std::size_t i) {
  Vec3& part = i < 3 ? ray.o : ray.d;
  return i % 3 == 0 ? part.x : i % 3 == 1 ? part.y : part.z;
}

inline std::size_t pick(Rng& rng, std::size_t count) {
  return static_cast<std::size_t>(rng.uniform() * static_cast<double>(count));
}
inline bool chance(Rng& rng, double probability) { return rng.uniform() < probability; }
/// -bound, ..., bound.
inline int whole(Rng& rng, int bound) {
  return static_cast<int>(pick(rng, static_cast<std::size_t>(2 * bound + 1))) - bound;
}

/// The place of a double in the order of doubles: neighbours differ by 1; both zeros are 0.
inline std::int64_t place_of(double x) {
  const auto bits = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(std::fabs(x)));
  return std::signbit(x) ? -bits : bits;
}
/// The double at that place; the largest finite one beyond the ends.
inline double double_at(std::int64_t place) {
  constexpr std::int64_t kLargest = 0x7fef'ffff'ffff'ffff;
  const auto bits = std::bit_cast<double>(std::min(std::abs(place), kLargest));
  return place < 0 ? -bits : bits;
}

/// The least step of a number: 2^-112 of its vector, or of L for origins. Below that a search would go on
/// towards zero without end, and zeros would become subnormal at the first step.
inline double least_step(const Ray& ray, std::size_t i, double size) {
  return 0x1p-112 * (i < 3 ? std::max(max_abs(ray.o), size) : max_abs(ray.d));
}
/// One of the numbers some ulps aside.
inline void step_aside(Ray& ray, std::size_t i, double ulps, double size) {
  const double least = least_step(ray, i, size);
  double& x = number(ray, i);
  x += ulps * std::max(ulp(x), least);
}

/// x with its mantissa cut to `bits` bits.
inline double cut(double x, int bits) {
  if (x == 0 || !std::isfinite(x)) return x;
  const int exponent = std::ilogb(x);
  return std::ldexp(std::trunc(std::ldexp(x, bits - exponent)), exponent - bits);
}
inline Vec3 cut(Vec3 v, int bits) { return {cut(v.x, bits), cut(v.y, bits), cut(v.z, bits)}; }

inline Vec3 small_integers(Rng& rng, int bound) {
  const int x = whole(rng, bound), y = whole(rng, bound), z = whole(rng, bound);
  return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
}

// ------------------------------------------------------------------------------------------------ structured

/// The power of two just below the size.
inline double grid_of(const AnySurface& surface) { return std::ldexp(1.0, std::ilogb(surface.size())); }

/// A point worth aiming at: a landmark, an extreme of the bounds, a lattice point, a point of the surface.
inline Vec3 target_point(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  std::vector<Vec3> points{marks.centre};
  points.insert(points.end(), marks.poles.begin(), marks.poles.end());
  for (const auto& [point, kind] : marks.singular) points.push_back(point);
  for (const auto& [from, to] : marks.edges) {
    points.push_back(from);
    points.push_back(from + (1 + static_cast<double>(pick(rng, 15))) / 16 * (to - from));
  }
  switch (pick(rng, 5)) {
    case 0: {
      const Vec3 lattice = 0.125 * grid_of(surface) * small_integers(rng, 16);
      return chance(rng, 0.5) ? lattice : marks.centre + lattice;
    }
    case 1: {
      // Where the tangent plane is a coordinate plane, for what is symmetric about its middle.
      const Vec3 signs = small_integers(rng, 1);
      return marks.centre + Vec3{signs.x * marks.half.x, signs.y * marks.half.y, signs.z * marks.half.z};
    }
    case 2:
      return points[pick(rng, points.size())];
    default: {
      const double u = rng.uniform(), v = rng.uniform();
      const Vec3 point = chance(rng, 0.5)
                             ? surface.sample(u, v).point
                             : surface.sample(std::floor(16 * u) / 16, std::floor(16 * v) / 16).point;
      return chance(rng, 0.5) ? point : cut(point, 4 + static_cast<int>(pick(rng, 28)));
    }
  }
}

/// Along an axis, with small integers, dyadic slopes, a ruling, an edge, a tangent, or from point to point.
inline Vec3 structured_direction(const AnySurface& surface, Vec3 target, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  std::vector<Vec3> special = marks.parallels;
  special.insert(special.end(), marks.asymptotes.begin(), marks.asymptotes.end());
  for (const auto& [from, to] : marks.edges) special.push_back(to - from);
  switch (pick(rng, 7)) {
    case 0: {
      Ray axis{};
      number(axis, 3 + pick(rng, 3)) = chance(rng, 0.5) ? 1 : -1;
      return axis.d;
    }
    case 1:
      return small_integers(rng, 4);
    case 2: {
      const Vec3 base = small_integers(rng, 2);
      return base + std::ldexp(1.0, -static_cast<int>(pick(rng, 60))) * small_integers(rng, 1);
    }
    case 3:
      if (!special.empty()) return special[pick(rng, special.size())];
      [[fallthrough]];
    case 4: {
      const double u = rng.uniform();
      const SurfaceSample sample = surface.sample(u, rng.uniform());
      const Vec3 tangent = cross(sample.normal, small_integers(rng, 2));
      return chance(rng, 0.5) ? tangent : cut(tangent, 8 + static_cast<int>(pick(rng, 20)));
    }
    default:
      return target_point(surface, rng) - target;
  }
}

/// Directions of other lengths; huge and tiny ones now and then.
inline double structured_length(Rng& rng) {
  switch (pick(rng, 8)) {
    case 0:
      return std::ldexp(1.0, whole(rng, 60));
    case 1:
      return 1 + static_cast<double>(pick(rng, 9));
    case 2:
      return rng.uniform(0.5, 2);
    case 3:
      return chance(rng, 0.1) ? std::ldexp(1.0, whole(rng, 900)) : 0.1;
    default:
      return 1;
  }
}

/// How far before the target the ray starts, in directions of the length of the surface.
inline double structured_distance(Rng& rng) {
  switch (pick(rng, 8)) {
    case 0:
      return 0;  // on it
    case 1:
      return std::ldexp(1.0, static_cast<int>(pick(rng, 45)));
    case 2:
      return rng.uniform(0, 4);
    case 3:
      return -static_cast<double>(1 + pick(rng, 3)) / 2;
    default:
      return static_cast<double>(1 + pick(rng, 16)) / 4;
  }
}

/// Zeros of either sign, now and then an ulp aside, seldom the smallest doubles for zeros.
inline void blur(Ray& ray, double size, Rng& rng) {
  const bool is_wild = chance(rng, 0.05);
  for (std::size_t i = 0; i < kNumbers; ++i) {
    double& x = number(ray, i);
    if (x == 0 && chance(rng, 0.3)) x = -0.0;
    if (is_wild && chance(rng, 0.5)) x = double_at(place_of(x) + whole(rng, 2));
  }
  if (chance(rng, 0.4)) step_aside(ray, pick(rng, kNumbers), whole(rng, 2), size);
}

inline Ray structured_ray(const AnySurface& surface, Rng& rng) {
  while (true) {
    const Vec3 target = target_point(surface, rng);
    Vec3 direction = structured_direction(surface, target, rng);
    if (!(max_abs(direction) > 0)) continue;
    // The power of two that brings the direction to the surface's size keeps its bits.
    const Vec3 step =
        std::ldexp(1.0, std::ilogb(surface.size()) - std::ilogb(max_abs(direction))) * direction;
    Ray ray{target - structured_distance(rng) * step, structured_length(rng) * direction};
    blur(ray, surface.size(), rng);
    if (is_valid(ray)) return ray;
  }
}

// ----------------------------------------------------------------------------------------------------- moves

/// A neighbour on a surface of size L: ulps, one bit of a mantissa, another length of d, another origin on
/// the ray, fewer bits.
inline Ray moved(Ray ray, double size, Rng& rng) {
  const std::size_t i = pick(rng, kNumbers);
  double& x = number(ray, i);
  switch (pick(rng, 8)) {
    case 0:
      ray.d = rng.uniform(0.5, 2) * ray.d;
      break;
    case 1:
      ray.o = ray.o + rng.uniform(-1, 1) * ray.d;
      break;
    case 2:
      x = cut(x, 8 + static_cast<int>(pick(rng, 40)));
      break;
    case 3:
    case 4:
      if (x != 0)
        x = std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) ^ (std::uint64_t{1} << pick(rng, 52)));
      break;
    default:
      step_aside(ray, i, whole(rng, 1 << pick(rng, 10)), size);
      break;
  }
  return ray;
}

/// Some of the numbers a few ulps aside.
inline Ray nudged(Ray ray, double size, Rng& rng) {
  for (std::size_t count = 1 + pick(rng, 3); count > 0; --count)
    step_aside(ray, pick(rng, kNumbers), whole(rng, 1 << pick(rng, 7)), size);
  return ray;
}

}  // namespace graze::test
