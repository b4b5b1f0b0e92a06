#include <graze/surfaces/torus_certified.hpp>

#include <algorithm>

#include <graze/solvers/certified.hpp>

namespace graze {

TorusCertified::TorusCertified(const Torus& surface, const Parameters& options)
    : profile_(surface.profile), set_(Certified::instruction_set(options)) {
  // Beyond this the bounds of the lanes (surfaces/torus.md) say little, and near a horn nothing.
  constexpr double kLeast = 0x1p-20;
  const int unit = surface.unit();
  if (profile_.tube >= kLeast && profile_.ring - profile_.tube >= kLeast && unit > -1022 && unit < 1022)
    inverse_unit_ = power_of_two(-unit);
}

void TorusCertified::intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers,
                               std::size_t first) const {
  if (rays.empty()) return;
  TorusAnswers to{&answers.hits[first]};
  for (std::size_t k = 0; k < KernelAnswers::kMost; ++k) to.l[k] = &answers.l[k][first];
  if (inverse_unit_ == 0) {
    std::fill_n(to.hits, rays.size(), KernelAnswers::kOpen);
    return;
  }
  run_lanes({rays.data(), rays.size(), profile_.ring, profile_.tube, inverse_unit_, all}, to);
}

void TorusCertified::run_lanes(const TorusBatch& batch, const TorusAnswers& to) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::intersect_torus(batch, to);
  if (set_ == InstructionSet::avx2) return avx2::intersect_torus(batch, to);
#endif
  baseline::intersect_torus(batch, to);
}

}  // namespace graze
