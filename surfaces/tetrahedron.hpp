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

struct Tetrahedron;

/// The side of the plane a, b, c from which these run clockwise: n.x <= n.a, n = (b - a) x (c - a).
struct TetrahedronFace {
  Vec3 a, b, c;
  std::array<Interval, 3> normal;  ///< n within 1 ulp
  Vec3 rounded;                    ///< n in plain doubles

  template <class T>
  [[nodiscard]] T top(const LocalRay& ray) const {
    const auto [x, y, z] = normal_as<T>();
    return x * (exactly<T>(a.x) - exactly<T>(ray.o.x)) + y * (exactly<T>(a.y) - exactly<T>(ray.o.y)) +
           z * (exactly<T>(a.z) - exactly<T>(ray.o.z));
  }
  template <class T>
  [[nodiscard]] T bottom(const LocalRay& ray) const {
    const auto [x, y, z] = normal_as<T>();
    return x * exactly<T>(ray.d.x) + y * exactly<T>(ray.d.y) + z * exactly<T>(ray.d.z);
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
    if constexpr (std::is_same_v<T, Expansion> || std::is_same_v<T, DoubleDouble>) {
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

/// Cyrus and Beck with exact comparisons.
struct TetrahedronExact {
  static FormulationInfo info();
  explicit TetrahedronExact(const Tetrahedron& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  std::array<TetrahedronFace, 4> faces;
  convex::Grain grain;
};

/// Cyrus and Beck in plain arithmetic, with rounded normals.
struct TetrahedronCyrusBeck {
  static FormulationInfo info();
  explicit TetrahedronCyrusBeck(const Tetrahedron& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  std::array<TetrahedronFace, 4> faces;
};

struct Tetrahedron {
  using Formulations = std::tuple<TetrahedronExact, TetrahedronCyrusBeck>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Tetrahedron(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return exponent_of(size()); }
  [[nodiscard]] double size() const { return shape.size(); }
  [[nodiscard]] Bounds bounds() const { return shape.bounds(); }
  [[nodiscard]] bool clip(LocalRay& ray) const {
    reach.clip(ray);
    return true;
  }
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const { return shape.sample(u, v); }
  [[nodiscard]] Landmarks landmarks() const { return shape.landmarks(); }

  convex::Shape shape;
  convex::Reach reach;
  std::array<TetrahedronFace, 4> faces;  ///< in local units
  convex::Grain grain;
};

}  // namespace graze
