// Polynomial equations whose coefficients are computed once in double or float, or in intervals where the
// solver wants their error bounds: one formula, generic over the number type. A polynomial in delta also
// makes a function of delta, for solvers that take other forms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/polynomial.hpp>
#include <graze/surfaces/equation_block.hpp>
#include <graze/surfaces/local_ray.hpp>

namespace graze {

/// A double as a number of type T: exact, except in float, where it is rounded.
template <class T>
T exactly(double x) {
  if constexpr (std::is_same_v<T, Interval>) {
    return point(x);
  } else {
    return static_cast<T>(x);
  }
}

template <class T>
requires std::is_floating_point_v<T> T sqr(T x) { return x * x; }

namespace detail {

/// A ray's `local` number, which is `world` 2^-k rounded, as a number of type T that is exact or holds it.
/// Expansions cannot: nobody asks for them unless the ray is exact.
template <class T>
T unrounded(double local, double world, int k) {
  constexpr double kLeast = std::numeric_limits<double>::denorm_min();
  const bool is_same = scale_by_power(local, k) == world;
  if constexpr (std::is_same_v<T, Dyadic>) {
    return scale_by_power(T(world), -k);
  } else if constexpr (std::is_same_v<T, Interval>) {
    return is_same ? point(local) : Interval{next_below(local), next_above(local)};
  } else if constexpr (std::is_constructible_v<T, double, double> && !std::is_same_v<T, DoubleDouble>) {
    // A number with a bound on its error.
    return T(local, is_same ? 0 : kLeast);
  } else {
    return exactly<T>(local);
  }
}

template <class T>
std::array<T, 3> unrounded(Vec3 local, Vec3 world, int k, bool is_exact) {
  if (is_exact) [[likely]]
    return {exactly<T>(local.x), exactly<T>(local.y), exactly<T>(local.z)};
  return {unrounded<T>(local.x, world.x, k), unrounded<T>(local.y, world.y, k),
          unrounded<T>(local.z, world.z, k)};
}

}  // namespace detail

/// The ray's origin and direction in numbers of type T: exactly for Dyadic, and held by numbers with bounds,
/// also where the local frame has lost bits of them.
template <class T>
std::array<T, 3> origin_as(const LocalRay& ray) {
  return detail::unrounded<T>(ray.o, ray.world.o, ray.unit, ray.is_exact);
}
template <class T>
std::array<T, 3> direction_as(const LocalRay& ray) {
  return detail::unrounded<T>(ray.d, ray.world.d, ray.unit - ray.l_exponent, ray.is_exact);
}

namespace detail {

template <class T>
std::span<T> store(Arena& arena, std::span<const T> values) {
  const std::span<T> kept = arena.array<T>(values.size());
  std::copy(values.begin(), values.end(), kept.begin());
  return kept;
}

}  // namespace detail

/// Exact coefficients by `make(c)`, which fills a span of dyadics, where the block's solver may ask for them;
/// it lives as long as the block's equations. The unknown is l - origin; `near` is copied.
template <class Make>
ExactCoefficients exact_by(EquationBlock& block, double origin, const Make& make,
                           std::span<const DoubleDoubleBall> near = {}) {
  if (!block.wants_coefficient_errors()) return {};
  const auto get = [](const void* self, std::span<Dyadic> c) { (*static_cast<const Make*>(self))(c); };
  ExactCoefficients exact{block.arena().make(make), get, origin};
  if (block.digits() >= Digits::near) exact.near = detail::store(block.arena(), near);
  return exact;
}

/// The point p at l = centre: as rounded in `ray`, enclosed, or exactly.
template <class T>
std::array<T, 3> recentred_point(const LocalRay& ray) {
  const auto sum = [&] {
    const std::array<T, 3> o = origin_as<T>(ray), d = direction_as<T>(ray);
    const T centre = exactly<T>(ray.centre);
    return std::array<T, 3>{o[0] + centre * d[0], o[1] + centre * d[1], o[2] + centre * d[2]};
  };
  if constexpr (std::is_same_v<T, Dyadic>) {
    return sum();
  } else if constexpr (std::is_same_v<T, Interval>) {
    if (!ray.is_exact) return sum();
    if (ray.centre == 0) return {point(ray.o.x), point(ray.o.y), point(ray.o.z)};
    // The product exactly, so that only what is left after the large parts cancel is rounded.
    const auto coordinate = [&](double o, double d) {
      const DoubleDouble product = two_prod(ray.centre, d);
      return (point(o) + point(product.hi)) + point(product.lo);
    };
    return {coordinate(ray.o.x, ray.d.x), coordinate(ray.o.y, ray.d.y), coordinate(ray.o.z, ray.d.z)};
  } else {
    return {exactly<T>(ray.p.x), exactly<T>(ray.p.y), exactly<T>(ray.p.z)};
  }
}

namespace detail {

template <class T>
bool all_finite(std::span<const T> values) {
  return std::all_of(values.begin(), values.end(), [](T v) { return std::isfinite(v); });
}

template <class T>
double largest(std::span<const T> values) {
  T size = 0;
  for (const T v : values) size = std::max(size, std::fabs(v));
  return static_cast<double>(size);
}
inline double largest(const std::vector<double>& values) { return largest(std::span<const double>(values)); }

/// Slopes below this share of the largest coefficient count as shallow (a grazing ray).
inline constexpr double kShallow = 0x1p-10;

/// An end of an interval as a T, rounded outward.
template <class T>
T lower_end(double x) {
  const T rounded = static_cast<T>(x);
  return static_cast<double>(rounded) > x ? std::nextafter(rounded, -std::numeric_limits<T>::infinity())
                                          : rounded;
}
template <class T>
T upper_end(double x) {
  return -lower_end<T>(-x);
}

/// Coefficients in the block's memory, with bounds on their errors where they are enclosures.
template <class T>
struct Stored {
  std::span<const T> c;
  std::span<const T> c_error;
  [[nodiscard]] bool is_finite() const { return all_finite(c) && all_finite(c_error); }
};

template <class T>
Stored<T> store_coefficients(Arena& arena, std::span<const T> c) {
  return {store(arena, c), {}};
}
/// Midpoints, with radii as the coefficients' errors.
inline Stored<double> store_coefficients(Arena& arena, std::span<const Interval> c) {
  const std::span<double> error = arena.array<double>(c.size());
  const std::span<double> middle = arena.array<double>(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    middle[i] = mid(c[i]);
    error[i] = std::max(sub_up(c[i].hi, middle[i]), sub_up(middle[i], c[i].lo));
  }
  return {middle, error};
}

/// Fujiwara's bound of all roots for every polynomial within c_error of c; inf when the leading coefficient
/// may vanish.
inline double root_bound_of(Arena& arena, const Stored<double>& stored) {
  if (stored.c_error.empty()) return root_bound(stored.c);
  const std::span<double> sizes = arena.array<double>(stored.c.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = add_up(std::fabs(stored.c[i]), stored.c_error[i]);
  const std::size_t n = sizes.size() - 1;
  sizes[n] = sub_down(std::fabs(stored.c[n]), stored.c_error[n]);
  return sizes[n] > 0 ? root_bound(sizes) : std::numeric_limits<double>::infinity();
}

inline double root_bound_of(Arena& arena, const Stored<float>& stored) {
  const std::span<double> c = arena.array<double>(stored.c.size());
  std::copy(stored.c.begin(), stored.c.end(), c.begin());
  return root_bound(c);
}

/// A polynomial as a function of its unknown.
template <class T>
struct PolynomialFunction {
  Stored<T> stored;

  /// Horner for p, p' and p''; the bound counts 2n + 2 roundings of each term.
  [[nodiscard]] BasicJet<T> jet(T x) const {
    const std::span<const T> c = stored.c;
    BasicJet<T> jet;
    T size = 0;
    for (std::size_t i = c.size(); i-- > 0;) {
      jet.ddf = jet.ddf * x + 2 * jet.df;
      jet.df = jet.df * x + jet.f;
      jet.f = jet.f * x + c[i];
      size = size * std::fabs(x) + std::fabs(c[i]);
    }
    jet.f_error = static_cast<T>(2 * c.size()) * std::numeric_limits<T>::epsilon() / 2 * size;
    return jet;
  }
  [[nodiscard]] Interval f(Interval x) const { return evaluate(stored.c, stored.c_error, x); }
  [[nodiscard]] Interval df(Interval x) const { return evaluate_derivative(stored.c, stored.c_error, x); }
};

template <class T, class Function>
BasicScalarEquation<T> scalar_equation(const Function* self, double lo, double hi, int max_roots,
                                       std::uint64_t seed) {
  const auto eval = [](const void* function, T x) { return static_cast<const Function*>(function)->jet(x); };
  return {self, eval, lower_end<T>(lo), upper_end<T>(hi), max_roots, seed};
}

template <class T>
void pose_stored(EquationBlock& block, std::uint32_t kind, Basis basis, double lo, double hi,
                 Epsilons epsilons, const Stored<T>& stored, const ExactCoefficients& exact = {}) {
  if (!stored.is_finite()) return block.settle(Status::failed);
  epsilons.shallow = kShallow * largest(stored.c);
  block.pose(BasicPolynomialEquation<T>{.c = stored.c,
                                        .c_error = stored.c_error,
                                        .basis = basis,
                                        .lo = lower_end<T>(lo),
                                        .hi = upper_end<T>(hi),
                                        .epsilons = epsilons,
                                        .exact = exact},
             kind);
}

}  // namespace detail

/// Calls `pose(c)` with the coefficients that `make(T{})` computes in the block's number type: float, double,
/// or Interval where their errors are wanted.
template <class Make, class Pose>
void with_coefficients(const EquationBlock& block, const Make& make, const Pose& pose) {
  const auto call = [&](auto number) {
    using T = decltype(number);
    const auto c = make(number);
    pose(std::span<const T>(c));
  };
  if (block.precision() == Precision::binary32) {
    call(float{});
  } else if (block.wants_coefficient_errors()) {
    call(Interval{});
  } else {
    call(double{});
  }
}

/// Poses the polynomial whose coefficients `make(T{})` computes in the number type T, on [lo, hi]. Numbers
/// beyond the range of T settle the ray as failed.
template <class Make>
void pose_polynomial(EquationBlock& block, std::uint32_t kind, Basis basis, double lo, double hi,
                     const Epsilons& epsilons, const Make& make) {
  with_coefficients(block, make, [&](auto c) {
    detail::pose_stored(block, kind, basis, lo, hi, epsilons, detail::store_coefficients(block.arena(), c));
  });
}

/// Poses f(delta) = 0 on [lo, hi] in form scalar, in the block's arithmetic: self->jet(delta), for float and
/// for double, is f with its derivatives. *self lives as long as the block's equations.
template <class Function>
void pose_scalar(EquationBlock& block, std::uint32_t kind, const Function* self, double lo, double hi,
                 int max_roots, std::uint64_t seed) {
  const auto pose = [&](auto number) {
    using T = decltype(number);
    block.pose(detail::scalar_equation<T>(self, lo, hi, max_roots, seed), kind);
  };
  if (block.precision() == Precision::binary32) return pose(float{});
  pose(double{});
}

/// Poses the same in form interval: self->f(x) and self->df(x) enclose f and f' over x.
template <class Function>
void pose_interval(EquationBlock& block, std::uint32_t kind, const Function* self, double lo, double hi,
                   const Epsilons& epsilons) {
  const auto f = [](const void* function, Interval x) {
    return static_cast<const Function*>(function)->f(x);
  };
  const auto df = [](const void* function, Interval x) {
    return static_cast<const Function*>(function)->df(x);
  };
  block.pose(IntervalEquation{self, f, df, lo, hi, epsilons}, kind);
}

/// What solvers that work to a width are asked for, for roots of size `scale`: an ulp or two, and
/// sqrt(u) where the ray grazes, for what a double root can be known to.
inline Epsilons sharp_epsilons(Arena& arena, double scale, double largest_coefficient) {
  const std::span<Region> parts = arena.array<Region>(1);
  parts[0].eps = 0x1p-51 * scale;
  return {parts, 0x1p-27 * scale, detail::kShallow * largest_coefficient};
}

/// Poses a polynomial in delta (power basis) on [lo, hi] in the block's form: as it is, or as a function of
/// delta. An infinite hi is replaced by a bound of all roots, where one is known: solvers that search need an
/// interval; epsilons are sharp ones, in local units. `seed` and `max_roots` as in ScalarEquation; `exact`
/// are the polynomial's own coefficients, where `make` rounds them.
template <class Make>
void pose_in_delta(EquationBlock& block, std::uint32_t kind, double lo, double hi, std::uint64_t seed,
                   int max_roots, const Make& make, const ExactCoefficients& exact = {}) {
  with_coefficients(block, make, [&](auto c) {
    const auto stored = detail::store_coefficients(block.arena(), c);
    using T = std::remove_const_t<typename decltype(stored.c)::value_type>;
    if (!stored.is_finite()) return block.settle(Status::failed);
    const bool bounded = hi < std::numeric_limits<double>::infinity();
    const double end = bounded ? hi : detail::root_bound_of(block.arena(), stored);
    if (end < lo) return;  // every root lies before the ray's origin
    if (block.form() == Form::polynomial) {
      return detail::pose_stored(block, kind, Basis::power, lo, end, sharp_epsilons(block.arena(), 1, 0),
                                 stored, exact);
    }
    if (!std::isfinite(end)) return block.settle(Status::failed);
    const auto* const self = block.arena().make(detail::PolynomialFunction<T>{stored});
    if (block.form() == Form::scalar) {
      block.pose(detail::scalar_equation<T>(self, lo, end, max_roots, seed), kind);
    } else if constexpr (std::is_same_v<T, double>) {
      pose_interval(block, kind, self, lo, end, sharp_epsilons(block.arena(), 1, detail::largest(stored.c)));
    }
  });
}

}  // namespace graze
