// Case families: seeded rays from benign to extreme, each with a difficulty knob, counted from ray 0. Family,
// seed and index name a ray of a surface for ever: rays never depend on how many are asked for.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <graze/surfaces/ray.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

/// A ray, and how hard it is: the family says in which unit.
struct CaseRay {
  Ray ray;
  double difficulty = 0;
};

struct CaseFamily {
  std::string_view name;
  std::string_view summary;               ///< one sentence
  std::string_view difficulty;            ///< what the number is
  bool (*suits)(const Landmarks& marks);  ///< does it make sense for a surface?
  CaseRay (*make)(const AnySurface& surface, Rng& rng);
};

/// Every family, in list order.
std::span<const CaseFamily> case_families();
/// The family called `name`; throws std::invalid_argument that names the nearest.
const CaseFamily& find_family(std::string_view name);

/// Rays come in blocks that share one scale of the surface: 1, except in the family `scale`.
inline constexpr std::size_t kCaseBlock = 50;

/// The factor by which the surface's lengths are multiplied for this block of rays.
double block_scale(const CaseFamily& family, std::uint64_t seed, std::size_t block);

/// Rays [block * kCaseBlock, ...) of the family, `count` of them. `surface` has the block's scale already.
std::vector<CaseRay> make_block(const CaseFamily& family, const AnySurface& surface, std::uint64_t seed,
                                std::size_t block, std::size_t count);

}  // namespace graze
