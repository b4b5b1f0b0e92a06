// The polygon by the even-odd rule (document 001).
//
// surface       the inside and the edges of a simple polygon, on its reference plane N.(x - v0) = 0 with
//               the exact Newell normal N = sum (v_i - v0) x (v_{i+1} - v0)
// needs         at least three finite vertices; no edge without length, no self-intersection, all vertices
//               within 2^-46 of the largest coordinate difference of the plane: each decided exactly
// parameters    none
// facts         at most one hit. A ray meets it if its line passes inside the chain of edges, half open in
//               ray space: of two polygons that share an edge exactly one is hit by a ray through that edge
//               (unless the edge is a silhouette: then both or none)
// normal        N / |N|, whichever side the ray comes from
// source        document 001 (even-odd, drop the dominant axis); exact normal and ray space: graze
#pragma once

#include <array>
#include <tuple>
#include <vector>

#include <graze/surfaces/planar.hpp>

namespace graze {

struct Polygon;

/// The numbers of a polygon in local units that its formulations need.
struct PolygonData {
  planar::ExactPlane plane;
  std::vector<Vec3> vertices;
  Bits bits;                ///< of the vertices
  std::size_t dropped = 0;  ///< the normal's largest axis
};

/// The crossing of the reference plane; inside by the half-open even-odd rule in ray space, in exact signs.
struct PolygonExact {
  static FormulationInfo info();
  explicit PolygonExact(const Polygon& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  const PolygonData* data;

 private:
  [[nodiscard]] bool is_inside(const LocalRay& ray, planar::Judge& judge) const;
};

/// Document 001: the plane first, then even-odd about the computed point, the dominant coordinate dropped.
struct PolygonEvenOdd {
  static FormulationInfo info();
  explicit PolygonEvenOdd(const Polygon& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  const PolygonData* data;
};

struct Polygon {
  using Formulations = std::tuple<PolygonExact, PolygonEvenOdd>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Polygon(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] Bounds bounds() const;
  [[nodiscard]] bool clip(LocalRay& ray) const { return planar::clip(ray, ball_, false); }
  [[nodiscard]] LocalPoint describe(const LocalRay& /*ray*/, const LocalHit& /*hit*/) const {
    return {normal_, {}};
  }
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const { return planar::landmarks_of(vertices_); }

  PolygonData data;

 private:
  /// A triangle of the polygon and the share of the area up to its end.
  struct Ear {
    std::array<std::size_t, 3> corners;
    double end;
  };
  void cut_into_ears();

  std::vector<Vec3> vertices_;  ///< object space
  std::vector<Ear> ears_;
  planar::Ball ball_;
  Vec3 normal_;
  double size_;  ///< the largest coordinate difference
  int unit_;
};

}  // namespace graze
