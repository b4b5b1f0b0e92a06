// The quadric's kernel for `certified`: many rays at once, each answer proved. Contract, error and cost:
// surfaces/second_degree_certified.hpp.
#pragma once

#include <graze/surfaces/quadric.hpp>
#include <graze/surfaces/second_degree_certified.hpp>

namespace graze {

class QuadricCertified : public SecondDegreeCertified {
 public:
  using Surface = Quadric;
  static constexpr std::string_view kSolver = "certified";
  static constexpr std::string_view kFormulation = "vertex";

  QuadricCertified(const Quadric& surface, const Parameters& options);
};

}  // namespace graze
