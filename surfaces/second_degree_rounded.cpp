// In place of second_degree_exact.cpp for builds without a solver that ends in integers: nobody asks.
#include <graze/surfaces/second_degree.hpp>
#include <graze/surfaces/sphere.hpp>

namespace graze::second_degree {

template <class Form>
ExactCoefficients exact_coefficients(EquationBlock& /*block*/, const Form& /*form*/, const LocalRay& /*ray*/,
                                     Slice /*slice*/) {
  return {};
}

template <class Form>
void keep_in_range(const Form& /*form*/, LocalRay& /*ray*/) {}

template <class Form>
bool pose_beyond_range(EquationBlock& /*block*/, const Form& /*form*/, const LocalRay& /*ray*/) {
  return false;
}

template ExactCoefficients exact_coefficients(EquationBlock&, const SphereForm&, const LocalRay&, Slice);
template ExactCoefficients exact_coefficients(EquationBlock&, const QuadraticForm&, const LocalRay&, Slice);
template void keep_in_range(const SphereForm&, LocalRay&);
template void keep_in_range(const QuadraticForm&, LocalRay&);
template bool pose_beyond_range(EquationBlock&, const SphereForm&, const LocalRay&);
template bool pose_beyond_range(EquationBlock&, const QuadraticForm&, const LocalRay&);

}  // namespace graze::second_degree
