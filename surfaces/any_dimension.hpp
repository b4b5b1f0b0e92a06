// Spheres, hyperplanes and ellipsoids in N dimensions: document 002's primitives as plain templates.
//
// Solves:  |o + l d - c| = r;  a.(o + l d) = b;  (o + l d - c)^T P^-1 (o + l d - c) = 1, for l > 0.
// Needs:   N >= 1, finite inputs, r > 0, a != 0, P symmetric positive definite (std::invalid_argument where
//          not). d is any non-zero vector, not assumed unit: l is in units of |d|.
// Returns: hits sorted by l, each with its multiplicity (2 = touches), and a status: `coincident` for a ray
//          inside a plane; `invalid` for a ray that is not finite or has no direction; `uncertain` where the
//          range below, or an ellipsoid's condition, hides the answer: the list then holds what is proved.
// Error:   sphere and plane: the count is exact, l within 1 ulp, for coordinates (of o, c, r, and among
//          those of d and of a) that are zero or within 2^200 of the largest of their kind; beyond, the
//          count is right or the status is `uncertain`. Ellipsoid: the count is right or `uncertain` (a
//          touch always is); l as for a P that is off by a relative eta = 2^-101 N (N + 4) condition().
//          Scaling all lengths, or d, by a power of two changes no bit of the significands (the ellipsoid:
//          all lengths by 2^k is P by 2^2k).
// Cost:    O(N) double-double operations (ellipsoid: O(N^2)), no allocation; expansions where the filter
//          cannot tell. Measured for N = 3: plane 0.08, sphere 0.17, ellipsoid 0.3, a touched sphere 0.6 to
//          1.4 us.
// Source:  document 002, whose plane formula has the wrong sign: l = (b - a.o)/(a.d). Changed: the
//          quadratic is posed at the foot of the perpendicular, so that far origins and grazing rays do not
//          cancel.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/solvers/roots.hpp>

namespace graze::nd {

template <std::size_t N>
using Vector = std::array<double, N>;
/// Rows of an N x N matrix.
template <std::size_t N>
using Matrix = std::array<Vector<N>, N>;

struct Hit {
  double l = 0;                    ///< in units of |d|, > 0
  std::uint32_t multiplicity = 1;  ///< 2 = touches

  friend constexpr bool operator==(const Hit&, const Hit&) = default;
};

/// At most two hits, sorted by l.
class Hits {
 public:
  Status status = Status::ok;

  Hits() = default;
  explicit Hits(Status without_hits) : status(without_hits) {}
  void append(double l, std::uint32_t multiplicity) { list_[size_++] = {l, multiplicity}; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const Hit& operator[](std::size_t i) const { return list_[i]; }
  [[nodiscard]] const Hit* begin() const { return list_.data(); }
  [[nodiscard]] const Hit* end() const { return list_.data() + size_; }

  friend bool operator==(const Hits&, const Hits&) = default;

 private:
  std::array<Hit, 2> list_{};
  std::size_t size_ = 0;
};

namespace detail {

inline constexpr double kU2 = 0x1p-106;  // u^2
/// Inputs are scaled to at most 1 or so; where products fall below this, their low parts underflow.
inline constexpr double kFloor = 0x1p-900;

template <std::size_t N>
using WideVector = std::array<DoubleDouble, N>;

template <std::size_t N>
bool is_finite(const Vector<N>& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}
template <std::size_t N>
double max_abs(const Vector<N>& v) {
  double largest = 0;
  for (const double x : v) largest = std::max(largest, std::fabs(x));
  return largest;
}
/// Finite, with a direction.
template <std::size_t N>
bool is_ray(const Vector<N>& o, const Vector<N>& d) {
  return is_finite(o) && is_finite(d) && max_abs(d) > 0;
}

/// Scales by powers of two and remembers whether that, and exact arithmetic afterwards, loses nothing.
struct Scaler {
  int degree;  ///< of what is to be formed exactly
  bool exact = true;

  double operator()(double x, int k) {
    const double scaled = scale_by_power(x, k);
    exact = exact && (x == 0 || (scaled != 0 && Expansion::in_range(scaled, degree)));
    return scaled;
  }
  template <std::size_t N>
  Vector<N> operator()(Vector<N> v, int k) {
    for (double& x : v) x = (*this)(x, k);
    return v;
  }
};

template <std::size_t N, class A, class B>
DoubleDouble wide_dot(const std::array<A, N>& a, const std::array<B, N>& b) {
  DoubleDouble sum;
  for (std::size_t i = 0; i < N; ++i) sum += DoubleDouble(a[i]) * b[i];
  return sum;
}

/// A quantity with a bound of its error.
struct Bounded {
  DoubleDouble value;
  double bound = 0;

