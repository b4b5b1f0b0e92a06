// First and second hits of many rays with a surface of second degree, proved in double. Compiled once for
// each instruction set; derivation and error analysis: surfaces/quadric.md and surfaces/sphere.md, "Kernel".
#include <graze/surfaces/second_degree_lanes.hpp>

#include <graze/solvers/math/lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

using Surface = SecondDegreeSurface;
using Shape = SecondDegreeSurface::Shape;

constexpr double kU = 0x1p-53;
constexpr double kInfinity = __builtin_inf();
constexpr double kNormal = 0x1p-1022;  // below, l would be rounded by more than u of itself
constexpr double kTiny = 0x1p-960;     // far above what underflow can add to a bound, far below what matters

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

/// The six numbers of each ray, one vector a coordinate: o, then d.
#if defined(__AVX512F__) && defined(__AVX512DQ__)
/// Rays 0 to 3 and 4 to 7 lie alike in three vectors each: two blends gather a pair of coordinates of four
/// rays, in another order, and one permutation a coordinate puts both halves in order.
void load_rays(const double* from, Vector& o, Vector& d) {
  const Lanes a = load(from), b = load(from + 8), c = load(from + 16);
  const Lanes e = load(from + 24), f = load(from + 32), g = load(from + 40);
  const auto first = [](Lanes p, Lanes q, Lanes r) {  // rays 0, 3, 2, 1
    return __builtin_shufflevector(__builtin_shufflevector(p, q, 0, 1, 2, 3, 12, 13, 6, 7), r, 0, 1, 10, 11,
                                   4, 5, 6, 7);
  };
  const auto second = [](Lanes p, Lanes q, Lanes r) {  // rays 1, 0, 3, 2
    return __builtin_shufflevector(__builtin_shufflevector(p, q, 8, 9, 2, 3, 4, 5, 14, 15), r, 0, 1, 2, 3, 12,
                                   13, 6, 7);
  };
  const auto third = [](Lanes p, Lanes q, Lanes r) {  // rays 2, 1, 0, 3
    return __builtin_shufflevector(__builtin_shufflevector(p, q, 0, 1, 10, 11, 4, 5, 6, 7), r, 8, 9, 2, 3, 4,
                                   5, 14, 15);
  };
  const Lanes s = first(a, b, c), t = first(e, f, g);
  const Lanes v = second(a, b, c), w = second(e, f, g);
  const Lanes x = third(a, b, c), y = third(e, f, g);
  o.x = __builtin_shufflevector(s, t, 0, 6, 4, 2, 8, 14, 12, 10);
  o.y = __builtin_shufflevector(s, t, 1, 7, 5, 3, 9, 15, 13, 11);
  o.z = __builtin_shufflevector(v, w, 2, 0, 6, 4, 10, 8, 14, 12);
  d.x = __builtin_shufflevector(v, w, 3, 1, 7, 5, 11, 9, 15, 13);
  d.y = __builtin_shufflevector(x, y, 4, 2, 0, 6, 12, 10, 8, 14);
  d.z = __builtin_shufflevector(x, y, 5, 3, 1, 7, 13, 11, 9, 15);
}
#elif defined(__AVX2__) && defined(__FMA__)
/// The same in halves of two numbers: those of rays 0 and 2, those of rays 1 and 3, and both in turn.
void load_rays(const double* from, Vector& o, Vector& d) {
  const Lanes a = load(from), b = load(from + 4), c = load(from + 8);
  const Lanes e = load(from + 12), f = load(from + 16), g = load(from + 20);
  const auto pairs = [](Lanes even, Lanes odd, Lanes& low, Lanes& high) {
    low = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
    high = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
  };
  pairs(__builtin_shufflevector(a, e, 0, 1, 4, 5), __builtin_shufflevector(b, f, 2, 3, 6, 7), o.x, o.y);
  pairs(__builtin_shufflevector(a, e, 2, 3, 6, 7), __builtin_shufflevector(c, g, 0, 1, 4, 5), o.z, d.x);
  pairs(__builtin_shufflevector(b, f, 0, 1, 4, 5), __builtin_shufflevector(c, g, 2, 3, 6, 7), d.y, d.z);
}
#else
void load_rays(const double* from, Vector& o, Vector& d) {
  const auto at = [&](std::size_t k) { return load_strided(from + k, 6); };
  o = {at(0), at(1), at(2)};
  d = {at(3), at(4), at(5)};
}
#endif

/// Lengths in the surface's unit, the largest |d_i| in [1, 2): exact, short of underflow.
Rays rays_at(const Surface& surface, bool is_central, const double* from) {
  Vector o, d;
  load_rays(from, o, d);
  const Lanes shrink = reciprocal_power(max(abs(d.x), max(abs(d.y), abs(d.z))));
  o = {o.x * surface.inverse_unit, o.y * surface.inverse_unit, o.z * surface.inverse_unit};
  Rays rays{o, {}, {d.x * shrink, d.y * shrink, d.z * shrink}, shrink * surface.unit};
  if (is_central) return rays;
  subtract(o.x, surface.centre[0], rays.m.x, rays.rest.x);
  subtract(o.y, surface.centre[1], rays.m.y, rays.rest.y);
  subtract(o.z, surface.centre[2], rays.m.z, rays.rest.z);
  return rays;
}

