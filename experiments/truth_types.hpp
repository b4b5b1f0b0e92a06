// Makers of truth, one a surface type. A new type: its file truth_X.cpp, a declaration here, a row in
// truth.cpp.
#pragma once

#include <graze/experiments/truth.hpp>
#include <memory>

namespace graze::truth {

/// Each throws std::invalid_argument when the parameters or the placement are no surface.
std::unique_ptr<Surface> make_teardrop(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_bezier_revolution(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_plane(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_triangle(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_polygon(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_disk(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_box(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_tetrahedron(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_convex_polyhedron(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_sphere(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_ellipsoid(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_quadric(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_torus(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_implicit_polynomial(const SurfaceSpec& spec);

}  // namespace graze::truth
