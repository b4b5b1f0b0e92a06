// What box, tetrahedron and convex_polyhedron share: a solid as the intersection of half-spaces n_i.x <= b_i,
// and where a line is inside all of them.
//
// solves    entering planes (n.d < 0) and leaving planes (n.d > 0) are crossed at l_i = (b_i - n_i.o) /
//           (n_i.d); l_in = the largest entering one, l_out = the smallest leaving one; the line meets the
//           solid if l_in <= l_out and no parallel plane (n.d = 0) has it outside
// needs     a surface derived from Solid whose `faces` have `template <class T> T top(ray)` = b - n.o and `T
// bottom(ray)` = n.d (up to one
//           positive factor for both), for T = double, float, Interval and Expansion, and a Grain that
//           bounds their bits
// returns   miss, through, touch (l_in = l_out), coincident (a stretch of the ray lies in a plane and in
//           the solid)
// error     `exact_passage`: none; its equations are good to the last bit. `plain_passage`: that of doubles
// cost      at most one test a plane; ends as soon as l_in > l_out or l_out <= 0. No allocation but in
//           expansions of more than 32 parts
// source    Cyrus, Beck, Computers & Graphics 3 (1978) 23-28; documents 001 (slabs) and 004. Changed:
//           decisions are exact, by intervals and then by expansions
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/surfaces/coefficients.hpp>
#include <graze/surfaces/exact.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze::convex {

// ------------------------------------------------------------------------------------- range of exact sums

/// Bits of every monomial of a solid's n and b.
struct Grain {
  Bits normal, offset;
  [[nodiscard]] Bits bottom(const LocalRay& ray) const { return normal * Bits(ray.d); }
  [[nodiscard]] Bits top(const LocalRay& ray) const { return offset | normal * Bits(ray.o); }
};

/// Directions with parts near the smallest numbers, times 2^kLift: moves them into the range of exact sums
/// and changes no sign and no order of the l.
struct Lifted {
  LocalRay ray;
  int exponent = 0;  ///< l here times 2^exponent is the local frame's
};
inline Lifted lifted(const LocalRay& ray) {
  constexpr int kLow = -400, kLift = 500;
  if (Bits(ray.d).low >= kLow) return {ray, 0};
  Lifted result{ray, kLift};
  result.ray.d = scale_by_power(ray.d, kLift);
  result.ray.l_exponent += kLift;
  return result;
}

/// A double with a bound on its error: a first filter, several times quicker than intervals. Every bound
/// counts twice the unit roundoff, which covers its own roundings, and the smallest number, which covers
/// underflow.
struct Ball {
  double value = 0, error = 0;

  Ball() = default;
  explicit Ball(double x) : value(x) {}
  Ball(double x, double e) : value(x), error(e) {}

  friend Ball operator+(Ball a, Ball b) { return rounded(a.value + b.value, a.error + b.error); }
  friend Ball operator-(Ball a) { return {-a.value, a.error}; }
  friend Ball operator-(Ball a, Ball b) { return rounded(a.value - b.value, a.error + b.error); }
  friend Ball operator*(Ball a, Ball b) {
    return rounded(a.value * b.value,
                   std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error);
  }
  [[nodiscard]] bool is_positive() const { return value > error; }
  [[nodiscard]] bool is_negative() const { return -value > error; }

 private:
  static Ball rounded(double value, double error) {
    return {value, (1 + 0x1p-50) * error + 0x1p-52 * std::fabs(value) +
                       4 * std::numeric_limits<double>::denorm_min()};
  }
};

// ------------------------------------------------------------------------------------------------ decisions

enum class Verdict : std::uint8_t { miss, through, touch, coincident };

struct Passage {
  Verdict verdict = Verdict::miss;
  std::uint32_t in = 0;        ///< the first of the faces that attain l_in
  std::uint32_t out = 0;       ///< ... and l_out
  bool starts_inside = false;  ///< l_in <= 0: only l_out is a hit
  std::uint32_t tests = 0;     ///< planes looked at
};

