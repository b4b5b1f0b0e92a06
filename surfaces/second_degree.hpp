// Rays against surfaces of second degree: the count decided exactly, the equation posed without cancellation.
//
// Solves:  f(o + l d) = A l^2 + 2 B l + C = 0 for l > 0, f a polynomial of degree 2 whose coefficients are
//          exact numbers (sphere, ellipsoid, quadric).
// Needs:   a Form, a plain struct with
//            template <class T> std::array<T, 3> along(const std::array<T, 3>& x, const std::array<T, 3>& d)
//              const;  // {f(x), half its derivative along d, A} for T = double, DoubleDouble, Magnitude,
//                      // Expansion, in fewer than 2^7 roundings
// Returns: equations whose real roots in the posed interval are the hits and no others: none for a miss,
//          c0 + c1 delta for a touch (kind kTouch: the exact double root) and where A or C is zero; settles
//          coincident when A, B and C all are, failed where numbers leave the range of double.
// Error:   each coefficient within 1 ulp of its exact value, so that roots carry a few ulps.
// Cost:    60 to 250 double-double operations a ray, 0.1 to 0.4 us; a few us where expansions decide.
// Source:  Kahan, "On the cost of floating-point computation without extra-precise arithmetic", 2004, for
//          why b^2 - ac decides; the choice of the frame, the filter and the exact fallback are graze's own
//          (surfaces/quadric.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/coefficients.hpp>
#include <graze/surfaces/exact.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze::second_degree {

/// What a sum of products would be if nothing cancelled: the size that its rounding errors scale with.
class Magnitude {
 public:
  Magnitude() = default;
  explicit Magnitude(double x) : size_(std::fabs(x)) {}
  [[nodiscard]] double size() const { return size_; }

  friend Magnitude operator+(Magnitude a, Magnitude b) { return Magnitude(a.size_ + b.size_); }
  friend Magnitude operator-(Magnitude a, Magnitude b) { return a + b; }
  friend Magnitude operator*(Magnitude a, Magnitude b) { return Magnitude(a.size_ * b.size_); }

 private:
  double size_ = 0;
};

/// What a number's bits would be if nothing cancelled, and whether Expansions have lost none of them on the
/// way to it.
class Exactness {
 public:
  Exactness() = default;
  explicit Exactness(double x) : bits_(x) {}
  [[nodiscard]] bool is_exact() const { return is_exact_; }

  friend Exactness operator+(const Exactness& a, const Exactness& b) { return {a.bits_ | b.bits_, a, b}; }
  friend Exactness operator-(const Exactness& a, const Exactness& b) { return a + b; }
  friend Exactness operator*(const Exactness& a, const Exactness& b) { return {a.bits_ * b.bits_, a, b}; }

 private:
  Exactness(const Bits& bits, const Exactness& a, const Exactness& b)
      : bits_(bits), is_exact_(a.is_exact_ && b.is_exact_ && bits.is_exact()) {}

  Bits bits_;
  bool is_exact_ = true;
};

template <class T>
using Triple = std::array<T, 3>;

/// An exact coefficient of a surface, ready for every arithmetic that a Form is called in.
class Coefficient {
 public:
  Coefficient() = default;
  explicit Coefficient(const Expansion& x) : exact_(x), wide_(x.to_double_double()) {}
  [[nodiscard]] const Expansion& exact() const { return exact_; }
  [[nodiscard]] double value() const { return wide_.hi; }

  template <class T>
  [[nodiscard]] T as() const {
    if constexpr (std::is_same_v<T, Expansion>) {
      return exact_;
    } else if constexpr (std::is_same_v<T, DoubleDouble>) {
      return wide_;
    } else if constexpr (std::is_same_v<T, Interval>) {
      return wide_.lo == 0 ? point(wide_.hi) : Interval{next_below(wide_.hi), next_above(wide_.hi)};
    } else if constexpr (std::is_same_v<T, Dyadic> || std::is_same_v<T, Exactness>) {
      T sum;
      for (const double part : exact_.parts()) sum = sum + T(part);
      return sum;
    } else {
      return static_cast<T>(wide_.hi);
    }
  }

 private:
  Expansion exact_;
  DoubleDouble wide_;
};

