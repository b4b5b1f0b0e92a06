// Polynomials in the Bernstein basis on [0, 1], with every rounding error accounted for.
//
// Solves:  p(t) = sum_i b[i] B_{i,n}(t), B_{i,n}(t) = C(n,i) t^i (1-t)^(n-i), n = b.size() - 1: values,
//          derivatives, ranges, subdivision, products, sign variations, change of basis.
// Needs:   1 <= b.size() <= kMaxBernsteinSize (degree 64); rounding to nearest. b_error is empty (exact
//          coefficients) or has b's length and bounds |b[i] - true b[i]|. Outputs have the sizes stated.
// Returns: numbers with bounds on their absolute errors, proved: underflow and the rounding of the bounds are
//          in them, and a bound is 0 where nothing was rounded. A bound is inf where something overflows, is
//          not a number, or the degree is beyond the limit.
// Cost:    stated for each; working memory on the stack, no allocation.
// Source:  Farouki, "The Bernstein polynomial basis: a centennial retrospective", CAGD 29, 2012 (identities);
//          Farouki, Rajan, "On the numerical condition of polynomials in Bernstein form", CAGD 4, 1987.
//          Bounds: standard model of rounding, Higham 2002, chapters 2 and 3.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/polynomial.hpp>
#include <span>

namespace graze {

/// Degree 64: the last even degree whose binomials all fit in 64 bits with room for the additions.
inline constexpr int kMaxBernsteinDegree = 64;
inline constexpr std::size_t kMaxBernsteinSize = kMaxBernsteinDegree + 1;
/// All C(n, k) are doubles up to n = 56; beyond, they are rounded once: relative error at most u = 2^-53.
inline constexpr int kMaxExactBinomial = 56;

namespace detail {

/// Pascal's triangle up to row 64, as exact integers: the left half of each row, which is symmetrical.
class PascalTriangle {
 public:
  constexpr PascalTriangle() {
    for (std::size_t n = 0; n < kMaxBernsteinSize; ++n) {
      entries_[row(n)] = 1;
      for (std::size_t k = 1; k <= n / 2; ++k)
        entries_[row(n) + k] = (*this)(n - 1, k - 1) + (*this)(n - 1, k);
    }
  }
  /// C(n, k) for k <= n <= 64.
  constexpr std::uint64_t operator()(std::size_t n, std::size_t k) const {
    return entries_[row(n) + std::min(k, n - k)];
  }

 private:
  /// Rows 0 to n - 1 have floor(i/2) + 1 entries each.
  static constexpr std::size_t row(std::size_t n) { return (n + 1) * (n + 1) / 4; }

  std::array<std::uint64_t, (kMaxBernsteinSize + 1) * (kMaxBernsteinSize + 1) / 4> entries_{};
};
inline constexpr PascalTriangle kPascal{};

/// A number with a bound on its error; bounds are sums of non-negative terms.
using Ball = Evaluation;

/// What the underflow of one product may lose: nothing while it is far from the subnormal range.
inline double underflow_of(double product, double a, double b) {
  if (std::fabs(product) >= kResidualFloor || a == 0 || b == 0) [[likely]]
    return 0;
  return std::numeric_limits<double>::denorm_min();
}

/// A bound that overflowed on the way is no bound.
inline double sound(double error) { return error >= 0 ? error : kInfinity; }

/// The weights (1 - t, t) with the rounding error of the first.
struct Blend {
  double s, t;
  double s_error;

  explicit Blend(double at) : s(1 - at), t(at), s_error(std::fabs(sum_residual(1, -at, s))) {}

