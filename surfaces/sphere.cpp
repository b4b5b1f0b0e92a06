#include <graze/surfaces/sphere.hpp>

#include <cmath>

#include <graze/surfaces/sphere_algorithms.hpp>

namespace graze {
namespace {

std::vector<Form> all_forms() { return {Form::polynomial, Form::scalar, Form::interval}; }

/// Kinds of the geometric formulation: in which arithmetic t_ca was found.
enum GeometricKind : std::uint32_t { kInDouble, kInFloat };

/// Ray and sphere as the document wants them: d of unit length, and its length before that.
template <class T>
struct UnitRay {
  std::array<T, 3> d, from_centre;
  T length, radius;

  UnitRay(const SphereForm& form, const LocalRay& ray)
      : d{exactly<T>(ray.d.x), exactly<T>(ray.d.y), exactly<T>(ray.d.z)},
        from_centre{exactly<T>(ray.o.x) - exactly<T>(form.centre.x),
                    exactly<T>(ray.o.y) - exactly<T>(form.centre.y),
                    exactly<T>(ray.o.z) - exactly<T>(form.centre.z)},
        radius(exactly<T>(form.radius)) {
    using std::sqrt;
    length = sqrt(sphere_algorithms::dot(d, d));
    for (T& x : d) x = x / length;
  }
  [[nodiscard]] sphere_algorithms::Algebraic<T> algebraic() const { return {from_centre, d, radius}; }
  [[nodiscard]] sphere_algorithms::Geometric<T> geometric() const {
    return {{-from_centre[0], -from_centre[1], -from_centre[2]}, d, radius};
  }
};

}  // namespace

// -------------------------------------------------------------------------------------------- formulations

SphereFoot::SphereFoot(const Sphere& surface) : form(surface.form) {}

FormulationInfo SphereFoot::info() {
  return {"foot",
          "d^2 l^2 + 2 (d.m) l + m^2 - r^2, m from the foot of the perpendicular, or from an origin close by",
          "graze (surfaces/sphere.md)", all_forms(), 2};
}

SphereGeometric::SphereGeometric(const Sphere& surface) : form(surface.form) {}

FormulationInfo SphereGeometric::info() {
  return {"geometric", "(t - t_ca)^2 = r^2 - |OC|^2 + t_ca^2 for d/|d|, in plain arithmetic",
          "document 001, geometric algorithm", all_forms(), 2};
}

void SphereGeometric::pose(const LocalRay& ray, EquationBlock& block) const {
  const bool in_float = block.precision() == Precision::binary32;
  // t_hc is at most r; what lies behind the origin is dropped with l <= 0.
  const double reach = 2 * form.radius;
  pose_in_delta(block, in_float ? kInFloat : kInDouble, -reach, reach, ray.seed(), 2, [&](auto number) {
    using T = decltype(number);
    return std::array<T, 3>{-UnitRay<T>(form, ray).geometric().t_hc2(), T{}, exactly<T>(1)};
  });
}

void SphereGeometric::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                           std::vector<LocalHit>& hits) const {
  const UnitRay<double> unit(form, ray);
  const double t_ca = posed.kind == kInFloat ? static_cast<double>(UnitRay<float>(form, ray).geometric().t_ca)
                                             : unit.geometric().t_ca;
  const double size = std::hypot(unit.from_centre[0], unit.from_centre[1], unit.from_centre[2]);
  // Fewer than 16 roundings on terms of this size.
  hits.push_back({.multiplicity = root.multiplicity,
                  .delta = (t_ca + root.x) / unit.length - ray.centre,
                  .error = 0x1p-48 * size / unit.length});
}

SphereAlgebraic::SphereAlgebraic(const Sphere& surface) : form(surface.form) {}

FormulationInfo SphereAlgebraic::info() {
  return {"algebraic", "t^2 + 2 B t + C about the origin, t = l |d|, in plain arithmetic",
          "document 001, algebraic algorithm", all_forms(), 2};
}

void SphereAlgebraic::pose(const LocalRay& ray, EquationBlock& block) const {
  second_degree::pose_about_origin(block, ray, [&](auto number) {
    using T = decltype(number);
    // The document's t is l |d|: put in, the equation is one in l.
    const UnitRay<T> unit(form, ray);
    const auto q = unit.algebraic();
    return std::array<T, 3>{q.c, exactly<T>(2) * q.b * unit.length, unit.length * unit.length};
  });
}

void SphereAlgebraic::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                           std::vector<LocalHit>& hits) const {
  second_degree::lift_from_origin(ray, root, hits);
}

SphereSystem::SphereSystem(const Sphere& surface) : form(surface.form), meridian{surface.form.radius} {}

FormulationInfo SphereSystem::info() {
  return {"system",
          "o + l d = c + r (cos phi cos theta, sin phi, cos phi sin theta) in (l, theta, phi)",
          "document 003's system for a circle",
          {Form::system}};
}

void SphereSystem::pose(const LocalRay& ray, EquationBlock& block) const {
  LocalRay from_centre = ray;
  from_centre.p = second_degree::seen_from(form.centre, ray, 0);
  revolution::System<SphereMeridian>::pose(meridian, from_centre, block);
}

void SphereSystem::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                        std::vector<LocalHit>& hits) const {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x});
}

// -------------------------------------------------------------------------------------------------- sphere

SurfaceInfo Sphere::info() {
  SurfaceInfo info;
  info.summary = "|x - center| = radius";
  info.source = "documents 001 and 002";
  info.page = "surfaces/sphere.md";
  info.parameters = {"center", "radius"};
  info.params = {"theta", "phi"};
  return info;
}

Parameters Sphere::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"center"}, Length{"radius"}};
  return scale_lengths(parameters, kLengths, factor);
}

Sphere::Sphere(const SurfaceSpec& spec)
    : centre_(vec3(spec.parameters, "center", {})), radius_(spec.parameters.number("radius")) {
  if (radius_ <= 0) throw std::invalid_argument("radius must be positive");
  unit_ = exponent_of(radius_);
  form.radius = scale_by_power(radius_, -unit_);
  form.centre = scale_by_power(centre_, -unit_);
}

bool Sphere::clip(LocalRay& ray) const {
  return second_degree::clip_ball(form, form.centre, form.radius, ray);
}

LocalPoint Sphere::describe(const LocalRay& ray, const LocalHit& hit) const {
  const Vec3 m = second_degree::seen_from(form.centre, ray, hit.delta);
  return {normalized(m), sphere_parameters(m)};
}

SurfaceSample Sphere::sample(double u, double v) const {
  const Vec3 normal = second_degree::on_unit_sphere(u, v);
  return {centre_ + radius_ * normal, normal};
}

Landmarks Sphere::landmarks() const {
  Landmarks marks;
  marks.centre = centre_;
  marks.half = {radius_, radius_, radius_};
  marks.poles = {centre_ - Vec3{0, radius_, 0}, centre_ + Vec3{0, radius_, 0}};
  marks.has_axis = centre_.x == 0 && centre_.z == 0;
  return marks;
}

}  // namespace graze
