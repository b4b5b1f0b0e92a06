// The torus about the y axis: a circle of radius r whose centre runs on a circle of radius R (document 004).
//
// surface       f = (|x|^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + z^2) = 0; centre at the origin
// needs         R > 0, r > 0 finite, R + r finite, the smaller at least 2^-1022 of the larger
// kinds         ring torus (R > r), horn torus (R = r), spindle torus (R < r: an outer sheet, the apple,
//               and an inner one, the lemon, which meet in (0, +-sqrt(r^2 - R^2), 0))
// parameters    u = atan2(z, x), v = atan2(y, hypot(x, z) - R)
// facts         f = F1 F2 with F1,2 = (rho -+ R)^2 + y^2 - r^2, rho = hypot(x, z): F1 = 0 is the outer
//               sheet, F2 = 0 the inner one; at most four hits
// source        document 004; see surfaces/torus.md
#pragma once

#include <array>
#include <tuple>

#include <graze/surfaces/revolution.hpp>

namespace graze {

struct Torus;

/// The tube in local units; R + r lies in [1, 2). t in [0, 1) is v / (2 pi), of both sheets.
struct TorusProfile {
  double ring = 1;  ///< R
  double tube = 0;  ///< r

  template <class T>
  [[nodiscard]] BasicProfilePoint<T> at(T t) const {
    constexpr T kTurn = 2 * std::numbers::pi_v<T>;
    const T r = static_cast<T>(tube);
    const T cosine = std::cos(kTurn * t), sine = std::sin(kTurn * t);
    return {static_cast<T>(ring) + r * cosine, r * sine, -kTurn * r * sine, kTurn * r * cosine};
  }
  /// The outer or the inner half of the tube, as u says.
  [[nodiscard]] double t_of_height(double y, double u) const {
    const double v = std::asin(std::clamp(y / tube, -1.0, 1.0)) / (2 * std::numbers::pi);
    return u < 0.5 ? v : 0.5 - v;
  }
  [[nodiscard]] Cylinder bounds() const { return {add_up(ring, tube), -tube, tube}; }
  [[nodiscard]] static int max_hits() { return 4; }
  [[nodiscard]] bool has_inner_sheet() const { return ring < tube; }
};

/// The quartic in delta about the recentred point, coefficients in double-double and rounded once.
struct TorusQuarticRecentred {
  static FormulationInfo info();
  explicit TorusQuarticRecentred(const Torus& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TorusProfile profile;
};

/// F1(delta) = (rho - R)^2 + y^2 - r^2 (kind 0), and for a spindle torus F2 (kind 1).
struct TorusAlongRay {
  static FormulationInfo info();
  explicit TorusAlongRay(const Torus& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TorusProfile profile;
};

/// Three equations in (delta, v / 2 pi, u), as document 003 poses them for its profile.
struct TorusSystem {
  static FormulationInfo info();
  explicit TorusSystem(const Torus& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TorusProfile profile;
};

/// The document's quartic in l about the ray's own origin, in plain arithmetic.
struct TorusQuartic {
  static FormulationInfo info();
  explicit TorusQuartic(const Torus& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TorusProfile profile;
};

struct Torus {
  using Formulations = std::tuple<TorusQuarticRecentred, TorusAlongRay, TorusSystem, TorusQuartic>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Torus(const SurfaceSpec& spec);

  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] Bounds bounds() const { return revolution::box(profile, unit_); }
  [[nodiscard]] bool clip(LocalRay& ray) const;
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const;
  /// "ring torus", "horn torus" or "spindle torus".
  [[nodiscard]] std::string_view variety() const;

  TorusProfile profile;

 private:
  int unit_ = 0;
  double size_ = 1;
};

static_assert(SurfaceType<Torus>);
static_assert(Formulation<TorusQuarticRecentred, Torus> && Formulation<TorusAlongRay, Torus> &&
              Formulation<TorusSystem, Torus> && Formulation<TorusQuartic, Torus>);

}  // namespace graze
