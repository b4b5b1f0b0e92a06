// First and second hits of many rays with the teardrop, proved in double. Compiled once for each instruction
// set; derivation and error analysis: surfaces/teardrop.md, "Kernel".
#include <graze/surfaces/teardrop_lanes.hpp>

#include <type_traits>

#include <graze/solvers/math/lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kInfinity = __builtin_inf();
constexpr double kOpen = __builtin_nan("");
constexpr double kTiny = 0x1p-960;   // far above what underflow can add to a bound, far below what matters
constexpr std::size_t kBlock = 512;  // about 140 kB of lanes, most of them unused; few vectors are part empty
constexpr std::size_t kPadded = kBlock + kFloats;

template <class V>
using Scalar = std::remove_reference_t<decltype(V{}[0])>;
/// Half the spacing of the numbers at 1.
template <class S>
constexpr S kUnit = sizeof(S) == sizeof(float) ? S(0x1p-24) : S(0x1p-53);

/// The profile in v = y / 6m: R^2 = m^2 rho(v), rho = 9 v g^2, g = 2 - v - sqrt(v).
struct Frame {
  double m;
  double m2;          ///< m^2
  double per_height;  ///< 1 / 6m
  double per_height_tail;
  double nine_m2;  ///< 9 m^2
  double nine_m2_tail;
  double above;   ///< no point of the surface is higher
  double middle;  ///< height near which rays are recentred
};

Frame frame_of(double m) {
  const double height = 6 * m, height_tail = __builtin_fma(6, m, -height);
  const double per_height = 1 / height;
  const double per_height_tail =
      (__builtin_fma(-per_height, height, 1) - per_height * height_tail) * per_height;
  const double m2 = m * m, m2_tail = __builtin_fma(m, m, -m2);
  const double nine_m2 = 9 * m2;
  return {m,
          m2,
          per_height,
          per_height_tail,
          nine_m2,
          __builtin_fma(9, m2, -nine_m2) + 9 * m2_tail,
          height * (1 + 8 * kU),
          2.52 * m};
}

/// rho <= r0 + r1 (v - at) + r2 (v - at)^2 on [0, 1]: tangent at `at`, through (1, 0).
template <class V>
struct Majorant {
  V at, r0, r1, r2;
};

/// rho''' > 0, so the difference to the quadratic has no other zero in [0, 1] than those.
template <class V>
[[gnu::always_inline]] inline Majorant<V> majorant_at(V v) {
  const V t = sqrt(v);
  const V g = 2 - v - t;
  const V turn = 2 - 3 * v - 2 * t;
  const V w = (2 + t) / (1 + t);
  return {v, 9 * v * g * g, 9 * g * turn, -9 * w * fma(v, w, turn)};
}

/// x where it is a number, else none: infinity says a proved miss, which a division by zero is not.
template <class V>
[[gnu::always_inline]] inline V finite(V x) {
  return fma(x, V{}, x);
}

/// Lines whose entry is looked for, as arrays: an exit is the entry of the reversed line.
struct Queue {
  alignas(64) double o[3][kPadded], d[3][kPadded];
  alignas(64) double centre[kPadded];  ///< l near the closest approach
  alignas(64) double entry[kPadded];   ///< guess, l - centre; at last l, kInfinity for a miss, or kOpen
  alignas(64) double width[kPadded];   ///< of the bracket on each side; kInfinity: F bends too much in it
  alignas(64) double per_slope[kPadded];
  alignas(64) double back[kPadded];                ///< l of the caller = l here * back
  alignas(64) float p[3][kPadded], q[3][kPadded];  ///< in floats: the point at `centre`, and d
  alignas(64) float start[kPadded];                ///< where it enters the first majorant, l - centre
  alignas(64) float guess[kPadded];                ///< of entry - centre
  std::int32_t ray[kPadded];                       ///< of the block
  std::size_t size = 0;
};

struct Block {
  Queue entries, exits;
  alignas(64) double out[kPadded];  ///< by ray: where it leaves; kInfinity: not asked for
  // What is proved of the rays of `entries`, in its order.
  alignas(64) double first[kPadded], second[kPadded];
  alignas(64) std::int8_t hits[kPadded];
};

