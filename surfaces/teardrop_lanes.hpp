// The teardrop's kernel: what its code for one instruction set takes and gives (surfaces/teardrop.md).
#pragma once

#include <cstddef>
#include <cstdint>

#include <graze/surfaces/ray.hpp>

namespace graze {

/// Rays of one teardrop: lengths in units of 2^unit, where its s is m in [1, 2).
struct TeardropBatch {
  const Ray* rays = nullptr;
  std::size_t count = 0;
  double m = 1;
  double unit = 1;          ///< 2^unit
  double inverse_unit = 1;  ///< 2^-unit
  bool both = false;        ///< all hits wanted; else the first
};

/// Where answers go: the proved number of hits of each ray (of at most one, unless both are wanted) or -1,
/// and their l in units of |d|, ascending.
struct TeardropAnswers {
  std::int8_t* hits = nullptr;
  double* first = nullptr;
  double* second = nullptr;
};

// Each returns how many rays it leaves open.
namespace avx512 {
std::size_t intersect_teardrop(const TeardropBatch& batch, const TeardropAnswers& answers);
}
namespace avx2 {
std::size_t intersect_teardrop(const TeardropBatch& batch, const TeardropAnswers& answers);
}
namespace baseline {
std::size_t intersect_teardrop(const TeardropBatch& batch, const TeardropAnswers& answers);
}

}  // namespace graze
