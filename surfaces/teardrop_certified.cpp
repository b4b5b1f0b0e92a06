#include <graze/surfaces/teardrop_certified.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <graze/solvers/certified.hpp>
#include <graze/surfaces/teardrop_double_double.hpp>
#include <graze/surfaces/teardrop_exact.hpp>

namespace graze {
namespace {

/// Hits of one ray on their way into the answers: open where one leaves the range of double.
class HitsOfRay {
 public:
  HitsOfRay(KernelAnswers& answers, std::size_t at) : answers_(answers), at_(at) {}

  bool add(double l, std::uint32_t multiplicity) {
    if (!(l > 0 && std::isfinite(l))) return false;
    // Two crossings are two hits, also where both round to one double.
    if (count_ > 0 && l <= answers_.l[count_ - 1][at_])
      l = std::nextafter(answers_.l[count_ - 1][at_], std::numeric_limits<double>::infinity());
    if (multiplicity == 2) answers_.touching[at_] |= static_cast<std::uint8_t>(1U << count_);
    answers_.l[count_++][at_] = l;
    return true;
  }
  void close(std::uint8_t tier) {
    answers_.hits[at_] = static_cast<std::int8_t>(count_);
    answers_.tier[at_] = tier;
  }

 private:
  KernelAnswers& answers_;
  std::size_t at_;
  std::size_t count_ = 0;
};

/// Whether the crossing lies ahead of the ray's origin; nothing where that is not known. A bracket that holds
/// the origin is narrower than any digit of l that counts: the side of the origin decides.
std::optional<bool> is_ahead(const LineAnswer& line, const LineCrossing& crossing, bool enters) {
  if ((crossing.hi + line.centre).hi < 0) return false;
  if ((crossing.lo + line.centre).hi > 0) return true;
  if (line.origin == LineAnswer::Origin::on) return std::nullopt;
  return (line.origin == LineAnswer::Origin::outside) == enters;
}

}  // namespace

TeardropCertified::TeardropCertified(const Teardrop& surface, const Parameters& options)
    : size_(surface.size()),
      m_(surface.profile.m),
      unit_(surface.unit()),
      set_(Certified::instruction_set(options)) {
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
    if (to.hits[i] != KernelAnswers::kOpen || !is_valid(rays[i])) continue;
    if (!look_again(rays[i], all, answers, first + i)) decide(rays[i], all, answers, first + i);
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
bool TeardropCertified::look_again(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const {
  const LocalRay local = to_unit(ray, unit_);
  const LineAnswer line = prove_line({local.o, local.d}, m_, !all);
  if (line.proved == LineAnswer::Proved::open) return false;
  HitsOfRay hits(answers, at);
  for (const bool enters : {true, false}) {
    if (line.proved == LineAnswer::Proved::misses) break;
    const LineCrossing& crossing = enters ? line.entry : line.exit;
    const std::optional<bool> ahead = is_ahead(line, crossing, enters);
    if (!ahead) return false;
    if (!*ahead) continue;
    const double l = (crossing.delta + line.centre).hi;
    const double positive = l > 0 ? l : (crossing.hi + line.centre).hi;
    if (!hits.add(scale_by_power(positive, local.l_exponent), 1)) return false;
    if (!all) break;
  }
  hits.close(2);
  return true;
}

/// The last tier: every ray has an answer; only an l out of the range of double is left open.
void TeardropCertified::decide(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const {
  HitsOfRay hits(answers, at);
  for (ExactHit& hit : exact_teardrop_hits(ray, size_)) {
    if (!hits.add(hit.l.to_double(), hit.multiplicity)) return;
    if (!all) break;
  }
  hits.close(3);
}

}  // namespace graze