template <class V>
struct Line {
  V px, py, pz, dx, dy, dz;
};

/// A line against a majorant: m^2 Q(v(delta)) - |x_xz|^2 = a delta^2 + 2 b delta + c.
template <class V>
struct Quadratic {
  V a, b, c, discriminant;
  V error;  ///< of the discriminant: what it would have to exceed to be sure
  V size;   ///< of b, nothing cancelled
};

/// At most 24 roundings go into each of a, b, c, relative to the sums of their terms' sizes: those of p (2,
/// of its `size`), of d and of the frame included, 8 for the majorant's coefficients. So each is within 32 u,
/// and the discriminant within 64 u of the sizes' b^2 + a c; in a, the sum of two negative terms, nothing
/// cancels.
template <class V>
[[gnu::always_inline]] inline Quadratic<V> against(const Frame& frame, const Line<V>& x, const V (&size)[3],
                                                   const Majorant<V>& q) {
  using S = Scalar<V>;
  const S per_height = static_cast<S>(frame.per_height), m2 = static_cast<S>(frame.m2);
  const V k = x.dy * per_height;
  const V s = x.py * per_height - q.at;
  const V size_s = size[1] * per_height + q.at;
  const V flat = fma(x.dx, x.dx, x.dz * x.dz);
  const V r1 = abs(q.r1), r2 = abs(q.r2);
  const V a = m2 * q.r2 * k * k - flat;
  const V b = m2 * fma(q.r2, s, S(0.5) * q.r1) * k - fma(x.px, x.dx, x.pz * x.dz);
  const V c = m2 * fma(s, fma(q.r2, s, q.r1), q.r0) - fma(x.px, x.px, x.pz * x.pz);
  const V size_b = m2 * fma(r2, size_s, r1) * abs(k) + fma(size[0], abs(x.dx), size[2] * abs(x.dz));
  const V size_c =
      m2 * fma(size_s, fma(r2, size_s, r1), q.r0 + r1 + r2) + fma(size[0], size[0], size[2] * size[2]);
  return {a, b, c, fma(b, b, -(a * c)), 64 * kUnit<S> * fma(size_b, size_b, -a * size_c), size_b};
}
/// The same for a point that was rounded once.
template <class V>
[[gnu::always_inline]] inline Quadratic<V> against(const Frame& frame, const Line<V>& x,
                                                   const Majorant<V>& q) {
  return against(frame, x, {abs(x.px), abs(x.py), abs(x.pz)}, q);
}

/// F and what it depends on at a height, for steps: no error bound.
template <class V>
struct Local {
  V f, df;
  V ddf_t;  ///< F'' t
  V t;
  V size;  ///< of f's terms, nothing cancelled
};

template <class V>
[[gnu::always_inline]] inline Local<V> evaluate(const Frame& frame, const Line<V>& x, V delta) {
  using S = Scalar<V>;
  constexpr S kLeast = S(0x1p-80);  // keeps 1/t a number
  const S per_height = static_cast<S>(frame.per_height), nine_m2 = static_cast<S>(frame.nine_m2);
  const V px = fma(delta, x.dx, x.px), py = fma(delta, x.dy, x.py), pz = fma(delta, x.dz, x.pz);
  const V v = max(py * per_height, all(kLeast));
  const V k = x.dy * per_height;
  const V t = sqrt(v);
  const V g = 2 - v - t;
  const V turn = 2 - 3 * v - 2 * t;
  const V slope = nine_m2 * g * turn;
  const V df = fma(slope, k, -2 * fma(px, x.dx, pz * x.dz));
  // -F'' t = 9 m^2 ((t + 1/2) turn + g (3 t + 1)) k^2 + 2 |d_xz|^2 t: divided by t where it is wanted.
  const V bend = nine_m2 * fma(t + S(0.5), turn, g * fma(t, all(S(3)), all(S(1))));
  const V minus_ddf_t = fma(bend, k * k, 2 * t * fma(x.dx, x.dx, x.dz * x.dz));
  return {fma(nine_m2 * v * g, g, -fma(px, px, pz * pz)), df, -minus_ddf_t, t,
          fma(nine_m2 * v, abs(g) + 16 * kUnit<S>, fma(px, px, pz * pz))};
}

