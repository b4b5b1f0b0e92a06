// One polynomial along a ray in any of three bases, from one formula.
//
// solves    products and differences of polynomials held in the power basis, or on an interval [lo, hi] in
//           the Bernstein or the Chebyshev basis; a coordinate of the ray as such a polynomial; posing the
//           result
// needs     T: float, DoubleDoubleBall or Dyadic. lo < hi for the bases that belong to an interval
// shapes    power: c[i] delta^i. Bernstein: c[i] s^(n-i) t^i with s + t = 1, that is C(n,i) times the
//           Bernstein coefficient, so that a product is a convolution. Chebyshev: c[i] T_i(x), x in [-1, 1]
// error     that of T: proved bounds in DoubleDoubleBall, none in Dyadic
// cost      (m+1)(n+1) products of T for degrees m and n; no allocation but Dyadic's own
// source    T_i T_j = (T_{i+j} + T_{|i-j|}) / 2; Farouki, Rajan, CAGD 5 (1988), for scaled Bernstein products
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/recentred_ball.hpp>

namespace graze {

template <Basis kBasis, class T, std::size_t kSize>
struct InBasis {
  std::array<T, kSize> c{};

  friend InBasis operator-(const InBasis& a, const InBasis& b) {
    InBasis difference;
    for (std::size_t i = 0; i < kSize; ++i) difference.c[i] = a.c[i] - b.c[i];
    return difference;
  }
  friend InBasis operator+(const InBasis& a, const InBasis& b) {
    InBasis sum;
    for (std::size_t i = 0; i < kSize; ++i) sum.c[i] = a.c[i] + b.c[i];
    return sum;
  }
  friend InBasis operator*(double factor, const InBasis& a) {
    InBasis multiple;
    for (std::size_t i = 0; i < kSize; ++i) multiple.c[i] = exactly<T>(factor) * a.c[i];
    return multiple;
  }
};

template <Basis kBasis, class T, std::size_t kA, std::size_t kB>
InBasis<kBasis, T, kA + kB - 1> operator*(const InBasis<kBasis, T, kA>& a, const InBasis<kBasis, T, kB>& b) {
  InBasis<kBasis, T, kA + kB - 1> product;
  const auto add = [&](std::size_t i, const T& term) { product.c[i] = product.c[i] + term; };
  for (std::size_t i = 0; i < kA; ++i) {
    for (std::size_t j = 0; j < kB; ++j) {
      const T term = a.c[i] * b.c[j];
      if (kBasis == Basis::chebyshev && i > 0 && j > 0) {
        const T half = exactly<T>(0.5) * term;
        add(i + j, half);
        add(i > j ? i - j : j - i, half);
      } else {
        add(i + j, term);
      }
    }
  }
  return product;
}

/// Part of a line: x = o + (centre + delta) d for lo <= delta <= hi.
struct LinePart {
  Vec3 o, d;
  double centre, lo, hi;
};

/// The line in the arithmetic of T. In float it starts from p, since a far origin would cancel.
template <class T>
LinePart line_part(const LocalRay& ray, double lo, double hi) {
  if constexpr (std::is_same_v<T, float>) {
    return {ray.p, ray.d, 0, lo, hi};
  } else {
    return {ray.o, ray.d, ray.centre, lo, hi};
  }
}

/// The coordinate o + (centre + delta) d of the line; a d of zero leaves exact zeros.
template <Basis kBasis, class T>
InBasis<kBasis, T, 2> coordinate_in_basis(const LinePart& line, double o, double d) {
  const T origin = exactly<T>(o), direction = exactly<T>(d), centre = exactly<T>(line.centre);
  const T lo = exactly<T>(line.lo), hi = exactly<T>(line.hi), half = exactly<T>(0.5);
  const auto at = [&](const T& delta) { return origin + (centre + delta) * direction; };
  if constexpr (kBasis == Basis::power) {
    return {{origin + centre * direction, direction}};
  } else if constexpr (kBasis == Basis::bernstein) {
    return {{at(lo), at(hi)}};
  } else {
    return {{at(half * (lo + hi)), half * (hi - lo) * direction}};
  }
}

/// A constant, of degree 1 by form, so that homogeneous formulas hold as they stand.
template <Basis kBasis, class T>
InBasis<kBasis, T, 2> constant_in_basis(const T& x) {
  if constexpr (kBasis == Basis::bernstein) return {{x, x}};
  return {{x, T{}}};
}

/// Without the exact root at the low end (power: at zero), whose factor is delta, t or x + 1: one degree
/// less.
template <Basis kBasis>
std::vector<Dyadic> without_low_root(std::span<const Dyadic> c) {
  if constexpr (kBasis != Basis::chebyshev) return {c.begin() + 1, c.end()};
  // (1 + x) q: c_j = q_j + (q_{j-1} + q_{j+1}) / 2, but q_0 counts in full at j = 1.
  std::vector<Dyadic> q(c.size() + 1);
  for (std::size_t j = c.size() - 1; j > 1; --j) q[j - 1] = Dyadic(2.0) * (c[j] - q[j]) - q[j + 1];
  q[0] = c[1] - q[1] - Dyadic(0.5) * q[2];
  q.resize(c.size() - 1);
  return q;
}

/// The value at the low end (power: at zero).
template <Basis kBasis>
Dyadic low_value(std::span<const Dyadic> c) {
  Dyadic value = c[0];
  for (std::size_t i = 1; kBasis == Basis::chebyshev && i < c.size(); ++i) value += i % 2 == 0 ? c[i] : -c[i];
  return value;
}

/// Scaled Bernstein coefficients to Bernstein ones times lcm(1, ..., n+1) / (n+1), a multiple of every C(n,i)
/// for n <= 6: no division, the same roots. Other bases stay as they are.
template <Basis kBasis, class T>
void remove_binomials(std::span<T> c) {
  static constexpr std::array<double, 7> kMultiple{1, 1, 2, 3, 12, 10, 60};
  if constexpr (kBasis == Basis::bernstein) {
    const auto n = static_cast<int>(c.size()) - 1;
    for (int i = 0; i <= n; ++i) {
      T& value = c[static_cast<std::size_t>(i)];
      value = exactly<T>(kMultiple[static_cast<std::size_t>(n)] / binomial(n, i)) * value;
    }
  }
}

/// Poses the polynomial on [lo, hi] in form polynomial and the block's arithmetic; `in_float()` and
/// `exact(c)` as in pose_balls.
template <class InFloat, class Exact>
void pose_in_basis(EquationBlock& block, Basis basis, std::span<const DoubleDoubleBall> c, double lo,
                   double hi, const InFloat& in_float, const Exact& exact) {
  const auto rounded = [&](auto number) { return rounded_balls<decltype(number)>(block, c, in_float); };
  with_coefficients(block, rounded, [&](auto values) {
    detail::pose_stored(block, 0, basis, lo, hi, sharp_epsilons(block.arena(), 1, 0),
                        detail::store_coefficients(block.arena(), values), exact_by(block, 0, exact));
  });
}

}  // namespace graze