  [[nodiscard]] bool sign_known() const { return std::fabs(value.hi) > bound || bound == 0; }
  [[nodiscard]] int sign() const { return value.hi < 0 ? -1 : value.hi > 0 ? 1 : 0; }
  /// 2^-60 is far enough below u that what is computed from it still rounds to within an ulp.
  [[nodiscard]] bool is_sharp() const { return std::fabs(value.hi) * 0x1p-60 > bound + kFloor; }
};

/// q itself where it is sharp, else its exact value, rounded to a double-double.
template <class ExactValue>
Bounded sharpened(const Bounded& q, bool exact, const ExactValue& exact_value) {
  if (q.is_sharp()) return q;
  if (!exact) return {q.value, q.bound + kFloor};
  return {Expansion(exact_value()).to_double_double(), 0};
}

/// a l^2 + 2 b l + c = 0 with a > 0; `discriminant` = b^2 - a c, found without that subtraction.
struct Quadratic {
  DoubleDouble a;
  Bounded b, c, discriminant;
};

/// Appends l 2^k, unless the result leaves the doubles: that hit exists, but has no number.
inline void append_scaled(Hits& hits, const DoubleDouble& l, std::uint32_t multiplicity, int k) {
  const double scaled = scale_by_power(l.hi, k);
  if (scaled > 0 && std::isfinite(scaled)) {
    hits.append(scaled, multiplicity);
  } else {
    hits.status = Status::uncertain;
  }
}

/// The positive roots times 2^k. Sums of like signs only: nothing cancels.
inline Hits positive_roots(const Quadratic& q, int k) {
  Hits hits;
  const Bounded& d = q.discriminant;
  const DoubleDouble root = d.sign() > 0 ? sqrt(d.value) : DoubleDouble();
  const DoubleDouble b = q.b.value, c = q.c.value;
  const bool away = q.b.sign() >= 0 && q.b.sign_known();
  if (q.c.sign_known() && q.c.sign() < 0) {
    // The origin is inside: one root of each sign.
    append_scaled(hits, b.hi <= 0 ? (root - b) / q.a : -c / (b + root), 1, k);
  } else if ((d.sign_known() && d.sign() < 0) || (away && q.c.sign_known())) {
    return hits;
  } else if (!q.b.sign_known() || !q.c.sign_known()) {
    // The origin may be on the surface, where only the far root of a ray that goes inward is certain.
    hits.status = Status::uncertain;
    if (q.b.sign_known() && q.b.sign() < 0 && d.sign_known() && d.sign() > 0)
      append_scaled(hits, (root - b) / q.a, 1, k);
  } else if (q.c.sign() == 0) {
    append_scaled(hits, -2.0 * b / q.a, 1, k);
  } else if (!d.sign_known()) {
    hits.status = Status::uncertain;
  } else if (d.sign() == 0) {
    append_scaled(hits, -b / q.a, 2, k);
  } else {
    // Two roots that agree to all digits may round in the wrong order.
    const auto [near, far] = std::minmax({c / (root - b), (root - b) / q.a});
    append_scaled(hits, near, 1, k);
    append_scaled(hits, far, 1, k);
  }
  return hits;
}

/// |m + l0 d|^2 at the foot of the perpendicular, l0 = -b/a: an error of l0 enters squared only.
template <std::size_t N, class D>
DoubleDouble foot_square(const WideVector<N>& m, const std::array<D, N>& d, const DoubleDouble& l0) {
  WideVector<N> p;
  for (std::size_t i = 0; i < N; ++i) p[i] = m[i] + l0 * d[i];
  return wide_dot(p, p);
}

/// A bound of the error of foot_square: one rounding of each coordinate, of the size of m, seen from p; that
/// of l0, squared; and the sum's own. `steps` grows with the operations in a dot product.
inline double foot_bound(double foot2, double m2, double steps) {
  const double along = 16 * steps * kU2;
  return 32 * kU2 * std::sqrt(foot2 * m2) + along * along * m2 + 8 * steps * kU2 * foot2;
}

}  // namespace detail

/// |x - c| = r.
template <std::size_t N>
class Sphere {
  static_assert(N >= 1);

