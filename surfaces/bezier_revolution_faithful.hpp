// The kernel of Bezier profiles for `faithful`: each l proved to an ulp.
//
// solves    what the kernel for `certified` solves
// needs     the same
// returns   by ray: the proved number of hits and their l; open (-1) where `certified` leaves it open
// error     of l: one ulp. Misses are those of `certified`; a hit's l is found again in double-doubles, whose
//           enclosure shows that no further double is nearer, else it is the double nearest to the exact l
// cost      surfaces/bezier_revolution.md: double-doubles for every ray that hits; allocates in the exact
// tier source    graze
#pragma once

#include <graze/surfaces/bezier_revolution_certified.hpp>

namespace graze {

class BezierRevolutionFaithful {
 public:
  using Surface = BezierRevolution;
  static constexpr std::string_view kSolver = "faithful";
  static constexpr std::string_view kFormulation = BezierRevolutionCertified::kFormulation;

  BezierRevolutionFaithful(const BezierRevolution& surface, const Parameters& options)
      : certified_(surface, options) {}
  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const;

 private:
  [[nodiscard]] bool place(const Ray& ray, bool all, HitsOfRay& hits) const;

  BezierRevolutionCertified certified_;
};

}  // namespace graze
