// Rays of a case family, and how far an l is from the truth in the unit of what is promised.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/surface.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {

/// Rays a family: GRAZE_RAYS=20000 asks for a long run.
inline std::size_t rays_a_family(std::size_t usual, std::size_t sanitized) {
  const char* const wanted = std::getenv("GRAZE_RAYS");
  return wanted != nullptr ? std::strtoul(wanted, nullptr, 10) : kSanitized ? sanitized : usual;
}

/// Rays of the surface's own scale. Needs: the family is not `scale`, where most are of others.
inline std::vector<Ray> rays_of(const CaseFamily& family, const AnySurface& surface, std::uint64_t seed,
                                std::size_t count) {
  std::vector<Ray> rays;
  for (std::size_t block = 0; rays.size() < count; ++block) {
    if (block_scale(family, seed, block) != 1) continue;
    const std::size_t wanted = std::min(kCaseBlock, count - rays.size());
    for (const CaseRay& ray : make_block(family, surface, seed, block, wanted)) rays.push_back(ray.ray);
  }
  return rays;
}

/// What a solver promises of every hit's l.
struct Promise {
  std::string_view solver;
  double bound;
  bool in_ulps;  ///< of l; else in condition units, eps (|l| + L/|n.d|)

  [[nodiscard]] const char* unit() const { return in_ulps ? "ulps" : "condition units"; }
  /// Of l, as a share of the bound; `size` is L. An exact l is right in any unit, also in an infinite one.
  [[nodiscard]] double share(double l, const truth::Hit& hit, const Ray& ray, double size) const {
    const double error = std::fabs((l - hit.l.head) - hit.l.tail);
    if (error == 0) return 0;
    const double condition = 0x1p-52 * (std::fabs(hit.l.head) + size / norm(ray.d) / hit.cosine);
    return error / (in_ulps ? ulp(hit.l.head) : condition) / bound;
  }
};
inline constexpr std::array<Promise, 2> kPromises{{{"certified", 4, false}, {"faithful", 1, true}}};

/// Needs: one of those.
inline const Promise& promise_of(std::string_view solver) {
  return *std::find_if(kPromises.begin(), kPromises.end(),
                       [&](const Promise& promise) { return promise.solver == solver; });
}

}  // namespace graze::test
