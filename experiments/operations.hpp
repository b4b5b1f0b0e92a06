// What a ray costs in floating-point operations of the solver or the kernel: a cost apart from any machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <graze/solvers/math/counting.hpp>

#include "specs.hpp"

namespace graze {

/// Totals over rays.
struct OperationTotals {
  /// Of the solver, all equations; of a kernel its lanes, from the ray's numbers to l (counted_kernel.hpp).
  OperationCount count;
  /// Calls of a scalar equation's f, its inclusions or a system's F: their operations are the surface's and
  /// not in `count`. 0 for polynomials, whose evaluations are the solver's own.
  std::uint64_t evaluations = 0;
  std::size_t rays = 0;

  [[nodiscard]] double per_ray(std::uint64_t total) const {
    return static_cast<double>(total) / static_cast<double>(rays);
  }
};

/// Runs the surface's rays through the same scene with the solver in numbers that count, or the kernel in
/// lanes that do. Nothing where the cell cannot be counted: float, Ceres, peers, and equations in the
/// Bernstein basis (whose change to powers is made in double), but for solvers that count in any basis
/// (counted_solver.hpp). Throws as build_scene does.
std::optional<OperationTotals> count_operations(const SurfaceSpec& surface, std::string_view formulation,
                                                const SolverSpec& solver, std::span<const Ray> rays,
                                                Query query);

}  // namespace graze
