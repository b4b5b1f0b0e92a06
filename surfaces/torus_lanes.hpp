// The torus's kernel: what its code for one instruction set takes and gives (surfaces/torus.md).
#pragma once

#include <cstddef>
#include <cstdint>

#include <graze/surfaces/ray.hpp>

namespace graze {

/// Rays of one torus: lengths in units of 2^unit, where R + r is in [1, 2).
struct TorusBatch {
  const Ray* rays = nullptr;
  std::size_t count = 0;
  double ring = 1;          ///< R
  double tube = 0;          ///< r; both at least 2^-20
  double inverse_unit = 1;  ///< 2^-unit
  bool all = false;         ///< all hits wanted; else the first
};

/// Where answers go: the proved number of hits of each ray (of at most one, unless all are wanted) or -1,
/// and their l in units of |d|, ascending.
struct TorusAnswers {
  std::int8_t* hits = nullptr;
  double* l[4] = {};
};

namespace avx512 {
void intersect_torus(const TorusBatch& batch, const TorusAnswers& answers);
}
namespace avx2 {
void intersect_torus(const TorusBatch& batch, const TorusAnswers& answers);
}
namespace baseline {
void intersect_torus(const TorusBatch& batch, const TorusAnswers& answers);
}

}  // namespace graze
