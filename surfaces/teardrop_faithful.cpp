#include <graze/surfaces/teardrop_faithful.hpp>

#include <cmath>

#include <graze/solvers/certified.hpp>
#include <graze/surfaces/local_ray.hpp>
#include <graze/surfaces/teardrop_exact.hpp>

namespace graze {

TeardropFaithfulStep::TeardropFaithfulStep(const Teardrop& surface, const TeardropCertified& /*certified*/,
                                           const Parameters& options)
    : size_(surface.size()), set_(Certified::instruction_set(options)) {
  const int unit = surface.unit();
  frame_.m = surface.profile.m;
  // In units out of range the kernel for `certified` answers nothing either.
  if (unit > -1022 && unit < 1022) {
    frame_.unit = power_of_two(unit);
    frame_.inverse_unit = power_of_two(-unit);
  }
}

void TeardropFaithfulStep::correct(const FaithfulBatch& batch) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::correct_teardrop(frame_, batch);
  if (set_ == InstructionSet::avx2) return avx2::correct_teardrop(frame_, batch);
#endif
  baseline::correct_teardrop(frame_, batch);
}

/// Of two hits x rounds from both, the one that is further from it moves by an ulp: neither is then further
/// from its own than that.
bool TeardropFaithfulStep::decide(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const {
  HitsOfRay hits(answers, at);
  std::vector<ExactHit> exact = exact_teardrop_hits(ray, size_);
  for (std::size_t k = 0; k < exact.size(); ++k) {
    double l = exact[k].l.to_double();
    const bool meets = k + 1 < exact.size() && exact[k + 1].l.to_double() == l;
    if (meets && exact[k + 1].l.compare_with(Dyadic(l)) < 0) l = std::nextafter(l, 0.0);
    if (!hits.add(l, exact[k].multiplicity)) return false;
    if (!all) break;
  }
  hits.close(3);
  return true;
}

}  // namespace graze
