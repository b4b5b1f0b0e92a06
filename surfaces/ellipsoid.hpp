// The ellipsoid (x - c)^T P^-1 (x - c) = 1 (document 002).
//
// surface       (x - center)^T P^-1 (x - center) = 1 over the rationals: adj(P) and det(P) instead of P^-1
// needs         finite center; P 3x3 symmetric positive definite (checked exactly), or semi_axes = [a, b,
//               c] > 0, which is P = diag(a^2, b^2, c^2) exactly
// parameters    theta = atan2(z - c_z, x - c_x) in (-pi, pi], phi = atan2(y - c_y, hypot(x - c_x, z - c_z))
// facts         at most two hits; half extents of its box sqrt(P_ii); normal P^-1 (x - c), normalised
// source        document 002
#pragma once

#include <tuple>

#include <graze/surfaces/second_degree.hpp>

namespace graze {

struct Ellipsoid;

/// d.(adj P) d l^2 + 2 d.(adj P) m l + m.(adj P) m - det P, m from the vertex of the quadratic or from an
/// origin close by: count exact, nothing cancels (surfaces/second_degree.hpp).
struct EllipsoidVertex {
  static FormulationInfo info();
  explicit EllipsoidVertex(const Ellipsoid& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const { second_degree::pose(form, ray, block); }
  void lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
            std::vector<LocalHit>& hits) const {
    second_degree::lift(posed, root, hits);
  }

  second_degree::QuadraticForm form;
};

/// The document's quadratic about the ray's own origin, P^-1 and all in plain arithmetic.
struct EllipsoidAlgebraic {
  static FormulationInfo info();
  explicit EllipsoidAlgebraic(const Ellipsoid& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  /// P^-1 rounded, or enclosed.
  template <class T>
  [[nodiscard]] T inverse(std::size_t i, std::size_t j) const {
    if constexpr (std::is_same_v<T, Interval>)
      return enclosed[i][j];
    else
      return static_cast<T>(plain[i][j]);
  }

  Vec3 centre;
  std::array<std::array<double, 3>, 3> plain;
  std::array<std::array<Interval, 3>, 3> enclosed;
};

struct Ellipsoid {
  using Formulations = std::tuple<EllipsoidVertex, EllipsoidAlgebraic>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Ellipsoid(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return scale_by_power(max_abs(half_), unit_); }
  [[nodiscard]] Bounds bounds() const;
  [[nodiscard]] bool clip(LocalRay& ray) const {
    return second_degree::clip_ball(form, form.centre, reach_, ray);
  }
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const;

  second_degree::QuadraticForm form;
  /// P in local units, rounded where it is made of semi-axes: for samples and for the textbook's inverse.
  std::array<std::array<double, 3>, 3> p{};

 private:
  Vec3 centre_;
  Vec3 half_;     ///< half extents of the box, local units
  double reach_;  ///< radius of a ball about the centre that holds the surface, local units
  int unit_ = 0;
};

}  // namespace graze
