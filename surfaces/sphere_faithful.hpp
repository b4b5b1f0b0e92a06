// The sphere's kernel for `faithful`: many rays at once, each l proved to an ulp. Contract, error and cost:
// surfaces/second_degree_faithful.hpp.
#pragma once

#include <graze/surfaces/second_degree_faithful.hpp>
#include <graze/surfaces/sphere_certified.hpp>

namespace graze {

using SphereFaithful = SecondDegreeFaithful<SphereCertified>;

}  // namespace graze
