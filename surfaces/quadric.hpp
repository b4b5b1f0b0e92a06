// The general surface of second degree, with document 001's ten coefficients.
//
// surface       A x^2 + E y^2 + H z^2 + 2B xy + 2C xz + 2F yz + 2D x + 2G y + 2I z + J = 0
// needs         finite A ... J, each 0 where it is not given, not all zero
// parameters    none
// facts         at most two hits, or the ray runs inside (a generator: coincident). Normal: the gradient of
//               s f, s = -1 if the quadratic part has more negative than positive eigenvalues, else 1;
//               where the gradient is exactly zero (apex, crossing), -d/|d|. variety() is its canonical
//               class, by the exact inertias of the 3x3 and the 4x4 matrix; surfaces without a real point
//               are allowed
// source        document 001
#pragma once

#include <tuple>

#include <graze/surfaces/second_degree.hpp>

namespace graze {

struct Quadric;

/// A l^2 + 2 B l + C from the vertex of the quadratic, or from the origin where its roots differ by more than
/// their size: count exact, nothing cancels (surfaces/second_degree.hpp).
struct QuadricVertex {
  static FormulationInfo info();
  explicit QuadricVertex(const Quadric& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const { second_degree::pose(form, ray, block); }
  void lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
            std::vector<LocalHit>& hits) const {
    second_degree::lift(posed, root, hits);
  }

  second_degree::QuadraticForm form;
};

/// The document's a, b, c about the ray's own origin, in plain arithmetic.
struct QuadricAlgebraic {
  static FormulationInfo info();
  explicit QuadricAlgebraic(const Quadric& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  /// {c, b, a}.
  template <class T>
  [[nodiscard]] std::array<T, 3> along(const LocalRay& ray) const;

  std::array<double, 10> coefficients;
};

/// The shape of a quadric in its principal axes, rounded: for samples and landmarks.
struct QuadricAxes {
  Vec3 centre;                         ///< or vertex, or a point of the axis
  std::array<Vec3, 3> axis;            ///< orthonormal
  std::array<double, 3> eigenvalue{};  ///< exactly 0 where it is
  std::array<double, 3> extent{};      ///< a length along each axis: semi-axes where there are any
};

struct Quadric {
  using Formulations = std::tuple<QuadricVertex, QuadricAlgebraic>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Quadric(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const;
  [[nodiscard]] Bounds bounds() const { return bounds_; }
  [[nodiscard]] bool clip(LocalRay& ray) const;
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const;
  [[nodiscard]] std::string_view variety() const { return variety_; }

  second_degree::QuadraticForm form;
  std::array<double, 10> coefficients{};  ///< A ... J in local units

 private:
  [[nodiscard]] Vec3 in_object_space(Vec3 x) const { return scale_by_power(x, unit_); }
  [[nodiscard]] bool touches_singular_point(const LocalRay& ray) const;
  /// Axes of cylinders, generators, and directions in which A vanishes.
  void add_directions(Landmarks& marks) const;

  static void measure_by_origin(LocalRay& ray);

  std::string_view variety_;
  bool is_homogeneous_ = false;  ///< terms of one degree only: every scale looks alike
  double orientation_ = 1;       ///< s
  QuadricAxes axes_;             ///< local units
  Bounds bounds_;                ///< object space
  double reach_ = 0;  ///< radius of a ball about the axes' centre that holds the surface; 0: unbounded
  int unit_ = 0;
};

}  // namespace graze