  /// s a + t b and its error: the products' and the sum's exact residuals, and the operands' own errors.
  [[nodiscard]] Ball operator()(const Ball& a, const Ball& b) const {
    const double left = s * a.value, right = t * b.value;
    const double value = left + right;
    const double rounding = std::fabs(std::fma(s, a.value, -left)) + std::fabs(std::fma(t, b.value, -right)) +
                            std::fabs(sum_residual(left, right, value));
    const double size = std::fabs(s), other = std::fabs(t);
    const double left_data = size * a.error, right_data = other * b.error;
    const double underflow = underflow_of(left, s, a.value) + underflow_of(right, t, b.value) +
                             underflow_of(left_data, s, a.error) + underflow_of(right_data, t, b.error);
    const double weight = s_error == 0 ? 0 : mul_up(s_error, std::fabs(a.value) + a.error);
    const double error = (left_data + right_data) + (rounding + weight) + underflow;
    // Fewer than twelve roundings, each of a non-negative term.
    return {value, sound(error == 0 ? 0 : mul_up(error, 1 + 16 * kUnitRoundoff))};
  }
};

/// sum_i w[i] x[i] with a running bound made of exact residuals.
class WeightedSum {
 public:
  /// Adds w x, where w is known to within w.error and x to within x.error.
  void add(const Ball& w, const Ball& x) {
    const double product = w.value * x.value;
    const double sum = sum_ + product;
    const double data = std::fabs(w.value) * x.error;
    const double weight = w.error * (std::fabs(x.value) + x.error);
    const double rounding =
        std::fabs(std::fma(w.value, x.value, -product)) + std::fabs(sum_residual(sum_, product, sum));
    error_ += data + weight + rounding + underflow_of(product, w.value, x.value) +
              underflow_of(data, w.value, x.error) +
              underflow_of(weight, w.error, std::fabs(x.value) + x.error);
    sum_ = sum;
    ++terms_;
  }
  [[nodiscard]] Ball result() const {
    return {sum_, sound(error_ == 0 ? 0 : mul_up(bound_slack(terms_ + 2), error_))};
  }

