// The box: all six sides of lo <= x <= hi, sides parallel to the axes (document 001).
//
// surface       the boundary of the closed solid min_i <= x_i <= max_i
// needs         min_i < max_i in every coordinate (compared exactly)
// parameters    face: 0..5 for -x, +x, -y, +y, -z, +z
// facts         convex: at most two hits; a ray that touches an edge or a corner has one of multiplicity 2;
//               one that runs inside a side is coincident
// source        document 001; Cyrus, Beck 1978 (see convex_solid.hpp)
#pragma once

#include <array>
#include <cstddef>
#include <tuple>

#include <graze/surfaces/convex_solid.hpp>

namespace graze {

struct Box;

/// side x_axis <= side at, side = +-1.
struct BoxFace {
  std::size_t axis = 0;
  double side = 1;
  double at = 0;

  template <class T>
  [[nodiscard]] T top(const LocalRay& ray) const {
    const T plane = exactly<T>(at);
    const T origin = exactly<T>(component(ray.o, axis));
    return side < 0 ? origin - plane : plane - origin;
  }
  template <class T>
  [[nodiscard]] T bottom(const LocalRay& ray) const {
    const double along = component(ray.d, axis);
    return exactly<T>(side < 0 ? -along : along);
  }
};

/// Slabs ordered by exact comparisons.
struct BoxExact {
  static FormulationInfo info();
  explicit BoxExact(const Box& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  std::array<BoxFace, 6> faces;
  convex::Grain grain;
};

/// Document 001's slab test in plain arithmetic.
struct BoxSlabs {
  static FormulationInfo info();
  explicit BoxSlabs(const Box& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  std::array<BoxFace, 6> faces;
};

struct Box {
  using Formulations = std::tuple<BoxExact, BoxSlabs>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Box(const SurfaceSpec& spec);
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
  std::array<BoxFace, 6> faces;  ///< in local units
};

}  // namespace graze