 public:
  Sphere(const Vector<N>& center, double radius) : center_(center), radius_(radius) {
    if (!detail::is_finite(center)) throw std::invalid_argument("center is not finite");
    if (!(radius > 0) || !std::isfinite(radius)) throw std::invalid_argument("radius must be positive");
  }
  [[nodiscard]] const Vector<N>& center() const { return center_; }
  [[nodiscard]] double radius() const { return radius_; }

  [[nodiscard]] Hits hits(const Vector<N>& o, const Vector<N>& d) const {
    if (!detail::is_ray(o, d)) return Hits(Status::invalid);
    // Lengths and direction near 1: no product over- or underflows, and scaled scenes give the same bits.
    const int k = -exponent_of(std::max({detail::max_abs(o), detail::max_abs(center_), radius_}));
    const int kd = -exponent_of(detail::max_abs(d));
    detail::Scaler scaled{.degree = 4};
    const Problem problem{scaled(o, k), scaled(center_, k), scaled(d, kd), scaled(radius_, k)};
    return detail::positive_roots(problem.quadratic(scaled.exact), kd - k);
  }

 private:
  /// One scaled ray and sphere.
  struct Problem {
    Vector<N> o, c, d;
    double r;

    [[nodiscard]] detail::Quadratic quadratic(bool exact) const {
      detail::WideVector<N> m;
      for (std::size_t i = 0; i < N; ++i) m[i] = two_sum(o[i], -c[i]);
      const DoubleDouble a = detail::wide_dot(d, d), b = detail::wide_dot(m, d), m2 = detail::wide_dot(m, m);
      const DoubleDouble r2 = two_prod(r, r), foot2 = detail::foot_square(m, d, -b / a);
      // A dot product of N terms: N sums of 3 u^2 and products of 5 u^2, of terms bounded by Cauchy-Schwarz.
      const double steps = static_cast<double>(N) + 4;
      const double b_bound = 8 * steps * detail::kU2 * std::sqrt(a.hi * m2.hi);
      const double c_bound = 8 * steps * detail::kU2 * (m2.hi + r2.hi);
      const double h_bound = detail::foot_bound(foot2.hi, m2.hi, steps) + 8 * steps * detail::kU2 * r2.hi;
      const auto at = [&](std::size_t i) { return Expansion(o[i]) - c[i]; };
      return {a, detail::sharpened({b, b_bound}, exact, [&] { return exact_slope(at); }),
              detail::sharpened({m2 - r2, c_bound}, exact, [&] { return exact_power(at); }),
              detail::sharpened({a * (r2 - foot2), 2 * a.hi * h_bound}, exact,
                                [&] { return exact_discriminant(at); })};
    }
    template <class At>
    Expansion exact_slope(const At& at) const {
      Expansion sum;
      for (std::size_t i = 0; i < N; ++i) sum += at(i) * d[i];
      return sum;
    }
    /// The power of the origin: |m|^2 - r^2.
    template <class At>
    Expansion exact_power(const At& at) const {
      Expansion sum = -(Expansion(r) * r);
      for (std::size_t i = 0; i < N; ++i) sum += at(i) * at(i);
      return sum;
    }
    template <class At>
    Expansion exact_discriminant(const At& at) const {
      const Expansion slope = exact_slope(at);
      return slope * slope - exact_dot(d, d) * exact_power(at);
    }
  };

  Vector<N> center_;
  double radius_;
};

/// a.x = b.
template <std::size_t N>
class Plane {
  static_assert(N >= 1);

 public:
  Plane(const Vector<N>& a, double b) : a_(a), b_(b) {
    if (!detail::is_finite(a) || !std::isfinite(b)) throw std::invalid_argument("plane is not finite");
    if (detail::max_abs(a) == 0) throw std::invalid_argument("a must not be zero");
  }
  [[nodiscard]] const Vector<N>& a() const { return a_; }
  [[nodiscard]] double b() const { return b_; }

  [[nodiscard]] Hits hits(const Vector<N>& o, const Vector<N>& d) const {
    if (!detail::is_ray(o, d)) return Hits(Status::invalid);
    const int ka = -exponent_of(detail::max_abs(a_)), kd = -exponent_of(detail::max_abs(d));
    // b is a length times a: both it and the origin decide the scale of lengths.
    const int from_o = detail::max_abs(o) > 0 ? exponent_of(detail::max_abs(o)) : kNothing;
    const int from_b = b_ != 0 ? exponent_of(b_) + ka : kNothing;
    const int largest = std::max(from_o, from_b);
    const int k = largest == kNothing ? 0 : -largest;
    detail::Scaler scaled{.degree = 2};
    const Vector<N> a = scaled(a_, ka), p = scaled(o, k), q = scaled(d, kd);
    const double b = scaled(b_, ka + k);
    const detail::Bounded above = offset(a, p, b, scaled.exact), slope = offset(a, q, 0, scaled.exact);
    return quotient(above, slope, kd - k);
  }