/// f(x) = y.(M y) + 2 g.y + j for y = x - centre, M symmetric.
struct QuadraticForm {
  Vec3 centre;
  std::array<Triple<Coefficient>, 3> m;
  Triple<Coefficient> g;
  Coefficient j;

  /// M y.
  template <class T>
  [[nodiscard]] Triple<T> times(const Triple<T>& y) const {
    Triple<T> product;
    for (std::size_t i = 0; i < 3; ++i) {
      product[i] = m[i][0].as<T>() * y[0] + m[i][1].as<T>() * y[1] + m[i][2].as<T>() * y[2];
    }
    return product;
  }
  template <class T>
  [[nodiscard]] Triple<T> from_centre(const Triple<T>& x) const {
    return {x[0] - exactly<T>(centre.x), x[1] - exactly<T>(centre.y), x[2] - exactly<T>(centre.z)};
  }
  /// Half the gradient at x.
  template <class T>
  [[nodiscard]] Triple<T> slope(const Triple<T>& x) const {
    Triple<T> s = times(from_centre(x));
    for (std::size_t i = 0; i < 3; ++i) s[i] = s[i] + g[i].as<T>();
    return s;
  }
  template <class T>
  [[nodiscard]] Triple<T> along(const Triple<T>& x, const Triple<T>& d) const {
    const Triple<T> y = from_centre(x), s = slope(x), md = times(d);
    const auto dot3 = [](const Triple<T>& a, const Triple<T>& b) {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    const T linear = g[0].as<T>() * y[0] + g[1].as<T>() * y[1] + g[2].as<T>() * y[2];
    return {dot3(y, s) + (linear + j.as<T>()), dot3(d, s), dot3(d, md)};
  }
};

// ------------------------------------------------------------------------------------------- exact numbers

/// The point at l = centre + delta: exact for T = Expansion and Dyadic, within 6 u^2 of each coordinate in
/// double-doubles however much cancels, rounded once for double.
template <class T>
Triple<T> point_on(const LocalRay& ray, double delta = 0) {
  if constexpr (std::is_same_v<T, Dyadic> || std::is_same_v<T, Exactness>) {
    const Triple<T> o = origin_as<T>(ray), d = direction_as<T>(ray);
    const T l = T(ray.centre) + T(delta);
    return {o[0] + l * d[0], o[1] + l * d[1], o[2] + l * d[2]};
  }
  const auto coordinate = [&](double o, double d) {
    if constexpr (std::is_same_v<T, Expansion>) {
      return Expansion(o) + Expansion(ray.centre) * d + Expansion(delta) * d;
    } else {
      const DoubleDouble x = ray.centre == 0 ? DoubleDouble(o) : two_prod(ray.centre, d) + o;
      const DoubleDouble moved = delta == 0 ? x : x + two_prod(delta, d);
      if constexpr (std::is_same_v<T, DoubleDouble>)
        return moved;
      else
        return T(moved.hi);
    }
  };
  return {coordinate(ray.o.x, ray.d.x), coordinate(ray.o.y, ray.d.y), coordinate(ray.o.z, ray.d.z)};
}

template <class T>
Triple<T> direction_of(const LocalRay& ray) {
  return direction_as<T>(ray);
}

/// The hit's position seen from c, good to an ulp a coordinate also where c is far from the origin.
inline Vec3 seen_from(Vec3 c, const LocalRay& ray, double delta) {
  const Triple<DoubleDouble> x = point_on<DoubleDouble>(ray, delta);
  return {(x[0] - c.x).hi, (x[1] - c.y).hi, (x[2] - c.z).hi};
}

/// A unit vector for u, v in [0, 1), uniform in area; each coordinate within a few ulps of 1.
inline Vec3 on_unit_sphere(double u, double v) {
  const double y = 2 * u - 1;
  const double radius = 2 * std::sqrt(u * (1 - u));
  const double theta = 2 * std::numbers::pi * v;
  return normalized({radius * std::cos(theta), y, radius * std::sin(theta)});
}

/// A real number with its exact sign, within an ulp.
struct Sharp {
  double value = 0;

