// The triangle (documents 001 and 002).
//
// surface       v0 + u (v1 - v0) + v (v2 - v0), u >= 0, v >= 0, u + v <= 1: closed
// needs         three finite vertices that do not lie on a line (decided exactly)
// parameters    u, v
// facts         at most one hit; a ray in the plane is coincident, or touches a vertex (multiplicity 2)
// normal        (v1 - v0) x (v2 - v0), normalised, whichever side the ray comes from
// source        document 002 (Moeller, Trumbore, J. Graphics Tools 2, 1997), document 001 (barycentric)
#pragma once

#include <array>
#include <tuple>

#include <graze/surfaces/planar.hpp>

namespace graze {

struct Triangle;

/// The numbers of a triangle in local units that its formulations need.
struct TriangleData {
  planar::ExactPlane plane;
  std::array<Vec3, 3> vertices;
  Bits bits;                ///< of the vertices
  std::size_t dropped = 0;  ///< the normal's largest axis

  /// det(d, v_i - p, v_j - p) for the edge opposite to vertex i: its share of d.n is the weight of vertex i.
  template <class T>
  [[nodiscard]] T weight(const LocalRay& ray, std::size_t i) const {
    const planar::Array3<T> p = planar::point_of_line<T>(ray);
    const auto from = [&](std::size_t k) {
      return planar::difference(planar::exactly<T>(vertices[k % 3]), p);
    };
    return planar::volume(direction_as<T>(ray), from(i + 1), from(i + 2));
  }
  /// Whether expansions hold the weights of this ray.
  [[nodiscard]] bool holds(const LocalRay& ray) const {
    const Bits x = bits | planar::bits_of(ray.o);
    return planar::is_exact(x * x * (x | planar::bits_of(ray.d)));
  }
};

/// The crossing of the plane; inside by the signs of the three weights, zero counts as inside.
struct TriangleExact {
  static FormulationInfo info();
  explicit TriangleExact(const Triangle& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TriangleData data;

 private:
  [[nodiscard]] bool is_inside(const LocalRay& ray, planar::Judge& judge) const;
};

/// Document 002: t, u, v as quotients of triple products, in plain arithmetic.
struct TriangleBarycentric {
  static FormulationInfo info();
  explicit TriangleBarycentric(const Triangle& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TriangleData data;
};

/// o + l d = v0 + u e1 + v e2: the three equations themselves, for (l, u, v).
struct TriangleSystem {
  static FormulationInfo info();
  explicit TriangleSystem(const Triangle& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TriangleData data;
};

struct Triangle {
  using Formulations = std::tuple<TriangleExact, TriangleSystem, TriangleBarycentric>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Triangle(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] Bounds bounds() const { return planar::box_of(vertices_); }
  [[nodiscard]] bool clip(LocalRay& ray) const { return planar::clip(ray, ball_, true); }
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const {
    return {planar::sample_triangle(vertices_[0], vertices_[1], vertices_[2], u, v), normal_};
  }
  [[nodiscard]] Landmarks landmarks() const { return planar::landmarks_of(vertices_); }

  TriangleData data;

 private:
  std::array<Vec3, 3> vertices_;  ///< object space
  planar::Ball ball_;
  Vec3 normal_;
  double size_;  ///< the largest coordinate difference
  int unit_;
};

}  // namespace graze
