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

#include <array>
#include <tuple>
#include <vector>

#include <graze/surfaces/convex_solid.hpp>

namespace graze {

/// n.x <= b, where the largest |n_i| lies in [1, 2).
struct HalfspaceFace {
  Vec3 n;
  double b = 0;

  template <class T>
  [[nodiscard]] T top(const LocalRay& ray) const {
    return exactly<T>(b) - times(origin_as<T>(ray));
  }
  template <class T>
  [[nodiscard]] T bottom(const LocalRay& ray) const {
    return times(direction_as<T>(ray));
  }

 private:
  template <class T>
  [[nodiscard]] T times(const std::array<T, 3>& v) const {
    return exactly<T>(n.x) * v[0] + exactly<T>(n.y) * v[1] + exactly<T>(n.z) * v[2];
  }
};

struct ConvexPolyhedron : convex::Solid {
  using Formulations = std::tuple<convex::Exact<ConvexPolyhedron>, convex::Plain<ConvexPolyhedron>>;
  static constexpr convex::Wording kWording{
      .exact_summary = "planes ordered by exact comparisons, then one linear equation a hit",
      .exact_source = "document 004; Cyrus, Beck 1978, made exact",
      .plain_name = "cyrus_beck",
      .plain_summary = "entering and leaving planes in plain arithmetic",
      .plain_source = "document 004; Cyrus, Beck 1978"};
  /// Building looks at every triple of planes: 0.6 s for this many (surfaces/convex_polyhedron.md).
  static constexpr std::size_t kMostHalfspaces = 128;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit ConvexPolyhedron(const SurfaceSpec& spec);

  std::vector<HalfspaceFace> faces;  ///< in local units
};

extern template struct convex::Exact<ConvexPolyhedron>;
extern template struct convex::Plain<ConvexPolyhedron>;

}  // namespace graze