  [[nodiscard]] int sign() const { return value < 0 ? -1 : value > 0 ? 1 : 0; }
  [[nodiscard]] double size() const { return std::fabs(value); }
  /// Rounded, or enclosed.
  template <class T>
  [[nodiscard]] T as() const {
    if constexpr (std::is_same_v<T, Interval>) {
      return value == 0 ? Interval{} : Interval{next_below(value), next_above(value)};
    } else {
      return static_cast<T>(value);
    }
  }
};

/// Which of C, k B, A are the coefficients of an equation, in ascending powers from the one at `first` on.
struct Slice {
  std::size_t first = 0;
  double factor = 2;  ///< k: 2, or 1 for the linear equation of a double root
};

/// The exact coefficients of a ray's equation, for SphereForm and QuadraticForm; none in a build without the
/// solvers that end in integers (second_degree_exact.cpp, second_degree_rounded.cpp).
template <class Form>
ExactCoefficients exact_coefficients(EquationBlock& block, const Form& form, const LocalRay& ray,
                                     Slice slice);

/// Poses a ray whose coefficients leave the range of double: rounded to a common power of two, with bounds,
/// and exactly. False, and nothing posed, where the block's solver cannot use that.
template <class Form>
bool pose_beyond_range(EquationBlock& block, const Form& form, const LocalRay& ray);

/// Measures l in other units where roots are near the ends of double in the local ones: a power of two moves
/// from l to d. Needs: a ray about its origin. Nothing is done in a build without exact
/// coefficients.
template <class Form>
void keep_in_range(const Form& form, LocalRay& ray);

/// The coefficients of f about l = centre, and their discriminant.
template <class Form>
class Along {
 public:
  Along(const Form& form, const LocalRay& ray)
      : form_(form),
        ray_(ray),
        wide_(form.along(point_on<DoubleDouble>(ray), direction_of<DoubleDouble>(ray))),
        size_(form.along(point_on<Magnitude>(ray), direction_of<Magnitude>(ray))) {
    for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
      sharp_[i] = sharpened(wide_[i], size_[i].size(), [i](const auto& q) { return q[i]; });
    }
    // At the vertex B is all but zero, and need only be known to a small part of an ulp of l times A.
    const double allowed = 0x1p-12 * ulp(ray.centre) * sharp_[2].size();
    const bool is_small = ray.centre != 0 && allowed > kFloor && kError * size_[1].size() <= allowed;
    sharp_[1] = is_small ? Sharp{wide_[1].hi}
                         : sharpened(wide_[1], size_[1].size(), [](const auto& q) { return q[1]; });
  }

  /// Finite, and no coefficient so small that quotients and enclosures of it lose digits.
  [[nodiscard]] bool is_in_range() const {
    const auto has_digits = [](const Sharp& x) { return x.value == 0 || x.size() > 0x1p-960; };
    // At the vertex B and C are what rounding has left of zero.
    const bool is_at_vertex = ray_.centre != 0;
    return is_finite() && (is_at_vertex || (has_digits(sharp_[0]) && has_digits(sharp_[1]))) &&
           has_digits(sharp_[2]);
  }
  /// No overflow, and no NaN, in what was computed.
  [[nodiscard]] bool is_finite() const {
    return std::isfinite(size_[0].size()) && std::isfinite(size_[1].size()) &&
           std::isfinite(size_[2].size()) && std::isfinite(discriminant_size());
  }
  [[nodiscard]] const Sharp& c() const { return sharp_[0]; }
  [[nodiscard]] const Sharp& b() const { return sharp_[1]; }
  [[nodiscard]] const Sharp& a() const { return sharp_[2]; }
  /// B^2 - A C.
  [[nodiscard]] Sharp discriminant() const {
    return sharpened(sqr(wide_[1]) - wide_[2] * wide_[0], discriminant_size(),
                     [](const auto& q) { return q[1] * q[1] - q[2] * q[0]; });
  }
  /// For the equation whose coefficients these are, or some of them.
  [[nodiscard]] ExactCoefficients exact(EquationBlock& block, Slice slice = {}) const {
    ExactCoefficients exact = exact_coefficients(block, form_, ray_, slice);
    if (exact.get != nullptr && block.digits() >= Digits::near) exact.near = near(block, slice);
    return exact;
  }

