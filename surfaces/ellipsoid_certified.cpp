#include <graze/surfaces/ellipsoid_certified.hpp>

namespace graze {

EllipsoidCertified::EllipsoidCertified(const Ellipsoid& surface, const Parameters& options)
    : SecondDegreeCertified(surface.form, surface.size(), surface.unit(), options) {}

}  // namespace graze
