// The sphere's kernel for `certified`: many rays at once, each answer proved. Contract, error and cost:
// surfaces/second_degree_certified.hpp.
#pragma once

#include <graze/surfaces/second_degree_certified.hpp>
#include <graze/surfaces/sphere.hpp>

namespace graze {

class SphereCertified : public SecondDegreeCertified {
 public:
  using Surface = Sphere;
  static constexpr std::string_view kSolver = "certified";
  static constexpr std::string_view kFormulation = "foot";

  SphereCertified(const Sphere& surface, const Parameters& options);
};

}  // namespace graze
