// The torus's kernel for `faithful`: what its code for one instruction set takes (surfaces/torus.md).
#pragma once

#include <graze/surfaces/faithful_batch.hpp>

namespace graze {

/// Lengths in units of 2^unit, where R + r is in [1, 2).
struct TorusFrame {
  double ring = 1, tube = 0;          ///< R and r
  double unit = 1, inverse_unit = 1;  ///< 2^unit, 2^-unit
};

namespace avx512 {
void correct_torus(const TorusFrame& surface, const FaithfulBatch& batch);
}
namespace avx2 {
void correct_torus(const TorusFrame& surface, const FaithfulBatch& batch);
}
namespace baseline {
void correct_torus(const TorusFrame& surface, const FaithfulBatch& batch);
}

}  // namespace graze
