// The teardrop's kernel for `faithful`: what its code for one instruction set takes (surfaces/teardrop.md).
#pragma once

#include <graze/surfaces/faithful_batch.hpp>

namespace graze {

/// Lengths in units of 2^unit, where its s is m in [1, 2).
struct TeardropFrame {
  double m = 1;
  double unit = 1, inverse_unit = 1;  ///< 2^unit, 2^-unit
};

namespace avx512 {
void correct_teardrop(const TeardropFrame& surface, const FaithfulBatch& batch);
}
namespace avx2 {
void correct_teardrop(const TeardropFrame& surface, const FaithfulBatch& batch);
}
namespace baseline {
void correct_teardrop(const TeardropFrame& surface, const FaithfulBatch& batch);
}

}  // namespace graze
