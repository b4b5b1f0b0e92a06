// What the tests of box, tetrahedron and convex_polyhedron share.
#pragma once

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

#include <surfaces/cells.hpp>

namespace graze::test {

/// The surface in a formulation, answered by formulas.
inline Scene convex_scene(const SurfaceSpec& spec, std::string_view formulation = "exact") {
  return scene_of(spec, find_solver("closed_form"), formulation);
}

inline Answer convex_answer(const SurfaceSpec& spec, const Ray& ray, std::string_view formulation = "exact") {
  return ask(convex_scene(spec, formulation), {&ray, 1})[0];
}

/// Plane (box: slab) tests that one ray cost.
inline std::uint32_t tests_of(const SurfaceSpec& spec, const Ray& ray) {
  Scene::Workspace work;
  HitBuffer hits;
  convex_scene(spec).intersect({&ray, 1}, Query::all, {}, work, hits);
  return hits.counters[0].tests;
}

inline bool has_convex(std::string_view surface) {
  return has_surface(surface) && solver_named("closed_form") != nullptr;
}

/// a and b differ by at most `ulps` doubles' spacings.
inline void expect_ulps(double a, double b, double ulps) {
  EXPECT_LE(std::fabs(a - b), ulps * ulp(b)) << a << " against " << b;
}

/// The six half-spaces of a box, in the order of its faces.
inline Table box_halfspaces(Vec3 lo, Vec3 hi) {
  return {{-1, 0, 0, -lo.x}, {1, 0, 0, hi.x},   {0, -1, 0, -lo.y},
          {0, 1, 0, hi.y},   {0, 0, -1, -lo.z}, {0, 0, 1, hi.z}};
}

}  // namespace graze::test
