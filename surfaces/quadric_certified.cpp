#include <graze/surfaces/quadric_certified.hpp>

namespace graze {

QuadricCertified::QuadricCertified(const Quadric& surface, const Parameters& options)
    : SecondDegreeCertified(surface.form, surface.size(), surface.unit(), options) {}

}  // namespace graze