/// Cyrus and Beck's clipping with every comparison exact.
template <class Face>
class ExactClipping {
 public:
  ExactClipping(std::span<const Face> faces, const Grain& grain, const LocalRay& ray)
      : faces_(faces), grain_(grain), ray_(ray) {}

  Passage run() {
    Passage passage;
    for (std::uint32_t i = 0; i < faces_.size() && is_open_; ++i) {
      ++passage.tests;
      look_at(i);
    }
    passage.verdict = verdict();
    if (in_) passage.in = in_->face;
    if (out_) passage.out = out_->face;
    passage.starts_inside = in_ && in_->sign <= 0;
    return passage;
  }

 private:
  /// l = top / bottom, with the signs of bottom and l.
  struct Crossing {
    std::uint32_t face;
    Interval top, bottom, l;
    int direction;
    int sign;
  };

  /// Whether the plane is surely crossed at an l before l_in (entering) or behind l_out (leaving): the line
  /// is still inside of it there.
  [[nodiscard]] bool changes_nothing(const Face& face) const {
    const Ball bottom = face.template bottom<Ball>(ray_);
    if (in_ && bottom.is_negative()) return is_inside(face, bottom, in_->l.lo);
    if (out_ && bottom.is_positive()) return is_inside(face, bottom, out_->l.hi);
    return false;
  }
  [[nodiscard]] bool is_inside(const Face& face, const Ball& bottom, double l) const {
    return (face.template top<Ball>(ray_) - Ball(l) * bottom).is_positive();
  }

  void look_at(std::uint32_t i) {
    const Face& face = faces_[i];
    if (changes_nothing(face)) return;
    const Interval top = face.template top<Interval>(ray_);
    const Interval bottom = face.template bottom<Interval>(ray_);
    const int direction =
        sign(bottom, grain_.bottom(ray_), [&](auto number) { return bottom_of(i, number); });
    const int side = sign(top, grain_.top(ray_), [&](auto number) { return top_of(i, number); });
    if (direction == 0) {
      runs_along_ = runs_along_ || side == 0;
      is_open_ = side >= 0;
      return;
    }
    const Crossing crossing{i, top, bottom, top / bottom, direction, side * direction};
    std::optional<Crossing>& end = direction < 0 ? in_ : out_;
    if (!end || compare(crossing, *end) * direction < 0) end = crossing;
    order_ = in_ && out_ ? compare(*in_, *out_) : -1;
    const bool is_behind = out_ && out_->sign <= 0;
    if (order_ > 0 || is_behind) is_open_ = false;
  }

  [[nodiscard]] Verdict verdict() const {
    if (!is_open_) return Verdict::miss;
    if (order_ == 0) return Verdict::touch;
    return runs_along_ ? Verdict::coincident : Verdict::through;
  }

  /// Sign of a.l - b.l.
  int compare(const Crossing& a, const Crossing& b) {
    if (a.l.hi < b.l.lo) return -1;
    if (a.l.lo > b.l.hi) return 1;
    const Bits bits = grain_.top(ray_) * grain_.bottom(ray_);
    const int cross = sign(a.top * b.bottom - b.top * a.bottom, bits, [&](auto number) {
      return top_of(a.face, number) * bottom_of(b.face, number) -
             top_of(b.face, number) * bottom_of(a.face, number);
    });
    return cross * a.direction * b.direction;
  }

  /// In the number's type.
  template <class T>
  [[nodiscard]] T top_of(std::uint32_t face, const T& /*number*/) const {
    return faces_[face].template top<T>(ray_);
  }
  template <class T>
  [[nodiscard]] T bottom_of(std::uint32_t face, const T& /*number*/) const {
    return faces_[face].template bottom<T>(ray_);
  }

  /// The sign of what `quick` encloses: by expansions where it does not tell, by integers beyond their range.
  template <class Formula>
  int sign(const Interval& quick, const Bits& bits, const Formula& formula) {
    const auto told = sign_of(quick, ray_.is_exact && bits.is_exact(), [&] { return formula(Expansion{}); });
    return told ? *told : formula(Dyadic()).sign();
  }

