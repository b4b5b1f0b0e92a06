// The quadric's kernel for `faithful`: many rays at once, each l proved to an ulp. Contract, error and cost:
// surfaces/second_degree_faithful.hpp.
#pragma once

#include <graze/surfaces/quadric_certified.hpp>
#include <graze/surfaces/second_degree_faithful.hpp>

namespace graze {

using QuadricFaithful = SecondDegreeFaithful<QuadricCertified>;

}  // namespace graze
