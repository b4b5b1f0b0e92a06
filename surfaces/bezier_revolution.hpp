// A planar Bezier curve of any degree revolved about the y axis (document 003).
//
// surface       x^2 + z^2 = R(t)^2, y = Y(t), t in [0,1] closed; (R, Y)(t) = sum_i (r_i, y_i) B_{i,n}(t)
// needs         2 to 33 finite control points (degree 1 to 32), not all equal, not all on the axis;
//               r_i < 0 is allowed: the surface depends on |R| only
// parameters    t in [0,1], theta = atan2(z, x)
// facts         up to 2n hits; outward is away from the enclosed volume pi integral R^2 dY
// source        document 003 with the errata of surfaces/bezier_revolution.md
#pragma once

#include <array>
#include <tuple>
#include <vector>

#include <graze/solvers/math/interval.hpp>
#include <graze/surfaces/revolution.hpp>

namespace graze {

struct BezierRevolution;

/// A part of the profile on which Y is monotone.
struct MonotonePiece {
  double t_lo = 0, t_hi = 1;          ///< ends as found; exact at 0 and 1
  double slack_lo = 0, slack_hi = 0;  ///< the true extremum of Y lies within this of the end
  double y_lo = 0, y_hi = 0;          ///< Y(t_lo), Y(t_hi) in ascending order
  bool rising = true;
};

/// The profile in local units, with what is derived from it once.
struct BezierProfile {
  std::vector<double> r, y;           ///< control values
  std::vector<MonotonePiece> pieces;  ///< empty when Y is constant (flat)
  Cylinder cylinder;
  double orientation = 1;  ///< sign of the enclosed volume
  bool flat = false;       ///< a disk or annulus in the plane y = y[0]

  BezierProfile() = default;
  BezierProfile(std::vector<double> control_r, std::vector<double> control_y);
  template <class T>
  [[nodiscard]] BasicProfilePoint<T> at(T t) const;
  /// Y on one monotone piece, inverted: bisection-safeguarded Newton to the last bits.
  template <class T>
  [[nodiscard]] T invert(const MonotonePiece& piece, T height) const;
  [[nodiscard]] double t_of_height(double height, double u) const;
  [[nodiscard]] Cylinder bounds() const { return cylinder; }
  /// The bounds and 2^-20 of their size on all sides.
  [[nodiscard]] Cylinder roomy_cylinder() const {
    const double room = 0x1p-20 * std::max(cylinder.radius, cylinder.y_hi - cylinder.y_lo);
    return {cylinder.radius + room, cylinder.y_lo - room, cylinder.y_hi + room};
  }
  [[nodiscard]] static int max_hits() { return 0; }  // not known: up to 2n
};

/// Regions with an epsilon of their own: near the first control point, between, near the last; grazing rays.
struct BezierRegions {
  static constexpr std::array<std::string_view, 4> kNames{"bottom", "body", "apex", "grazing"};
  static constexpr std::size_t kParts = 3;
  static constexpr std::array<double, kParts> kEnds{0.0625, 0.9375, 1.0};  ///< upper ends in t
  std::array<double, 4> eps{};                                             ///< in units of the surface's size
};

/// q_y^2 R^2 - |q_xz (Y - p_y) + q_y p_xz|^2 in t, Bernstein basis of degree 2n, recentred.
struct BezierPolynomial {
  static FormulationInfo info();
  explicit BezierPolynomial(const BezierRevolution& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;
  /// t of the surface's point at delta: of the nearest one.
  [[nodiscard]] double place(const LocalRay& ray, double delta) const;

 private:
  void pose_circles(const LocalRay& ray, EquationBlock& block) const;
  template <class T>
  std::vector<T> coefficients(const LocalRay& ray) const;

  BezierProfile profile_;
  std::array<Region, BezierRegions::kParts> regions_;
  double grazing_eps_;
  std::vector<Interval> weights_;  ///< C(n,i) C(n,j) / C(2n,i+j), row i
};

/// F(delta) = R(t(y))^2 - |p_xz|^2 on every monotone piece of Y: one equation a piece, smooth through q_y =
/// 0.
struct BezierAlongRay {
  static FormulationInfo info();
  explicit BezierAlongRay(const BezierRevolution& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  BezierProfile profile;
  BezierRegions regions;
};

/// The document's three equations in (delta, t, theta).
struct BezierSystem {
  static FormulationInfo info();
  explicit BezierSystem(const BezierRevolution& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const {
    revolution::System<BezierProfile>::pose(profile, ray, block);
  }
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  BezierProfile profile;
};

struct BezierRevolution {
  using Formulations = std::tuple<BezierAlongRay, BezierPolynomial, BezierSystem>;
  static constexpr std::size_t kMaxPoints = 33;  ///< the polynomial has degree 2n <= 64 (kMaxBernsteinDegree)

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit BezierRevolution(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return size_; }
  /// Whether the profile in its own unit is the surface's, bit for bit.
  [[nodiscard]] bool is_exact_in_unit() const;
  [[nodiscard]] Bounds bounds() const { return revolution::box(profile, unit_); }
  /// With room for the bits that the local frame has lost.
  [[nodiscard]] bool clip(LocalRay& ray) const {
    return revolution::clip(ray, ray.is_exact ? profile.cylinder : profile.roomy_cylinder());
  }
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const {
    return revolution::sample(profile, profile.orientation, unit_, u, v);
  }
  [[nodiscard]] Landmarks landmarks() const { return revolution::landmarks(profile, unit_); }

  BezierProfile profile;
  BezierRegions regions;
  /// (r, y) as given: the profile's underflow by its unit.
  std::vector<std::array<double, 2>> control_points;

 private:
  double size_ = 0;
  int unit_ = 0;
};

}  // namespace graze
