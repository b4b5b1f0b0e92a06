// What the flat figures (plane, triangle, polygon, disk) share: the plane n.x = b in exact numbers, decisions
// by exact signs, and the linear equation c0 + c1 delta = 0 that a ray poses to it.
//
// solves        n.(o + l d) = b, and on which side of what the ray passes
// needs         a ray in the figure's local frame (local_ray.hpp)
// shapes        n, b of any length, as ExactNumber; coefficients ascending in delta = l - centre
// returns       an equation for a ray that meets the figure; nothing for one that does not;
//               Status::uncertain where a sign is beyond intervals and the figure's numbers are not exact in
//               its units;
//               Status::failed where the ray's numbers leave double in the figure's units, but for solvers
//               that prove their answers: those are answered by integers
// error         decisions: none. Coefficients: 1 ulp each; l within 4 ulps with closed_form (measured:
//               3.97)
// cost          some 20 interval operations a sign; expansions (0.2 ... 1 us) where those cannot tell
// source        document 001 and 002 for the figures; Shewchuk 1997 and solvers/math/interval.hpp for the
//               signs
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/exact.hpp>
#include <graze/surfaces/recentred_ball.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze::planar {

// --------------------------------------------------------------------------------------------- exact numbers

/// The bits of a number and of zero, taken for a multiple of 2^0; what is not finite does not count.
inline Bits bits_of(double x) {
  const Bits zero(0, 0);
  return std::isfinite(x) ? zero | Bits(x) : zero;
}
inline Bits bits_of(Vec3 v) { return bits_of(v.x) | bits_of(v.y) | bits_of(v.z); }
inline Bits bits_of(std::span<const Vec3> points) {
  Bits bits(0, 0);
  for (const Vec3& v : points) bits = bits | bits_of(v);
  return bits;
}

/// Expansions hold such numbers: no part below the least subnormal, sums of 2^23 terms below 2^1023.
inline bool is_exact(const Bits& bits) {
  constexpr int kSum = 23;
  return bits.is_exact(kSum);
}

/// A number known exactly, with the enclosure that decides most questions faster.
struct ExactNumber {
  Interval near;
  Expansion exact;

  ExactNumber() = default;
  explicit ExactNumber(double x) : near(point(x)), exact(x) {}
  explicit ExactNumber(Expansion x) : near(enclose(x)), exact(std::move(x)) {}

  template <class T>
  [[nodiscard]] T as() const {
    if constexpr (std::is_same_v<T, Interval>) {
      return near;
    } else if constexpr (std::is_same_v<T, Expansion>) {
      return exact;
    } else if constexpr (std::is_same_v<T, DoubleDoubleBall>) {
      return exact.parts().size() <= 1 ? T(exact.value()) : nearest_ball(exact);
    } else if constexpr (std::is_same_v<T, Dyadic>) {
      T sum;
      for (const double part : exact.parts()) sum += T(part);
      return sum;
    } else {
      return static_cast<T>(mid(near));
    }
  }
  [[nodiscard]] Bits bits() const {
    Bits bits = bits_of(0);
    for (const double part : exact.parts()) bits = bits | bits_of(part);
    return bits;
  }
};

/// x 2^k, and whether that is exact: what underflows is enclosed instead.
inline ExactNumber scaled_number(double x, int k, bool& exact) {
  const double value = scale_by_power(x, k);
  ExactNumber number(value);
  if (std::isfinite(value) && scale_by_power(value, -k) == x) return number;
  exact = false;
  number.near = {next_below(value), next_above(value)};
  return number;
}

/// Signs and enclosures of formulas: intervals first, expansions if they are exact for the numbers at hand,
/// else integers if those hold the figure.
class Judge {
 public:
  explicit Judge(bool exact, bool integers = false) : exact_(exact), integers_(integers) {}

  /// -1, 0, 1; a sign that nothing can tell makes the judge `undecided`.
  template <class Formula>
  int sign(const Formula& formula) {
    std::optional<int> told = sign_of(formula(Interval{}), exact_, [&] { return formula(Expansion{}); });
    if (!told && integers_) told = formula(Dyadic()).sign();
    undecided_ = undecided_ || !told;
    return told.value_or(0);
  }

