// What the kernels of sphere, ellipsoid and quadric for `certified` share: many rays at once, answers proved.
//
// solves    f(o + l d) = 0 for l > 0, f of second degree, rays in batches
// needs     finite rays; what is no question is left open
// returns   by ray: the proved number of hits and their l; open (-1) where double arithmetic proves nothing:
//           the solver's own tiers answer those
// error     of l: at most 4 condition units, eps (|l| + L/|n.d|); proof and error analysis: "Kernel" in
//           surfaces/sphere.md (spheres, ellipsoids in their axes) and surfaces/quadric.md
// cost      surfaces/sphere.md, surfaces/quadric.md; no allocation
// source    graze
#pragma once

#include <span>

#include <graze/solvers/math/instruction_set.hpp>
#include <graze/solvers/parameters.hpp>
#include <graze/surfaces/kernel.hpp>
#include <graze/surfaces/second_degree.hpp>
#include <graze/surfaces/second_degree_lanes.hpp>

namespace graze {

class SecondDegreeCertified {
 public:
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const;

  [[nodiscard]] const SecondDegreeSurface& surface() const { return surface_; }
  [[nodiscard]] InstructionSet instruction_set() const { return set_; }

 protected:
  /// A sphere in units of 2^unit.
  SecondDegreeCertified(Vec3 centre, double radius, int unit, const Parameters& options);
  /// A form in units of 2^unit; `size` is L in the world.
  SecondDegreeCertified(const second_degree::QuadraticForm& form, double size, int unit,
                        const Parameters& options);

 private:
  void set_frame(Vec3 centre, int unit);

  SecondDegreeSurface surface_;
  bool is_usable_ = false;  ///< the bounds hold for its numbers; else every ray is left open
  InstructionSet set_;
};

}  // namespace graze
