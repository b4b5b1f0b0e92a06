#include <graze/surfaces/second_degree_faithful.hpp>

namespace graze {

void SecondDegreeFaithfulStep::correct(const FaithfulBatch& batch) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::correct_second_degree(surface_, batch);
  if (set_ == InstructionSet::avx2) return avx2::correct_second_degree(surface_, batch);
#endif
  baseline::correct_second_degree(surface_, batch);
}

}  // namespace graze
