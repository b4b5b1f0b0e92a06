#include <graze/surfaces/teardrop_certified.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <graze/solvers/certified.hpp>
#include <graze/surfaces/teardrop_exact.hpp>

namespace graze {
namespace {

/// Whether the crossing lies ahead of the ray's origin; nothing where that is not known. A bracket that holds
/// the origin is narrower than any digit of l that counts: the side of the origin decides.
std::optional<bool> is_ahead(const LineAnswer& line, const LineCrossing& crossing, bool enters) {
  if (crossing.hi < 0) return false;
  if (crossing.lo > 0) return true;
  if (line.origin == LineAnswer::Origin::on) return std::nullopt;
  return (line.origin == LineAnswer::Origin::outside) == enters;
}

/// What is proved of the line, as hits ahead of the origin; false: nothing.
bool add_hits(const LineAnswer& line, int l_exponent, bool all, HitsOfRay& hits) {
  if (line.proved != LineAnswer::Proved::crosses) return line.proved == LineAnswer::Proved::misses;
  for (const bool enters : {true, false}) {
    const LineCrossing& crossing = enters ? line.entry : line.exit;
    const std::optional<bool> ahead = is_ahead(line, crossing, enters);
    if (!ahead) return false;
    if (!*ahead) continue;
    // The approximation, but ahead as well.
    const double l = std::max(crossing.l, std::numeric_limits<double>::epsilon() * crossing.hi);
    if (!hits.add(scale_by_power(l, l_exponent), 1)) return false;
    if (!all) break;
  }
  return true;
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
  std::array<std::size_t, kAtOnce> open{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (to.hits[i] == KernelAnswers::kOpen && is_valid(rays[i])) open[count++] = i;
    const bool is_last = i + 1 == rays.size();
    if (count == 0 || (count < kAtOnce && !is_last)) continue;
    look_again(rays, std::span(open).first(count), all, answers, first);
    count = 0;
  }
}

std::size_t TeardropCertified::run_lanes(const TeardropBatch& batch, const TeardropAnswers& to) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::intersect_teardrop(batch, to);
  if (set_ == InstructionSet::avx2) return avx2::intersect_teardrop(batch, to);
#endif
  return baseline::intersect_teardrop(batch, to);
}

void TeardropCertified::run_double_doubles(const TeardropLines& lines, LineAnswer* answers) const {
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::prove_teardrop_lines(lines, answers);
  if (set_ == InstructionSet::avx2) return avx2::prove_teardrop_lines(lines, answers);
#endif
  baseline::prove_teardrop_lines(lines, answers);
}

/// The middle tier: what double-doubles prove of the open lines; the last one decides the others.
void TeardropCertified::look_again(std::span<const Ray> rays, std::span<const std::size_t> open, bool all,
                                   KernelAnswers& answers, std::size_t first) const {
  std::array<Ray, kAtOnce> lines;
  std::array<int, kAtOnce> l_exponents{};
  std::array<LineAnswer, kAtOnce> proved;
  for (std::size_t k = 0; k < open.size(); ++k) {
    const LocalRay local = to_unit(rays[open[k]], unit_);
    lines[k] = {local.o, local.d};
    l_exponents[k] = local.l_exponent;
  }
  run_double_doubles({lines.data(), open.size(), m_, !all}, proved.data());
  for (std::size_t k = 0; k < open.size(); ++k) {
    HitsOfRay hits(answers, first + open[k]);
    if (add_hits(proved[k], l_exponents[k], all, hits)) {
      hits.close(2);
    } else {
      decide(rays[open[k]], all, answers, first + open[k]);
    }
  }
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
