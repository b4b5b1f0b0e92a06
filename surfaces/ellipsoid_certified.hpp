// The ellipsoid's kernel for `certified`: many rays at once, each answer proved. Contract, error and cost:
// surfaces/second_degree_certified.hpp.
#pragma once

#include <graze/surfaces/ellipsoid.hpp>
#include <graze/surfaces/second_degree_certified.hpp>

namespace graze {

class EllipsoidCertified : public SecondDegreeCertified {
 public:
  using Surface = Ellipsoid;
  static constexpr std::string_view kSolver = "certified";
  static constexpr std::string_view kFormulation = "vertex";

  EllipsoidCertified(const Ellipsoid& surface, const Parameters& options);
};

}  // namespace graze
