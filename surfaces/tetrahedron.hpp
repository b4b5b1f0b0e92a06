// The tetrahedron of four points (document 004).
//
// surface       the boundary of the closed solid between the four vertices, in any order
// needs         vertices that do not lie in one plane (decided exactly)
// parameters    face: 0..3, the one opposite to that vertex
// facts         convex: at most two hits; a ray that touches an edge or a corner has one of multiplicity 2;
//               one that runs inside a face is coincident. The faces' normals are no doubles: decisions
//               start from the vertices, n.d = det(d, b - a, c - a)
// source        document 004; Cyrus, Beck 1978 (see convex_solid.hpp)
#pragma once

#include <array>
#include <tuple>

#include <graze/surfaces/convex_solid.hpp>

namespace graze {

/// The side of the plane a, b, c from which these run clockwise: n.x <= n.a, n = (b - a) x (c - a).
struct TetrahedronFace {
  Vec3 a, b, c;
  std::array<Interval, 3> normal;  ///< n within 1 ulp
  Vec3 rounded;                    ///< n in plain doubles

  template <class T>
  [[nodiscard]] T top(const LocalRay& ray) const {
    const auto [x, y, z] = normal_as<T>();
    const std::array<T, 3> o = origin_as<T>(ray);
    return x * (exactly<T>(a.x) - o[0]) + y * (exactly<T>(a.y) - o[1]) + z * (exactly<T>(a.z) - o[2]);
  }
  template <class T>
  [[nodiscard]] T bottom(const LocalRay& ray) const {
    const auto [x, y, z] = normal_as<T>();
    const std::array<T, 3> d = direction_as<T>(ray);
    return x * d[0] + y * d[1] + z * d[2];
  }
  /// (b - a) x (c - a).
  template <class T>
  [[nodiscard]] std::array<T, 3> cross_as() const {
    const T ux = exactly<T>(b.x) - exactly<T>(a.x), vx = exactly<T>(c.x) - exactly<T>(a.x);
    const T uy = exactly<T>(b.y) - exactly<T>(a.y), vy = exactly<T>(c.y) - exactly<T>(a.y);
    const T uz = exactly<T>(b.z) - exactly<T>(a.z), vz = exactly<T>(c.z) - exactly<T>(a.z);
    return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
  }

 private:
  template <class T>
  [[nodiscard]] std::array<T, 3> normal_as() const {
    if constexpr (std::is_same_v<T, Expansion> || std::is_same_v<T, DoubleDouble> ||
                  std::is_same_v<T, Dyadic>) {
      return cross_as<T>();
    } else if constexpr (std::is_same_v<T, Interval>) {
      return normal;
    } else if constexpr (std::is_same_v<T, convex::Ball>) {
      const auto about = [](const Interval& x) { return convex::Ball(mid(x), width(x)); };
      return {about(normal[0]), about(normal[1]), about(normal[2])};
    } else {
      return {exactly<T>(rounded.x), exactly<T>(rounded.y), exactly<T>(rounded.z)};
    }
  }
};

struct Tetrahedron : convex::Solid {
  using Formulations = std::tuple<convex::Exact<Tetrahedron>, convex::Plain<Tetrahedron>>;
  static constexpr convex::Wording kWording{
      .exact_summary = "planes ordered by exact comparisons, then one linear equation a hit",
      .exact_source = "document 004; Cyrus, Beck 1978, made exact",
      .plain_name = "cyrus_beck",
      .plain_summary = "entering and leaving planes in plain arithmetic, with rounded normals",
      .plain_source = "document 004; Cyrus, Beck 1978"};

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Tetrahedron(const SurfaceSpec& spec);

  std::array<TetrahedronFace, 4> faces;  ///< in local units
};

extern template struct convex::Exact<Tetrahedron>;
extern template struct convex::Plain<Tetrahedron>;

}  // namespace graze
