// The disk: the points of a plane within a radius of a centre (document 002).
//
// surface       n.(x - c) = 0, |x - c| <= r, closed
// needs         n finite and not zero, r > 0, c finite
// parameters    none
// facts         at most one hit; a ray in the plane is coincident, or touches the rim (multiplicity 2)
// normal        n / |n|, whichever side the ray comes from
// source        document 002
#pragma once

#include <tuple>

#include <graze/surfaces/planar.hpp>

namespace graze {

struct Disk;

/// The numbers of a disk in local units that its formulations need.
struct DiskData {
  planar::ExactPlane plane;
  Vec3 centre;
  double radius = 1;  ///< in [1, 2)
};

/// The crossing of the plane; inside by the sign of |c1 (p - c) - c0 d|^2 - (r c1)^2, c0 = n.(p - c), c1 =
/// n.d.
struct DiskExact {
  static FormulationInfo info();
  explicit DiskExact(const Disk& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  DiskData data;

 private:
  [[nodiscard]] bool is_inside(const LocalRay& ray, planar::Judge& judge) const;
  void pose_within(const LocalRay& ray, planar::Judge& judge, EquationBlock& block) const;
};

/// The document's: first the plane, then the distance of the computed point from the centre.
struct DiskPlain {
  static FormulationInfo info();
  explicit DiskPlain(const Disk& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  DiskData data;
};

struct Disk {
  using Formulations = std::tuple<DiskExact, DiskPlain>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit Disk(const SurfaceSpec& spec);
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return radius_; }
  [[nodiscard]] Bounds bounds() const;
  [[nodiscard]] bool clip(LocalRay& ray) const { return planar::clip(ray, {data.centre, data.radius}, true); }
  [[nodiscard]] LocalPoint describe(const LocalRay& /*ray*/, const LocalHit& /*hit*/) const {
    return {normal_, {}};
  }
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const;

  DiskData data;

 private:
  /// Half the extent along x, y, z: r sqrt(1 - n_i^2).
  [[nodiscard]] Vec3 half() const;

  Vec3 centre_, normal_;
  double radius_;
  int unit_;
};

}  // namespace graze
