// The teardrop's kernel for `certified`: many rays at once, each answer proved.
//
// solves    F(l) = R(t(y))^2 - |x_xz|^2 = 0 for l > 0, formulation along_ray, rays in batches
// needs     finite rays; what is no question is left open
// returns   by ray: the proved number of hits and their l; open (-1) for what is no question and for an l out
//           of the range of double
// error     of l: measured, at most 4 condition units, eps (|l| + L/|n.d|); proof of the count and error
//           analysis: surfaces/teardrop.md, "Kernel"
// cost      surfaces/teardrop.md; allocates in its exact tier only
// source    graze; majorants from rho''' > 0 (surfaces/teardrop.md)
#pragma once

#include <span>

#include <graze/solvers/math/instruction_set.hpp>
#include <graze/surfaces/kernel.hpp>
#include <graze/surfaces/teardrop.hpp>
#include <graze/surfaces/teardrop_double_double.hpp>
#include <graze/surfaces/teardrop_lanes.hpp>

namespace graze {

class TeardropCertified {
 public:
  using Surface = Teardrop;
  static constexpr std::string_view kSolver = "certified";
  static constexpr std::string_view kFormulation = "along_ray";

  TeardropCertified(const Teardrop& surface, const Parameters& options);
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const;

 private:
  static constexpr std::size_t kAtOnce = 64;  ///< lines that the middle tier takes

  std::size_t run_lanes(const TeardropBatch& batch, const TeardropAnswers& to) const;
  void run_double_doubles(const TeardropLines& lines, LineAnswer* answers) const;
  void look_again(std::span<const Ray> rays, std::span<const std::size_t> open, bool all,
                  KernelAnswers& answers, std::size_t first) const;
  void decide(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const;

  double size_;  ///< s
  double m_;
  int unit_;
  double inverse_unit_;  ///< 2^-unit; 0 where it is no normal number, and rays are left open
  InstructionSet set_;
};

}  // namespace graze
