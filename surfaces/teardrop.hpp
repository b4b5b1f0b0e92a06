// The teardrop: the Bezier profile (0,0), (2s,0), (3s,2s), (0,6s) revolved about the y axis (document 000).
//
// surface       x^2 + z^2 = R(t)^2, y = Y(t), t in [0,1] closed; R = 3 s t (1-t)(2+t), Y = 6 s t^2
// needs         s > 0 finite
// parameters    t in [0,1], theta = atan2(z, x)
// facts         convex (x'y'' - y'x'' = 108 t^2 + 72 > 0 for s = 1): at most two hits; widest at
//               t = (sqrt 7 - 1)/3, radius (14 sqrt 7 - 20)/9 s; a cone tip at y = 6s, smooth at y = 0
// source        document 000 with the errata of surfaces/teardrop.md
#pragma once

#include <array>
#include <tuple>

#include <graze/solvers/math/interval.hpp>
#include <graze/surfaces/revolution.hpp>

namespace graze {

struct Teardrop;

/// The profile in local units, where s = m in [1, 2) exactly.
struct TeardropProfile {
  /// (14 sqrt 7 - 20)/9 = 1.89339092832269647..., rounded up.
  static constexpr double kWidest = 1.8933909283226967;
  double m = 1;

  template <class T>
  [[nodiscard]] BasicProfilePoint<T> at(T t) const {
    const T s = static_cast<T>(m);
    return {3 * s * t * (1 - t) * (2 + t), 6 * s * t * t, 3 * s * (2 - t * (2 + 3 * t)), 12 * s * t};
  }
  [[nodiscard]] double t_of_height(double y, double /*u*/) const {
    return std::sqrt(std::clamp(y / (6 * m), 0.0, 1.0));
  }
  [[nodiscard]] Cylinder bounds() const { return {kWidest * m, 0, 6 * m}; }
  [[nodiscard]] static int max_hits() { return 2; }  // convex
};

/// Regions of the surface with an epsilon of their own, ascending in t.
struct TeardropRegions {
  static constexpr std::array<std::string_view, 6> kNames{"bottom", "body", "equator",
                                                          "neck",   "apex", "grazing"};
  static constexpr std::size_t kParts = 5;  ///< the last name is no part of the surface but a class of rays
  /// Upper ends in t. The equator is the band around the widest circle t = 0.5486; the neck begins where the
  /// profile has turned towards the axis; bottom and apex are where y(t) and R(t) become singular in y.
  static constexpr std::array<double, kParts> kEnds{0.0625, 0.5, 0.625, 0.96875, 1.0};
  std::array<double, 6> eps{};  ///< in units of s
};

/// What the two sextics in t share.
struct TeardropInT {
  explicit TeardropInT(const Teardrop& surface);

  TeardropProfile profile;
  std::array<Region, TeardropRegions::kParts> regions;
  double grazing_eps;
};

/// The document's sextic in t: division by q_y and all (document 000). Special cases as it has them: a
/// circle for q_y = 0, the cubic for q_x = q_z = 0.
struct TeardropSextic : TeardropInT {
  using TeardropInT::TeardropInT;
  static FormulationInfo info();
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;
};

/// q_y^2 R(t)^2 = |q_xz (Y(t) - p_y) + q_y p_xz|^2 about the recentred point p.
struct TeardropSexticHomogeneous : TeardropInT {
  using TeardropInT::TeardropInT;
  static FormulationInfo info();
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;
};

/// F(delta) = R(t(y))^2 - |p_xz|^2 at p + delta q, y = p_y + delta q_y: smooth through q_y = 0. For a ray
/// parallel to the axis, R - |p_xz| instead, which has no double zeros at the poles.
struct TeardropAlongRay {
  static FormulationInfo info();
  explicit TeardropAlongRay(const Teardrop& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TeardropProfile profile;
  TeardropRegions regions;

 private:
  template <class Function>
  void pose_function(const Function& function, const LocalRay& ray, EquationBlock& block) const;
};

/// The document's three equations in (delta, t, theta) (document 003).
struct TeardropSystem {
  static FormulationInfo info();
  explicit TeardropSystem(const Teardrop& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const {
    revolution::System<TeardropProfile>::pose(profile, ray, block);
  }
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TeardropProfile profile;
};

/// The implicit sextic in delta, B^2 - 4 H y^3 (2H - y)^2 with H = 6s, W = x^2 + z^2 and B = 4 H W - y ((2H -
/// y)^2 + H y), in one basis; the surface is where B <= 0 and 0 <= y <= H. Coefficients are formed in
/// double-double with proved errors. A root whose sheet cannot be told makes the answer uncertain.
template <Basis kBasis>
struct TeardropImplicitSextic {
  static FormulationInfo info();
  explicit TeardropImplicitSextic(const Teardrop& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  TeardropProfile profile;
};

struct Teardrop {
  using Formulations =
      std::tuple<TeardropAlongRay, TeardropSexticHomogeneous, TeardropSystem, TeardropSextic,
                 TeardropImplicitSextic<Basis::power>, TeardropImplicitSextic<Basis::bernstein>,
                 TeardropImplicitSextic<Basis::chebyshev>>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Teardrop(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return s_; }
  [[nodiscard]] Bounds bounds() const { return revolution::box(profile, unit_); }
  [[nodiscard]] bool clip(LocalRay& ray) const { return revolution::clip(ray, profile.bounds()); }
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const {
    return revolution::sample(profile, 1.0, unit_, u, v);
  }
  [[nodiscard]] Landmarks landmarks() const { return revolution::landmarks(profile, unit_); }

  TeardropProfile profile;
  TeardropRegions regions;

 private:
  double s_;
  int unit_;
};

}  // namespace graze