  std::span<const Face> faces_;
  const Grain& grain_;
  const LocalRay& ray_;
  std::optional<Crossing> in_, out_;
  int order_ = -1;  ///< of l_in and l_out
  bool is_open_ = true;
  bool runs_along_ = false;
};

/// The same in the arithmetic of T, as the textbooks have it: a parallel plane is passed by a line in it.
template <class T, class Face>
Passage plain_passage(std::span<const Face> faces, const LocalRay& ray) {
  Passage passage;
  T in = -std::numeric_limits<T>::infinity();
  T out = std::numeric_limits<T>::infinity();
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    ++passage.tests;
    const T top = faces[i].template top<T>(ray);
    const T bottom = faces[i].template bottom<T>(ray);
    if (bottom == 0) {
      if (top < 0) return passage;
      continue;
    }
    const T l = top / bottom;
    if (bottom < 0 && l > in) {
      in = l;
      passage.in = i;
    } else if (bottom > 0 && l < out) {
      out = l;
      passage.out = i;
    }
    if (in > out || out <= 0) return passage;
  }
  passage.starts_inside = !(in > 0);
  passage.verdict = in == out ? Verdict::touch : Verdict::through;
  return passage;
}

// ------------------------------------------------------------------------------------------------ equations

/// A posed equation's kind is its face, and whether the ray only touches there.
inline constexpr std::uint32_t kTouch = std::uint32_t{1} << 31U;

/// Poses an equation for each hit of a passage: pose_face(kind).
template <class PoseFace>
void pose_hits(const Passage& passage, EquationBlock& block, const PoseFace& pose_face) {
  switch (passage.verdict) {
    case Verdict::miss:
      return;
    case Verdict::coincident:
      return block.settle(Status::coincident);
    case Verdict::touch:
      return pose_face(std::min(passage.in, passage.out) | kTouch);
    case Verdict::through:
      if (!passage.starts_inside) pose_face(passage.in);
      return pose_face(passage.out);
  }
}

inline LocalHit hit_of(const Posed& posed, const Root& root, double shift) {
  return {.multiplicity = (posed.kind & kTouch) != 0 ? 2U : root.multiplicity,
          .delta = root.x - shift,
          .t = static_cast<double>(posed.kind & ~kTouch),
          .is_root = shift == 0,
          .is_apart = true};
}

/// The formula's value with a relative error below 2^-52 times that of a double; needs bits.is_exact().
/// Double-double loses at most 2^-96 of the largest monomial, so that all but badly cancelled values are good
/// to 2^-56.
template <class Formula>
DoubleDouble sharp(const Formula& formula, const Bits& bits) {
  constexpr int kMostCancelled = 40;
  const DoubleDouble quick = formula(DoubleDouble{});
  if (std::fabs(quick.hi) >= scale_by_power(1.0, bits.high - kMostCancelled)) return quick;
  return formula(Expansion{}).to_double_double();
}

/// Where a line crosses a face, as delta.
struct Place {
  double value;  ///< rounded correctly, or the middle of a wide enclosure
  Interval enclosure;
  std::optional<DoubleDoubleBall> near{};

  template <class T>
  [[nodiscard]] T as() const {
    if constexpr (std::is_same_v<T, Interval>) {
      return enclosure;
    } else {
      return static_cast<T>(value);
    }
  }
};
/// x / y 2^k, scaled so that nothing leaves the range of double-doubles before the last.
inline DoubleDouble quotient(const Dyadic& x, const Dyadic& y, int k) {
  if (x.is_zero()) return 0;
  const long up = x.top_exponent(), down = y.top_exponent();
  const DoubleDouble q =
      scale_by_power(x, -up).to_double_double() / scale_by_power(y, -down).to_double_double();
  const auto shift = static_cast<int>(std::clamp(up - down + k, -4000L, 4000L));
  return {scale_by_power(q.hi, shift), scale_by_power(q.lo, shift)};
}

