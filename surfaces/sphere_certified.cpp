#include <graze/surfaces/sphere_certified.hpp>

namespace graze {

SphereCertified::SphereCertified(const Sphere& surface, const Parameters& options)
    : SecondDegreeCertified(surface.form.centre, surface.form.radius, surface.unit(), options) {}

}  // namespace graze
