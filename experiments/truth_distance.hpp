// Distance of a point from a surface of revolution, in 113-bit arithmetic: the judge's ruler for claimed
// points.
#pragma once

#include <graze/surfaces/ray.hpp>
#include <graze/surfaces/spec.hpp>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace graze::truth {

using Quad = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_quad::backend_type,
                                           boost::multiprecision::et_off>;

/// The profile in power basis, real units, and where the surface is placed.
class ProfileDistance {
 public:
  ProfileDistance() = default;
  ProfileDistance(std::vector<Quad> r, std::vector<Quad> y, const Placement& placement);
  [[nodiscard]] double operator()(Vec3 point) const;

 private:
  [[nodiscard]] Quad refine(double start, const Quad& rho, const Quad& height, int side) const;

  std::vector<Quad> r_, y_;
  std::vector<double> r_near_, y_near_;  ///< the same, rounded, to find where to look
  Placement placement_;
};

}  // namespace graze::truth