  /// An enclosure no wider than `relative` times its magnitude, as far as the numbers allow.
  template <class Formula>
  [[nodiscard]] Interval enclosure(const Formula& formula, double relative = kSharp) const {
    const Interval told = sharp_enclosure(formula, exact_, relative);
    if (exact_ || !integers_ || width(told) <= relative * mig(told)) return told;
    const Dyadic value = formula(Dyadic());
    return {value.round_down(), value.round_up()};
  }

  [[nodiscard]] bool undecided() const { return undecided_; }

  /// Two ulps wide: the middle is then within one ulp.
  static constexpr double kSharp = 0x1p-51;

 private:
  bool exact_, integers_;
  bool undecided_ = false;
};

// --------------------------------------------------------------------------------------------- small algebra

template <class T>
using Array3 = std::array<T, 3>;

template <class T>
Array3<T> exactly(Vec3 v) {
  return {graze::exactly<T>(v.x), graze::exactly<T>(v.y), graze::exactly<T>(v.z)};
}
template <class T>
Array3<T> difference(const Array3<T>& a, const Array3<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
T inner(const Array3<T>& a, const Array3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Array3<T> outer(const Array3<T>& a, const Array3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// The determinant with rows a, b, c.
template <class T>
T volume(const Array3<T>& a, const Array3<T>& b, const Array3<T>& c) {
  return inner(a, outer(b, c));
}

/// The axis of the largest |v_k|, the smallest such index.
inline std::size_t largest_axis(Vec3 v) {
  std::size_t axis = std::fabs(v.y) > std::fabs(v.x) ? 1 : 0;
  if (std::fabs(v.z) > std::fabs(component(v, axis))) axis = 2;
  return axis;
}

/// Two unit vectors that make a right-handed frame with the unit vector n.
inline std::array<Vec3, 2> tangents(Vec3 n) {
  // Crossed with the axis that n is farthest from, so that nothing cancels.
  const Vec3 size{std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)};
  const Vec3 axis = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                    : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                         : Vec3{0, 0, 1};
  const Vec3 first = normalized(cross(n, axis));
  return {first, cross(n, first)};
}

// ------------------------------------------------------------------------------------------------- the plane

/// n.x = b in local units, exactly.
struct ExactPlane {
  Array3<ExactNumber> n;
  ExactNumber b;
  bool exact = true;  ///< false: expansions do not hold these numbers, enclosures only
  Bits n_bits, b_bits;

  template <class T>
  [[nodiscard]] Array3<T> normal() const {
    return {n[0].as<T>(), n[1].as<T>(), n[2].as<T>()};
  }
  [[nodiscard]] Vec3 unit_normal() const {
    return normalized({mid(n[0].near), mid(n[1].near), mid(n[2].near)});
  }
  /// n.d
  template <class T>
  [[nodiscard]] T slope(const LocalRay& ray) const {
    return inner(normal<T>(), direction_as<T>(ray));
  }
  /// n.x - b
  template <class T>
  [[nodiscard]] T height(const Array3<T>& x) const {
    return inner(normal<T>(), x) - b.as<T>();
  }
  void note_bits() {
    n_bits = n[0].bits() | n[1].bits() | n[2].bits();
    b_bits = b.bits();
  }
  /// Whether expansions are exact for slope and height of this ray.
  [[nodiscard]] bool holds(const LocalRay& ray) const {
    const Bits along = bits_of(ray.d) * bits_of(ray.centre);
    const Bits point = bits_of(ray.o) | along | bits_of(ray.d);
    return exact && ray.is_exact && is_exact(n_bits * point) && is_exact(b_bits);
  }
};

/// The sum over the edges of (v_i - v_0) x (v_{i+1} - v_0) (Newell), in T.
template <class T>
Array3<T> newell_normal(std::span<const Vec3> v) {
  const Array3<T> base = planar::exactly<T>(v[0]);
  Array3<T> sum{};
  for (std::size_t i = 1; i + 1 < v.size(); ++i) {
    const Array3<T> part =
        outer(difference(planar::exactly<T>(v[i]), base), difference(planar::exactly<T>(v[i + 1]), base));
    for (std::size_t k = 0; k < 3; ++k) sum[k] = sum[k] + part[k];
  }
  return sum;
}

/// The plane through v_0 with the Newell normal of the vertices, brought up to a largest |n_i| of at least
/// about 1 by a power of two (so that it does not underflow in float). n may be zero: see is_degenerate.
inline ExactPlane plane_of(std::span<const Vec3> v) {
  ExactPlane plane;
  const Bits x = bits_of(v);
  plane.exact = is_exact(x * x * x);
  if (!plane.exact) {
    const auto n = newell_normal<Interval>(v);
    for (std::size_t i = 0; i < 3; ++i) plane.n[i].near = n[i];
    plane.b.near = inner(n, planar::exactly<Interval>(v[0]));
    return plane;
  }
  Array3<Expansion> n = newell_normal<Expansion>(v);
  const double size = std::max({std::fabs(n[0].value()), std::fabs(n[1].value()), std::fabs(n[2].value())});
  const double lift = size > 0 && size < 1 ? power_of_two(std::min(-exponent_of(size), 1000)) : 1;
  for (std::size_t i = 0; i < 3; ++i) {
    n[i] = n[i] * lift;
    plane.n[i] = ExactNumber(n[i]);
  }
  plane.b = ExactNumber(inner(n, planar::exactly<Expansion>(v[0])));
  plane.note_bits();
  return plane;
}

/// No normal: the vertices lie on a line (or enclose no area).
inline bool is_degenerate(const ExactPlane& plane) {
  return std::all_of(plane.n.begin(), plane.n.end(),
                     [](const ExactNumber& x) { return contains_zero(x.near); });
}

/// A point of the ray's line: p enclosed (nearest to the figure, so nothing cancels), or exactly the origin.
/// For formulas that do not depend on which point of the line it is.
template <class T>
Array3<T> point_of_line(const LocalRay& ray) {
  if constexpr (std::is_same_v<T, Expansion>) {
    return origin_as<T>(ray);
  } else {
    return recentred_point<T>(ray);
  }
}

/// The point at l = centre.
template <class T>
Array3<T> point_at_centre(const LocalRay& ray) {
  if constexpr (std::is_same_v<T, Expansion>) {
    const Array3<T> o = origin_as<T>(ray), d = direction_as<T>(ray);
    const T centre = graze::exactly<T>(ray.centre);
    return {o[0] + centre * d[0], o[1] + centre * d[1], o[2] + centre * d[2]};
  } else if constexpr (std::is_same_v<T, DoubleDoubleBall>) {
    return recentred_ball(ray);
  } else {
    return recentred_point<T>(ray);
  }
}

// ---------------------------------------------------------------------------------------- the ray's equation

/// A ball that holds a figure, local units.
struct Ball {
  Vec3 centre;
  double radius = 0;
};

inline bool is_usable(const LocalRay& ray) {
  return is_finite(ray.o) && is_finite(ray.p) && is_finite(ray.d) && std::isfinite(ray.centre);
}

/// Origins beyond double in local units: l is measured in units as far beyond, for integers to answer.
inline void measure_far(LocalRay& ray) {
  constexpr int kFar = 1000;
  if (!is_finite(ray.o) && ray.centre == 0) measure_l(ray, kFar);
}
/// Whether integers can answer a ray whose numbers leave double in local units.
inline bool is_for_integers(const LocalRay& ray, const ExactPlane& plane, const EquationBlock& block) {
  return plane.exact && block.wants_coefficient_errors() && is_valid(ray.world);
}

/// Recentres the ray about the ball; false: it certainly passes the ball. lo and hi are set to l >= 0 and,
/// for a figure whose hits all lie in the ball, to where the ray may be inside it.
inline bool clip(LocalRay& ray, const Ball& ball, bool hits_lie_inside) {
  constexpr double kNear = 4;  // sizes: from there on p has no more digits than o
  recentre_within_range(ray, ball.centre, kNear);
  ray.lo = -ray.centre;
  ray.hi = std::numeric_limits<double>::infinity();
  if (!is_usable(ray)) {
    measure_far(ray);
    return true;
  }
  // Wide margins cost nothing here: 2^-20 of the ball, and 2^8 times the rounding of p and of p - centre.
  const Vec3 offset = ray.p - ball.centre;
  const double reach = (1 + 0x1p-20) * ball.radius + 0x1p-45 * (max_abs(ray.p) + max_abs(ball.centre));
  const double distance = norm(offset);
  if (norm(cross(offset, ray.d)) - 0x1p-45 * distance > reach * norm(ray.d)) return false;
  if (!hits_lie_inside) return true;
  const double range = (1 + 0x1p-20) * (distance + reach);  // |d| >= 1
  ray.lo = std::max(ray.lo, -range);
  ray.hi = range;
  return ray.lo <= ray.hi;
}

/// Whether the block's arithmetic holds the equation and its root. About a centre the root is a correction
/// that may vanish; otherwise it must not underflow.
inline bool fits(Precision precision, const LocalRay& ray, Interval c0, Interval c1, Interval root) {
  if (!std::isfinite(mag(root))) return false;
  if (precision == Precision::binary64) return true;
  constexpr auto kLargest = static_cast<double>(std::numeric_limits<float>::max());
  constexpr auto kLeast = static_cast<double>(std::numeric_limits<float>::min());
  if (mag(c0) > kLargest || mag(root) > kLargest || mag(c1) < kLeast) return false;
  return ray.centre != 0 || (mag(c0) >= kLeast && mag(root) >= kLeast);
}

/// Poses c0 + c1 delta = 0 with its one root in a bracket about -c0 / c1.
inline void pose_linear(EquationBlock& block, const LocalRay& ray, std::uint32_t kind, std::uint64_t seed,
                        Interval c0, Interval c1, const ExactCoefficients& exact) {
  const Interval root = -c0 / c1;
  if (!fits(block.precision(), ray, c0, c1, root)) return block.settle(Status::failed);
  // Beside the enclosure: what rounding the coefficients to the block's arithmetic may move the root, with
  // room for a solver to see the signs at the ends; the spacing of l; and enough that no fraction of the
  // bracket underflows (2^-900 of the figure's size).
  const double slack = block.precision() == Precision::binary32 ? 0x1p-20 : 0x1p-47;
  const double margin = slack * mag(root) + 0x1p-52 * std::fabs(ray.centre) + 0x1p-900;
  const double lo = std::max(-ray.centre, root.lo - margin);
  const auto rounded = [&](auto number) {
    using T = decltype(number);
    return std::array<T, 2>{middle_as<T>(c0), middle_as<T>(c1)};
  };
  pose_in_delta(block, kind, lo, root.hi + margin, seed, 1, rounded, exact);
}

/// The exact coefficients c0 and c1 of a linear equation by formulas generic over the number type, which hold
/// what they need.
template <class C0, class C1>
ExactCoefficients exact_by_formulas(EquationBlock& block, const LocalRay& ray, const C0& c0, const C1& c1) {
  const auto exact = [c0, c1](std::span<Dyadic> to) {
    to[0] = c0(Dyadic());
    to[1] = c1(Dyadic());
  };
  if (block.digits() < Digits::near) return exact_by(block, ray.centre, exact);
  const std::array<DoubleDoubleBall, 2> near{c0(DoubleDoubleBall()), c1(DoubleDoubleBall())};
  return exact_by(block, ray.centre, exact, near);
}

/// Poses where a ray crosses the plane whose numbers leave double in local units: about its origin, by
/// integers, times the power of two that makes the slope about 1.
inline void pose_far_crossing(EquationBlock& block, const LocalRay& ray, const ExactPlane& plane) {
  constexpr long kMost = 1000;  // exponents of l that leave room for bounds
  const Dyadic slope = plane.slope<Dyadic>(ray), height = plane.height(origin_as<Dyadic>(ray));
  const long shift = -slope.top_exponent();
  if (std::abs(height.top_exponent() + shift) > kMost) return block.settle(Status::uncertain);
  const auto enclosed = [shift](const Dyadic& x) {
    const Dyadic scaled = scale_by_power(x, shift);
    return Interval{scaled.round_down(), scaled.round_up()};
  };
  const auto rounded = [c = std::array{enclosed(height), enclosed(slope)}](auto number) {
    using T = decltype(number);
    return std::array<T, 2>{middle_as<T>(c[0]), middle_as<T>(c[1])};
  };
  const auto exact = [self = &plane, where = &ray](std::span<Dyadic> to) {
    to[0] = self->height(origin_as<Dyadic>(*where));
    to[1] = self->slope<Dyadic>(*where);
  };
  pose_in_delta(block, 0, 0, std::numeric_limits<double>::infinity(), ray.seed(), 1, rounded,
                exact_by(block, 0, exact));
}

/// Poses where the ray crosses the plane.
inline void pose_crossing(EquationBlock& block, const LocalRay& ray, std::uint64_t seed,
                          const ExactPlane& plane, const Judge& judge) {
  if (!is_usable(ray)) return pose_far_crossing(block, ray, plane);
  const auto slope = [self = &plane, where = &ray](auto number) {
    return self->slope<decltype(number)>(*where);
  };
  const auto height = [self = &plane, where = &ray](auto number) {
    return self->height(point_at_centre<decltype(number)>(*where));
  };
  pose_linear(block, ray, 0, seed, judge.enclosure(height), judge.enclosure(slope),
              plane.exact ? exact_by_formulas(block, ray, height, slope) : ExactCoefficients{});
}

/// How a ray and a plane lie.
enum class Meeting { apart, ahead, within };  ///< within: the ray's line lies in the plane

inline Meeting meet(Judge& judge, const ExactPlane& plane, const LocalRay& ray) {
  const int slope = judge.sign([&](auto number) { return plane.slope<decltype(number)>(ray); });
  const int height = judge.sign([&](auto number) { return plane.height(origin_as<decltype(number)>(ray)); });
  if (slope == 0) return height == 0 ? Meeting::within : Meeting::apart;
  return slope * height < 0 ? Meeting::ahead : Meeting::apart;
}

/// The exact formulation of a figure: `is_inside(judge)` decides whether the ray's line passes inside it,
/// `pose_within(judge)` answers a ray in its plane.
template <class Inside, class Within>
void pose_exact(EquationBlock& block, const LocalRay& ray, const ExactPlane& plane, bool exact,
                const Inside& is_inside, const Within& pose_within) {
  const bool usable = is_usable(ray);
  if (!usable && !is_for_integers(ray, plane, block)) return block.settle(Status::failed);
  Judge judge(usable && exact && plane.holds(ray), plane.exact);
  const Meeting meeting = meet(judge, plane, ray);
  const bool inside = meeting == Meeting::ahead && !judge.undecided() && is_inside(judge);
  if (meeting == Meeting::within && !judge.undecided()) pose_within(judge);
  if (judge.undecided()) return block.settle(Status::uncertain);
  if (inside) pose_crossing(block, ray, ray.seed(), plane, judge);
}

/// Kinds of equation of the figures: a crossing of the plane, or a touch in the plane (kTouch + vertex).
inline constexpr std::uint32_t kTouch = 1;

/// Poses where the ray, which lies in the plane, passes nearest to a point (foot of the perpendicular):
/// d.(o + l d - v) = 0.
inline void pose_touch(EquationBlock& block, const LocalRay& ray, Vec3 v, std::uint32_t which,
                       const Judge& judge) {
  const auto slope = [where = &ray](auto number) {
    const auto d = direction_as<decltype(number)>(*where);
    return inner(d, d);
  };
  const auto height = [where = &ray, v](auto number) {
    using T = decltype(number);
    return inner(direction_as<T>(*where), difference(point_at_centre<T>(*where), planar::exactly<T>(v)));
  };
  pose_linear(block, ray, kTouch + which, ray.seed(), judge.enclosure(height), judge.enclosure(slope),
              exact_by_formulas(block, ray, height, slope));
}

/// The hit of an exact formulation's root: a touch counts twice and carries its vertex in t.
inline void lift_exact(const Posed& posed, const Root& root, std::vector<LocalHit>& hits) {
  const bool touch = posed.kind >= kTouch;
  hits.push_back({.multiplicity = touch ? 2U : 1U,
                  .delta = root.x,
                  .t = touch ? static_cast<double>(posed.kind - kTouch) : 0.0,
                  .is_root = true});
}

// --------------------------------------------------------------------------------------- rays in the plane

/// A ray in the plane of a polygon, seen in the projection that drops one axis.
struct WithinPolygon {
  enum class Kind { outside, touches, coincident } kind = Kind::outside;
  std::size_t vertex = 0;  ///< the vertex touched
};

namespace detail {

/// Signs of a ray against points of its plane, in a projection on two axes.
class PlaneSigns {
 public:
  PlaneSigns(const LocalRay& ray, std::size_t dropped, Judge& judge)
      : ray_(ray), i_((dropped + 1) % 3), j_((dropped + 2) % 3), judge_(judge) {}

  /// On which side of the line is v?
  [[nodiscard]] int side(Vec3 v) const {
    return judge_.sign([&](auto number) {
      using T = decltype(number);
      const auto p = point_of_line<T>(ray_), d = direction_as<T>(ray_);
      return d[i_] * (of<T>(v, j_) - p[j_]) - d[j_] * (of<T>(v, i_) - p[i_]);
    });
  }
  /// Sign of l of the foot of v, which lies on the line.
  [[nodiscard]] int ahead(Vec3 v) const {
    return judge_.sign([&](auto number) {
      using T = decltype(number);
      const auto o = origin_as<T>(ray_), d = direction_as<T>(ray_);
      return d[i_] * (of<T>(v, i_) - o[i_]) + d[j_] * (of<T>(v, j_) - o[j_]);
    });
  }
  /// Sign of l where the line crosses the edge from a to b, which lie on opposite sides; b's side is given.
  /// With s = d x (v - o), t = d.(v - o): l has the sign of (s_b t_a - s_a t_b)/(s_b - s_a), whose numerator
  /// is |d|^2 (a - o) x (b - o).
  [[nodiscard]] int crossing_ahead(Vec3 a, Vec3 b, int side_of_b) const {
    return side_of_b * judge_.sign([&](auto number) {
      using T = decltype(number);
      const auto o = origin_as<T>(ray_);
      const T &oi = o[i_], &oj = o[j_];
      return (of<T>(a, i_) - oi) * (of<T>(b, j_) - oj) - (of<T>(a, j_) - oj) * (of<T>(b, i_) - oi);
    });
  }

 private:
  template <class T>
  static T of(Vec3 v, std::size_t axis) {
    return graze::exactly<T>(component(v, axis));
  }
  const LocalRay& ray_;
  std::size_t i_, j_;
  Judge& judge_;
};

}  // namespace detail

/// Whether a ray in the polygon's plane runs inside it. It does where it crosses an edge, runs along one, or
/// passes a vertex from one side of the boundary to the other, at l > 0: an interval inside ends at one of
/// these. `touches` names a vertex on the ray where it does none of them: for a convex polygon the only
/// point.
inline WithinPolygon within_polygon(std::span<const Vec3> v, const LocalRay& ray, std::size_t dropped,
                                    Judge& judge) {
  using Kind = WithinPolygon::Kind;
  const detail::PlaneSigns signs(ray, dropped, judge);
  const std::size_t n = v.size();
  WithinPolygon answer;
  int before = signs.side(v[n - 1]);
  int here = signs.side(v[0]);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 next_vertex = v[(i + 1) % n];
    const int next = signs.side(next_vertex);
    if (here == 0 && signs.ahead(v[i]) > 0) {
      if (before * next <= 0) return {Kind::coincident, i};
      answer = {Kind::touches, i};
    }
    if (here * next < 0 && signs.crossing_ahead(v[i], next_vertex, next) > 0) return {Kind::coincident, i};
    before = here;
    here = next;
  }
  return answer;
}

// ------------------------------------------------------------------------------ what textbook formulas share

/// Kinds of a textbook formulation: the arithmetic of its inside test.
enum PlainKind : std::uint32_t { kDouble, kFloat };

/// Poses c0 + c1 l = 0 from the ray's own origin, as `make(T{})` rounds it; nothing where c1 rounds to zero.
template <class Make>
void pose_plain(EquationBlock& block, const LocalRay& ray, std::uint64_t seed, const Make& make) {
  if (!is_usable(ray)) return block.settle(Status::failed);
  const bool wide = block.precision() == Precision::binary64;
  const auto [c0, c1] = make(double{});
  if (wide ? c1 == 0 : make(float{})[1] == 0) return;
  // Nearer than 2^-900 of the figure's size the ray starts on the plane, as far as a solver's steps can tell.
  if (std::fabs(c0) <= 0x1p-900 * std::fabs(c1)) return;
  pose_in_delta(block, wide ? kDouble : kFloat, 0, std::numeric_limits<double>::infinity(), seed, 1, make);
}

/// o + l d, l in the arithmetic of T.
template <class T>
Array3<T> plain_point(const LocalRay& ray, double l) {
  const Array3<T> o = planar::exactly<T>(ray.o), d = planar::exactly<T>(ray.d);
  const T t = static_cast<T>(l);
  return {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
}

/// Appends the hit at root if `is_inside(T{})` says so in the arithmetic of the posed kind.
template <class Inside>
void lift_plain(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits,
                const Inside& is_inside) {
  const bool inside = posed.kind == kFloat ? is_inside(float{}) : is_inside(double{});
  if (inside) hits.push_back({.multiplicity = 1, .delta = root.x - ray.centre});
}

// ---------------------------------------------------------------------------------------------- vertex lists

inline std::vector<Vec3> vertices_of(const SurfaceSpec& spec) {
  std::vector<Vec3> vertices;
  for (const auto& row : spec.parameters.table("vertices", 3)) vertices.push_back({row[0], row[1], row[2]});
  return vertices;
}

inline Bounds box_of(std::span<const Vec3> v) {
  Bounds box{v[0], v[0]};
  for (const Vec3& x : v) box = hull(box, {x, x});
  return box;
}

/// The largest coordinate difference; throws where it is no double.
inline double extent_of(std::span<const Vec3> v) {
  const Bounds box = box_of(v);
  const double extent = max_abs(box.hi - box.lo);
  if (!std::isfinite(extent)) throw std::invalid_argument("vertices are too far apart for double");
  return extent;
}

/// About the middle of the box, through the farthest vertex.
inline Ball ball_about(std::span<const Vec3> v) {
  const Bounds box = box_of(v);
  Ball ball{0.5 * box.lo + 0.5 * box.hi, 0};
  for (const Vec3& x : v) ball.radius = std::max(ball.radius, norm(x - ball.centre));
  return ball;
}

/// Edges, directions of edges and box of a figure with vertices.
inline Landmarks landmarks_of(std::span<const Vec3> v) {
  const Bounds box = box_of(v);
  Landmarks marks;
  marks.centre = 0.5 * box.lo + 0.5 * box.hi;
  marks.half = 0.5 * box.hi - 0.5 * box.lo;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Vec3 next = v[(i + 1) % v.size()];
    marks.edges.push_back({v[i], next});
    marks.parallels.push_back(normalized(next - v[i]));
  }
  return marks;
}

/// A point of the triangle a b c, uniform in area.
inline Vec3 sample_triangle(Vec3 a, Vec3 b, Vec3 c, double u, double v) {
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return a + u * (b - a) + v * (c - a);
}

}  // namespace graze::planar
