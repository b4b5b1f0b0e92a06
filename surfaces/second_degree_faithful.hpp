// What the kernels of sphere, ellipsoid and quadric for `faithful` share: the step that corrects l.
//
// solves    f(o + l d) = 0 for l > 0, f of second degree, about an l that is nearly right
// needs     a kernel for `certified` (second_degree_certified.hpp)
// returns   l, open where nothing is proved: the solver's own tiers answer those
// error     one ulp; proof: surfaces/teardrop.md and surfaces/quadric.md, "Kernel"
// cost      surfaces/sphere.md, surfaces/quadric.md
// source    graze
#pragma once

#include <graze/surfaces/faithful_kernel.hpp>
#include <graze/surfaces/second_degree_certified.hpp>
#include <graze/surfaces/second_degree_faithful_lanes.hpp>

namespace graze {

class SecondDegreeFaithfulStep {
 public:
  static constexpr std::uint8_t kLastAgain = 3;

  template <class Surface>
  SecondDegreeFaithfulStep(const Surface& /*surface*/, const SecondDegreeCertified& certified,
                           const Parameters& /*options*/)
      : surface_(certified.surface()), set_(certified.instruction_set()) {}
  void correct(const FaithfulBatch& batch) const;
  static bool decide(const Ray& /*ray*/, bool /*all*/, std::span<const double> /*near*/,
                     KernelAnswers& /*answers*/, std::size_t /*at*/) {
    return false;
  }

 private:
  SecondDegreeSurface surface_;
  InstructionSet set_;
};

template <class Certified>
using SecondDegreeFaithful = FaithfulKernel<Certified, SecondDegreeFaithfulStep>;

}  // namespace graze
