// Document 001's two algorithms for ray and sphere, step by step, generic over the scalar so that their
// operations can be counted (solvers/math/counting.hpp).
//
// solves    |o + t d - c| = r for the first t >= 0, d of unit length
// needs     T with + - * / sqrt and comparisons; |d| = 1; r > 0
// returns   the hit, or none: then `t` and what follows were not computed
// error     that of plain arithmetic: the document's formulas as they stand
// cost      algebraic: 16 additions, 11 multiplications, 3 divisions, 1 square root for a hit from outside;
//           geometric the same; what a miss costs is in surfaces/sphere.md
// source    document 001, "Intersection of a ray and a sphere", algorithms 1 and 2
#pragma once

#include <array>
#include <cmath>
#include <optional>

namespace graze {

template <class T>
struct SphereHit {
  T t{};
  std::array<T, 3> point{};
  std::array<T, 3> normal{};
};

namespace sphere_algorithms {

template <class T>
T dot(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
std::array<T, 3> difference(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// t^2 + 2 B t + C = 0, m = o - c.
template <class T>
struct Algebraic {
  T b, c;
  Algebraic(const std::array<T, 3>& m, const std::array<T, 3>& d, const T& r)
      : b(dot(d, m)), c(dot(m, m) - r * r) {}
};

/// (t - t_ca)^2 = t_hc^2, oc = c - o.
template <class T>
struct Geometric {
  T distance2;  ///< |oc|^2
  T r2;
  T t_ca;
  Geometric(const std::array<T, 3>& oc, const std::array<T, 3>& d, const T& r)
      : distance2(dot(oc, oc)), r2(r * r), t_ca(dot(oc, d)) {}
  [[nodiscard]] T t_hc2() const { return r2 - distance2 + t_ca * t_ca; }
};

/// The last two steps of both: point and normal.
template <class T>
SphereHit<T> hit_at(const T& t, const std::array<T, 3>& o, const std::array<T, 3>& d,
                    const std::array<T, 3>& c, const T& r) {
  SphereHit<T> hit;
  hit.t = t;
  for (std::size_t i = 0; i < 3; ++i) hit.point[i] = o[i] + d[i] * t;
  for (std::size_t i = 0; i < 3; ++i) hit.normal[i] = (hit.point[i] - c[i]) / r;
  return hit;
}

}  // namespace sphere_algorithms

template <class T>
std::optional<SphereHit<T>> sphere_algebraic(const std::array<T, 3>& o, const std::array<T, 3>& d,
                                             const std::array<T, 3>& c, const T& r) {
  using std::sqrt;
  const T zero{};
  const sphere_algorithms::Algebraic<T> q(sphere_algorithms::difference(o, c), d, r);
  const T discriminant = q.b * q.b - q.c;
  if (discriminant < zero) return std::nullopt;
  const T root = sqrt(discriminant);
  T t = -q.b - root;
  if (t < zero) {
    t = -q.b + root;
    if (t < zero) return std::nullopt;
  }
  return sphere_algorithms::hit_at(t, o, d, c, r);
}

template <class T>
std::optional<SphereHit<T>> sphere_geometric(const std::array<T, 3>& o, const std::array<T, 3>& d,
                                             const std::array<T, 3>& c, const T& r) {
  using std::sqrt;
  const T zero{};
  const sphere_algorithms::Geometric<T> q(sphere_algorithms::difference(c, o), d, r);
  const bool inside = q.distance2 < q.r2;
  if (!inside && q.t_ca < zero) return std::nullopt;
  const T t_hc2 = q.t_hc2();
  if (t_hc2 < zero) return std::nullopt;
  const T t_hc = sqrt(t_hc2);
  return sphere_algorithms::hit_at(inside ? q.t_ca + t_hc : q.t_ca - t_hc, o, d, c, r);
}

}  // namespace graze
