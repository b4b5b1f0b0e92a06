// The kernel of Bezier profiles for `certified`: many rays at once, each answer proved.
//
// solves    x^2 + z^2 = R(t)^2, y = Y(t) along the ray, l > 0, rays in batches
// needs     finite rays; degree at most 16. Doubles: degree at most 8, heights within twice the size of 0,
//           Y not constant; double-doubles: rays that climb; the rest and what these leave are for exact
//           integers
// returns   by ray: the proved number of hits and their l, with multiplicities; coincident where it runs
//           inside the surface; open (-1): what is no question, higher degrees, an l out of the range of
//           double
// error     of l: measured, at most 4 condition units, eps (|l| + L/|n.d|); proof of the count and error
//           analysis: surfaces/bezier_revolution.md, "Kernel"
// cost      surfaces/bezier_revolution.md; allocates when it is built, and in the exact tier
// source    graze; ratios of Bernstein polynomials: Farin, "Curves and Surfaces for CAGD", chapter 13
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <graze/solvers/math/instruction_set.hpp>
#include <graze/surfaces/bezier_revolution.hpp>
#include <graze/surfaces/bezier_revolution_double_double.hpp>
#include <graze/surfaces/bezier_revolution_exact.hpp>
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

  /// The middle tier: all hits of a ray, l in units of 2^l_exponent; false where it proves nothing.
  [[nodiscard]] bool find_in_double_doubles(const Ray& ray, BezierDoubleDouble::Hits& found,
                                            int& l_exponent) const;
  /// The last tier.
  [[nodiscard]] ExactBezierRevolution::Hits exact_hits(const Ray& ray) const {
    return exact_ ? exact_->hits(ray) : std::nullopt;
  }

 private:
  void prepare_lanes(const BezierProfile& profile, double size);
  bool add_track(const BezierProfile& profile, const MonotonePiece& piece);
  void run_lanes(std::span<const Ray> rays, bool all, const BezierAnswers& to) const;
  [[nodiscard]] bool add_double_doubles(const Ray& ray, bool all, HitsOfRay& hits) const;
  void decide(const Ray& ray, bool all, KernelAnswers& answers, std::size_t at) const;

  int unit_;
  std::optional<BezierDoubleDouble> double_doubles_;  ///< where the profile's own unit is no underflow
  std::optional<ExactBezierRevolution> exact_;
  std::vector<BezierInterval> intervals_;  ///< none: no ray is answered by lanes
  std::vector<BezierTrack> tracks_;
  BezierBatch frame_;  ///< all but the rays
  InstructionSet set_;
};

}  // namespace graze
