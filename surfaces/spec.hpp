// A surface as the user states it: raw doubles, each an exact number. Contestants and truth both start here.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include <graze/solvers/parameters.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// Places an object in the world: x_world = matrix x_object + translate.
struct Placement {
  Vec3 translate;
  Mat3 matrix = kIdentity;

  [[nodiscard]] bool is_identity() const { return translate == Vec3{} && matrix == kIdentity; }
};

struct SurfaceSpec {
  std::string type;       ///< registry name, such as "teardrop"
  Parameters parameters;  ///< such as s = 1
  Placement placement;
  std::string name;                   ///< the user's name for it, may be empty
  std::map<std::string, double> eps;  ///< per-region epsilons, in units of the surface's size
};

/// A parameter that is a length, an area (power 2), ...
struct Length {
  std::string_view name;
  int power = 1;
};
/// The parameters with every entry of the named ones (those that are there) times factor^power.
Parameters scale_lengths(Parameters parameters, std::span<const Length> lengths, double factor);

/// A parameter that is a point or a vector [x, y, z].
Vec3 vec3(const Parameters& parameters, const std::string& name);
Vec3 vec3(const Parameters& parameters, const std::string& name, Vec3 fallback);

/// Throws std::invalid_argument unless the placement is finite and its matrix is invertible.
/// Decided exactly: a determinant that only rounds to zero passes, an exactly zero one does not.
void check_placement(const Placement& placement);

/// Replaces the defaults in `eps` by what the specification sets for the regions of these names.
void override_eps(const SurfaceSpec& spec, std::span<const std::string_view> names, std::span<double> eps);

}  // namespace graze