 private:
  /// The slice's coefficients in double-double, those of all higher powers; none where low parts underflow.
  [[nodiscard]] std::span<const DoubleDoubleBall> near(EquationBlock& block, Slice slice) const {
    const std::span<DoubleDoubleBall> balls = block.arena().array<DoubleDoubleBall>(3 - slice.first);
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const std::size_t power = slice.first + i;
      const double size = size_[power].size(), factor = power == 1 ? slice.factor : 1;
      if (size == 0) continue;  // no term: zero
      if (!(size > kFloor)) return {};
      balls[i] = {scaled(wide_[power], factor), factor * kError * size};
    }
    return balls;
  }
  [[nodiscard]] double discriminant_size() const {
    return size_[1].size() * size_[1].size() + size_[2].size() * size_[0].size();
  }
  /// The formula of C, B, A, rounded to the nearest double but never to zero: by expansions, or by integers
  /// where those would lose bits.
  template <class Formula>
  [[nodiscard]] [[gnu::noinline]] double exact_value(const Formula& formula) const {  // rare: not inlined
    if (ray_.is_exact && formula(along<Exactness>()).is_exact()) return formula(along<Expansion>()).value();
    const Dyadic exact = formula(along<Dyadic>());
    const double value = exact.to_double();
    return value == 0 ? exact.sign() * std::numeric_limits<double>::denorm_min() : value;
  }
  template <class T>
  [[nodiscard]] Triple<T> along() const {
    return form_.along(point_on<T>(ray_), direction_of<T>(ray_));
  }
  /// Fewer than 2^7 roundings of 8 u^2 each leave 2^-96 of the size open: less than 2^-56 of a value that is
  /// at least 2^-40 of it. What falls below is computed exactly.
  template <class Formula>
  [[nodiscard]] Sharp sharpened(const DoubleDouble& wide, double size, const Formula& formula) const {
    if (!std::isfinite(size)) return {size};
    return {std::fabs(wide.hi) >= 0x1p-40 * size && size > kFloor ? wide.hi : exact_value(formula)};
  }
  static constexpr double kError = 0x1p-96;   ///< of double-doubles, times the size
  static constexpr double kFloor = 0x1p-800;  ///< below, low parts of products underflow

  const Form& form_;
  const LocalRay& ray_;
  Triple<DoubleDouble> wide_;
  Triple<Magnitude> size_;
  Triple<Sharp> sharp_;
};

/// A point near the surface moved onto it along the gradient: two Newton steps, good to a few ulps away from
/// singular points. Form: QuadraticForm.
inline Vec3 polished(const QuadraticForm& form, Vec3 start) {
  Triple<DoubleDouble> x{start.x, start.y, start.z};
  for (int step = 0; step < 2; ++step) {
    const Triple<DoubleDouble> slope = form.slope(x);
    const Triple<DoubleDouble> q = form.along(x, slope);
    // f(x + t s) = f + 2 t s.s + ..., s half the gradient: q[1] is s.s.
    if (!(q[1].hi > 0)) break;
    const DoubleDouble t = q[0] / q[1];
    for (std::size_t i = 0; i < 3; ++i) x[i] = x[i] - 0.5 * (t * slope[i]);
  }
  return {x[0].hi, x[1].hi, x[2].hi};
}

/// Half the gradient at a point, each coordinate as good as double-doubles make it.
inline Vec3 slope_at(const QuadraticForm& form, const Triple<DoubleDouble>& x) {
  const Triple<DoubleDouble> s = form.slope(x);
  return {s[0].hi, s[1].hi, s[2].hi};
}

/// adj(M) and det(M) of a symmetric matrix, exactly.
struct ExactInverse {
  std::array<Triple<Expansion>, 3> adjugate;
  Expansion determinant;

  explicit ExactInverse(const std::array<Triple<Expansion>, 3>& m) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        adjugate[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
      }
    }
    determinant = m[0][0] * adjugate[0][0] + m[0][1] * adjugate[1][0] + m[0][2] * adjugate[2][0];
  }
};

// --------------------------------------------------------------------------------------------------- frame

