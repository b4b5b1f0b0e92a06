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

/// side x_axis <= side at, side = +-1.
struct BoxFace {
  std::size_t axis = 0;
  double side = 1;
  double at = 0;

  template <class T>
  [[nodiscard]] T top(const LocalRay& ray) const {
    const T plane = exactly<T>(at);
    const T origin = origin_as<T>(ray)[axis];
    return side < 0 ? origin - plane : plane - origin;
  }
  template <class T>
  [[nodiscard]] T bottom(const LocalRay& ray) const {
    const T along = direction_as<T>(ray)[axis];
    return side < 0 ? -along : along;
  }
};

struct Box : convex::Solid {
  using Formulations = std::tuple<convex::Exact<Box>, convex::Plain<Box>>;
  static constexpr convex::Wording kWording{
      .exact_summary = "slabs ordered by exact comparisons, then one linear equation a hit",
      .exact_source = "document 001; Cyrus, Beck 1978, made exact",
      .plain_name = "slabs",
      .plain_summary = "t1 = (lo - o) / d, t2 = (hi - o) / d of each slab in plain arithmetic",
      .plain_source = "document 001"};
  static constexpr std::uint32_t kPlanesATest = 2;  ///< those of a slab

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Box(const SurfaceSpec& spec);

  std::array<BoxFace, 6> faces;  ///< in local units
};

extern template struct convex::Exact<Box>;
extern template struct convex::Plain<Box>;

}  // namespace graze
