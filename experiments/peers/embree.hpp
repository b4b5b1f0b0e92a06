// Peer: Embree, the nearest triangle of a mesh that stands for the surface.
//
// solves    for each ray: which triangles of the mesh it meets, in single precision; it takes no equation
// needs     a surface that its two parameters cover: teardrop, bezier_revolution, sphere, ellipsoid, torus;
//           the vertices lie on the surface, at the crossings of a uniform grid of the parameters
// returns   always ok, whatever is true: a mesh cannot know what it misses. `first`: rtcIntersect1 or 16;
//           `any`: rtcOccluded1 or 16, whose hits say that there is one and not where (l is the largest
//           float); `all`: the nearest hit again and again from behind the last one, at most four
// error     of the mesh, about (length of an edge)^2 / (8 radius of curvature), and of single precision;
//           a ray that is not finite in single precision meets nothing
// cost      `triangles` triangles are built and kept in memory; one thread
// source    Wald, Woop, Benthin, Johnson, Ernst, "Embree: a kernel framework for efficient CPU ray
//           tracing", ACM TOG 33 (2014); version 3.13
#pragma once

#include <graze/solvers/solver.hpp>
#include <graze/surfaces/hit.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

class Embree {
 public:
  static SolverInfo info();
  explicit Embree(const Parameters& options);
  /// Never asked: the mesh answers every ray. Fails.
  void solve(const ScalarEquation& equation, Roots& roots) const;

  /// The surface as this peer sees it: one formulation, `triangles`, that the mesh answers; none for surfaces
  /// that have no such mesh.
  static SurfaceEntry seen(SurfaceEntry surface, Query query);
};

static_assert(Solver<Embree>);

}  // namespace graze
