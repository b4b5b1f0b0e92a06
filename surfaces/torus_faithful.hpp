// The torus's kernel for `faithful`: many rays at once, each l proved to an ulp.
//
// solves    f(l) = K^2 + 4 R^2 (y^2 - r^2) = 0 for l > 0, formulation quartic_recentred, rays in batches
// needs     as torus_certified.hpp
// returns   by ray: the proved number of hits and their l; open (-1) where nothing is proved: the solver's
//           own tiers answer those
// error     of l: one ulp; proof: surfaces/torus.md, "Kernel"
// cost      surfaces/torus.md; allocates for rays that one step does not settle
// source    graze
#pragma once

#include <graze/surfaces/faithful_kernel.hpp>
#include <graze/surfaces/torus_certified.hpp>
#include <graze/surfaces/torus_faithful_lanes.hpp>

namespace graze {

class TorusFaithfulStep {
 public:
  static constexpr std::uint8_t kLastAgain = 3;

  TorusFaithfulStep(const Torus& surface, const TorusCertified& certified, const Parameters& options);
  void correct(const FaithfulBatch& batch) const;
  static bool decide(const Ray& /*ray*/, bool /*all*/, std::span<const double> /*near*/,
                     KernelAnswers& /*answers*/, std::size_t /*at*/) {
    return false;
  }

 private:
  TorusFrame frame_;
  InstructionSet set_;
};

using TorusFaithful = FaithfulKernel<TorusCertified, TorusFaithfulStep>;

}  // namespace graze
