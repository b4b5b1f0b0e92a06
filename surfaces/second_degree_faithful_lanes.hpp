// Kernels of second degree for `faithful`: what their code for one instruction set takes
// (surfaces/quadric.md).
#pragma once

#include <graze/surfaces/faithful_batch.hpp>
#include <graze/surfaces/second_degree_lanes.hpp>

namespace graze {

namespace avx512 {
void correct_second_degree(const SecondDegreeSurface& surface, const FaithfulBatch& batch);
}
namespace avx2 {
void correct_second_degree(const SecondDegreeSurface& surface, const FaithfulBatch& batch);
}
namespace baseline {
void correct_second_degree(const SecondDegreeSurface& surface, const FaithfulBatch& batch);
}

}  // namespace graze
