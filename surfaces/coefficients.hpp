// Polynomial equations whose coefficients are computed once in double, or in intervals where the solver wants
// their error bounds: one formula, generic over the number type.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <type_traits>

#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/surfaces/equation_block.hpp>
#include <graze/surfaces/local_ray.hpp>

namespace graze {

/// A double as an exact number of type T.
template <class T>
T exactly(double x) {
  if constexpr (std::is_same_v<T, Interval>) {
    return point(x);
  } else {
    return x;
  }
}

inline double sqr(double x) { return x * x; }

/// The point p at l = centre: as rounded in `ray`, or enclosed.
template <class T>
std::array<T, 3> recentred_point(const LocalRay& ray) {
  if constexpr (std::is_same_v<T, Interval>) {
    if (ray.centre == 0) return {point(ray.o.x), point(ray.o.y), point(ray.o.z)};
    // The product exactly, so that only what is left after the large parts cancel is rounded.
    const auto coordinate = [&](double o, double d) {
      const DoubleDouble product = two_prod(ray.centre, d);
      return (point(o) + point(product.hi)) + point(product.lo);
    };
    return {coordinate(ray.o.x, ray.d.x), coordinate(ray.o.y, ray.d.y), coordinate(ray.o.z, ray.d.z)};
  } else {
    return {ray.p.x, ray.p.y, ray.p.z};
  }
}

namespace detail {

inline std::span<double> store(Arena& arena, std::span<const double> values) {
  const std::span<double> kept = arena.array<double>(values.size());
  std::copy(values.begin(), values.end(), kept.begin());
  return kept;
}

inline bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

inline double largest(std::span<const double> values) {
  double size = 0;
  for (const double v : values) size = std::max(size, std::fabs(v));
  return size;
}

/// Slopes below this share of the largest coefficient count as shallow (a grazing ray).
inline constexpr double kShallow = 0x1p-10;

}  // namespace detail

/// Stores coefficients (doubles) and poses the equation; numbers beyond the range of double settle the ray
/// as failed.
inline void pose_coefficients(EquationBlock& block, std::uint32_t kind, PolynomialEquation equation,
                              std::span<const double> c) {
  if (!detail::all_finite(c)) return block.settle(Status::failed);
  equation.c = detail::store(block.arena(), c);
  equation.epsilons.shallow = detail::kShallow * detail::largest(c);
  block.pose(equation, kind);
}

/// The same for enclosures: midpoints, with radii as the coefficients' errors.
inline void pose_coefficients(EquationBlock& block, std::uint32_t kind, PolynomialEquation equation,
                              std::span<const Interval> c) {
  const std::span<double> error = block.arena().array<double>(c.size());
  const std::span<double> middle = block.arena().array<double>(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    middle[i] = mid(c[i]);
    error[i] = std::max(sub_up(c[i].hi, middle[i]), sub_up(middle[i], c[i].lo));
  }
  if (!detail::all_finite(error)) return block.settle(Status::failed);
  equation.c_error = error;
  pose_coefficients(block, kind, equation, middle);
}

/// Poses the polynomial whose coefficients `make(T{})` computes in the number type T, on [lo, hi].
template <class Make>
void pose_polynomial(EquationBlock& block, std::uint32_t kind, Basis basis, double lo, double hi,
                     const Epsilons& epsilons, const Make& make) {
  const PolynomialEquation equation{
      .c = {}, .c_error = {}, .basis = basis, .lo = lo, .hi = hi, .epsilons = epsilons};
  if (block.wants_coefficient_errors()) {
    const auto c = make(Interval{});
    pose_coefficients(block, kind, equation, std::span<const Interval>(c));
  } else {
    const auto c = make(double{});
    pose_coefficients(block, kind, equation, std::span<const double>(c));
  }
}

}  // namespace graze
