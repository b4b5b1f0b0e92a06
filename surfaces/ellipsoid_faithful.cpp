#include <graze/surfaces/ellipsoid_faithful.hpp>

namespace graze {

template class FaithfulKernel<EllipsoidCertified, SecondDegreeFaithfulStep>;

}  // namespace graze
