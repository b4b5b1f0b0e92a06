// The torus's kernel for `certified`: many rays at once, each answer proved.
//
// solves    f(l) = K^2 + 4 R^2 (y^2 - r^2) = 0 for l > 0, formulation quartic_recentred, rays in batches
// needs     finite rays and a torus with R and r at least 2^-20 of R + r; all else is left open
// returns   by ray: the proved number of hits and their l; open (-1) where double arithmetic proves nothing:
//           the solver's own tiers answer those
// error     of l: measured, at most 4 condition units, eps (|l| + L/|n.d|); proof of the count and error
//           analysis: surfaces/torus.md, "Kernel"
// cost      surfaces/torus.md; no allocation
// source    graze; convex pieces of the quartic (surfaces/torus.md)
#pragma once

#include <span>

#include <graze/solvers/math/instruction_set.hpp>
#include <graze/surfaces/kernel.hpp>
#include <graze/surfaces/torus.hpp>
#include <graze/surfaces/torus_lanes.hpp>

namespace graze {

class TorusCertified {
 public:
  using Surface = Torus;
  static constexpr std::string_view kSolver = "certified";
  static constexpr std::string_view kFormulation = "quartic_recentred";

  TorusCertified(const Torus& surface, const Parameters& options);
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const;

 private:
  void run_lanes(const TorusBatch& batch, const TorusAnswers& to) const;
  void look_again(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const;

  TorusProfile profile_;
  int unit_;
  double inverse_unit_ = 0;  ///< 2^-unit; 0 where lanes are not for this torus
  InstructionSet set_;
};

}  // namespace graze
