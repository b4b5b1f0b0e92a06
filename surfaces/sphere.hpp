// The sphere |x - c| = r (documents 001 and 002).
//
// surface       |x - center|^2 = radius^2
// needs         finite center, radius > 0 finite
// parameters    theta = atan2(z - c_z, x - c_x) in (-pi, pi], phi = atan2(y - c_y, hypot(x - c_x, z - c_z))
//               in [-pi/2, pi/2]; theta = 0 on the axis
// facts         at most two hits; a touch counts twice; the normal is (x - c)/r
// source        document 001 (its two algorithms), document 002
#pragma once

#include <numbers>
#include <tuple>

#include <graze/surfaces/revolution.hpp>
#include <graze/surfaces/second_degree.hpp>

namespace graze {

struct Sphere;

/// theta and phi of a point seen from the centre.
inline std::array<double, 2> sphere_parameters(Vec3 m) {
  const double distance = std::hypot(m.x, m.z);
  return {distance == 0 ? 0.0 : std::atan2(m.z, m.x), std::atan2(m.y, distance)};
}

/// In local units: radius in [1, 2), exactly.
struct SphereForm {
  Vec3 centre;
  double radius = 1;

  template <class T>
  [[nodiscard]] std::array<T, 3> along(const std::array<T, 3>& x, const std::array<T, 3>& d) const {
    const T mx = x[0] - exactly<T>(centre.x), my = x[1] - exactly<T>(centre.y),
            mz = x[2] - exactly<T>(centre.z);
    const T r = exactly<T>(radius);
    return {mx * mx + my * my + mz * mz - r * r, mx * d[0] + my * d[1] + mz * d[2],
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2]};
  }
};

/// About the foot of the perpendicular from the centre, or about the origin where that lies near the surface
/// or inside: count exact, nothing cancels (surfaces/second_degree.hpp).
struct SphereFoot {
  static FormulationInfo info();
  explicit SphereFoot(const Sphere& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const { second_degree::pose(form, ray, block); }
  void lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
            std::vector<LocalHit>& hits) const {
    second_degree::lift(posed, root, hits);
  }

  SphereForm form;
};

/// The document's t_hc^2 = r^2 - |OC|^2 + t_ca^2 about t_ca, in plain arithmetic.
struct SphereGeometric {
  static FormulationInfo info();
  explicit SphereGeometric(const Sphere& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  SphereForm form;
};

/// The document's t^2 + 2 B t + C about the ray's own origin, in plain arithmetic.
struct SphereAlgebraic {
  static FormulationInfo info();
  explicit SphereAlgebraic(const Sphere& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  SphereForm form;
};

/// The meridian (r sin pi t, -r cos pi t), t in [0, 1], as a profile revolved about y
/// (surfaces/revolution.hpp).
struct SphereMeridian {
  double radius = 1;

  template <class T>
  [[nodiscard]] BasicProfilePoint<T> at(T t) const {
    constexpr T kPi = std::numbers::pi_v<T>;
    const T r = static_cast<T>(radius);
    const T sine = std::sin(kPi * t), cosine = std::cos(kPi * t);
    return {r * sine, -r * cosine, kPi * r * cosine, kPi * r * sine};
  }
  [[nodiscard]] double t_of_height(double y, double /*u*/) const {
    return std::acos(std::clamp(-y / radius, -1.0, 1.0)) / std::numbers::pi;
  }
  [[nodiscard]] Cylinder bounds() const { return {radius, -radius, radius}; }
  [[nodiscard]] static int max_hits() { return 2; }
};

/// Three equations in (l, t, theta), phi = pi (t - 1/2): document 003's system for a circle.
struct SphereSystem {
  static FormulationInfo info();
  explicit SphereSystem(const Sphere& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  SphereForm form;
  SphereMeridian meridian;
};

struct Sphere {
  using Formulations = std::tuple<SphereFoot, SphereGeometric, SphereAlgebraic, SphereSystem>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Sphere(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return radius_; }
  [[nodiscard]] Bounds bounds() const { return box_about(centre_, {radius_, radius_, radius_}); }
  [[nodiscard]] bool clip(LocalRay& ray) const;
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const;

  SphereForm form;

 private:
  Vec3 centre_;
  double radius_;
  int unit_;
};

}  // namespace graze
