// What this build has: generated from the lists in solvers/CMakeLists.txt and surfaces/CMakeLists.txt.
#pragma once

#include <vector>

#include <graze/solvers/solver.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

/// Every solver of this build, in list order.
const std::vector<SolverEntry>& solver_registry();
/// Every surface of this build, in list order.
const std::vector<SurfaceEntry>& surface_registry();

/// The entry called `name`; throws std::invalid_argument that names the nearest ones.
const SolverEntry& find_solver(std::string_view name);
const SurfaceEntry& find_surface(std::string_view name);

}  // namespace graze