 private:
  /// Below every exponent of a double and of a quotient of two.
  static constexpr int kNothing = -5000;

  /// b - a.x, with the sign of its exact value if `exact`.
  static detail::Bounded offset(const Vector<N>& a, const Vector<N>& x, double b, bool exact) {
    DoubleDouble value(b);
    double size = std::fabs(b);
    for (std::size_t i = 0; i < N; ++i) {
      const DoubleDouble term = two_prod(a[i], x[i]);
      value = value - term;
      size += std::fabs(term.hi);
    }
    const double bound = 4 * (static_cast<double>(N) + 2) * detail::kU2 * size;
    return detail::sharpened({value, bound}, exact, [&] { return b - exact_dot(a, x); });
  }
  /// l = (b - a.o)/(a.d) = above / -slope.
  static Hits quotient(const detail::Bounded& above, const detail::Bounded& slope, int k) {
    Hits hits;
    if (!above.sign_known() || !slope.sign_known()) {
      hits.status = Status::uncertain;
    } else if (slope.sign() == 0) {
      if (above.sign() == 0) hits.status = Status::coincident;
    } else if (above.sign() * slope.sign() < 0) {
      detail::append_scaled(hits, above.value / -slope.value, 1, k);
    }
    return hits;
  }

  Vector<N> a_;
  double b_;
};

/// (x - c)^T P^-1 (x - c) = 1.
template <std::size_t N>
class Ellipsoid {
  static_assert(N >= 1);

 public:
  /// Refuses a P that is not exactly symmetric, or whose factorisation P = L D L^T meets a pivot that is not
  /// positive beyond the rounding of double-doubles: kappa up to about 2^90 passes.
  Ellipsoid(const Vector<N>& center, const Matrix<N>& P) : center_(center), p_(P) {
    if (!detail::is_finite(center)) throw std::invalid_argument("center is not finite");
    check_symmetric();
    // Axes in units near their own half widths: what is left of the condition number is skewness.
    for (std::size_t i = 0; i < N; ++i) shift_[i] = -floor_half(exponent_of(P[i][i]));
    factorise();
    estimate_condition();
  }
  [[nodiscard]] const Vector<N>& center() const { return center_; }
  [[nodiscard]] const Matrix<N>& matrix() const { return p_; }
  /// An upper estimate of the condition number of P in axes scaled to like widths (at least N^2). Near
  /// 2^40 grazing rays start to be `uncertain` where a double could tell; near 2^90 nearly all are.
  [[nodiscard]] double condition() const { return condition_; }

  [[nodiscard]] Hits hits(const Vector<N>& o, const Vector<N>& d) const {
    if (!detail::is_ray(o, d)) return Hits(Status::invalid);
    // In whitened coordinates the ellipsoid is the unit sphere.
    std::array<int, N> units = shift_;
    const detail::WideVector<N> m = offset_from_center(o, units);
    const int k = std::min(0, normalising_power(m, units)), kd = normalising_power(as_wide(d), shift_);
    const detail::WideVector<N> y = whitened(m, units, k), e = whitened(as_wide(d), shift_, kd);
    return detail::positive_roots(quadratic(y, e, k), kd - k);
  }

 private:
  static int floor_half(int k) { return (k - (k & 1)) / 2; }

