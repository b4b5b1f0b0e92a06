// The teardrop's kernel for `faithful`: many rays at once, each l proved to an ulp.
//
// solves    F(l) = R(t(y))^2 - |x_xz|^2 = 0 for l > 0, formulation along_ray, rays in batches
// needs     finite rays; what is no question is left open
// returns   by ray: the proved number of hits and their l; open (-1) where l leaves the range of double
// error     of l: one ulp; proof: surfaces/teardrop.md, "Kernel"
// cost      surfaces/teardrop.md; allocates for rays that one step does not settle
// source    graze
#pragma once

#include <graze/surfaces/faithful_kernel.hpp>
#include <graze/surfaces/teardrop_certified.hpp>
#include <graze/surfaces/teardrop_faithful_lanes.hpp>

namespace graze {

class TeardropFaithfulStep {
 public:
  static constexpr std::uint8_t kLastAgain = 3;

  TeardropFaithfulStep(const Teardrop& surface, const TeardropCertified& certified,
                       const Parameters& options);
  void correct(const FaithfulBatch& batch) const;
  bool decide(const Ray& ray, bool all, std::span<const double> near, KernelAnswers& answers,
              std::size_t at) const;

 private:
  [[nodiscard]] double crossing_near(const Ray& ray, double l, bool enters) const;
  bool place(const Ray& ray, bool all, std::span<const double> near, HitsOfRay& hits) const;
  bool isolate(const Ray& ray, bool all, HitsOfRay& hits) const;

  double size_;  ///< s
  TeardropFrame frame_;
  InstructionSet set_;
};

using TeardropFaithful = FaithfulKernel<TeardropCertified, TeardropFaithfulStep>;

}  // namespace graze
