// First and second hits of many rays with a surface of second degree, proved in double. Compiled once for
// each instruction set; derivation and error analysis: surfaces/quadric.md and surfaces/sphere.md, "Kernel".
#include <graze/surfaces/second_degree_lanes.hpp>

#include <graze/solvers/math/lanes_double_double.hpp>

namespace graze::GRAZE_LANES {
namespace {

using Surface = SecondDegreeSurface;
using Shape = SecondDegreeSurface::Shape;

constexpr double kU = 0x1p-53;
constexpr double kInfinity = __builtin_inf();
constexpr double kNormal = 0x1p-1022;  // below, l would be rounded by more than u of itself
constexpr double kU2 = kU * kU;
constexpr double kTiny = 0x1p-960;  // far above what underflow can add to a bound, far below what matters

struct Vector {
  Lanes x, y, z;
};

Lanes dot(const Vector& a, const Vector& b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
Lanes sum_of_sizes(const Vector& a) { return abs(a.x) + abs(a.y) + abs(a.z); }
/// Sum of |a_i b_i|.
Lanes dot_of_sizes(const Vector& a, const Vector& b) {
  return fma(abs(a.x), abs(b.x), fma(abs(a.y), abs(b.y), abs(a.z * b.z)));
}

/// kLanes rays seen from the centre: m + rest + l d, rest what m was rounded by.
struct Rays {
  Vector m, rest, d;
  Lanes back;  ///< l of the caller = l here * back
};

/// o - c = difference + rest, exactly (Knuth).
void subtract(Lanes o, double c, Lanes& difference, Lanes& rest) {
  difference = o - c;
  const Lanes moved = difference - o;
  rest = (o - (difference - moved)) - (c + moved);
}

/// Lengths in the surface's unit, the largest |d_i| in [1, 2): exact, short of underflow.
template <bool kCentral>
[[gnu::always_inline]] inline Rays rays_at(const Surface& surface, const double* from) {
  Lanes x[6];
  load_records(from, x);
  Vector o{x[0], x[1], x[2]};
  const Vector d{x[3], x[4], x[5]};
  const Lanes shrink = reciprocal_power(max(abs(d.x), max(abs(d.y), abs(d.z))));
  o = {o.x * surface.inverse_unit, o.y * surface.inverse_unit, o.z * surface.inverse_unit};
  Rays rays{o, {}, {d.x * shrink, d.y * shrink, d.z * shrink}, shrink * surface.unit};
  if constexpr (kCentral) return rays;
  subtract(o.x, surface.centre[0], rays.m.x, rays.rest.x);
  subtract(o.y, surface.centre[1], rays.m.y, rays.rest.y);
  subtract(o.z, surface.centre[2], rays.m.z, rays.rest.z);
  return rays;
}

/// The point at l, rounded twice a coordinate; once where there is no rest.
template <bool kCentral>
[[gnu::always_inline]] inline Vector point_at(const Rays& rays, Lanes l) {
  if constexpr (kCentral) {
    return {fma(l, rays.d.x, rays.m.x), fma(l, rays.d.y, rays.m.y), fma(l, rays.d.z, rays.m.z)};
  }
  return {fma(l, rays.d.x, rays.m.x) + rays.rest.x, fma(l, rays.d.y, rays.m.y) + rays.rest.y,
          fma(l, rays.d.z, rays.m.z) + rays.rest.z};
}

template <Shape kShape>
[[gnu::always_inline]] inline Vector times(const Surface& s, const Vector& y) {
  if constexpr (kShape == Shape::sphere) {
    return y;
  } else if constexpr (kShape != Shape::full) {
    return {s.m[0] * y.x, s.m[1] * y.y, s.m[2] * y.z};
  } else {
    return {fma(all(s.m[0]), y.x, fma(all(s.m[3]), y.y, s.m[4] * y.z)),
            fma(all(s.m[3]), y.x, fma(all(s.m[1]), y.y, s.m[5] * y.z)),
            fma(all(s.m[4]), y.x, fma(all(s.m[5]), y.y, s.m[2] * y.z))};
  }
}

/// M y + g, half the gradient.
template <Shape kShape>
[[gnu::always_inline]] inline Vector slope(const Surface& s, const Vector& y) {
  if constexpr (kShape == Shape::central) {
    return times<kShape>(s, y);
  } else if constexpr (kShape == Shape::diagonal) {
    return {fma(all(s.m[0]), y.x, all(s.g[0])), fma(all(s.m[1]), y.y, all(s.g[1])),
            fma(all(s.m[2]), y.z, all(s.g[2]))};
  } else {
    return {fma(all(s.m[0]), y.x, fma(all(s.m[3]), y.y, fma(all(s.m[4]), y.z, all(s.g[0])))),
            fma(all(s.m[3]), y.x, fma(all(s.m[1]), y.y, fma(all(s.m[5]), y.z, all(s.g[1])))),
            fma(all(s.m[4]), y.x, fma(all(s.m[5]), y.y, fma(all(s.m[2]), y.z, all(s.g[2]))))};
  }
}

/// |y|.(|M| |y| + |g|) of a full shape, |y|.|g| of a diagonal one.
template <Shape kShape>
[[gnu::always_inline]] inline Lanes size_at(const Surface& s, const Vector& y) {
  const auto size = [](double x) { return all(__builtin_fabs(x)); };
  const Vector g{size(s.g[0]), size(s.g[1]), size(s.g[2])};
  if constexpr (kShape == Shape::central) return Lanes{};
  if constexpr (kShape == Shape::diagonal) return dot_of_sizes(y, g);
  const Vector z{abs(y.x), abs(y.y), abs(y.z)};
  return dot(z, {fma(size(s.m[0]), z.x, fma(size(s.m[3]), z.y, fma(size(s.m[4]), z.z, g.x))),
                 fma(size(s.m[3]), z.x, fma(size(s.m[1]), z.y, fma(size(s.m[5]), z.z, g.y))),
                 fma(size(s.m[4]), z.x, fma(size(s.m[5]), z.y, fma(size(s.m[2]), z.z, g.z)))});
}

/// f(y), by its slope there.
template <Shape kShape>
[[gnu::always_inline]] inline Lanes value(const Surface& s, const Vector& y, const Vector& slope) {
  if constexpr (kShape == Shape::central) {
    return fma(y.x, slope.x, fma(y.y, slope.y, fma(y.z, slope.z, all(s.j))));
  } else {
    return fma(y.x, slope.x + s.g[0], fma(y.y, slope.y + s.g[1], fma(y.z, slope.z + s.g[2], all(s.j))));
  }
}

/// What is proved of kLanes rays; of `one` and `two` the hits are l[0] and l[1].
struct Proved {
  Mask none, one, two;
  Lanes l[2];
};

/// Sphere and ellipsoid in its axes: from the foot, -B/A, no term of the filter or of l cancels, and l needs
/// no correction (surfaces/sphere.md).
template <Shape kShape, bool kCentral, bool kBoth>
[[gnu::always_inline]] inline Proved prove_axial(const Surface& s, const Rays& rays) {
  const double j = -s.j;
  const Vector md = times<kShape>(s, rays.d), mm = times<kShape>(s, rays.m);
  const Lanes a = dot(md, rays.d), b = dot(mm, rays.d), q0 = dot(mm, rays.m);
  const Lanes c0 = q0 - j;
  const Lanes m2 = kShape == Shape::sphere ? q0 : dot(rays.m, rays.m);
  const Lanes per_a = 1 / a;
  const Lanes centre = -b * per_a;
  const Vector p = point_at<kCentral>(rays, centre);
  const Vector mp = times<kShape>(s, p);
  const Lanes along = dot(mp, rays.d), q = dot(mp, p);
  const Lanes square = along * along;
  const Lanes discriminant = fma(-a, q - j, square);
  const Lanes error = fma(a, fma(q, all(9.5 * kU), all(1.0625 * kU * j)), 128 * kU * square);
  const Lanes root = sqrt(discriminant);

  const Mask is_near = m2 < s.farthest2;
  const Mask crosses = (discriminant > error) & is_near;
  const Mask misses = (discriminant < -error) & is_near;
  const Mask outside = c0 > 16 * kU * j, inside = c0 < -32 * kU * j;
  const Mask is_clear = b * b > 0x1p-100 * (a * q0);  // b's error is below 8 u sqrt(a q0)
  const Mask leaves = outside & is_clear & (b > 0);
  const Mask enters = outside & is_clear & (b < 0);
  const Lanes far = fma(root - along, per_a, centre);
  const Lanes near = fma(-root - along, per_a, centre);
  Proved proved{misses | leaves, crosses & inside, crosses & enters, {select(inside, far, near), far}};
  if constexpr (kBoth) proved.two &= near < far;
  return proved;
}

/// A root of a l^2 + 2 b l + c polished from the ray itself, and whether it is good to 4 condition units.
struct Polished {
  Lanes l;
  Mask proved;
};

/// The line about its vertex, where B is all but zero.
struct Vertex {
  Lanes a, centre, along;
  Lanes error;            ///< of the discriminant
  Lanes root;             ///< of the discriminant
  Lanes per_a, per_root;  ///< 1/a, 1/root
};

/// Whether l - f / (2 side root) is within 4 condition units of the root; n: half the gradient at l.
[[gnu::always_inline]] inline Mask is_good(const Surface& s, const Vertex& v, Lanes l, Lanes f, Lanes f_error,
                                           const Vector& n) {
  const Lanes f_most = abs(f) + f_error;
  const Lanes curved = fma(abs(v.a), f_most, v.error) * (v.per_root * v.per_root);
  const Lanes most = fma(f_most, 16 * kU + curved, f_error);
  // |n| is at least the sum of its sizes over sqrt 3; 8 < 16 / sqrt 3 * sqrt(4 / 5).
  const Lanes allowed = kU * fma(14 * v.root, abs(l), 8 * s.length * sum_of_sizes(n));
  const Mask is_close = abs(v.a * l) * 0x1p-48 < v.root;
  return (most < allowed) & is_close;
}

/// Where the hits of a line that crosses are, by the exact signs of a, b and c = f(o).
struct Sides {
  Mask between;        ///< the origin is between them
  Mask ahead, behind;  ///< both ahead, both behind or none at all
  Lanes upward;        ///< 1 where f rises at the far one, else -1
};

[[gnu::always_inline]] inline Sides sides_of(Lanes a, Lanes b, Lanes c, Lanes c_error, Lanes b_error2) {
  const Mask rises = a > 0;
  const Mask is_off = abs(c) > c_error;
  const Mask same = rises == (c > 0);
  const Mask beside = is_off & same & (b * b > b_error2);
  const Mask is_before = rises != (b > 0);
  return {is_off & ~same, beside & is_before, beside & ~is_before, select(rises, all(1.0), all(-1.0))};
}

/// `side`: the sign of half the derivative there, 1 or -1.
template <Shape kShape, bool kCentral>
[[gnu::always_inline]] inline Polished polish(const Surface& s, const Rays& rays, const Vertex& v,
                                              Lanes side) {
  const Lanes l = fma(side * v.root - v.along, v.per_a, v.centre);
  const Vector x = point_at<kCentral>(rays, l);
  const Vector n = slope<kShape>(s, x);
  const Lanes f = value<kShape>(s, x, n);
  const Lanes better = l - 0.5 * f * (side * v.per_root);
  constexpr double kMoved = kCentral ? 2.125 : 4.25;  // twice x's roundings, and 1/16 of that
  const Lanes other = fma(size_at<kShape>(s, x), all(s.of_size), all(3 * __builtin_fabs(s.j)));
  const Lanes f_error = kU * fma(dot_of_sizes(n, x), all(s.of_slope + kMoved), other) + kTiny;
  return {better, is_good(s, v, l, f, f_error, n)};
}

/// Any surface of second degree (surfaces/quadric.md).
template <Shape kShape, bool kCentral, bool kBoth>
[[gnu::always_inline]] inline Proved prove_general(const Surface& s, const Rays& rays) {
  const Vector md = times<kShape>(s, rays.d);
  const Lanes a = dot(md, rays.d), d2 = dot(rays.d, rays.d), m2 = dot(rays.m, rays.m);
  const Lanes size_a = s.norm * d2;
  const Vector n0 = slope<kShape>(s, rays.m);
  const Lanes b = dot(n0, rays.d), c = value<kShape>(s, rays.m, n0);
  const Lanes size_c = fma(m2, all(s.linear * s.norm), all(s.constant));

  const Lanes centre = -b / a;
  const Vector p = point_at<kCentral>(rays, centre);
  const Vector n = slope<kShape>(s, p);
  const Lanes along = dot(n, rays.d), level = value<kShape>(s, p, n);
  const Lanes square = along * along;
  const Lanes size = fma(dot(p, p), all(s.linear * s.norm), all(s.constant));
  const Lanes discriminant = fma(-a, level, square);
  const Lanes error =
      kU * fma(14 * abs(a), size, fma(size_a, fma(abs(level), all(8.0), 1.25 * size), 160 * square)) + kTiny;
  const Lanes root = sqrt(discriminant);
  const Lanes both = 1 / (a * root);

  const Mask is_near = (m2 < s.farthest2) & (abs(a) > 0x1p-20 * size_a);
  const Mask crosses = (discriminant > 4 * error) & is_near;
  const Mask misses = discriminant < -error;
  const Vertex vertex{a, centre, along, error, root, both * root, both * a};
  const Sides sides = sides_of(a, b, c, fma(size_c, all(12 * kU), all(kTiny)),
                               fma(size_a * size_c, all(0x1p-98), all(kTiny)));
  Proved proved{(misses | sides.behind) & is_near, crosses & sides.between, crosses & sides.ahead, {}};
  const Polished first =
      polish<kShape, kCentral>(s, rays, vertex, select(sides.between, sides.upward, -sides.upward));
  proved.l[0] = first.l;
  proved.one &= first.proved;
  proved.two &= first.proved;
  if constexpr (kBoth) {
    const Polished second = polish<kShape, kCentral>(s, rays, vertex, sides.upward);
    proved.l[1] = second.l;
    proved.two &= second.proved & (first.l < second.l);
  }
  return proved;
}

using Bytes = std::int8_t __attribute__((vector_size(kLanes)));

/// From what is proved in the surface's units to answers in the caller's: the number of hits, or -1.
template <bool kBoth>
[[gnu::always_inline]] inline Bytes conclude(const Rays& rays, Proved& proved) {
  proved.l[0] *= rays.back;
  const Mask in_range = (proved.l[0] >= kNormal) & (proved.l[0] < kInfinity);
  const Mask open = Mask{} - 1;
  Mask hits = proved.none ? Mask{} : open;
  if constexpr (kBoth) {
    proved.l[1] *= rays.back;
    hits = (proved.two & in_range & (proved.l[1] < kInfinity)) ? Mask{} + 2 : hits;
    hits = (proved.one & in_range) ? Mask{} + 1 : hits;
  } else {
    hits = ((proved.one | proved.two) & in_range) ? Mask{} + 1 : hits;
  }
  return __builtin_convertvector(hits, Bytes);
}

// Every operation on double-doubles is within 8 u^2 of the sum of its terms' sizes (lanes_double_double.hpp).

struct WideVector {
  Wide x, y, z;
};

Wide dot(const WideVector& a, const WideVector& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
WideVector operator+(const WideVector& a, const WideVector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

/// The surface's coefficients with their tails.
struct WideSurface {
  WideVector row[3];
  WideVector g;
  Wide j;

  explicit WideSurface(const Surface& s) : j{all(s.j), all(s.j_tail)} {
    const auto entry = [&](std::size_t i) { return Wide{all(s.m[i]), all(s.m_tail[i])}; };
    const auto linear = [&](std::size_t i) { return Wide{all(s.g[i]), all(s.g_tail[i])}; };
    row[0] = {entry(0), entry(3), entry(4)};
    row[1] = {entry(3), entry(1), entry(5)};
    row[2] = {entry(4), entry(5), entry(2)};
    g = {linear(0), linear(1), linear(2)};
  }
  [[nodiscard]] WideVector times(const WideVector& y) const {
    return {dot(row[0], y), dot(row[1], y), dot(row[2], y)};
  }
};

WideVector widened(const Vector& a) { return {{a.x, Lanes{}}, {a.y, Lanes{}}, {a.z, Lanes{}}}; }
Lanes norm(const Vector& a) { return sqrt(dot(a, a)); }
Vector heads(const WideVector& a) { return {a.x.hi, a.y.hi, a.z.hi}; }

/// m + rest + l d, within u^2 (3 |x_i| + 4 |m_i|) a coordinate.
WideVector wide_point_at(const Rays& rays, Lanes l) {
  const auto coordinate = [&](Lanes m, Lanes rest, Lanes d) {
    const Wide moved = two_prod(l, d), sum = two_sum(moved.hi, m);
    return two_sum(sum.hi, sum.lo + (moved.lo + rest));
  };
  return {coordinate(rays.m.x, rays.rest.x, rays.d.x), coordinate(rays.m.y, rays.rest.y, rays.d.y),
          coordinate(rays.m.z, rays.rest.z, rays.d.z)};
}

/// f at a point, with a bound on its error; half the gradient there.
struct Value {
  WideVector slope;
  Wide f;
  Lanes error;
  Lanes steep;  ///< at least |slope|, nothing cancelled
  Lanes moved;  ///< how far the point is from the one meant
};

/// `far`: |m|, or 0 for a point that is exact.
Value wide_value(const Surface& s, const WideSurface& wide, const WideVector& x, Lanes far) {
  const WideVector slope = wide.times(x) + wide.g;
  const Lanes distance = norm(heads(x));
  const Lanes steep = fma(distance, all(s.norm), all(s.gradient));
  const Lanes moved = kU2 * fma(far, all(4.0), 3 * distance);
  const Lanes size = fma(s.linear * s.norm * distance, distance, all(s.constant));
  return {slope, dot(x, slope + wide.g) + wide.j, fma(size, all(96 * kU2), 2.125 * steep * moved) + kTiny,
          steep, moved};
}

/// As polish, f in double-doubles.
Polished polish_again(const Surface& s, const WideSurface& wide, const Rays& rays, const Vertex& v, Lanes far,
                      Lanes side) {
  const Lanes l = fma(side * v.root - v.along, v.per_a, v.centre);
  const Value here = wide_value(s, wide, wide_point_at(rays, l), far);
  const Lanes better = l - 0.5 * here.f.hi * (side * v.per_root);
  return {better, is_good(s, v, l, here.f.hi, here.error, heads(here.slope))};
}

/// The second look, for rays that the first leaves open: the same with double-doubles (surfaces/quadric.md).
template <bool kBoth>
Proved prove_again(const Surface& s, const Rays& rays) {
  const WideSurface wide(s);
  const WideVector d = widened(rays.d);
  const WideVector m{{rays.m.x, rays.rest.x}, {rays.m.y, rays.rest.y}, {rays.m.z, rays.rest.z}};
  const Wide a = dot(d, wide.times(d));
  const Lanes length = norm(rays.d), far = norm(rays.m);
  const Lanes size_a = s.norm * length * length;
  const Value start = wide_value(s, wide, m, Lanes{});
  const Wide b = dot(d, start.slope);

  const Lanes centre = -b.hi / a.hi;
  const Value foot = wide_value(s, wide, wide_point_at(rays, centre), far);
  const Wide along = dot(d, foot.slope);
  const Wide discriminant = along * along + -(a * foot.f);
  const Lanes along_error = length * fma(foot.steep, all(80 * kU2), s.norm * foot.moved);
  const Lanes square = along.hi * along.hi;
  const Lanes error = 1.125 * (2 * abs(along.hi) * along_error + abs(a.hi) * foot.error +
                               80 * kU2 * (size_a * abs(foot.f.hi) + square)) +
                      kTiny;
  const Lanes root = sqrt(discriminant.hi);
  const Lanes both = 1 / (a.hi * root);

  const Mask is_curved = abs(a.hi) > 0x1p-60 * size_a;
  const Mask is_at_vertex =
      (16 * along_error * along_error < discriminant.hi) & (0x1p-30 * square < discriminant.hi);
  const Mask crosses = (discriminant.hi > 4 * error) & is_curved & is_at_vertex;
  const Vertex vertex{a.hi, centre, along.hi, error, root, both * root, both * a.hi};
  const Lanes b_error = 80 * kU2 * length * start.steep;
  const Sides sides = sides_of(a.hi, b.hi, start.f.hi, start.error, fma(b_error, b_error, all(kTiny)));
  Proved proved{((discriminant.hi < -error) | sides.behind) & is_curved,
                crosses & sides.between,
                crosses & sides.ahead,
                {}};
  const Polished first =
      polish_again(s, wide, rays, vertex, far, select(sides.between, sides.upward, -sides.upward));
  proved.l[0] = first.l;
  proved.one &= first.proved;
  proved.two &= first.proved;
  if constexpr (kBoth) {
    const Polished second = polish_again(s, wide, rays, vertex, far, sides.upward);
    proved.l[1] = second.l;
    proved.two &= second.proved & (first.l < second.l);
  }
  return proved;
}

constexpr std::size_t kBlock = 256;

/// Rays that the first look leaves open, one after another, and where they stand in the batch.
struct Open {
  alignas(64) double rays[6 * (kBlock + kLanes)];
  std::size_t at[kBlock + kLanes];
  std::size_t size = 0;
};

/// One look at `count` rays, kLanes at a time; the last ones by themselves, with zeros behind them.
template <class Look, bool kCentral, bool kBoth>
[[gnu::always_inline]] inline void look_at(const Surface& surface, const double* rays, std::size_t count,
                                           std::int8_t* hits, double* first, double* second,
                                           const Look& look) {
  double last[6 * kLanes] = {};
  double lasts[2][kLanes];
  std::int8_t last_hits[kLanes];
  for (std::size_t i = 0; i < count; i += kLanes) {
    const bool is_whole = i + kLanes <= count;
    if (!is_whole) __builtin_memcpy(last, rays + 6 * i, 6 * sizeof(double) * (count - i));
    const Rays group = rays_at<kCentral>(surface, is_whole ? rays + 6 * i : last);
    Proved proved = look(group);
    const Bytes counts = conclude<kBoth>(group, proved);
    __builtin_memcpy(is_whole ? hits + i : last_hits, &counts, sizeof counts);
    store(is_whole ? first + i : lasts[0], proved.l[0]);
    if constexpr (kBoth) store(is_whole ? second + i : lasts[1], proved.l[1]);
    if (is_whole) continue;
    __builtin_memcpy(hits + i, last_hits, count - i);
    __builtin_memcpy(first + i, lasts[0], (count - i) * sizeof(double));
    if constexpr (kBoth) __builtin_memcpy(second + i, lasts[1], (count - i) * sizeof(double));
  }
}

/// The second look at a block's open rays.
template <bool kCentral, bool kBoth>
[[gnu::noinline]] void look_again(const Surface& surface, Open& open, const SecondDegreeAnswers& to) {
  double first[kBlock + kLanes], second[kBlock + kLanes];
  std::int8_t hits[kBlock + kLanes];
  const auto look = [&](const Rays& rays) { return prove_again<kBoth>(surface, rays); };
  look_at<decltype(look), kCentral, kBoth>(surface, open.rays, open.size, hits, first, second, look);
  for (std::size_t i = 0; i < open.size; ++i) {
    to.hits[open.at[i]] = hits[i];
    if (hits[i] >= 0) to.tier[open.at[i]] = 2;
    to.first[open.at[i]] = first[i];
    if constexpr (kBoth) to.second[open.at[i]] = second[i];
  }
}

void collect_open(const double* rays, const std::int8_t* hits, std::size_t begin, std::size_t end,
                  Open& open) {
  constexpr std::uint64_t kSigns = 0x8080'8080'8080'8080;
  open.size = 0;
  for (std::size_t i = begin; i < end; i += 8) {
    const std::size_t size = end - i < 8 ? end - i : 8;
    std::uint64_t eight = 0;
    if (size == 8) __builtin_memcpy(&eight, hits + i, 8);
    if (size == 8 && (eight & kSigns) == 0) continue;  // none of the eight is -1
    for (std::size_t k = i; k < i + size; ++k) {
      if (hits[k] >= 0) continue;
      __builtin_memcpy(open.rays + 6 * open.size, rays + 6 * k, 6 * sizeof(double));
      open.at[open.size++] = k;
    }
  }
}

template <Shape kShape, bool kCentral, bool kBoth>
void answer(const Surface& s, const SecondDegreeBatch& batch, const SecondDegreeAnswers& to) {
  const Surface surface = s;  // what is stored through other pointers does not change it
  const double* const rays = &batch.rays->o.x;
  const auto look = [&](const Rays& group) {
    if constexpr (kShape == Shape::sphere || kShape == Shape::axial) {
      return prove_axial<kShape, kCentral, kBoth>(surface, group);
    } else {
      return prove_general<kShape, kCentral, kBoth>(surface, group);
    }
  };
  Open open;
  for (std::size_t begin = 0; begin < batch.count; begin += kBlock) {
    const std::size_t end = batch.count - begin < kBlock ? batch.count : begin + kBlock;
    look_at<decltype(look), kCentral, kBoth>(surface, rays + 6 * begin, end - begin, to.hits + begin,
                                             to.first + begin, to.second + begin, look);
    collect_open(rays, to.hits, begin, end, open);
    if (open.size > 0) look_again<kCentral, kBoth>(surface, open, to);
  }
}

template <Shape kShape>
void answer(const Surface& surface, const SecondDegreeBatch& batch, const SecondDegreeAnswers& to) {
  const bool is_central = surface.centre[0] == 0 && surface.centre[1] == 0 && surface.centre[2] == 0;
  if (is_central)
    return batch.both ? answer<kShape, true, true>(surface, batch, to)
                      : answer<kShape, true, false>(surface, batch, to);
  batch.both ? answer<kShape, false, true>(surface, batch, to)
             : answer<kShape, false, false>(surface, batch, to);
}

}  // namespace

void intersect_second_degree(const SecondDegreeSurface& surface, const SecondDegreeBatch& batch,
                             const SecondDegreeAnswers& answers) {
  if (surface.shape == Shape::sphere) return answer<Shape::sphere>(surface, batch, answers);
  if (surface.shape == Shape::axial) return answer<Shape::axial>(surface, batch, answers);
  if (surface.shape == Shape::central) return answer<Shape::central>(surface, batch, answers);
  if (surface.shape == Shape::diagonal) return answer<Shape::diagonal>(surface, batch, answers);
  answer<Shape::full>(surface, batch, answers);
}

}  // namespace graze::GRAZE_LANES
