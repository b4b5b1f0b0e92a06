// What kernels for `faithful` share: the answers of a surface's kernel for `certified`, every l corrected.
//
// solves    what the kernel for `certified` solves, in its formulation
// needs     Step: a plain struct
//             static constexpr std::uint8_t kLastAgain;  // the last tier whose rays are looked at again
//             Step(const Surface&, const Certified&, const Parameters& options);
//             void correct(const FaithfulBatch&) const;    // lanes, for instance faithful_lanes.hpp
//             bool decide(const Ray&, bool all, std::span<const double> near, KernelAnswers&,
//                         std::size_t at) const;
//                  // the exact tier of one ray; near: its hits, all crossings and nearly right, or none
//                  // where they are not known. false: there is no such tier
// returns   by ray: the proved number of hits and their l; open (-1) where nothing is proved
// error     of l: one ulp; which zero of the equation an l stands for is proved too (surfaces/teardrop.md)
// cost      at most twice that of `certified` on camera rays (the surfaces' pages); what is not proved at
//           once is asked for again with all its hits, and allocates
// source    graze
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include <graze/surfaces/faithful_batch.hpp>
#include <graze/surfaces/kernel.hpp>

namespace graze {

template <class Certified, class Step>
class FaithfulKernel {
 public:
  using Surface = typename Certified::Surface;
  static constexpr std::string_view kSolver = "faithful";
  static constexpr std::string_view kFormulation = Certified::kFormulation;

  FaithfulKernel(const Surface& surface, const Parameters& options)
      : certified_(surface, options), step_(surface, certified_, options) {}

  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const {
    for (std::size_t begin = 0; begin < rays.size(); begin += kBlock) {
      const std::span<const Ray> block = rays.subspan(begin, std::min(kBlock, rays.size() - begin));
      certified_.intersect(block, all, answers, first + begin);
      correct_block(block, all, answers, first + begin);
    }
  }

 private:
  static constexpr std::size_t kBlock = 1024;  ///< rays that stay in the second cache level between the two
  static constexpr std::size_t kAgain = 64;    ///< rays that are looked at again together
  static constexpr std::uint8_t kExact = 3;    ///< the tier whose hits are the nearest doubles
  using Marks = std::array<std::uint8_t, kBlock>;

  /// One step for every hit; open[i] becomes 1 where ray i has one that is not proved.
  void correct_hits(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first,
                    Marks& open) const {
    const std::int8_t* const hits = &answers.hits[first];
    std::array<std::uint32_t, kBlock> which;
    std::size_t count = 0, exact = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool is_exact = answers.tier[first + i] == kExact;
      which[count] = static_cast<std::uint32_t>(i);
      count += hits[i] > 0 && !is_exact ? 1 : 0;
      exact += is_exact ? 1 : 0;
    }
    for (std::size_t rank = 0; count > 0; ++rank) {
      step_.correct({rays.data(), which.data(), count, &answers.l[rank][first], open.data(), !all});
      if (!all) break;
      std::size_t kept = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint32_t i = which[k];
        if (rank > 0 && are_close(answers, rank, first + i)) open[i] = 1;
        which[kept] = i;
        kept += hits[i] > static_cast<int>(rank + 1) ? 1 : 0;
      }
      count = kept;
    }
    for (std::size_t i = 0; all && exact > 0 && i < rays.size(); ++i) {
      const std::size_t many =
          answers.tier[first + i] == kExact && hits[i] > 1 ? static_cast<std::size_t>(hits[i]) : 1;
      for (std::size_t rank = 1; rank < many; ++rank) {
        if (are_close(answers, rank, first + i)) open[i] = 1;
      }
    }
  }

  /// Hits that are proved to an ulp and are further apart than four are different ones: as many as there are.
  static bool are_close(const KernelAnswers& answers, std::size_t rank, std::size_t at) {
    constexpr double kApart = 0x1p-50;
    const double from = answers.l[rank - 1][at], to = answers.l[rank][at];
    return !(to - from > kApart * to);
  }

  void correct_block(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const {
    Marks open;
    std::fill_n(open.begin(), rays.size(), std::uint8_t{0});
    correct_hits(rays, all, answers, first, open);
    std::array<std::size_t, kAgain> again;
    std::size_t count = 0;
    for (std::size_t i = next_open(open, 0, rays.size()); i < rays.size();) {
      if (answers.tier[first + i] > Step::kLastAgain) {
        decide(rays[i], {}, all, answers, first + i);
      } else {
        again[count++] = i;
      }
      i = next_open(open, i + 1, rays.size());
      if (count == kAgain || (i == rays.size() && count > 0)) {
        look_again(rays, std::span(again).first(count), all, answers, first);
        count = 0;
      }
    }
  }

  static std::size_t next_open(const Marks& open, std::size_t from, std::size_t size) {
    const void* const found = std::memchr(open.data() + from, 1, size - from);
    return found == nullptr ? size
                            : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - open.data());
  }

  /// All hits of the rays that are left, with more steps. Which hit is which is told by their order.
  void look_again(std::span<const Ray> rays, std::span<const std::size_t> which, bool all,
                  KernelAnswers& answers, std::size_t first) const {
    constexpr int kSteps = 3;
    std::array<Ray, kAgain> left;
    for (std::size_t k = 0; k < which.size(); ++k) left[k] = rays[which[k]];
    const std::span<const Ray> asked = std::span(left).first(which.size());
    KernelAnswers found;
    found.resize(which.size());
    certified_.intersect(asked, true, found, 0);
    Marks open;
    for (int step = 0; step < kSteps; ++step) {
      std::fill_n(open.begin(), which.size(), std::uint8_t{0});
      correct_hits(asked, true, found, 0, open);
    }
    for (std::size_t k = 0; k < which.size(); ++k) {
      const std::size_t at = first + which[k];
      if (found.hits[k] != KernelAnswers::kOpen && open[k] == 0) {
        take(found, k, all, answers, at);
        continue;
      }
      std::array<double, KernelAnswers::kMany> near;
      const std::size_t hits =
          found.hits[k] > 0 && found.touching[k] == 0 ? static_cast<std::size_t>(found.hits[k]) : 0;
      for (std::size_t rank = 0; rank < hits; ++rank) near[rank] = found.l[rank][k];
      decide(left[k], std::span(near).first(hits), all, answers, at);
    }
  }

  void decide(const Ray& ray, std::span<const double> near, bool all, KernelAnswers& answers,
              std::size_t at) const {
    if (!step_.decide(ray, all, near, answers, at)) answers.hits[at] = KernelAnswers::kOpen;
  }

  static void take(const KernelAnswers& from, std::size_t k, bool all, KernelAnswers& to, std::size_t at) {
    to.hits[at] = all ? from.hits[k] : std::min<std::int8_t>(1, from.hits[k]);
    for (std::size_t rank = 0; static_cast<int>(rank) < to.hits[at]; ++rank) {
      if (to.l[rank].size() <= at) to.l[rank].resize(to.hits.size());
      to.l[rank][at] = from.l[rank][k];
      const bool touches = (from.touching[k] >> rank & 1U) != 0;
      if (touches) to.set_multiplicity(at, rank, from.multiplicity(k, static_cast<int>(rank)));
    }
    to.touching[at] = all ? from.touching[k] : from.touching[k] & std::uint8_t{1};
    to.tier[at] = std::max(from.tier[k], std::uint8_t{2});
  }

  Certified certified_;
  Step step_;
};

}  // namespace graze