/// Moves p to l = centre, unless the numbers leave the range of double.
inline void move_to(LocalRay& ray, double centre) {
  LocalRay moved = ray;
  set_centre(moved, centre);
  if (std::isfinite(centre) && is_finite(moved.p)) ray = moved;
}

/// Moves p to the vertex of f along the ray, l = -B/A, to within an ulp or so of l. Needs: an A that is more
/// than the rounding of double-doubles.
template <class Form>
void move_to_vertex(const Form& form, LocalRay& ray) {
  const auto q = form.along(point_on<DoubleDouble>(ray), direction_of<DoubleDouble>(ray));
  move_to(ray, ray.centre - (q[1] / q[2]).hi);
}

enum class Frame { origin, vertex };

/// From |AC| <= B^2/2 on the roots differ by more than their size: each has its own accuracy from the origin,
/// and nothing cancels in B^2 - AC. Otherwise their difference is what matters: from the vertex.
inline Frame frame_of(double a, double b, double c) {
  return (a < 0) == (c < 0) && std::fabs(a) * std::fabs(c) > 0.5 * b * b ? Frame::vertex : Frame::origin;
}

/// Whether a root, about -b/2a or -c/2b, may be near the ends of the range of double.
inline bool has_far_roots(double a, double b, double c) {
  const auto is_far = [](double x, double y) {
    const double size = std::fabs(x), other = std::fabs(y);
    return size > 0 && other > 0 && (size > 0x1p1000 * other || other > 0x1p1000 * size);
  };
  return is_far(a, b) || is_far(b, c);
}

/// Chooses the frame of a ray that is still about its origin; false: certainly no hit. With `vertex` A and C
/// have one sign, so that both roots have the sign of centre.
template <class Form>
bool choose_frame(const Form& form, LocalRay& ray) {
  const auto q = form.along(point_on<double>(ray), direction_of<double>(ray));
  const auto size = form.along(point_on<Magnitude>(ray), direction_of<Magnitude>(ray));
  // Fewer than 2^7 roundings; where they could change the choice or a sign that it rests on, exactly.
  const auto error = [&](std::size_t i) { return 0x1p-46 * size[i].size(); };
  const double ac = std::fabs(q[0] * q[2]);
  const double ac_error = error(0) * size[2].size() + size[0].size() * error(2);
  const double b2_error = 2 * size[1].size() * error(1);
  const bool clear = ray.is_exact && std::fabs(ac - 0.5 * q[1] * q[1]) > ac_error + b2_error;
  double a = q[2], b = q[1], c = q[0];
  bool is_plain = true;
  const bool is_small = !(size[1].size() > 0x1p-900);  // where underflow could count
  if (!clear || (frame_of(a, b, c) == Frame::vertex && (std::fabs(b) <= error(1) || is_small))) {
    const Along<Form> exact(form, ray);
    if (!exact.is_in_range()) {
      keep_in_range(form, ray);
      return true;  // left to the formulation, which settles it
    }
    is_plain = false;
    a = exact.a().value;
    b = exact.b().value;
    c = exact.c().value;
  }
  if (frame_of(a, b, c) == Frame::origin) {
    if (has_far_roots(a, b, c)) keep_in_range(form, ray);
    return true;
  }
  if (b == 0 || (b < 0) == (a < 0)) return false;
  // Near a cone's apex A and B can cancel below double-doubles.
  if (is_plain) {
    move_to_vertex(form, ray);
  } else {
    move_to(ray, -b / a);
  }
  return true;
}

/// clip of a surface that lies within `reach` of c: frame, and a range of delta that holds every hit. Origins
/// further than 4 reach away are outside, and recentred before anything is squared.
template <class Form>
bool clip_ball(const Form& form, Vec3 c, double reach, LocalRay& ray) {
  recentre(ray, c, 4 * reach);
  if (ray.centre == 0) {
    if (!choose_frame(form, ray)) return false;
  } else {
    if (ray.centre > 0) move_to_vertex(form, ray);
    if (ray.centre <= 0) return false;
  }
  // |delta d| <= |p - c| + reach; the margin covers the roundings of these lines.
  ray.hi = (norm(seen_from(c, ray, 0)) + reach) / norm(ray.d) * (1 + 0x1p-40);
  ray.lo = std::max(-ray.centre, -ray.hi);
  return true;
}

