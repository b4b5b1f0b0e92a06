// Rays and the little vector algebra they need.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <graze/solvers/math/scaling.hpp>

namespace graze {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(double k, Vec3 a) { return {k * a.x, k * a.y, k * a.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr bool operator==(Vec3 a, Vec3 b) = default;
};

constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double max_abs(Vec3 a) { return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}); }
inline double norm(Vec3 a) { return std::hypot(a.x, a.y, a.z); }
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
/// The coordinate along an axis: 0, 1, 2 for x, y, z.
constexpr double component(Vec3 a, std::size_t axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }
/// a * 2^k, each coordinate as in scaling.hpp.
inline Vec3 scale_by_power(Vec3 a, int k) {
  return {scale_by_power(a.x, k), scale_by_power(a.y, k), scale_by_power(a.z, k)};
}
/// a / |a|, without overflow or underflow for any finite a != 0; zero stays zero.
inline Vec3 normalized(Vec3 a) {
  const double size = max_abs(a);
  if (size == 0) return a;
  const Vec3 b{a.x / size, a.y / size, a.z / size};
  return (1 / norm(b)) * b;
}

/// Rows of a 3x3 matrix.
using Mat3 = std::array<Vec3, 3>;
inline constexpr Mat3 kIdentity{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
constexpr Vec3 operator*(const Mat3& m, Vec3 v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
constexpr Mat3 transpose(const Mat3& m) {
  return {Vec3{m[0].x, m[1].x, m[2].x}, Vec3{m[0].y, m[1].y, m[2].y}, Vec3{m[0].z, m[1].z, m[2].z}};
}

/// x = o + l d, l > 0 strictly. d is any finite non-zero vector, not assumed unit: l is in units of |d|.
struct Ray {
  Vec3 o;
  Vec3 d;
};

/// A ray that is a question: finite, with a direction.
inline bool is_valid(const Ray& ray) { return is_finite(ray.o) && is_finite(ray.d) && max_abs(ray.d) > 0; }

}  // namespace graze
