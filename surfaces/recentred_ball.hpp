// Polynomials along a ray whose coefficients carry hardly any rounding: formed in double-double with error
// bounds, rounded once, and posed in every form.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/expansion.hpp>
#include <graze/surfaces/coefficients.hpp>

namespace graze {

/// The point at l = centre: the product exactly, then one double-double addition a coordinate.
inline std::array<DoubleDoubleBall, 3> recentred_ball(const LocalRay& ray) {
  if (!ray.is_exact) {
    const auto o = origin_as<DoubleDoubleBall>(ray), d = direction_as<DoubleDoubleBall>(ray);
    const DoubleDoubleBall centre(ray.centre);
    return {centre * d[0] + o[0], centre * d[1] + o[1], centre * d[2] + o[2]};
  }
  const auto coordinate = [&](double o, double d) {
    return DoubleDoubleBall(two_prod(ray.centre, d)) + DoubleDoubleBall(o);
  };
  return {coordinate(ray.o.x, ray.d.x), coordinate(ray.o.y, ray.d.y), coordinate(ray.o.z, ray.d.z)};
}

/// An exact number as a ball: zero stays exactly zero.
inline DoubleDoubleBall nearest_ball(const Expansion& x) {
  const DoubleDouble value = x.to_double_double();
  return {value, 0x1p-105 * std::fabs(value.hi)};
}
inline DoubleDoubleBall nearest_ball(const Dyadic& x) {
  const DoubleDouble value = x.to_double_double();
  if (std::isfinite(value.hi) && x == Dyadic(value)) return DoubleDoubleBall(value);
  // Below 2^-900 the low part may have lost bits of 2^-1074 and less.
  const double floor = std::fabs(value.hi) < 0x1p-900 ? 0x1p-1000 : 0;
  return {value, 0x1p-105 * std::fabs(value.hi) + floor};
}

/// Coefficients in the arithmetic of T, in the block's arena: the balls rounded, or in float as in_float()
/// says.
template <class T, class InFloat>
std::span<T> rounded_balls(EquationBlock& block, std::span<const DoubleDoubleBall> c,
                           const InFloat& in_float) {
  const std::span<T> values = block.arena().array<T>(c.size());
  if constexpr (std::is_same_v<T, float>) {
    const auto plain = in_float();
    std::copy_n(plain.begin(), values.size(), values.begin());
  } else {
    std::transform(c.begin(), c.end(), values.begin(), [](const auto& x) { return rounded_to<T>(x); });
  }
  return values;
}

/// Poses sum c[i] delta^i = 0, delta = l - origin, on [lo, hi] in the block's form and arithmetic.
/// `in_float()` gives the coefficients of binary32, formed in it: at least as many; `exact(c)` fills in the
/// exact ones.
template <class InFloat, class Exact>
void pose_balls(EquationBlock& block, std::span<const DoubleDoubleBall> c, double origin, double lo,
                double hi, double scale, std::uint64_t seed, const InFloat& in_float, const Exact& exact) {
  const auto rounded = [&](auto number) { return rounded_balls<decltype(number)>(block, c, in_float); };
  if (block.form() != Form::interval) {
    return pose_in_delta(block, 0, lo, hi, seed, static_cast<int>(c.size()) - 1, rounded,
                         exact_by(block, origin, exact, c));
  }

  const std::span<const Interval> enclosures = rounded(Interval{});
  const auto stored = detail::store_coefficients(block.arena(), enclosures);
  if (!stored.is_finite() || !std::isfinite(hi)) return block.settle(Status::failed);
  const auto* const self = block.arena().make(detail::PolynomialFunction<double>{stored});
  pose_interval(block, 0, self, lo, hi, sharp_epsilons(block.arena(), scale, detail::largest(stored.c)));
}

}  // namespace graze