/// Where the line crosses a face, as l: within 2^-90 of it, but for numbers that underflow.
template <class Face>
DoubleDouble crossing_of(const Face& face, const Grain& grain, const Lifted& line) {
  const LocalRay& ray = line.ray;
  const auto top = [&](auto number) { return face.template top<decltype(number)>(ray); };
  const auto bottom = [&](auto number) { return face.template bottom<decltype(number)>(ray); };
  const bool is_exact = ray.is_exact && (grain.top(ray) | grain.bottom(ray)).is_exact();
  if (is_exact) {
    constexpr double kSmall = 0x1p-900;  // below, low parts underflow
    const DoubleDouble l = sharp(top, grain.top(ray)) / sharp(bottom, grain.bottom(ray));
    const bool is_number = std::fabs(l.hi) > kSmall && std::isfinite(l.hi);
    if (is_number) return {scale_by_power(l.hi, line.exponent), scale_by_power(l.lo, line.exponent)};
  }
  return quotient(top(Dyadic()), bottom(Dyadic()), line.exponent);
}

/// Encloses delta = l - centre there, by 1 ulp of delta and 2^-90 of l.
template <class Face>
Place place_of(const Face& face, const Grain& grain, const Lifted& line) {
  const DoubleDouble l = crossing_of(face, grain, line);
  const DoubleDouble delta = l - line.ray.centre;
  const double size = std::fabs(l.hi), error = 0x1p-90 * size;
  constexpr double kSmall = 0x1p-900;  // below, low parts underflow
  const bool is_small = size < kSmall;
  // Scaled from normal numbers, once.
  const double underflow = is_small ? std::numeric_limits<double>::denorm_min() : 0;
  Place place{delta.hi, ball(delta.hi, 0x1p-53 * std::fabs(delta.hi) + error + underflow)};
  if (!is_small) place.near = DoubleDoubleBall(delta, error);
  return place;
}

/// Exact decisions, and the linear equation delta - place = 0 for each hit: divided through by n.d beyond
/// double precision, so that a solver's answer is as good as its last rounding. A test that is counted looks
/// at `planes_a_test` planes (a slab's two).
template <class Face>
void pose_exact(std::span<const Face> faces, const Grain& grain, const LocalRay& ray, EquationBlock& block,
                std::uint32_t planes_a_test) {
  const Lifted line = lifted(ray);
  const Passage passage = ExactClipping<Face>(faces, grain, line.ray).run();
  block.spend((passage.tests + planes_a_test - 1) / planes_a_test);
  pose_hits(passage, block, [&](std::uint32_t kind) {
    const Place place = place_of(faces[kind & ~kTouch], grain, line);
    // Only numbers beyond the range of exact sums, or an l beyond that of double, leave more than two ulps.
    const double size = mag(place.enclosure) + std::fabs(ray.centre);
    if (!(width(place.enclosure) <= 0x1p-50 * size)) return block.settle(Status::uncertain);
    const auto rounded = [&](auto number) {
      using T = decltype(number);
      return std::array<T, 2>{-place.template as<T>(), exactly<T>(1)};
    };
    // top = bottom (centre + delta)
    const auto exact = [face = &faces[kind & ~kTouch], where = &ray](std::span<Dyadic> to) {
      to[1] = face->template bottom<Dyadic>(*where);
      to[0] = Dyadic(where->centre) * to[1] - face->template top<Dyadic>(*where);
    };
    const std::array<DoubleDoubleBall, 2> near{-place.near.value_or(DoubleDoubleBall()), DoubleDoubleBall(1)};
    pose_in_delta(block, kind, ray.lo, ray.hi, ray.seed(), 1, rounded,
                  exact_by(block, ray.centre, exact, std::span(near).first(place.near ? 2 : 0)));
  });
}

