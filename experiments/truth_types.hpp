// Makers of truth, one a surface type. A new type: its file truth_X.cpp, a declaration here, a row in
// truth.cpp.
#pragma once

#include <graze/experiments/truth.hpp>
#include <memory>

namespace graze::truth {

/// Each throws std::invalid_argument when the parameters or the placement are no surface.
std::unique_ptr<Surface> make_teardrop(const SurfaceSpec& spec);
std::unique_ptr<Surface> make_bezier_revolution(const SurfaceSpec& spec);

}  // namespace graze::truth