  void check_symmetric() const {
    for (std::size_t i = 0; i < N; ++i) {
      if (!detail::is_finite(p_[i])) throw std::invalid_argument("P is not finite");
      for (std::size_t j = 0; j < i; ++j)
        if (p_[i][j] != p_[j][i]) throw std::invalid_argument("P is not symmetric");
      if (!(p_[i][i] > 0)) throw std::invalid_argument("P is not positive definite");
    }
  }
  /// LDL^T of the scaled P (Golub, Van Loan, Matrix Computations, 4th ed., alg. 4.1.2), in double-double.
  void factorise() {
    for (std::size_t j = 0; j < N; ++j) {
      for (std::size_t i = j; i < N; ++i) {
        DoubleDouble sum(scale_by_power(p_[i][j], shift_[i] + shift_[j]));
        const double diagonal = std::fabs(sum.hi);
        for (std::size_t k = 0; k < j; ++k) sum -= lower_[i][k] * lower_[j][k] * pivot_[k];
        if (i > j) {
          lower_[i][j] = sum / pivot_[j];
        } else if (!(sum.hi > 16 * static_cast<double>(N) * detail::kU2 * diagonal)) {
          throw std::invalid_argument("P is not positive definite (or too ill-conditioned to tell)");
        } else {
          pivot_[j] = sum;
        }
      }
    }
  }
  /// trace(P) trace(P^-1) >= the ratio of the extreme eigenvalues.
  void estimate_condition() {
    double trace = 0, inverse_trace = 0;
    for (std::size_t i = 0; i < N; ++i) {
      trace += scale_by_power(p_[i][i], 2 * shift_[i]);
      detail::WideVector<N> unit{};
      unit[i] = 1.0;
      const detail::WideVector<N> column = solved(unit);
      inverse_trace += detail::wide_dot(column, column).hi;
    }
    condition_ = trace * inverse_trace;
  }

  static detail::WideVector<N> as_wide(const Vector<N>& v) {
    detail::WideVector<N> wide;
    std::copy(v.begin(), v.end(), wide.begin());
    return wide;
  }
  /// o - c exactly; coordinates that could overflow are quartered, and their units say so.
  detail::WideVector<N> offset_from_center(const Vector<N>& o, std::array<int, N>& units) const {
    detail::WideVector<N> m;
    for (std::size_t i = 0; i < N; ++i) {
      const bool huge = std::max(std::fabs(o[i]), std::fabs(center_[i])) > 0x1p1000;
      const double scale = huge ? 0.25 : 1.0;
      m[i] = two_sum(scale * o[i], -scale * center_[i]);
      units[i] += huge ? 2 : 0;
    }
    return m;
  }
  /// D^-1/2 L^-1 v.
  detail::WideVector<N> solved(detail::WideVector<N> v) const {
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < i; ++j) v[i] -= lower_[i][j] * v[j];
    for (std::size_t i = 0; i < N; ++i) v[i] = v[i] / sqrt(pivot_[i]);
    return v;
  }
  /// The k that brings the largest v_i 2^units_i near 1; 0 for a zero vector.
  static int normalising_power(const detail::WideVector<N>& v, const std::array<int, N>& units) {
    int largest = kNothing;
    for (std::size_t i = 0; i < N; ++i)
      if (v[i].hi != 0) largest = std::max(largest, exponent_of(v[i].hi) + units[i]);
    return largest == kNothing ? 0 : -largest;
  }
  /// D^-1/2 L^-1 applied to v_i 2^(units_i + k).
  detail::WideVector<N> whitened(detail::WideVector<N> v, const std::array<int, N>& units, int k) const {
    for (std::size_t i = 0; i < N; ++i)
      v[i] = {scale_by_power(v[i].hi, k + units[i]), scale_by_power(v[i].lo, k + units[i])};
    return solved(v);
  }

  /// The unit sphere becomes one of radius 2^k.
  detail::Quadratic quadratic(const detail::WideVector<N>& y, const detail::WideVector<N>& e, int k) const {
    const DoubleDouble a = detail::wide_dot(e, e), b = detail::wide_dot(y, e), m2 = detail::wide_dot(y, y);
    const DoubleDouble foot2 = detail::foot_square(y, e, -b / a);
    // A radius below 2^-500 of the distance drowns in the bounds; its square must only not underflow.
    const double r2 = scale_by_power(1, 2 * std::max(k, -500));
    // Solving with L and D is exact for a P that is off by 4 N u^2 kappa (Higham, ch. 10, first order), and
    // for m and d by other such amounts: the latter shows as a shift of the foot, seen from p.
    const double n = static_cast<double>(N);
    const double eta = 32 * (n + 4) * n * detail::kU2 * condition_;
    const double h_bound = eta * (foot2.hi + r2 + std::sqrt(foot2.hi * m2.hi)) + eta * eta * m2.hi;
    return {a,
            {b, eta * std::sqrt(a.hi * m2.hi)},
            {m2 - r2, eta * (m2.hi + r2)},
            {a * (r2 - foot2), 2 * a.hi * h_bound}};
  }

  /// Below every exponent of a scaled double.
  static constexpr int kNothing = -5000;

  Vector<N> center_;
  Matrix<N> p_;
  std::array<int, N> shift_{};
  std::array<detail::WideVector<N>, N> lower_{};
  detail::WideVector<N> pivot_{};
  double condition_ = 0;
};

}  // namespace graze::nd
