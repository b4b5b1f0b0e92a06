// The convex polyhedron: all points on the right side of given planes (document 004).
//
// surface       the boundary of the closed solid n_i.x <= b_i
// needs         rows [nx, ny, nz, b], at most kMostHalfspaces, n_i not zero; a bounded solid with interior.
//               All is decided exactly; what is empty, flat or unbounded is refused. Planes that bound
//               nothing are allowed
// parameters    face: the row's index
// facts         at most two hits; a ray that touches an edge or a corner has one of multiplicity 2; one
//               that runs inside a plane and the solid is coincident
// cost          building: all triples of planes, O(N^3) and more with planes through one corner
//               (surfaces/convex_polyhedron.md); a ray: at most N plane tests
// source        document 004; Cyrus, Beck 1978 (see convex_solid.hpp)
#pragma once

#include <tuple>
#include <vector>

#include <graze/surfaces/convex_solid.hpp>

namespace graze {

struct ConvexPolyhedron;

/// n.x <= b, where the largest |n_i| lies in [1, 2).
struct HalfspaceFace {
  Vec3 n;
  double b = 0;

  template <class T>
  [[nodiscard]] T top(const LocalRay& ray) const {
    return exactly<T>(b) - times<T>(ray.o);
  }
  template <class T>
  [[nodiscard]] T bottom(const LocalRay& ray) const {
    return times<T>(ray.d);
  }

 private:
  template <class T>
  [[nodiscard]] T times(Vec3 v) const {
    return exactly<T>(n.x) * exactly<T>(v.x) + exactly<T>(n.y) * exactly<T>(v.y) +
           exactly<T>(n.z) * exactly<T>(v.z);
  }
};

/// Cyrus and Beck with exact comparisons.
struct ConvexPolyhedronExact {
  static FormulationInfo info();
  explicit ConvexPolyhedronExact(const ConvexPolyhedron& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  std::vector<HalfspaceFace> faces;
  convex::Grain grain;
};

/// Cyrus and Beck in plain arithmetic.
struct ConvexPolyhedronCyrusBeck {
  static FormulationInfo info();
  explicit ConvexPolyhedronCyrusBeck(const ConvexPolyhedron& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  std::vector<HalfspaceFace> faces;
};

struct ConvexPolyhedron {
  using Formulations = std::tuple<ConvexPolyhedronExact, ConvexPolyhedronCyrusBeck>;
  /// Building looks at every triple of planes: 0.6 s for this many (surfaces/convex_polyhedron.md).
  static constexpr std::size_t kMostHalfspaces = 128;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit ConvexPolyhedron(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
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
  std::vector<HalfspaceFace> faces;  ///< in local units
  convex::Grain grain;

 private:
  int unit_;
};

}  // namespace graze
