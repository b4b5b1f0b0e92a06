// Certified truth: the hits of a ray, proved, from the raw doubles of ray and surface.
//
// solves   the exact equation over the rationals, formed from the doubles as exact numbers
// returns  every distinct hit with l > 0 in ascending order, with enclosures as narrow as asked
// error    none in count, order and multiplicity; enclosures are proved
// cost     about 40 us a ray of the teardrop at 40 digits (measured: see experiments/truth.md)
// Shares no code with any solver or surface of graze; it reads their specifications only.
#pragma once

#include <graze/solvers/roots.hpp>
#include <graze/surfaces/ray.hpp>
#include <graze/surfaces/spec.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace graze::truth {

struct Options {
  int digits = 40;  ///< decimal digits wanted of every l, x (relative; at least 17)
};

/// A real number between two neighbouring decimals, and as a double-double for error measurement.
struct Real {
  std::string decimal;  ///< `digits` significant digits, correctly rounded
  std::string lo, hi;   ///< decimals with lo <= value <= hi; equal when the value is that decimal exactly
  double head = 0;      ///< the double nearest to the value (may be +-inf or 0 beyond double's range)
  double tail = 0;      ///< the double nearest to value - head (0 when head is not finite)
};

struct Hit {
  Real l;
  std::size_t surface = 0;
  std::uint32_t multiplicity = 1;  ///< 1 = the ray crosses; 2 = touches (or crosses two sheets at once)
  bool tangent = false;            ///< multiplicity >= 2
  Vec3 point;                      ///< correctly rounded to within 1 ulp a coordinate
  Vec3 normal;                     ///< outward, unit, world space; error < 4 ulp of 1
  /// The surface's own, as its entry in the registry names them: t in [0,1] and theta of a profile, theta and
  /// phi of sphere and ellipsoid, two angles of the torus, weights of a triangle's second and third vertex, a
  /// solid's face; angles in [-pi, pi]; 0 where there is none.
  std::array<double, 2> params{};
  /// |n . d| / |d| with full relative accuracy; exactly 0 where the ray lies in the tangent plane. A touch of
  /// an edge, a pole or a singular point has the cosine of the normal that is given.
  double cosine = 0;
};

struct Answer {
  std::vector<Hit> hits;
  Status status = Status::ok;  ///< ok, coincident or invalid
  std::string why;             ///< a sentence when not ok
};

/// One surface, prepared for many rays. Thread-safe: `all` may be called from many threads at once.
class Surface {
 public:
  virtual ~Surface() = default;
  [[nodiscard]] virtual Answer all(const Ray& ray, const Options& options) const = 0;
  /// Distance of a world point from the surface in world space, for backward errors; not proved. 113 bits for
  /// surfaces of revolution, flat figures and solids (about 1e-30 of their size), 237 bits for algebraic
  /// ones. An upper bound far from an algebraic surface, and where a placement that is no similarity moves
  /// the nearest point of a profile or of a disk's rim, which are sought in object space.
  [[nodiscard]] virtual double distance(Vec3 point) const = 0;
};

/// Types that have truth, in the order of their list.
std::vector<std::string> types();

/// Throws std::invalid_argument when the type has no truth or the parameters are no surface.
std::unique_ptr<Surface> make_surface(const SurfaceSpec& spec);

/// Hits of a whole scene, merged in ascending order of l, ties by surface index. Hits of different surfaces
/// that agree to 2560 digits are ties. coincident if any surface is; the hits of the others are still given.
Answer all_hits(std::span<const std::unique_ptr<Surface>> scene, const Ray& ray, const Options& options = {});

struct PolynomialRoot {
  Real x;
  std::uint32_t multiplicity = 1;
};

struct PolynomialAnswer {
  std::vector<PolynomialRoot> roots;
  Status status = Status::ok;  ///< coincident: the zero polynomial
  std::string why;
};

/// Distinct real roots of sum_i c[i] x^i (exact doubles, any magnitude, leading zeros allowed) in the closed
/// interval [lo, hi], or all real roots when none is given.
PolynomialAnswer real_roots(std::span<const double> c, std::optional<std::pair<double, double>> interval,
                            const Options& options = {});

}  // namespace graze::truth
