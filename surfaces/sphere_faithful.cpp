#include <graze/surfaces/sphere_faithful.hpp>

namespace graze {

template class FaithfulKernel<SphereCertified, SecondDegreeFaithfulStep>;

}  // namespace graze
