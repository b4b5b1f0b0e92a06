// The plane a.x = b (documents 001 and 002).
//
// surface       a.x = b; one_sided: it is there only for rays that meet its front (a.d < 0)
// needs         a finite and not zero, b finite
// parameters    none
// facts         at most one hit; a ray in the plane is coincident (one-sided: no hit)
// normal        a / |a|, whichever side the ray comes from
// size          L = |b| / |a|, the distance from the origin; 1 for b = 0, when the plane has no length of
//               its own
// source        document 001 (one- and two-sided), document 002 with its sign corrected
#pragma once

#include <tuple>

#include <graze/surfaces/planar.hpp>

namespace graze {

struct Plane;

/// The numbers of a plane in local units that its formulations need.
struct PlaneData {
  planar::ExactPlane plane;
  bool one_sided = false;
};

/// c0 + c1 delta = 0 with c0 = a.p - b and c1 = a.d enclosed, and exact signs of a.d and a.o - b.
struct PlaneExact {
  static FormulationInfo info();
  explicit PlaneExact(const Plane& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  PlaneData data;
};

/// The documents' t = (b - a.o) / (a.d), in plain arithmetic.
struct PlanePlain {
  static FormulationInfo info();
  explicit PlanePlain(const Plane& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  PlaneData data;
};

struct Plane {
  using Formulations = std::tuple<PlaneExact, PlanePlain>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Plane(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] Bounds bounds() const { return {}; }
  [[nodiscard]] bool clip(LocalRay& ray) const;
  [[nodiscard]] LocalPoint describe(const LocalRay& /*ray*/, const LocalHit& /*hit*/) const {
    return {normal_, {}};
  }
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const;

  PlaneData data;

 private:
  static void measure_by_itself(LocalRay& ray);
  static bool keep_in_range(LocalRay& ray, const Interval& l);
  [[nodiscard]] bool clip_about_crossing(LocalRay& ray) const;

  Vec3 normal_;
  Vec3 foot_;  ///< of the perpendicular from the origin, object space
  double size_ = 1;
  int unit_ = 0;
  bool through_origin_ = false;
};

}  // namespace graze