/// F = R^2 - |x_xz|^2 at the double l of the ray itself, with a bound on its error (surfaces/teardrop.md).
struct Sign {
  Lanes f, error;
  Mask beside;  ///< below the bottom or above the apex: outside whatever F says
};

[[gnu::always_inline]] inline Sign sign_at(const Frame& frame, const Queue& queue, std::size_t i, Lanes l) {
  const Lanes x = fma(l, load(&queue.d[0][i]), load(&queue.o[0][i]));
  const Lanes y = fma(l, load(&queue.d[1][i]), load(&queue.o[1][i]));
  const Lanes z = fma(l, load(&queue.d[2][i]), load(&queue.o[2][i]));
  // v and 9 m^2 v with the tails of their constants: one rounding each beside that of y.
  const Lanes v = fma(y, all(frame.per_height), y * frame.per_height_tail);
  const Lanes t = sqrt(max(v, Lanes{}));
  const Lanes g = 2 - v - t;
  const Lanes kv = fma(v, all(frame.nine_m2), v * frame.nine_m2_tail);
  const Lanes rho = kv * g * g;
  const Lanes square = fma(x, x, z * z);
  const Lanes size_g = abs(g) + 16 * kU;
  const Lanes bound =
      fma(kv * size_g, fma(v, all(3.0), fma(t, all(3.0), all(9.0))), fma(rho, all(7.0), 7 * square));
  const Lanes error = fma(bound, all(kU), all(kTiny));
  return {rho - square, error, (y < 0) | (y > frame.above)};
}

/// Two vectors of rays in the frame: lengths in its unit, directions by a power of two with
/// 1 <= max |d_i| < 2.
struct Rays {
  Lanes o[3], d[3];
  Lanes back;  ///< l of the caller = l here * back
};
struct RayPair {
  Rays a, b;
  Lanes centre_a, centre_b;
  Line<Floats> line;  ///< through the points at `centre`
};

[[gnu::always_inline]] inline Rays scaled(const TeardropBatch& batch, const Lanes (&x)[6]) {
  const Lanes shrink = reciprocal_power(max(abs(x[3]), max(abs(x[4]), abs(x[5]))));
  const double scale = batch.inverse_unit;
  return {{x[0] * scale, x[1] * scale, x[2] * scale},
          {x[3] * shrink, x[4] * shrink, x[5] * shrink},
          shrink * batch.unit};
}

/// Recentres two vectors of rays. The reciprocals are those of floats with one correction: 46 bits are far
/// more than a point near the closest approach needs.
[[gnu::always_inline]] inline RayPair recentred(const Frame& frame, const Rays& a, const Rays& b) {
  const auto along = [&](const Rays& r) {
    return fma(r.o[0], r.d[0], fma(r.o[1] - frame.middle, r.d[1], r.o[2] * r.d[2]));
  };
  const auto square = [](const Rays& r) { return fma(r.d[0], r.d[0], fma(r.d[1], r.d[1], r.d[2] * r.d[2])); };
  const auto centre = [](Lanes wanted, Lanes squares, Lanes inverse) {
    const Lanes near = -wanted * inverse;
    return fma(-fma(near, squares, wanted), inverse, near);
  };
  const auto point = [](const Rays& r, Lanes l, int i) { return fma(l, r.d[i], r.o[i]); };
  const Lanes square_a = square(a), square_b = square(b);
  const auto inverse = widen(1 / narrow(square_a, square_b));
  const Lanes at_a = centre(along(a), square_a, inverse.first),
              at_b = centre(along(b), square_b, inverse.second);
  return {a,
          b,
          at_a,
          at_b,
          {narrow(point(a, at_a, 0), point(b, at_b, 0)), narrow(point(a, at_a, 1), point(b, at_b, 1)),
           narrow(point(a, at_a, 2), point(b, at_b, 2)), narrow(a.d[0], b.d[0]), narrow(a.d[1], b.d[1]),
           narrow(a.d[2], b.d[2])}};
}