/// Decisions and equations in plain arithmetic; the unknown is l itself.
template <class Face>
void pose_plain(std::span<const Face> faces, const LocalRay& ray, EquationBlock& block,
                std::uint32_t planes_a_test) {
  const bool wide = block.precision() == Precision::binary64;
  const Passage passage = wide ? plain_passage<double>(faces, ray) : plain_passage<float>(faces, ray);
  block.spend((passage.tests + planes_a_test - 1) / planes_a_test);
  pose_hits(passage, block, [&](std::uint32_t kind) {
    const Face& face = faces[kind & ~kTouch];
    pose_in_delta(block, kind, 0, ray.centre + ray.hi, ray.seed(), 1, [&](auto number) {
      using T = decltype(number);
      return std::array<T, 2>{-face.template top<T>(ray), face.template bottom<T>(ray)};
    });
  });
}

// ---------------------------------------------------------------------------------------------------- shape

/// Corners, edges and faces of a solid in object space: what bounds, samples and case families need.
struct Shape {
  struct Triangle {
    std::uint32_t face;
    std::array<std::size_t, 3> corners;
  };
  std::vector<Vec3> vertices;
  std::vector<std::array<std::size_t, 2>> edges;
  std::vector<Triangle> triangles;  ///< of all faces that have an area
  std::vector<Vec3> normals;        ///< outward, unit, one a face

  [[nodiscard]] Vec3 least() const {
    Vec3 lo = vertices[0];
    for (const Vec3& v : vertices) lo = {std::min(lo.x, v.x), std::min(lo.y, v.y), std::min(lo.z, v.z)};
    return lo;
  }
  [[nodiscard]] Vec3 greatest() const {
    Vec3 hi = vertices[0];
    for (const Vec3& v : vertices) hi = {std::max(hi.x, v.x), std::max(hi.y, v.y), std::max(hi.z, v.z)};
    return hi;
  }
  [[nodiscard]] Vec3 centre() const { return 0.5 * least() + 0.5 * greatest(); }
  [[nodiscard]] Vec3 half() const { return 0.5 * greatest() - 0.5 * least(); }
  /// Half the longest side of the bounding box; never zero.
  [[nodiscard]] double size() const {
    return std::max(max_abs(half()), std::numeric_limits<double>::denorm_min());
  }
  [[nodiscard]] Bounds bounds() const { return box_about(centre(), half()); }

  /// u chooses a triangle and a place along it, v the other place.
  [[nodiscard]] SurfaceSample sample(double u, double v) const {
    const double scaled = u * static_cast<double>(triangles.size());
    const std::size_t index = std::min(static_cast<std::size_t>(scaled), triangles.size() - 1);
    const Triangle& triangle = triangles[index];
    double s = scaled - static_cast<double>(index), t = v;
    // The other half of the square folds onto the triangle.
    if (s + t > 1) {
      s = 1 - s;
      t = 1 - t;
    }
    const auto& [a, b, c] = triangle.corners;
    const Vec3 p = vertices[a] + s * (vertices[b] - vertices[a]) + t * (vertices[c] - vertices[a]);
    return {p, normals[triangle.face]};
  }

  [[nodiscard]] Landmarks landmarks() const {
    Landmarks marks;
    marks.centre = centre();
    marks.half = half();
    for (const auto& [a, b] : edges) {
      marks.edges.push_back({vertices[a], vertices[b]});
      const Vec3 along = normalized(0.5 * vertices[b] - 0.5 * vertices[a]);
      const auto is_same = [&](Vec3 other) { return other == along || other == -along; };
      if (std::none_of(marks.parallels.begin(), marks.parallels.end(), is_same))
        marks.parallels.push_back(along);
    }
    return marks;
  }
};

/// The part of a local frame that rays are clipped to: a box about `centre`, in local units.
struct Reach {
  Vec3 centre;
  double radius = 1;  ///< of the box, in its largest coordinate

