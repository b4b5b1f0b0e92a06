#include <graze/surfaces/torus_certified.hpp>

#include <algorithm>

#include <graze/solvers/certified.hpp>
#include <graze/surfaces/local_ray.hpp>
#include <graze/surfaces/torus_double_double.hpp>

namespace graze {
namespace {

/// Of R + r: below it the bounds (surfaces/torus.md) say little.
constexpr double kLeast = 0x1p-20;

}  // namespace

TorusCertified::TorusCertified(const Torus& surface, const Parameters& options)
    : profile_(surface.profile), unit_(surface.unit()), set_(Certified::instruction_set(options)) {
  if (profile_.tube >= kLeast && profile_.ring >= kLeast && unit_ > -1022 && unit_ < 1022)
    inverse_unit_ = power_of_two(-unit_);
}

void TorusCertified::intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers,
                               std::size_t first) const {
  if (rays.empty()) return;
  TorusAnswers to{&answers.hits[first]};
  for (std::size_t k = 0; k < KernelAnswers::kMost; ++k) to.l[k] = &answers.l[k][first];
  if (inverse_unit_ != 0) {
    run_lanes({rays.data(), rays.size(), profile_.ring, profile_.tube, inverse_unit_, all}, to);
  } else {
    std::fill_n(to.hits, rays.size(), KernelAnswers::kOpen);
  }
  if (profile_.tube < kLeast || profile_.ring < kLeast) return;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (to.hits[i] == KernelAnswers::kOpen && is_valid(rays[i])) look_again(rays[i], all, answers, first + i);
  }
}

void TorusCertified::run_lanes(const TorusBatch& batch, const TorusAnswers& to) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::intersect_torus(batch, to);
  if (set_ == InstructionSet::avx2) return avx2::intersect_torus(batch, to);
#endif
  baseline::intersect_torus(batch, to);
}

/// The middle tier: what double-doubles prove of the line, as hits ahead of the origin.
void TorusCertified::look_again(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const {
  const LocalRay local = to_unit(ray, unit_);
  const TorusLineAnswer line = prove_torus_line({local.o, local.d}, profile_.ring, profile_.tube, !all);
  if (line.open) return;
  HitsOfRay hits(answers, at);
  for (std::size_t i = 0; i < line.count; ++i) {
    const TorusCrossing& crossing = line.crossings[i];
    if ((crossing.hi + line.centre).hi < 0) continue;
    if (!((crossing.lo + line.centre).hi > 0)) return;  // at the origin, on one side or the other: open
    const DoubleDouble middle = crossing.lo + 0.5 * (crossing.hi - crossing.lo);
    if (!hits.add(scale_by_power((middle + line.centre).hi, local.l_exponent), 1)) return;
    if (!all) break;
  }
  hits.close(2);
}

}  // namespace graze