/// The tangent ellipsoid at v = 0.42, where the body is widest but for 1 %: the fewest lines are left.
[[gnu::always_inline]] inline Majorant<Floats> first_majorant() { return majorant_at(all(0.42F)); }

/// Lines against the first majorant, in floats throughout: those that may hit ahead are queued. The point
/// near the closest approach carries u (|p| + |o|).
[[gnu::always_inline]] inline void cull(const Frame& frame, const TeardropBatch& batch, const double* rays,
                                        std::size_t at, std::size_t count, Queue& entries) {
  // Of the radius about (0, middle, 0), of which 3.48 m reach the apex.
  const auto reach = static_cast<float>(3.6 * frame.m), middle = static_cast<float>(frame.middle);
  // |along| is within 8 u |o| |d|, which is far below sqrt(kFar) |o| |d|.
  constexpr float kFar = 0x1p-36F;
  // Of |d|, so that no square of it leaves the floats.
  constexpr float kLeast = 0x1p-30F, kMost = 0x1p30F;
  Lanes low[6], high[6];
  load_records(rays, low);
  load_records(rays + std::size_t{6} * kLanes, high);
  const double scale = batch.inverse_unit;
  const Floats ox = narrow(low[0] * scale, high[0] * scale), oy = narrow(low[1] * scale, high[1] * scale),
               oz = narrow(low[2] * scale, high[2] * scale);
  const Floats dx = narrow(low[3], high[3]), dy = narrow(low[4], high[4]), dz = narrow(low[5], high[5]);
  const Floats up = oy - middle;
  const Floats along = fma(ox, dx, fma(up, dy, oz * dz)), square = fma(dx, dx, fma(dy, dy, dz * dz));
  const Floats far = fma(ox, ox, fma(up, up, oz * oz));
  const FloatMask behind = (along > 0) & (along * along > square * fma(all(kFar), far, all(reach * reach)));
  const Floats centre = -along / square;
  const Line<Floats> line{fma(centre, dx, ox), fma(centre, dy, oy), fma(centre, dz, oz), dx, dy, dz};
  const Quadratic<Floats> q =
      against(frame, line, {abs(line.px) + abs(ox), abs(line.py) + abs(oy), abs(line.pz) + abs(oz)},
              first_majorant());
  const Floats size = max(abs(dx), max(abs(dy), abs(dz)));
  const FloatMask missed = ((q.discriminant < -q.error) | behind) & (size > kLeast) & (size < kMost);
  const unsigned left = ((1U << count) - 1) & ~to_bits(missed);
  store_selected_numbers(entries.ray + entries.size, left, static_cast<std::int32_t>(at));
  entries.size += static_cast<unsigned>(__builtin_popcount(left));
}

/// The rays of two vectors of a queue.
[[gnu::always_inline]] inline RayPair rays_of(const Frame& frame, const TeardropBatch& batch,
                                              const Queue& queue, std::size_t i) {
  const auto record = [&](std::size_t k) { return &batch.rays[queue.ray[i + k]].o.x; };
  Lanes low[6], high[6];
  load_records_at(record, low);
  load_records_at([&](std::size_t k) { return record(k + kLanes); }, high);
  return recentred(frame, scaled(batch, low), scaled(batch, high));
}