 private:
  double sum_ = 0, error_ = 0;
  std::size_t terms_ = 0;
};

inline Ball ball_at(std::span<const double> b, std::span<const double> b_error, std::size_t i) {
  return {b[i], error_at(b_error, i)};
}

/// One level of de Casteljau's scheme in place, on `size` entries.
inline void casteljau_level(const Blend& blend, std::array<Ball, kMaxBernsteinSize>& work, std::size_t size) {
  for (std::size_t i = 0; i + 1 < size; ++i) work[i] = blend(work[i], work[i + 1]);
}

inline std::array<Ball, kMaxBernsteinSize> loaded(std::span<const double> b,
                                                  std::span<const double> b_error) {
  std::array<Ball, kMaxBernsteinSize> work;
  for (std::size_t i = 0; i < b.size(); ++i) work[i] = ball_at(b, b_error, i);
  return work;
}

/// What underflow may do to p(t) by de Casteljau's scheme in doubles, given the bound without it: each of the
/// n(n+1) products of a triangle may lose 2^-1075, which grows by at most (|1-t| + |t|)^n.
inline double casteljau_underflow(std::span<const double> b, std::span<const double> b_error, double t,
                                  double bound) {
  const auto is_zero = [](double x) { return x == 0; };
  const bool inside = t >= 0 && t <= 1;
  // A bound of ordinary size covers it by its slack, and zeros do not underflow.
  if (inside && bound >= kResidualFloor) [[likely]]
    return 0;
  if (std::all_of(b.begin(), b.end(), is_zero) && std::all_of(b_error.begin(), b_error.end(), is_zero))
    return 0;
  const double n = static_cast<double>(b.size());
  const double growth = inside ? 1 : 2 * std::pow(std::fabs(1 - t) + std::fabs(t), n);
  return mul_up(2 * n * n * std::numeric_limits<double>::denorm_min(), growth);
}

constexpr bool fits(std::span<const double> b) { return !b.empty() && b.size() <= kMaxBernsteinSize; }
inline constexpr Evaluation kUnknown{0, kInfinity};

}  // namespace detail

/// C(n, k) for 0 <= k <= n <= 64: exact up to n = 56, then rounded once.
constexpr double binomial(int n, int k) {
  return static_cast<double>(detail::kPascal(static_cast<std::size_t>(n), static_cast<std::size_t>(k)));
}

namespace detail {

/// C(n, k) with the error of its rounding.
inline Ball binomial_ball(std::size_t n, std::size_t k) {
  const std::uint64_t exact = kPascal(n, k);
  const double value = static_cast<double>(exact);
  return {value, n <= static_cast<std::size_t>(kMaxExactBinomial) ? 0 : value * kUnitRoundoff};
}
/// Product of binomials or their products: magnitudes between 2^-64 and 2^192, far from over- and underflow.
inline Ball times(const Ball& a, const Ball& b) {
  const double value = a.value * b.value;
  const double error =
      std::fabs(std::fma(a.value, b.value, -value)) + a.error * (b.value + b.error) + a.value * b.error;
  return {value, error * (1 + 16 * kUnitRoundoff)};
}
/// The same for quotients: |a/b - q| = |residual| / b, and b's own error enters with the size of q.
inline Ball over(const Ball& a, const Ball& b) {
  const double value = a.value / b.value;
  const double residual = std::fabs(std::fma(-value, b.value, a.value)) + a.error + value * b.error;
  return {value, residual / (b.value - b.error) * (1 + 16 * kUnitRoundoff)};
}

}  // namespace detail

/// p(t) in the arithmetic of T (double, DoubleDouble, Interval, ...) by de Casteljau's scheme; n^2/2 steps of
/// three operations. 0 beyond the degree limit.
template <class T>
T bernstein_value(std::span<const double> b, const T& t) {
  if (!detail::fits(b)) return detail::constant<T>(0);
  std::array<T, kMaxBernsteinSize> work{};
  for (std::size_t i = 0; i < b.size(); ++i) work[i] = detail::constant<T>(b[i]);
  const T s = detail::constant<T>(1) - t;
  for (std::size_t size = b.size(); size > 1; --size)
    for (std::size_t i = 0; i + 1 < size; ++i) work[i] = s * work[i] + t * work[i + 1];
  return work[0];
}

/// p(t) with an error bound, by de Casteljau's scheme: |error| <= 3 n u sum |b[i]| B_i(t) (1 + O(n u)) plus
/// the coefficients' own errors; for any finite t (then with |t|, |1-t| in the sum). Ends of [0, 1] are
/// exact. About 4 n^2 flops.
inline Evaluation bernstein_evaluate(std::span<const double> b, std::span<const double> b_error, double t) {
  if (!detail::fits(b)) return detail::kUnknown;
  if (t == 0 || b.size() == 1) return detail::ball_at(b, b_error, 0);
  if (t == 1) return detail::ball_at(b, b_error, b.size() - 1);
  // A second triangle carries, for each entry, its coefficient's share of the error: 3n roundings and e.
  const double roundings = 3 * static_cast<double>(b.size() - 1) * detail::kUnitRoundoff;
  std::array<double, kMaxBernsteinSize> value, bound;
  for (std::size_t i = 0; i < b.size(); ++i) {
    value[i] = b[i];
    bound[i] = roundings * std::fabs(b[i]) + detail::error_at(b_error, i);
  }
  const double s = 1 - t, s_size = std::fabs(s), t_size = std::fabs(t);
  for (std::size_t size = b.size(); size > 1; --size)
    for (std::size_t i = 0; i + 1 < size; ++i) {
      value[i] = s * value[i] + t * value[i + 1];
      bound[i] = s_size * bound[i] + t_size * bound[i + 1];
    }
  // gamma_3n / (1 - gamma_3n) <= 3n u (1 + 12 n u); the slack pays for that and the bound's own 3n + 5
  // roundings.
  const double slack = detail::bound_slack(4 * b.size());
  const double underflow = detail::casteljau_underflow(b, b_error, t, bound[0]);
  // The bound is smaller than the values by u and may stay finite where they overflow.
  if (!std::isfinite(value[0])) return detail::kUnknown;
  return {value[0], detail::sound(add_up(mul_up(slack, bound[0]), underflow))};
}
inline Evaluation bernstein_evaluate(std::span<const double> b, double t) {
  return bernstein_evaluate(b, {}, t);
}

/// p(t) and p'(t) = n sum (b[i+1] - b[i]) B_{i,n-1}(t), each with its error bound; residuals are measured.
inline DerivativeEvaluation bernstein_evaluate_with_derivative(std::span<const double> b,
                                                               std::span<const double> b_error, double t) {
  if (!detail::fits(b)) return {0, 0, detail::kInfinity, detail::kInfinity};
  if (b.size() == 1) return {b[0], 0, detail::error_at(b_error, 0), 0};
  auto work = detail::loaded(b, b_error);
  const detail::Blend blend(t);
  for (std::size_t size = b.size(); size > 2; --size) detail::casteljau_level(blend, work, size);
  // The last two entries hold the value's chord and the derivative's difference.
  detail::WeightedSum slope;
  const double n = static_cast<double>(b.size() - 1);
  slope.add({-n, 0}, work[0]);
  slope.add({n, 0}, work[1]);
  const Evaluation value = blend(work[0], work[1]);
  const Evaluation derivative = slope.result();
  return {value.value, derivative.value, value.error, derivative.error};
}
inline DerivativeEvaluation bernstein_evaluate_with_derivative(std::span<const double> b, double t) {
  return bernstein_evaluate_with_derivative(b, {}, t);
}

/// Contains p([0, 1]): the hull of the coefficients and their errors. n + 1 steps; any degree.
inline Interval bernstein_range(std::span<const double> b, std::span<const double> b_error) {
  if (b.empty()) return {};
  Interval range = detail::coefficient(b, b_error, 0);
  for (std::size_t i = 1; i < b.size(); ++i) range = hull(range, detail::coefficient(b, b_error, i));
  return range;
}

/// Coefficients on [0, t] and on [t, 1] with their errors: left[n] = right[0] = p(t). All four outputs have
/// b's size; left may be b itself and left_error b_error, or right and right_error. n^2/2 steps of about
/// 20 flops. At t = 1/2 a coefficient without rounding keeps the error 0.
inline void bernstein_subdivide(std::span<const double> b, std::span<const double> b_error, double t,
                                std::span<double> left, std::span<double> left_error, std::span<double> right,
                                std::span<double> right_error) {
  if (!detail::fits(b)) {
    std::fill(left_error.begin(), left_error.end(), detail::kInfinity);
    std::fill(right_error.begin(), right_error.end(), detail::kInfinity);
    return;
  }
  auto work = detail::loaded(b, b_error);
  const detail::Blend blend(t);
  // After level k the first entry is final on the left and entry n - k on the right.
  for (std::size_t size = left.size(); size > 0; --size) {
    const std::size_t k = left.size() - size;
    left[k] = work[0].value;
    left_error[k] = work[0].error;
    right[size - 1] = work[size - 1].value;
    right_error[size - 1] = work[size - 1].error;
    detail::casteljau_level(blend, work, size);
  }
}

/// Coefficients of p on a part of [0, 1], read from 0 to 1 along it, with their errors. The part returned is
/// t itself, or t widened at its low end by rounding; out and out_error have b's size and may be b, b_error.
/// t must lie in [0, 1].
inline Interval bernstein_restrict(std::span<const double> b, std::span<const double> b_error, Interval t,
                                   std::span<double> out, std::span<double> out_error) {
  std::array<double, kMaxBernsteinSize> rest, rest_error;
  const std::size_t size = detail::fits(b) ? b.size() : 0;
  const std::span<double> scratch(rest.data(), size), scratch_error(rest_error.data(), size);
  bernstein_subdivide(b, b_error, t.hi, out, out_error, scratch, scratch_error);
  if (t.lo <= 0 || t.hi <= 0) return {0, t.hi};
  // The low end as a fraction of the high one, rounded down: the part may grow, never shrink.
  const double fraction = div_down(t.lo, t.hi);
  bernstein_subdivide(out, out_error, fraction, scratch, scratch_error, out, out_error);
  return {mul_down(fraction, t.hi), t.hi};
}

/// Contains { p(v) : v in t }. Inside [0, 1]: hull of the coefficients on t, quadratically tight in the width
/// of t; elsewhere de Casteljau's scheme in interval arithmetic, which is wide. About n^2 steps.
inline Interval bernstein_evaluate(std::span<const double> b, std::span<const double> b_error, Interval t) {
  if (!detail::fits(b)) return entire();
  if (is_point(t)) return enclosure(bernstein_evaluate(b, b_error, t.lo));
  if (t.lo >= 0 && t.hi <= 1) {
    std::array<double, kMaxBernsteinSize> part, part_error;
    const std::span<double> c(part.data(), b.size()), c_error(part_error.data(), b.size());
    bernstein_restrict(b, b_error, t, c, c_error);
    return bernstein_range(c, c_error);
  }
  std::array<Interval, kMaxBernsteinSize> work;
  for (std::size_t i = 0; i < b.size(); ++i) work[i] = detail::coefficient(b, b_error, i);
  for (std::size_t size = b.size(); size > 1; --size)
    for (std::size_t i = 0; i + 1 < size; ++i) work[i] = work[i] + t * (work[i + 1] - work[i]);
  return work[0];
}

/// Coefficients of p' in degree n - 1, n (b[i+1] - b[i]), with their errors. Outputs have room for n numbers
/// (one for n = 0: the zero polynomial) and may be b, b_error.
inline void bernstein_derivative(std::span<const double> b, std::span<const double> b_error,
                                 std::span<double> out, std::span<double> out_error) {
  const double n = static_cast<double>(b.size()) - 1;
  if (b.size() < 2) out[0] = out_error[0] = 0;
  for (std::size_t i = 0; i + 1 < b.size(); ++i) {
    detail::WeightedSum difference;
    difference.add({-n, 0}, detail::ball_at(b, b_error, i));
    difference.add({n, 0}, detail::ball_at(b, b_error, i + 1));
    const Evaluation result = difference.result();
    out[i] = result.value;
    out_error[i] = result.error;
  }
}
/// Contains { p'(v) : v in t }.
inline Interval bernstein_evaluate_derivative(std::span<const double> b, std::span<const double> b_error,
                                              Interval t) {
  if (!detail::fits(b)) return entire();
  std::array<double, kMaxBernsteinSize> d, d_error;
  const std::size_t size = std::max<std::size_t>(b.size(), 2) - 1;
  const std::span<double> c(d.data(), size), c_error(d_error.data(), size);
  bernstein_derivative(b, b_error, c, c_error);
  return bernstein_evaluate(c, c_error, t);
}

/// Coefficients of the product of a (degree m) and b (degree n), degree m + n <= 64, with their errors:
/// out[k] = sum_{i+j=k} C(m,i) C(n,j) / C(m+n,k) a[i] b[j]. Outputs have m + n + 1 numbers and overlap no
/// input. About 25 (m+1)(n+1) flops.
inline void bernstein_product(std::span<const double> a, std::span<const double> a_error,
                              std::span<const double> b, std::span<const double> b_error,
                              std::span<double> out, std::span<double> out_error) {
  const std::size_t m = a.size() - 1, n = b.size() - 1;
  if (!detail::fits(a) || !detail::fits(b) || m + n + 1 > kMaxBernsteinSize) {
    std::fill(out_error.begin(), out_error.end(), detail::kInfinity);
    return;
  }
  for (std::size_t k = 0; k <= m + n; ++k) {
    detail::WeightedSum sum;
    for (std::size_t i = k > n ? k - n : 0; i <= std::min(k, m); ++i) {
      // a[i] b[j] first: its own underflow and rounding are one term's errors.
      detail::WeightedSum product;
      product.add(detail::ball_at(a, a_error, i), detail::ball_at(b, b_error, k - i));
      const auto ways = detail::times(detail::binomial_ball(m, i), detail::binomial_ball(n, k - i));
      sum.add(detail::over(ways, detail::binomial_ball(m + n, k)), product.result());
    }
    const Evaluation result = sum.result();
    out[k] = result.value;
    out_error[k] = result.error;
  }
}

/// Power coefficients c (ascending, on [0, 1]) to Bernstein coefficients: b[j] = sum_{i<=j} C(j,i)/C(n,i)
/// c[i]. Outputs have c's size and overlap no input; n^2/2 steps.
inline void power_to_bernstein(std::span<const double> c, std::span<const double> c_error,
                               std::span<double> b, std::span<double> b_error) {
  if (!detail::fits(c)) return std::fill(b_error.begin(), b_error.end(), detail::kInfinity);
  const std::size_t n = c.size() - 1;
  for (std::size_t j = 0; j <= n; ++j) {
    detail::WeightedSum sum;
    for (std::size_t i = 0; i <= j; ++i)
      sum.add(detail::over(detail::binomial_ball(j, i), detail::binomial_ball(n, i)),
              detail::ball_at(c, c_error, i));
    const Evaluation result = sum.result();
    b[j] = result.value;
    b_error[j] = result.error;
  }
}

/// Bernstein to power coefficients: c[i] = C(n,i) sum_{j<=i} (-1)^(i-j) C(i,j) b[j]. Outputs have b's size
/// and overlap no input; n^2/2 steps. The condition grows like 3^n: the error bounds say so.
inline void bernstein_to_power(std::span<const double> b, std::span<const double> b_error,
                               std::span<double> c, std::span<double> c_error) {
  if (!detail::fits(b)) return std::fill(c_error.begin(), c_error.end(), detail::kInfinity);
  const std::size_t n = b.size() - 1;
  for (std::size_t i = 0; i <= n; ++i) {
    detail::WeightedSum sum;
    for (std::size_t j = 0; j <= i; ++j) {
      detail::Ball weight = detail::times(detail::binomial_ball(n, i), detail::binomial_ball(i, j));
      if ((i - j) % 2 == 1) weight.value = -weight.value;
      sum.add(weight, detail::ball_at(b, b_error, j));
    }
    const Evaluation result = sum.result();
    c[i] = result.value;
    c_error[i] = result.error;
  }
}

/// The least and the greatest number of sign changes, zeros skipped, over all coefficients within b_error of
/// b.
struct SignVariations {
  int lower = 0;
  int upper = 0;
};

/// Both counts are attained. By Descartes' rule for the Bernstein basis p has at most `upper` roots in (0,
/// 1), and exactly one if both are 1 (counted with multiplicity). n + 1 steps; any degree.
inline SignVariations sign_variations(std::span<const double> b, std::span<const double> b_error) {
  constexpr int kNever = 1 << 20;
  // Fewest and most changes so far, by the last non-zero sign: none yet, negative, positive.
  struct Count {
    std::array<int, 3> fewest, most;
  };
  Count count{{0, kNever, kNever}, {0, -kNever, -kNever}};
  for (std::size_t i = 0; i < b.size(); ++i) {
    const Interval x = detail::coefficient(b, b_error, i);
    const bool may_be_zero = contains_zero(x);
    Count next{{kNever, kNever, kNever}, {-kNever, -kNever, -kNever}};
    if (may_be_zero) next = count;
    const auto take = [&](std::size_t sign) {
      const std::size_t other = 3 - sign;
      next.fewest[sign] =
          std::min({next.fewest[sign], count.fewest[0], count.fewest[sign], count.fewest[other] + 1});
      next.most[sign] = std::max({next.most[sign], count.most[0], count.most[sign], count.most[other] + 1});
    };
    if (x.lo < 0) take(1);
    if (x.hi > 0) take(2);
    count = next;
  }
  return {*std::min_element(count.fewest.begin(), count.fewest.end()),
          *std::max_element(count.most.begin(), count.most.end())};
}
inline SignVariations sign_variations(std::span<const double> b) { return sign_variations(b, {}); }

}  // namespace graze
