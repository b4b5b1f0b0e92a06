#include <graze/surfaces/surface.hpp>

#include <cmath>

namespace graze {

void check_names(const SurfaceSpec& spec, std::string_view type, const SurfaceInfo& info) {
  spec.parameters.expect_only(info.parameters, type);
  for (const auto& [region, eps] : spec.eps) {
    const std::vector<std::string_view>& known = info.regions;
    if (std::find(known.begin(), known.end(), region) == known.end()) {
      throw std::invalid_argument(unknown_name_message("eps region of " + std::string(type), region, known));
    }
    if (!std::isfinite(eps) || eps <= 0) {
      throw std::invalid_argument("eps." + region +
                                  " must be a positive number (in units of the surface's size)");
    }
  }
  check_placement(spec.placement);
}

}  // namespace graze
