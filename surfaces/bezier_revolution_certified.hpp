// The kernel of Bezier profiles for `certified`: many rays at once, each answer proved.
//
// solves    x^2 + z^2 = R(t)^2, y = Y(t) along the ray, l > 0, rays in batches
// needs     finite rays; degree at most 8, heights within twice the size of 0, Y not constant: what is
//           beyond, and what is no question, is left open
// returns   by ray: the proved number of hits (at most 4) and their l; open (-1) where double arithmetic
//           proves nothing: the solver's own tiers answer those
// error     of l: measured, at most 4 condition units, eps (|l| + L/|n.d|); proof of the count and error
//           analysis: surfaces/bezier_revolution.md, "Kernel"
// cost      surfaces/bezier_revolution.md; allocates when it is built
// source    graze; ratios of Bernstein polynomials: Farin, "Curves and Surfaces for CAGD", chapter 13
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <graze/solvers/math/instruction_set.hpp>
#include <graze/surfaces/bezier_revolution.hpp>
#include <graze/surfaces/bezier_revolution_lanes.hpp>
#include <graze/surfaces/kernel.hpp>

namespace graze {

class BezierRevolutionCertified {
 public:
  using Surface = BezierRevolution;
  static constexpr std::string_view kSolver = "certified";
  static constexpr std::string_view kFormulation = "polynomial";

  BezierRevolutionCertified(const BezierRevolution& surface, const Parameters& options);
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const;

 private:
  bool add_track(const BezierProfile& profile, const MonotonePiece& piece);

  std::vector<BezierInterval> intervals_;  ///< none: all rays are left open
  std::vector<BezierTrack> tracks_;
  BezierBatch frame_;  ///< all but the rays
  InstructionSet set_;
};

}  // namespace graze