// ---------------------------------------------------------------------------------------------------- pose

enum Kind : std::uint32_t { kSimple, kTouch };

/// Wider than the rounding of roots in float.
inline constexpr double kSlack = 0x1p-16;

/// c0 + c1 x (+ c2 x^2) on [lo, hi], widened by kSlack.
template <std::size_t N>
void pose_on(EquationBlock& block, const LocalRay& ray, Kind kind, double lo, double hi,
             const std::array<Sharp, N>& c, const ExactCoefficients& exact) {
  const double low = lo < 0 ? lo * (1 + kSlack) : lo * (1 - kSlack);
  const double high = hi * (1 + kSlack);
  // A root beyond the range of double has no number.
  if (std::isinf(high)) return block.settle(Status::uncertain);
  if (!(low <= high)) return;
  const auto rounded = [&](auto number) {
    using T = decltype(number);
    std::array<T, N> values{};
    for (std::size_t i = 0; i < N; ++i) values[i] = c[i].template as<T>();
    return values;
  };
  pose_in_delta(block, kind, low, high, ray.seed(), static_cast<int>(N) - 1, rounded, exact);
}

inline Sharp twice(const Sharp& x) { return {2 * x.value}; }

/// The one root -c0/c1.
inline void pose_linear(EquationBlock& block, const LocalRay& ray, Kind kind, const Sharp& c0,
                        const Sharp& c1, const ExactCoefficients& exact, double slack = 0) {
  const double root = -c0.value / c1.value;
  pose_on<2>(block, ray, kind, root - slack, root + slack, {c0, c1}, exact);
}

/// Two roots offset +- half, so close that their l may round to one double: the nearest doubles, or the next
/// pair of neighbours, so that two hits stay two. An ulp of l at most.
inline void pose_neighbours(EquationBlock& block, const LocalRay& ray, double offset, double half) {
  const double spacing = ulp(ray.centre);
  double near = std::round((offset - half) / spacing), far = std::round((offset + half) / spacing);
  if (near == far) (offset < near * spacing ? near : far) += offset < near * spacing ? -1 : 1;
  // Two numbers of a few bits, times the spacing: the equation's coefficients are exact.
  const std::array<Sharp, 3> c{{{near * far * spacing}, {-(near + far)}, {1 / spacing}}};
  const double reach = (std::max(std::fabs(near), std::fabs(far)) + 1) * spacing;
  const auto exactly_as = [&](auto number) {
    using T = decltype(number);
    return std::array<T, 3>{exactly<T>(c[0].value), exactly<T>(c[1].value), exactly<T>(c[2].value)};
  };
  pose_in_delta(block, kSimple, -reach, reach, ray.seed(), 2, exactly_as);
}

/// Both roots about the vertex, where B is all but zero: -B/A +- h, h = sqrt(D)/|A|.
template <class Form>
void pose_at_vertex(EquationBlock& block, const LocalRay& ray, const Along<Form>& q) {
  const Sharp d = q.discriminant();
  if (d.sign() < 0) return;
  const double offset = q.b().size() / q.a().size();
  if (d.sign() == 0) {
    // The vertex lies within an ulp or so of centre: 2^-30 of it is room enough.
    return pose_linear(block, ray, kTouch, q.b(), q.a(), q.exact(block, {1, 1}),
                       offset + 0x1p-30 * std::fabs(ray.centre));
  }
  const double half = std::sqrt(d.value) / q.a().size();
  const double reach = half + offset;
  // So near that C has lost its digits, neighbours are within an ulp of both.
  constexpr double kNear = 0x1p-300;
  const double spacing = ulp(ray.centre);
  if (half < spacing && (block.digits() < Digits::placed || half < kNear * spacing))
    return pose_neighbours(block, ray, -q.b().value / q.a().value, half);
  pose_on<3>(block, ray, kSimple, -reach, reach, {q.c(), twice(q.b()), q.a()}, q.exact(block));
}

