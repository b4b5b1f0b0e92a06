// Kernels whose operations are counted: their own sources once more, with lanes that count.
//
// solves    a batch as the kernel of that name does, one ray after another, and adds what its lanes did to
//           the count of the open CountingScope (solvers/math/counting.hpp)
// needs     a build with the kernel. The counting component compiles its sources under second names
//           (experiments/CMakeLists.txt)
// returns   the same answers, bit for bit, with the same tiers
// error     none in the lanes: all their operations are counted as the source has them, those of guesses in
//           float and of tiers in lanes of double-doubles too. What tiers in scalars do is not: the torus's
//           and the Bezier profile's double-doubles, exact integers, and the solver itself where a kernel
//           leaves a ray open. A vector of many rays goes on until its last one is done; a ray by itself
//           stops when it is, so that the count depends on no instruction set
// cost      3 to 30 times the time of the baseline kernel (camera rays, measured)
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <graze/solvers/math/counting.hpp>
#include <graze/surfaces/kernel.hpp>

namespace graze {

/// A kernel that is asked about one ray at a time: its lanes count one ray.
template <class K>
class CountedKernelModel final : public AnyKernel {
 public:
  explicit CountedKernelModel(const Parameters& options) : options_(options) {
    // Whose lanes these are: solvers/math/lanes.hpp.
    options_.set("instruction_set", "baseline");
  }

  void add(const SurfaceSpec& spec) override { kernels_.emplace_back(typename K::Surface(spec), options_); }
  void intersect(std::span<const Ray> rays, std::span<const std::uint32_t> surfaces, bool all,
                 KernelAnswers& answers) const override {
    answers.resize(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
      kernels_[surfaces[i]].intersect(rays.subspan(i, 1), all, answers, i);
  }
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers) const override {
    answers.resize(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
      kernels_.front().intersect(rays.subspan(i, 1), all, answers, i);
  }

 private:
  Parameters options_;
  std::deque<K> kernels_;
};

struct CountedKernelEntry {
  std::string_view surface;
  KernelEntry kernel;
};

/// The counted forms of the build's kernels; generated.
const std::vector<CountedKernelEntry>& counted_kernel_registry();

/// The kernel of that cell, counting; null where it has none. The option instruction_set is taken and
/// ignored.
const KernelEntry* find_counted_kernel(std::string_view surface, std::string_view solver,
                                       std::string_view formulation);

}  // namespace graze