/// The point at l, rounded twice a coordinate (once where the rest is zero).
Vector point_at(const Rays& rays, Lanes l) {
  return {fma(l, rays.d.x, rays.m.x) + rays.rest.x, fma(l, rays.d.y, rays.m.y) + rays.rest.y,
          fma(l, rays.d.z, rays.m.z) + rays.rest.z};
}

template <Shape kShape>
Vector times(const Surface& s, const Vector& y) {
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
Vector slope(const Surface& s, const Vector& y) {
  if constexpr (kShape == Shape::diagonal) {
    return {fma(all(s.m[0]), y.x, all(s.g[0])), fma(all(s.m[1]), y.y, all(s.g[1])),
            fma(all(s.m[2]), y.z, all(s.g[2]))};
  } else {
    return {fma(all(s.m[0]), y.x, fma(all(s.m[3]), y.y, fma(all(s.m[4]), y.z, all(s.g[0])))),
            fma(all(s.m[3]), y.x, fma(all(s.m[1]), y.y, fma(all(s.m[5]), y.z, all(s.g[1])))),
            fma(all(s.m[4]), y.x, fma(all(s.m[5]), y.y, fma(all(s.m[2]), y.z, all(s.g[2]))))};
  }
}

/// f(y), by its slope there.
Lanes value(const Surface& s, const Vector& y, const Vector& slope) {
  return fma(y.x, slope.x + s.g[0], fma(y.y, slope.y + s.g[1], fma(y.z, slope.z + s.g[2], all(s.j))));
}

/// What is proved of kLanes rays; of `one` and `two` the hits are l[0] and l[1].
struct Proved {
  Mask none, one, two;
  Lanes l[2];
};

/// Sphere and ellipsoid in its axes: from the foot, -B/A, no term of the filter or of l cancels, and l needs
/// no correction (surfaces/sphere.md).
template <Shape kShape, bool kBoth>
Proved prove_axial(const Surface& s, const Rays& rays) {
  const double j = -s.j;
  const Vector md = times<kShape>(s, rays.d), mm = times<kShape>(s, rays.m);
  const Lanes a = dot(md, rays.d), b = dot(mm, rays.d), q0 = dot(mm, rays.m);
  const Lanes c0 = q0 - j;
  const Lanes m2 = kShape == Shape::sphere ? q0 : dot(rays.m, rays.m);
  const Lanes per_a = 1 / a;
  const Lanes centre = -b * per_a;
  const Vector p = point_at(rays, centre);
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
  double roundings;       ///< of a point's coordinate
};

/// `side`: the sign of half the derivative there, 1 or -1.
template <Shape kShape>
Polished polish(const Surface& s, const Rays& rays, const Vertex& v, Lanes side) {
  const Lanes l = fma(side * v.root - v.along, v.per_a, v.centre);
  const Vector x = point_at(rays, l);
  const Vector n = slope<kShape>(s, x);
  const Lanes f = value(s, x, n);
  const Lanes better = l - 0.5 * f * (side * v.per_root);
  const Lanes size = fma(dot(x, x), all(s.linear * s.norm), all(s.constant));
  const Lanes f_error = fma(size, all(9 * kU), 2 * kU * v.roundings * dot_of_sizes(n, x)) + kTiny;
  const Lanes f_most = abs(f) + f_error;
  const Lanes curved = fma(abs(v.a), f_most, v.error) * (v.per_root * v.per_root);
  const Lanes most = fma(f_most, 16 * kU + curved, f_error);
  // |n| is at least the sum of its sizes over sqrt 3; 8 < 16 / sqrt 3 * sqrt(4 / 5).
  const Lanes allowed = kU * fma(14 * v.root, abs(l), 8 * s.length * sum_of_sizes(n));
  const Mask is_close = abs(v.a * l) * 0x1p-48 < v.root;
  return {better, (most < allowed) & is_close};
}

/// Any surface of second degree (surfaces/quadric.md).
template <Shape kShape, bool kBoth>
Proved prove_general(const Surface& s, const Rays& rays, bool is_central) {
  const Vector md = times<kShape>(s, rays.d);
  const Lanes a = dot(md, rays.d), d2 = dot(rays.d, rays.d), m2 = dot(rays.m, rays.m);
  const Lanes size_a = s.norm * d2;
  const Vector n0 = slope<kShape>(s, rays.m);
  const Lanes b = dot(n0, rays.d), c = value(s, rays.m, n0);
  const Lanes size_c = fma(m2, all(s.linear * s.norm), all(s.constant));

  const Lanes first_centre = -b / a;
  const Vector p = point_at(rays, first_centre);
  const Vector n = slope<kShape>(s, p);
  const Lanes along = dot(n, rays.d), level = value(s, p, n);
  const Lanes square = along * along;
  const Lanes size = fma(dot(p, p), all(s.linear * s.norm), all(s.constant));
  const Lanes discriminant = fma(-a, level, square);
  const Lanes error =
      kU * fma(14 * abs(a), size, fma(size_a, fma(abs(level), all(8.0), 1.25 * size), 160 * square)) + kTiny;
  const Lanes root = sqrt(discriminant);
  const Lanes both = 1 / (a * root);

  const Mask is_near = (m2 < s.farthest2) & (abs(a) > 0x1p-20 * size_a);
  const Mask crosses = (discriminant > 4 * error) & is_near;
  const Mask misses = (discriminant < -error) & is_near;
  const Mask is_off = abs(c) > fma(size_c, all(12 * kU), all(kTiny));
  const Mask is_clear = b * b > fma(size_a * size_c, all(0x1p-98), all(kTiny));
  const Mask same_side = is_off & ((a > 0) == (c > 0));
  const Mask between = is_off & ((a > 0) != (c > 0));
  const Mask ahead = (a > 0) != (b > 0);  // of the vertex

  const Vertex vertex{a, first_centre, along, error, root, both * root, both * a, is_central ? 1.0 : 2.0};
  const Lanes upward = select(a > 0, all(1.0), all(-1.0));  // of the far root
  Proved proved{misses | (same_side & is_clear & ~ahead & is_near),
                crosses & between,
                crosses & same_side & is_clear & ahead,
                {}};
  const Polished first = polish<kShape>(s, rays, vertex, select(between, upward, -upward));
  proved.l[0] = first.l;
  proved.one &= first.proved;
  proved.two &= first.proved;
  if constexpr (kBoth) {
    const Polished second = polish<kShape>(s, rays, vertex, upward);
    proved.l[1] = second.l;
    proved.two &= second.proved & (first.l < second.l);
  }
  return proved;
}

using Bytes = std::int8_t __attribute__((vector_size(kLanes)));

/// From what is proved in the surface's units to answers in the caller's: the number of hits, or -1.
template <bool kBoth>
Bytes conclude(const Rays& rays, Proved& proved) {
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

template <Shape kShape, bool kBoth>
void answer_lanes(const Surface& surface, bool is_central, const double* from, std::int8_t* hits,
                  double* first, double* second) {
  const Rays rays = rays_at(surface, is_central, from);
  Proved proved;
  if constexpr (kShape == Shape::sphere || kShape == Shape::axial) {
    proved = prove_axial<kShape, kBoth>(surface, rays);
  } else {
    proved = prove_general<kShape, kBoth>(surface, rays, is_central);
  }
  const Bytes counts = conclude<kBoth>(rays, proved);
  __builtin_memcpy(hits, &counts, sizeof counts);
  store(first, proved.l[0]);
  if constexpr (kBoth) store(second, proved.l[1]);
}

template <Shape kShape, bool kBoth>
void answer_all(const Surface& s, const SecondDegreeBatch& batch, const SecondDegreeAnswers& to) {
  const Surface surface = s;  // what is stored through other pointers does not change it
  const bool is_central = surface.centre[0] == 0 && surface.centre[1] == 0 && surface.centre[2] == 0;
  const double* const rays = &batch.rays->o.x;
  std::size_t i = 0;
  for (; i + kLanes <= batch.count; i += kLanes)
    answer_lanes<kShape, kBoth>(surface, is_central, rays + 6 * i, to.hits + i, to.first + i, to.second + i);
  if (i == batch.count) return;
  // The last ones by themselves: the lanes behind them compute on zeros.
  double last[6 * kLanes] = {};
  double first[kLanes], second[kLanes];
  std::int8_t hits[kLanes];
  const std::size_t rest = batch.count - i;
  __builtin_memcpy(last, rays + 6 * i, 6 * sizeof(double) * rest);
  answer_lanes<kShape, kBoth>(surface, is_central, last, hits, first, second);
  __builtin_memcpy(to.hits + i, hits, rest);
  __builtin_memcpy(to.first + i, first, rest * sizeof(double));
  if constexpr (kBoth) __builtin_memcpy(to.second + i, second, rest * sizeof(double));
}

template <Shape kShape>
void answer(const Surface& surface, const SecondDegreeBatch& batch, const SecondDegreeAnswers& to) {
  batch.both ? answer_all<kShape, true>(surface, batch, to) : answer_all<kShape, false>(surface, batch, to);
}

}  // namespace

void intersect_second_degree(const SecondDegreeSurface& surface, const SecondDegreeBatch& batch,
                             const SecondDegreeAnswers& answers) {
  if (surface.shape == Shape::sphere) return answer<Shape::sphere>(surface, batch, answers);
  if (surface.shape == Shape::axial) return answer<Shape::axial>(surface, batch, answers);
  if (surface.shape == Shape::diagonal) return answer<Shape::diagonal>(surface, batch, answers);
  answer<Shape::full>(surface, batch, answers);
}

}  // namespace graze::GRAZE_LANES