/// Files the queued rays as arrays, an exit as the entry of the reversed ray, and where they enter the first
/// majorant. Of entries, those that may not be ahead are queued in `exits`, unless that is null.
template <bool kReversed>
void file(const Frame& frame, const TeardropBatch& batch, Queue& queue, Queue* exits) {
  // What is ahead is proved to be by more than the roundings of 40 operations.
  constexpr float kMargin = 0x1p-16F;
  const auto turned = [](auto x) { return kReversed ? -x : x; };
  // The lanes behind the last ray compute too: on rays, not on whatever lies there.
  for (std::size_t i = 0; i < kFloats; ++i) queue.ray[queue.size + i] = 0;
  for (std::size_t i = 0; i < queue.size; i += kFloats) {
    const RayPair pair = rays_of(frame, batch, queue, i);
    for (std::size_t k = 0; k < 3; ++k) {
      store(&queue.o[k][i], pair.a.o[k]);
      store(&queue.o[k][i + kLanes], pair.b.o[k]);
      store(&queue.d[k][i], turned(pair.a.d[k]));
      store(&queue.d[k][i + kLanes], turned(pair.b.d[k]));
    }
    store(&queue.back[i], pair.a.back);
    store(&queue.back[i + kLanes], pair.b.back);
    store(&queue.centre[i], turned(pair.centre_a));
    store(&queue.centre[i + kLanes], turned(pair.centre_b));
    const Line<Floats>& line = pair.line;
    const Floats p[] = {line.px, line.py, line.pz}, d[] = {line.dx, line.dy, line.dz};
    for (std::size_t k = 0; k < 3; ++k) {
      store(&queue.p[k][i], p[k]);
      store(&queue.q[k][i], turned(d[k]));
    }
    // a < 0: entry before exit. The roots from the far side.
    const Quadratic<Floats> q = against(frame, line, first_majorant());
    const Floats root = sqrt(max(q.discriminant, Floats{}) + q.error) + kMargin * q.size;
    const Floats start = (kReversed ? root + q.b : root - q.b) / q.a;
    store(&queue.start[i], finite(start));
    if (kReversed || exits == nullptr) continue;
    const Floats centre = narrow(pair.centre_a, pair.centre_b);
    unsigned near = to_bits(~(start - kMargin * abs(start) > -centre + kMargin * abs(centre)));
    if (queue.size - i < kFloats) near &= (1U << (queue.size - i)) - 1;
    for (; near != 0; near &= near - 1)
      exits->ray[exits->size++] = queue.ray[i + static_cast<unsigned>(__builtin_ctz(near))];
  }
}

Line<Lanes> line_at(const Queue& queue, std::size_t i) {
  const Lanes centre = load(&queue.centre[i]);
  const Lanes dx = load(&queue.d[0][i]), dy = load(&queue.d[1][i]), dz = load(&queue.d[2][i]);
  return {fma(centre, dx, load(&queue.o[0][i])),
          fma(centre, dy, load(&queue.o[1][i])),
          fma(centre, dz, load(&queue.o[2][i])),
          dx,
          dy,
          dz};
}
Line<Floats> floats_at(const Queue& queue, std::size_t i) {
  return {load(&queue.p[0][i]), load(&queue.p[1][i]), load(&queue.p[2][i]),
          load(&queue.q[0][i]), load(&queue.q[1][i]), load(&queue.q[2][i])};
}

/// A line against the majorant that is tangent at the height of one of its points.
template <class V>
[[gnu::always_inline]] inline Quadratic<V> against_local(const Frame& frame, const Line<V>& line, V delta) {
  using S = Scalar<V>;
  constexpr S kEdge = S(0x1p-20);
  const V height = fma(delta, line.dy, line.py) * static_cast<S>(frame.per_height);
  return against(frame, line, majorant_at(min(max(height, all(kEdge)), all(1 - kEdge))));
}

/// A majorant step: it proves most of the misses that are left (kInfinity), and never passes the entry.
template <class V>
[[gnu::always_inline]] inline V step_by_majorant(const Frame& frame, const Line<V>& line, V delta) {
  const Quadratic<V> q = against_local(frame, line, delta);
  const V root = sqrt(max(q.discriminant, V{}));
  const auto cancels = q.b > 0;
  // Of -b + root and -b - root the one without cancellation; the other root of the two by their product.
  const V sum = select(cancels, -(q.b + root), root - q.b);
  const V next = finite(select(cancels, q.c, sum) / select(cancels, sum, q.a));
  return select((q.discriminant < -q.error) & (q.a < 0), all(static_cast<Scalar<V>>(kInfinity)), next);
}

