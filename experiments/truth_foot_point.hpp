// Distance of a point from a polynomial surface f(x, y, z) = 0, in 237-bit arithmetic: the judge's ruler for
// claimed points.
//
// solves   the nearest point x of a point p in world space: p - x = lambda grad f, f = 0
// needs    f in object space and its placement; starts on the surface where p is not near it
// returns  the distance; an upper bound where the nearest point was not found
// error    about 2^-200 of the coordinates for points near a regular part of the surface; not proved
// cost     some ten microseconds a quadric
#pragma once

#include <array>
#include <graze/surfaces/ray.hpp>
#include <graze/surfaces/spec.hpp>
#include <optional>
#include <span>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace graze::truth {

/// 237 bits, and an exponent range that degree 32 at the ends of double's range does not leave.
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_oct::backend_type,
                                           boost::multiprecision::et_off>;
using WidePoint = std::array<Wide, 3>;
using WideMatrix = std::array<WidePoint, 3>;

class FootPointDistance {
 public:
  /// c x^i y^j z^k.
  struct Term {
    Wide c;
    std::array<int, 3> powers{};
  };

  FootPointDistance(std::vector<Term> terms, const Placement& placement);

  /// For points so near a regular part of the surface that its curvature hardly matters; else none.
  [[nodiscard]] std::optional<double> near(Vec3 point) const;
  /// A point where grad f is zero, or nearly: the centre of a quadric or torus, from which lines meet it.
  [[nodiscard]] Vec3 center(Vec3 point) const;
  /// The least distance found by descending from the starts, which are on the surface in world space.
  /// Infinity without a start and without a singular point.
  [[nodiscard]] double from_starts(Vec3 point, std::span<const WidePoint> starts) const;

 private:
  /// f and its derivatives in world space.
  struct Value {
    Wide f;
    Wide noise;  ///< what rounding may have made of f
    WidePoint gradient{};
    WideMatrix hessian{};
  };
  struct Foot {
    WidePoint x;
    Wide distance;
    Wide first_step;  ///< |f| / |grad f| at the start
    Wide curving;     ///< distance times a bound of the surface's curvature at the foot
    bool converged = false;
  };
  struct Powers;
  [[nodiscard]] Value in_object(const WidePoint& at) const;
  [[nodiscard]] Value evaluate(const WidePoint& world) const;
  [[nodiscard]] Foot newton(const WidePoint& p, WidePoint x, Wide multiplier) const;
  [[nodiscard]] bool is_minimum(const WidePoint& p, const WidePoint& x) const;
  [[nodiscard]] Wide distance_from(const WidePoint& p, const WidePoint& start) const;
  [[nodiscard]] WidePoint descend(const WidePoint& p, WidePoint x) const;
  [[nodiscard]] std::optional<WidePoint> onto_surface(WidePoint x) const;
  [[nodiscard]] WidePoint critical_point(const WidePoint& p) const;

  std::vector<Term> terms_;   ///< in the order of their powers
  std::array<int, 3> top_{};  ///< the highest powers
  WideMatrix inverse_;        ///< M^-1
  WidePoint translate_;
  bool identity_ = true;
};

}  // namespace graze::truth
