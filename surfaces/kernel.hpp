// Batch kernels: a surface's own way to answer many rays at once, in place of one equation a ray.
//
// A kernel belongs to a surface, one of its formulations and a solver (the cell whose answers it gives): it
// is a plain struct beside the surface's file,
//   using Surface = ...;
//   static constexpr std::string_view kSolver, kFormulation;
//   Kernel(const Surface&, const Parameters& options);                 // options of the solver
//   void intersect(std::span<const Ray>, bool all, KernelAnswers&, std::size_t first) const;
// and one line graze_kernel(...) in the CMake list. It answers what it can prove and leaves the rest to the
// solver: answers.hits[first + i] is the number of hits of rays[i] (at most one unless `all`), or kOpen, or
// kCoincident.
// The formulation's unknown is l, so that a hit's place on the surface can be lifted from it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <graze/surfaces/hit.hpp>
#include <graze/surfaces/ray.hpp>
#include <graze/surfaces/spec.hpp>

namespace graze {

/// Proved answers of a batch, by position.
struct KernelAnswers {
  static constexpr std::size_t kMost = 4;   ///< hits of a ray that have their places in any batch
  static constexpr std::size_t kMany = 32;  ///< hits of a ray, ever
  static constexpr std::int8_t kOpen = -1;
  static constexpr std::int8_t kCoincident = -2;  ///< runs inside the surface, which is proved

  std::vector<std::int8_t> hits;
  std::array<std::vector<double>, kMany> l;  ///< ascending, in units of |d|; meaningful below `hits`
  std::vector<std::uint32_t> touching;       ///< bit k: hit k has a multiplicity above 1
  std::vector<std::uint8_t> tier;            ///< which arithmetic answered: Counters::tier

  [[nodiscard]] std::uint32_t multiplicity(std::size_t ray, int hit) const {
    if ((touching[ray] >> static_cast<unsigned>(hit) & 1U) == 0) return 1;
    const auto found = above_two_.find(ray * kMany + static_cast<std::size_t>(hit));
    return found == above_two_.end() ? 2 : found->second;
  }
  /// Of a hit whose bit is set.
  void set_multiplicity(std::size_t ray, std::size_t hit, std::uint32_t multiplicity) {
    if (multiplicity > 2) {
      above_two_[ray * kMany + hit] = multiplicity;
    } else if (!above_two_.empty()) {
      above_two_.erase(ray * kMany + hit);
    }
  }
  /// Of all rays: one pass, so that the ordinary batch, where there is nothing special, is told from others.
  struct Extremes {
    std::int8_t fewest = 0, most = 0;  ///< hits; fewest < 0: some ray has no count
    std::uint8_t tier = 1;             ///< the highest
    bool touches = false;
  };
  [[nodiscard]] Extremes extremes() const;
  void resize(std::size_t count);

 private:
  std::unordered_map<std::size_t, std::uint32_t> above_two_;  ///< by ray and hit: hardly ever any
};

/// Appends answers that leave no ray open, as those of surface 0. `first_tier`: as many counters as rays, or
/// more, of rays that the first tier answered.
void append_answers(const KernelAnswers& answers, const KernelAnswers::Extremes& extremes,
                    std::span<const Counters> first_tier, HitBuffer& out);

/// Hits of one ray on their way into the answers, for tiers that take a ray at a time; a ray that is not
/// closed stays as it was.
class HitsOfRay {
 public:
  HitsOfRay(KernelAnswers& answers, std::size_t at) : answers_(answers), at_(at) {}

  /// The next hit, ascending; false where l leaves the range of double or there are too many, of all or of
  /// those that round to one double.
  [[nodiscard]] bool add(double l, std::uint32_t multiplicity) {
    if (!(l > 0 && std::isfinite(l)) || count_ == KernelAnswers::kMany) return false;
    // Two hits are two, also where both round to one double; a fifth would be too far from where it is.
    constexpr int kMostMoved = 3;
    const bool is_behind = count_ == 0 || l > answers_.l[count_ - 1][at_];
    moved_ = is_behind ? 0 : moved_ + 1;
    if (moved_ > kMostMoved) return false;
    if (!is_behind) l = std::nextafter(answers_.l[count_ - 1][at_], std::numeric_limits<double>::infinity());
    if (multiplicity > 1) {
      touching_ |= std::uint32_t{1} << count_;
      answers_.set_multiplicity(at_, count_, multiplicity);
    }
    // Few rays of few surfaces have that many: their places are made when the first of them comes.
    std::vector<double>& place = answers_.l[count_++];
    if (place.size() <= at_) place.resize(answers_.hits.size());
    place[at_] = l;
    return true;
  }
  void close(std::uint8_t tier) {
    answers_.hits[at_] = static_cast<std::int8_t>(count_);
    answers_.touching[at_] = touching_;
    answers_.tier[at_] = tier;
  }
  /// The ray runs inside the surface.
  void close_coincident(std::uint8_t tier) {
    answers_.hits[at_] = KernelAnswers::kCoincident;
    answers_.tier[at_] = tier;
  }

 private:
  KernelAnswers& answers_;
  std::size_t at_;
  std::size_t count_ = 0;
  int moved_ = 0;  ///< hits in a row that are not where they round to
  std::uint32_t touching_ = 0;
};

/// Kernels of all surfaces of one group: one virtual call a batch.
class AnyKernel {
 public:
  virtual ~AnyKernel() = default;
  virtual void add(const SurfaceSpec& spec) = 0;
  /// rays[i] belongs to surface surfaces[i]; rays of one surface that follow one another are answered
  /// together.
  virtual void intersect(std::span<const Ray> rays, std::span<const std::uint32_t> surfaces, bool all,
                         KernelAnswers& answers) const = 0;
  /// The same for rays that all belong to surface 0.
  virtual void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers) const = 0;
};

template <class K>
class KernelModel final : public AnyKernel {
 public:
  explicit KernelModel(const Parameters& options) : options_(options) {}

  void add(const SurfaceSpec& spec) override { kernels_.emplace_back(typename K::Surface(spec), options_); }
  void intersect(std::span<const Ray> rays, std::span<const std::uint32_t> surfaces, bool all,
                 KernelAnswers& answers) const override {
    answers.resize(rays.size());
    for (std::size_t i = 0; i < rays.size();) {
      std::size_t end = i + 1;
      while (end < rays.size() && surfaces[end] == surfaces[i]) ++end;
      kernels_[surfaces[i]].intersect(rays.subspan(i, end - i), all, answers, i);
      i = end;
    }
  }
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers) const override {
    answers.resize(rays.size());
    kernels_.front().intersect(rays, all, answers, 0);
  }

 private:
  Parameters options_;
  std::deque<K> kernels_;
};

/// A surface's line for one of its kernels.
struct KernelEntry {
  std::string_view solver, formulation;
  std::unique_ptr<AnyKernel> (*make)(const Parameters& options) = nullptr;
};

template <class K>
KernelEntry kernel_entry() {
  return {K::kSolver, K::kFormulation, [](const Parameters& options) -> std::unique_ptr<AnyKernel> {
            return std::make_unique<KernelModel<K>>(options);
          }};
}

}  // namespace graze