  /// Recentres rays that start far away, and bounds delta by how far any point of the solid can be from p.
  void clip(LocalRay& ray) const {
    constexpr double kNear =
        8;  // from here on hits are far from l = 0, so that l = centre + delta is faithful
    recentre_within_range(ray, centre, kNear * radius);
    // sqrt 3 < 2 from coordinates to distances, and twice that for roundings of p, which are relative to p.
    const double reach = 4 * (max_abs(ray.p - centre) + radius) + 0x1p-48 * max_abs(centre);
    ray.lo = std::max(-ray.centre, -reach);
    ray.hi = reach;
  }
};

inline Reach reach_of(const Shape& shape, int unit) {
  // Twice the size: rounded corners and a rounded middle stay inside.
  return {scale_by_power(shape.centre(), -unit), 2 * scale_by_power(shape.size(), -unit)};
}

// ---------------------------------------------------------------------------------- surface and formulations

/// What `graze list` says of a solid's formulations.
struct Wording {
  std::string_view exact_summary, exact_source;
  std::string_view plain_name, plain_summary, plain_source;
};

/// What a solid's surface type has in common with the others: it adds its `faces`, in local units, its
/// `kWording` and its constructor, which fills in the shape and calls `measure` once the vertices are known.
struct Solid {
  static constexpr std::uint32_t kPlanesATest = 1;

  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return shape.size(); }
  [[nodiscard]] Bounds bounds() const { return shape.bounds(); }
  [[nodiscard]] bool clip(LocalRay& ray) const {
    reach.clip(ray);
    return true;
  }
  [[nodiscard]] LocalPoint describe(const LocalRay& /*ray*/, const LocalHit& hit) const {
    return {shape.normals[static_cast<std::size_t>(hit.t)], {hit.t, 0}};
  }
  [[nodiscard]] SurfaceSample sample(double u, double v) const { return shape.sample(u, v); }
  [[nodiscard]] Landmarks landmarks() const { return shape.landmarks(); }

  Shape shape;
  Reach reach;
  Grain grain;  ///< of the faces

 protected:
  /// Sets the local frame by the shape's vertices.
  void measure() {
    unit_ = exponent_of(shape.size());
    reach = reach_of(shape, unit_);
  }

 private:
  int unit_ = 0;
};

/// Cyrus and Beck with exact comparisons.
template <class S>
struct Exact {
  using Faces = decltype(S::faces);
  using Face = typename Faces::value_type;

  static FormulationInfo info();
  explicit Exact(const S& surface) : faces(surface.faces), grain(surface.grain) {}
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  Faces faces;
  Grain grain;
};

/// Cyrus and Beck in plain arithmetic.
template <class S>
struct Plain {
  using Faces = decltype(S::faces);
  using Face = typename Faces::value_type;

  static FormulationInfo info();
  explicit Plain(const S& surface) : faces(surface.faces) {}
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  Faces faces;
};

template <class S>
FormulationInfo Exact<S>::info() {
  const Wording& words = S::kWording;
  return {
      "exact", words.exact_summary, words.exact_source, {Form::polynomial, Form::scalar, Form::interval}, 1};
}

template <class S>
void Exact<S>::pose(const LocalRay& ray, EquationBlock& block) const {
  pose_exact<Face>(faces, grain, ray, block, S::kPlanesATest);
}

template <class S>
void Exact<S>::lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
                    std::vector<LocalHit>& hits) const {
  hits.push_back(hit_of(posed, root, 0));
}

template <class S>
FormulationInfo Plain<S>::info() {
  const Wording& words = S::kWording;
  return {words.plain_name,
          words.plain_summary,
          words.plain_source,
          {Form::polynomial, Form::scalar, Form::interval},
          1,
          true};
}

template <class S>
void Plain<S>::pose(const LocalRay& ray, EquationBlock& block) const {
  pose_plain<Face>(faces, ray, block, S::kPlanesATest);
}

template <class S>
void Plain<S>::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                    std::vector<LocalHit>& hits) const {
  hits.push_back(hit_of(posed, root, ray.centre));
}

}  // namespace graze::convex
