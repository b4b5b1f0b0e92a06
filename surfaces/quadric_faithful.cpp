#include <graze/surfaces/quadric_faithful.hpp>

namespace graze {

template class FaithfulKernel<QuadricCertified, SecondDegreeFaithfulStep>;

}  // namespace graze
