// What is done with the answers of every ray of a batch: rays are many and cheap here, and these loops are
// all that a scene adds to its kernel. Apart from the scene's other code, so that they can be vectors' loops;
// flattened, since a linker may take a vector's functions from a source that was compiled to be small.
#include <graze/surfaces/kernel.hpp>

#include <algorithm>

namespace graze {

[[gnu::flatten]] void KernelAnswers::resize(std::size_t count) {
  hits.resize(count);
  touching.assign(count, 0);
  tier.assign(count, 1);
  above_two_.clear();
  for (std::size_t k = 0; k < kMost; ++k) l[k].resize(count);
}

KernelAnswers::Extremes KernelAnswers::extremes() const {
  Extremes all;
  std::uint32_t touches = 0;
  for (const std::int8_t count : hits) all.fewest = std::min(all.fewest, count);
  for (const std::int8_t count : hits) all.most = std::max(all.most, count);
  for (const std::uint8_t one : tier) all.tier = std::max(all.tier, one);
  for (const std::uint32_t one : touching) touches |= one;
  all.touches = touches != 0;
  return all;
}

[[gnu::flatten]] void append_answers(const KernelAnswers& answers, const KernelAnswers::Extremes& extremes,
                                     std::span<const Counters> first_tier, HitBuffer& out) {
  const std::size_t rays = answers.hits.size(), ray = out.rays();
  const auto& l = answers.l;
  if (extremes.most <= 1) {
    out.append_rays<1>(answers.hits, {l[0].data()}, first_tier);
  } else if (extremes.most == 2) {
    out.append_rays<2>(answers.hits, {l[0].data(), l[1].data()}, first_tier);
  } else if (extremes.most <= static_cast<std::int8_t>(KernelAnswers::kMost)) {
    out.append_rays<KernelAnswers::kMost>(answers.hits, {l[0].data(), l[1].data(), l[2].data(), l[3].data()},
                                          first_tier);
  } else {
    for (std::size_t i = 0; i < rays; ++i) {
      for (int k = 0; k < answers.hits[i]; ++k) out.append(l[static_cast<std::size_t>(k)][i], 0, 1);
      out.close_ray(Status::ok, first_tier[i]);
    }
  }
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
