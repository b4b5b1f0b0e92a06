// Polynomials in the Chebyshev basis: values, and changes of basis with every rounding accounted for.
//
// Solves:  p(x) = sum_i c[i] T_i(x) and p'(x); the same p in the power basis of x in [-1, 1], or in the
//          Bernstein basis of t = (x + 1) / 2 in [0, 1].
// Needs:   1 <= c.size() <= kMaxChebyshevSize for a change of basis; any size for values. c_error is empty
//          (exact coefficients) or bounds |c[i] - true c[i]|. Outputs have c's size and overlap no input.
// Returns: numbers with bounds on their absolute errors, proved as in bernstein.hpp; inf where something
//          overflows or the degree is beyond the limit. Values carry no bound.
// Error:   a bound for every coefficient, 0 where nothing was rounded. To powers it grows like the sum of
//          |coefficients| of T_n, (1 + sqrt 2)^n.
// Cost:    n^2/2 weighted sums; values 3 operations a coefficient; no allocation.
// Source:  Clenshaw, MTAC 9 (1955); A. Rababah, "Transformation of Chebyshev-Bernstein polynomial basis",
//          Comput. Methods Appl. Math. 3 (2003). Changed: weights are exact integers over one binomial.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include <graze/solvers/math/bernstein.hpp>

namespace graze {

/// Degree 31: the weights' sums stay below 2^62 = 2^(2n), so that they are exact in 64 bits.
inline constexpr int kMaxChebyshevDegree = 31;
inline constexpr std::size_t kMaxChebyshevSize = kMaxChebyshevDegree + 1;

/// p and p' at x.
template <class T>
struct ChebyshevValue {
  T value = 0, derivative = 0;
};

/// Clenshaw's recurrence, b_k = c_k + 2 x b_{k+1} - b_{k+2}, and its derivative; p = b_0 - x b_1.
template <class T>
ChebyshevValue<T> chebyshev_value(std::span<const T> c, T x) {
  T b = 0, b_next = 0, d = 0, d_next = 0;
  for (std::size_t k = c.size(); k-- > 0;) {
    const T slope = 2 * (b + x * d) - d_next;
    const T value = c[k] + 2 * x * b - b_next;
    d_next = d;
    d = slope;
    b_next = b;
    b = value;
  }
  return {b - x * b_next, d - b_next - x * d_next};
}

namespace detail {

/// C(n,j) times Bernstein coefficient j of T_k in degree n: sum_i (-1)^(k-i) C(2k,2i) C(n-k,j-i).
constexpr std::int64_t chebyshev_in_bernstein(std::size_t n, std::size_t j, std::size_t k) {
  const auto choose = [](std::size_t a, std::size_t b) { return static_cast<std::int64_t>(kPascal(a, b)); };
  std::int64_t sum = 0;
  for (std::size_t i = j + k > n ? j + k - n : 0; i <= std::min(j, k); ++i) {
    const std::int64_t term = choose(2 * k, 2 * i) * choose(n - k, j - i);
    sum += (k - i) % 2 == 0 ? term : -term;
  }
  return sum;
}

/// An integer rounded once.
inline Ball integer_ball(std::int64_t x) {
  constexpr std::int64_t kExact = std::int64_t{1} << 53;
  const auto value = static_cast<double>(x);
  return {value, -kExact <= x && x <= kExact ? 0 : std::fabs(value) * kUnitRoundoff};
}

/// out[j] = sum_k weight(j, k) c[k].
template <class Weight>
void change_basis(std::span<const double> c, std::span<const double> c_error, std::span<double> out,
                  std::span<double> out_error, const Weight& weight) {
  if (c.empty() || c.size() > kMaxChebyshevSize)
    return std::fill(out_error.begin(), out_error.end(), kInfinity);
  for (std::size_t j = 0; j < c.size(); ++j) {
    WeightedSum sum;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const Ball w = weight(j, k);
      if (w.value != 0) sum.add(w, ball_at(c, c_error, k));
    }
    const Evaluation result = sum.result();
    out[j] = result.value;
    out_error[j] = result.error;
  }
}

}  // namespace detail

/// Coefficient i of T_k in the power basis, (-1)^m 2^(i-1) k C(k-m, m) / (k-m) for i = k - 2m; exact.
/// Needs: i, k <= kMaxChebyshevDegree.
inline double chebyshev_power_weight(std::size_t i, std::size_t k) {
  if (i > k || (k - i) % 2 != 0) return 0;
  if (k == 0) return 1;
  const std::size_t m = (k - i) / 2;
  const auto ways = static_cast<double>(detail::kPascal(k - m, m));
  const double size =
      std::ldexp(static_cast<double>(k) * ways / static_cast<double>(k - m), static_cast<int>(i) - 1);
  return m % 2 == 0 ? size : -size;
}

/// Chebyshev coefficients to power coefficients of x in [-1, 1], ascending.
inline void chebyshev_to_power(std::span<const double> c, std::span<const double> c_error,
                               std::span<double> out, std::span<double> out_error) {
  detail::change_basis(c, c_error, out, out_error, [](std::size_t i, std::size_t k) {
    return detail::Ball{chebyshev_power_weight(i, k), 0};
  });
}

/// Chebyshev coefficients to Bernstein coefficients on [0, 1].
inline void chebyshev_to_bernstein(std::span<const double> c, std::span<const double> c_error,
                                   std::span<double> b, std::span<double> b_error) {
  const std::size_t n = c.empty() ? 0 : c.size() - 1;
  detail::change_basis(c, c_error, b, b_error, [n](std::size_t j, std::size_t k) {
    const std::int64_t weight = detail::chebyshev_in_bernstein(n, j, k);
    const detail::Ball size =
        detail::over(detail::integer_ball(std::abs(weight)), detail::binomial_ball(n, j));
    return detail::Ball{weight < 0 ? -size.value : size.value, size.error};
  });
}

}  // namespace graze