/// Euler's step: the root of the local parabola, which bends the right way near a double root. A proved miss
/// stays one.
template <class V>
[[gnu::always_inline]] inline V step_by_euler(const Frame& frame, const Line<V>& line, V delta) {
  using S = Scalar<V>;
  const Local<V> here = evaluate(frame, line, delta);
  const V under = max(fma(here.df, here.df, -2 * here.f * (here.ddf_t / here.t)), V{});
  const V next = finite(delta - 2 * here.f / (here.df + sqrt(under)));
  return select(delta == static_cast<S>(kInfinity), delta, next);
}

/// Guesses in floats: what is left to double is one step and the proof. A loop for each step, so that the
/// long chains of neighbours overlap.
void guess(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kFloats)
    store(&queue.guess[i], step_by_majorant(frame, floats_at(queue, i), load(&queue.start[i])));
  for (std::size_t i = 0; i < queue.size; i += kFloats)
    store(&queue.guess[i], step_by_euler(frame, floats_at(queue, i), load(&queue.guess[i])));
  for (std::size_t i = 0; i < queue.size; i += kFloats) {
    const auto [a, b] = widen(step_by_euler(frame, floats_at(queue, i), load(&queue.guess[i])));
    store(&queue.entry[i], a);
    store(&queue.entry[i + kLanes], b);
  }
}

/// Whether a line is inside the majorant at the entry's height only below the bottom or above the apex.
Mask passes_beside(const Frame& frame, const Line<Lanes>& line, Lanes delta) {
  constexpr double kMargin = 0x1p-40;  // far more than the roundings of 40 operations
  const Quadratic<Lanes> q = against_local(frame, line, delta);
  const Lanes root = sqrt(max(q.discriminant, Lanes{}) + q.error) + kMargin * q.size;
  const Lanes in = (root - q.b) / q.a * line.dy, out = -(q.b + root) / q.a * line.dy;
  const Lanes margin = kMargin * (abs(line.py) + abs(in) + abs(out));
  const Lanes high = line.py + max(in, out) + margin, low = line.py + min(in, out) - margin;
  return (q.a < 0) & ((high < 0) | (low > frame.above));
}

/// The same in doubles with more steps, for the few that those do not settle.
void guess_hard(const Frame& frame, Queue& queue) {
  constexpr int kMajorants = 5, kEulers = 4;
  const auto each = [&](const auto& step) {
    for (std::size_t i = 0; i < queue.size; i += kLanes)
      store(&queue.entry[i], step(line_at(queue, i), load(&queue.entry[i])));
  };
  for (std::size_t i = 0; i < queue.size; i += kFloats) {
    const auto [a, b] = widen(load(&queue.start[i]));
    store(&queue.entry[i], a);
    store(&queue.entry[i + kLanes], b);
  }
  for (int step = 0; step < kMajorants; ++step) {
    each([&](const Line<Lanes>& line, Lanes delta) {
      return select(delta == kInfinity, delta, step_by_majorant(frame, line, delta));
    });
  }
  each([&](const Line<Lanes>& line, Lanes delta) {
    return select(passes_beside(frame, line, delta), all(kInfinity), delta);
  });
  for (int step = 0; step < kEulers; ++step)
    each([&](const Line<Lanes>& line, Lanes delta) { return step_by_euler(frame, line, delta); });
}

/// Chebyshev's step, of third order: its reciprocals are one division.
void polish(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kLanes) {
    const Lanes delta = load(&queue.entry[i]);
    const Local<Lanes> here = evaluate(frame, line_at(queue, i), delta);
    const Lanes per_both = 1 / (here.t * here.df);
    const Lanes ddf = here.ddf_t * (per_both * here.df), per_slope = per_both * here.t;
    const Lanes newton = here.f * per_slope;
    const Lanes next = finite(delta - newton * fma(0.5 * newton * ddf, per_slope, all(1.0)));
    store(&queue.entry[i], select(delta == kInfinity, delta, next));
    store(&queue.per_slope[i], per_slope);
    // Wide enough for the bound on F, and for what l itself is rounded by.
    const Lanes centre = load(&queue.centre[i]);
    const Lanes width = fma(32 * kU * here.size, per_slope, 4 * kU * (abs(centre + next) + abs(centre)));
    // Where F bends within the bracket its secant is no polish: those lines are left to the next tier.
    store(&queue.width[i], select(64 * abs(ddf) * width < here.df, width, all(kInfinity)));
  }
}

