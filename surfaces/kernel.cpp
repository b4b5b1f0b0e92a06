// What is done with the answers of every ray of a batch: rays are many and cheap here, and these loops are
// all that a scene adds to its kernel. Apart from the scene's other code, so that they can be unrolled.
#include <graze/surfaces/kernel.hpp>

#include <algorithm>

namespace graze {

KernelAnswers::Extremes KernelAnswers::extremes() const {
  Extremes all;
  std::uint8_t touches = 0;
  for (const std::int8_t count : hits) all.fewest = std::min(all.fewest, count);
  for (const std::int8_t count : hits) all.most = std::max(all.most, count);
  for (const std::uint8_t one : tier) all.tier = std::max(all.tier, one);
  for (const std::uint8_t one : touching) touches |= one;
  all.touches = touches != 0;
  return all;
}

// Whole arrays are copied, and no branch depends on a ray where it has at most one hit.
void append_answers(const KernelAnswers& answers, const KernelAnswers::Extremes& extremes,
                    std::span<const Counters> first_tier, HitBuffer& out) {
  const std::size_t rays = answers.hits.size(), ray = out.rays(), hit = out.l.size();
  const std::size_t most = static_cast<std::uint8_t>(extremes.most);  // no ray is open: not negative
  out.grow(rays * most);
  double* next = out.l.data() + hit;
  if (most == 1) {
    for (std::size_t i = 0; i < rays; ++i) {
      *next = answers.l[0][i];
      next += answers.hits[i];
    }
  } else {
    for (std::size_t i = 0; i < rays; ++i) {
      for (int k = 0; k < answers.hits[i]; ++k) *next++ = answers.l[static_cast<std::size_t>(k)][i];
    }
  }
  out.close_rays(answers.hits, first_tier);
  if (extremes.tier > 1) {
    for (std::size_t i = 0; i < rays; ++i) out.counters[ray + i].tier = answers.tier[i];
  }
  if (extremes.touches) {
    for (std::size_t i = 0; i < rays; ++i) {
      for (std::size_t k = out.begin(ray + i); k < out.end(ray + i); ++k)
        out.multiplicity[k] = answers.multiplicity(i, static_cast<int>(k - out.begin(ray + i)));
    }
  }
}

}  // namespace graze
