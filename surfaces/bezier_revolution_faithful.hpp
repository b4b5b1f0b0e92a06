// The kernel of Bezier profiles for `faithful`: many rays at once, each l proved to an ulp.
//
// solves    what the kernel for `certified` solves
// needs     the same
// returns   by ray: the proved number of hits and their l; open (-1) where `certified` leaves it open
// error     of l: one ulp; proof: surfaces/bezier_revolution.md, "Kernel of faithful"
// cost      surfaces/bezier_revolution.md; allocates when it is built, and for rays that one step does not
//           settle
// source    graze
#pragma once

#include <vector>

#include <graze/surfaces/bezier_revolution_certified.hpp>
#include <graze/surfaces/bezier_revolution_faithful_lanes.hpp>
#include <graze/surfaces/faithful_kernel.hpp>

namespace graze {

class BezierRevolutionFaithfulStep {
 public:
  /// decide() costs no more than the tier that would answer again.
  static constexpr std::uint8_t kLastAgain = 1;

  BezierRevolutionFaithfulStep(const BezierRevolution& surface, const BezierRevolutionCertified& certified,
                               const Parameters& options);
  void correct(const FaithfulBatch& batch) const;
  bool decide(const Ray& ray, bool all, std::span<const double> near, KernelAnswers& answers,
              std::size_t at) const;

 private:
  bool place(const Ray& ray, bool all, HitsOfRay& hits) const;

  BezierRevolutionCertified certified_;  ///< its later tiers
  std::vector<BezierMonotone> pieces_;   ///< none: nothing is proved in lanes
  BezierFaithfulFrame frame_;            ///< all but the pieces
  InstructionSet set_;
};

using BezierRevolutionFaithful = FaithfulKernel<BezierRevolutionCertified, BezierRevolutionFaithfulStep>;

}  // namespace graze