/// The proof: outside before a bracket about the approximation, inside behind it. The solid is convex, so a
/// line that goes in is met nowhere else going in. Leaves l.
void certify(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kLanes) {
    const Lanes centre = load(&queue.centre[i]), delta = load(&queue.entry[i]);
    const Lanes l = centre + delta;
    const Lanes width = load(&queue.width[i]);
    const Lanes low = l - width, high = l + width;
    const Sign a = sign_at(frame, queue, i, low);
    const Sign b = sign_at(frame, queue, i, high);
    const Mask outside = a.f < -a.error;
    const Mask inside = ~b.beside & (b.f > b.error);
    // A bracket that holds the origin does not say whether the hit is ahead of it.
    const Mask decided = (low > 0) | (high < 0);
    // Inside the bracket F is a line to all digits that matter: its zero from the values at both ends.
    const Lanes better = 0.5 * (low + high) - 0.5 * (a.f + b.f) * load(&queue.per_slope[i]);
    const Lanes entry = select((better >= low) & (better <= high), better, l);
    const Mask found = outside & inside & decided & (low < high), missed = delta == kInfinity;
    store(&queue.entry[i], select(missed, delta, select(found, entry, all(kOpen))));
  }
}

void find(const Frame& frame, bool is_hard, Queue& queue) {
  if (is_hard) {
    guess_hard(frame, queue);
  } else {
    guess(frame, queue);
  }
  polish(frame, queue);
  certify(frame, queue);
}

/// From what is proved of lines, where they enter and leave the solid, to what is proved of rays.
[[gnu::always_inline]] inline void decide(Lanes in, Lanes out, Lanes back, Mask both, std::size_t i,
                                          Block& block) {
  const Mask missed = (in == kInfinity) | (out == -kInfinity);
  const Mask ahead = in > 0, gone = out < 0;
  const Lanes first = select(ahead, in, out) * back, second = out * back;
  // What leaves the range of double in the caller's units is left open.
  const Mask first_fits = gone | ((first > 0) & (first < kInfinity));
  const Mask second_fits = ~both | ~ahead | (second < kInfinity);
  // The first hit needs no exit.
  const Mask ordered = (in < out) | (~both & ahead & (out != out));
  const Mask known = ordered & (ahead | (out < kInfinity)) & first_fits & second_fits;
  const Lanes some = select(both & ahead, all(2.0), all(1.0));
  const Lanes count = select(gone, Lanes{}, some);
  store(&block.first[i], first);
  store(&block.second[i], second);
  store_bytes(&block.hits[i], select(missed, Lanes{}, select(known, count, all(-1.0))));
}

/// Answers of the rays that were queued; returns how many are open.
std::size_t conclude(bool wants_both, Block& block, const TeardropAnswers& to) {
  const Queue &entries = block.entries, &exits = block.exits;
  const Mask both = all(wants_both ? 1.0 : 0.0) > 0;
  if (exits.size == 0) {
    for (std::size_t i = 0; i < entries.size; i += kLanes)
      decide(load(&entries.entry[i]), all(kInfinity), load(&entries.back[i]), both, i, block);
  } else {
    for (std::size_t i = 0; i < entries.size; ++i) block.out[entries.ray[i]] = kInfinity;
    for (std::size_t i = 0; i < exits.size; ++i) block.out[exits.ray[i]] = -exits.entry[i];
    for (std::size_t i = 0; i < entries.size; i += kLanes) {
      Lanes out;
      for (std::size_t k = 0; k < kLanes; ++k) out[k] = block.out[entries.ray[i + k]];
      decide(load(&entries.entry[i]), out, load(&entries.back[i]), both, i, block);
    }
  }
  // By names of their own: the compiler cannot know that bytes do not overlap them.
  const std::size_t size = entries.size;
  std::int8_t* const hits = to.hits;
  double* const first = to.first;
  std::size_t open = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::int32_t ray = entries.ray[i];
    hits[ray] = block.hits[i];
    first[ray] = block.first[i];
    open += block.hits[i] < 0 ? 1 : 0;
  }
  for (std::size_t i = 0; wants_both && i < entries.size; ++i) to.second[entries.ray[i]] = block.second[i];
  return open;
}

