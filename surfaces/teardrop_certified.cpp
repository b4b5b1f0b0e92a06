#include <graze/surfaces/teardrop_certified.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <graze/solvers/certified.hpp>
#include <graze/surfaces/teardrop_double_double.hpp>

namespace graze {

TeardropCertified::TeardropCertified(const Teardrop& surface, const Parameters& options)
    : m_(surface.profile.m), unit_(surface.unit()), set_(Certified::instruction_set(options)) {
  inverse_unit_ = unit_ > -1022 && unit_ < 1022 ? power_of_two(-unit_) : 0;
}

void TeardropCertified::intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers,
                                  std::size_t first) const {
  const TeardropAnswers to{&answers.hits[first], &answers.l[0][first], &answers.l[1][first]};
  if (inverse_unit_ == 0) {
    std::fill_n(to.hits, rays.size(), KernelAnswers::kOpen);
    return;
  }
  if (run_lanes({rays.data(), rays.size(), m_, 1 / inverse_unit_, inverse_unit_, all}, to) == 0) return;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (to.hits[i] == KernelAnswers::kOpen && is_valid(rays[i])) look_again(rays[i], all, answers, first + i);
  }
}

std::size_t TeardropCertified::run_lanes(const TeardropBatch& batch, const TeardropAnswers& to) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::intersect_teardrop(batch, to);
  if (set_ == InstructionSet::avx2) return avx2::intersect_teardrop(batch, to);
#endif
  return baseline::intersect_teardrop(batch, to);
}

/// The middle tier: what double-doubles prove of the line, as hits ahead of the origin.
void TeardropCertified::look_again(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const {
  const LocalRay local = to_unit(ray, unit_);
  const LineAnswer line = prove_line({local.o, local.d}, m_, !all);
  if (line.proved == LineAnswer::Proved::open) return;
  answers.tier[at] = 2;
  std::size_t hits = 0;
  if (line.proved == LineAnswer::Proved::crosses) {
    for (const LineCrossing& crossing : {line.entry, line.exit}) {
      if ((crossing.hi + line.centre).hi < 0) continue;
      if (!((crossing.lo + line.centre).hi > 0)) return;  // at the origin, on one side or the other: open
      const double l = scale_by_power((crossing.delta + line.centre).hi, local.l_exponent);
      if (!(l > 0 && std::isfinite(l))) return;  // beyond the range of double: open
      double& next = answers.l[hits][at];
      // Two crossings are two hits, also where both round to one double.
      next =
          hits > 0 && l == answers.l[0][at] ? std::nextafter(l, std::numeric_limits<double>::infinity()) : l;
      ++hits;
      if (!all) break;
    }
  }
  answers.hits[at] = static_cast<std::int8_t>(hits);
}

}  // namespace graze