/// One positive root, A and C of opposite signs: it lies between bounds that differ by a factor of 2 or so,
/// from 2|B|, sqrt|AC| <= |B| + sqrt(B^2 + |AC|) <= 2|B| + sqrt|AC|.
template <class Form>
void pose_from_inside(EquationBlock& block, const LocalRay& ray, const Along<Form>& q) {
  const double a = q.a().size(), b = q.b().size(), c = q.c().size();
  const double middle = std::sqrt(a) * std::sqrt(c);
  const double least = std::max(2 * b, middle), most = 2 * b + middle;
  const bool far = q.b().sign() * q.a().sign() < 0;
  const double lo = far ? least / a : c / most;
  const double hi = far ? most / a : c / least;
  pose_on<3>(block, ray, kSimple, lo, hi, {q.c(), twice(q.b()), q.a()}, q.exact(block));
}

/// Two positive roots, |C/2B| <= near <= |C/B| and |B/A| <= far <= |2B/A|: an equation each, since a solver's
/// tolerance for the far one could swallow the near one.
template <class Form>
void pose_from_outside(EquationBlock& block, const LocalRay& ray, const Along<Form>& q) {
  const Sharp d = q.discriminant();
  if (d.sign() < 0) return;
  if (d.sign() == 0) return pose_linear(block, ray, kTouch, q.b(), q.a(), q.exact(block, {1, 1}));
  const double a = q.a().size(), b = q.b().size(), c = q.c().size();
  const std::array<Sharp, 3> coefficients{q.c(), twice(q.b()), q.a()};
  const ExactCoefficients exact = q.exact(block);
  pose_on<3>(block, ray, kSimple, 0.5 * c / b, c / b, coefficients, exact);
  pose_on<3>(block, ray, kSimple, b / a, 2 * b / a, coefficients, exact);
}

/// About the ray's own origin, by the exact signs of A, B, C and the discriminant.
template <class Form>
void pose_at_origin(EquationBlock& block, const LocalRay& ray, const Along<Form>& q) {
  const int a = q.a().sign(), b = q.b().sign(), c = q.c().sign();
  if (a == 0) {
    if (b == 0 && c == 0) return block.settle(Status::coincident);
    if (b * c < 0) pose_linear(block, ray, kSimple, q.c(), twice(q.b()), q.exact(block));
  } else if (c == 0) {
    // The ray starts on the surface: that root is no hit, the other one is -2B/A.
    if (a * b < 0) pose_linear(block, ray, kSimple, twice(q.b()), q.a(), q.exact(block, {1, 2}));
  } else if (a * c < 0) {
    pose_from_inside(block, ray, q);
  } else if (a * b < 0) {
    pose_from_outside(block, ray, q);
  }
}

/// Poses the ray's equation. Needs: a ray for which choose_frame chose the frame.
template <class Form>
void pose(const Form& form, const LocalRay& ray, EquationBlock& block) {
  const Along<Form> q(form, ray);
  if (!q.is_in_range()) {
    if (pose_beyond_range(block, form, ray)) return;
    if (!q.is_finite()) return block.settle(Status::failed);
    // Enclosures would have to hold what the numbers have lost.
    if (block.form() == graze::Form::interval) return block.settle(Status::uncertain);
  }
  if (ray.centre == 0) return pose_at_origin(block, ray, q);
  pose_at_vertex(block, ray, q);
}

inline void lift(const Posed& posed, const Root& root, std::vector<LocalHit>& hits) {
  hits.push_back(
      {.multiplicity = posed.kind == kTouch ? 2 : root.multiplicity, .delta = root.x, .is_root = true});
}

/// Poses a polynomial in l about the ray's own origin, as a document states it: for formulations that are
/// there to be compared.
template <class Make>
void pose_about_origin(EquationBlock& block, const LocalRay& ray, const Make& make) {
  const double lo = ray.lo + ray.centre, hi = ray.hi + ray.centre;
  pose_in_delta(block, kSimple, std::max(0.0, lo - kSlack * std::fabs(lo)), hi + kSlack * std::fabs(hi),
                ray.seed(), 2, make);
}
inline void lift_from_origin(const LocalRay& ray, const Root& root, std::vector<LocalHit>& hits) {
  hits.push_back({.multiplicity = root.multiplicity, .delta = root.x - ray.centre});
}

}  // namespace graze::second_degree