/// At most kBlock rays; returns how many it leaves open.
std::size_t solve_block(const Frame& frame, const TeardropBatch& batch, bool is_hard, Block& block,
                        const TeardropAnswers& to) {
  Queue &entries = block.entries, &exits = block.exits;
  entries.size = exits.size = 0;
  __builtin_memset(to.hits, 0, batch.count);
  for_groups<kFloats>(&batch.rays->o.x, batch.count,
                      [&](const double* rays, std::size_t at, std::size_t count) {
                        cull(frame, batch, rays, at, count, entries);
                      });
  // A line that is hard to see from one side may be easy to see from the other.
  const bool leaving = batch.both || is_hard;
  file<false>(frame, batch, entries, leaving ? nullptr : &exits);
  find(frame, is_hard, entries);
  if (leaving) {
    __builtin_memcpy(exits.ray, entries.ray, entries.size * sizeof *exits.ray);
    exits.size = entries.size;
  }
  if (exits.size > 0) {
    file<true>(frame, batch, exits, nullptr);
    find(frame, is_hard, exits);
  }
  return conclude(batch.both, block, to);
}

/// Rays that are not in one place, and their answers.
struct Aside {
  double first[kBlock], second[kBlock];
  std::int8_t hits[kBlock];
  Ray rays[kBlock];
  std::size_t place[kBlock];

  [[nodiscard]] TeardropAnswers answers() { return {hits, first, second}; }
  void move(std::size_t from, const TeardropAnswers& to, bool both) const {
    const std::size_t at = place[from];
    to.hits[at] = hits[from];
    to.first[at] = first[from];
    if (both) to.second[at] = second[from];
  }
};

/// The next open ray from `next` on, or `count`: eight at a time while none of them is.
std::size_t next_open(const std::int8_t* hits, std::size_t next, std::size_t count) {
  constexpr std::uint64_t kSigns = 0x8080808080808080;
  for (; next + sizeof(std::uint64_t) <= count; next += sizeof(std::uint64_t)) {
    std::uint64_t eight = 0;
    __builtin_memcpy(&eight, hits + next, sizeof eight);
    if ((eight & kSigns) != 0) break;
  }
  while (next < count && hits[next] >= 0) ++next;
  return next;
}

/// The rays that most steps of the first look do not settle, gathered from all blocks, so that their loops
/// are long; returns how many stay open.
std::size_t look_again(const Frame& frame, const TeardropBatch& batch, Block& block, Aside& aside,
                       const TeardropAnswers& answers) {
  std::size_t open = 0, next = 0;
  while (next < batch.count) {
    std::size_t size = 0;
    while (size < kBlock && (next = next_open(answers.hits, next, batch.count)) < batch.count) {
      aside.rays[size] = batch.rays[next];
      aside.place[size++] = next++;
    }
    if (size == 0) break;
    TeardropBatch hard = batch;
    hard.rays = aside.rays;
    hard.count = size;
    open += solve_block(frame, hard, true, block, aside.answers());
    for (std::size_t i = 0; i < size; ++i) aside.move(i, answers, batch.both);
  }
  return open;
}

}  // namespace

std::size_t intersect_teardrop(const TeardropBatch& batch, const TeardropAnswers& answers) {
  const Frame frame = frame_of(batch.m);
  Block block;
  Aside aside;
  std::size_t open = 0;
  for (std::size_t begin = 0; begin < batch.count; begin += kBlock) {
    TeardropBatch part = batch;
    part.rays = batch.rays + begin;
    part.count = batch.count - begin < kBlock ? batch.count - begin : kBlock;
    const TeardropAnswers to{answers.hits + begin, answers.first + begin, answers.second + begin};
    open += solve_block(frame, part, false, block, to);
  }
  return open == 0 ? 0 : look_again(frame, batch, block, aside, answers);
}

}  // namespace graze::GRAZE_LANES
