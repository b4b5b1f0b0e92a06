#include <graze/surfaces/torus_faithful.hpp>

#include <limits>

#include <graze/solvers/certified.hpp>
#include <graze/solvers/math/scaling.hpp>

namespace graze {

TorusFaithfulStep::TorusFaithfulStep(const Torus& surface, const TorusCertified& /*certified*/,
                                     const Parameters& options)
    : set_(Certified::instruction_set(options)) {
  const int unit = surface.unit();
  const bool is_usable = unit > -1022 && unit < 1022;
  // Of no number nothing is proved.
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  frame_ = {surface.profile.ring, surface.profile.tube, is_usable ? power_of_two(unit) : kNone,
            is_usable ? power_of_two(-unit) : kNone};
}

void TorusFaithfulStep::correct(const FaithfulBatch& batch) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::correct_torus(frame_, batch);
  if (set_ == InstructionSet::avx2) return avx2::correct_torus(frame_, batch);
#endif
  baseline::correct_torus(frame_, batch);
}

}  // namespace graze
