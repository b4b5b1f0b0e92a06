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
constexpr std::size_t kBlock = 256;  // about 60 kB of lanes
constexpr std::size_t kPadded = kBlock + kFloats;

template <class V>
using Scalar = std::remove_reference_t<decltype(V{}[0])>;
/// Half the spacing of the numbers at 1.
template <class S>
constexpr S kUnit = sizeof(S) == sizeof(float) ? S(0x1p-24) : S(0x1p-53);

/// The profile in v = y / 6m: R^2 = m^2 rho(v), rho = 9 v g^2, g = 2 - v - sqrt(v).
struct Frame {
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
  return {m2,
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

/// Lines whose entry is looked for, as arrays: an exit is the entry of the reversed line.
struct Queue {
  alignas(64) double o[3][kPadded], d[3][kPadded];
  alignas(64) double centre[kPadded];  ///< l near the closest approach
  alignas(64) double entry[kPadded];   ///< guess, l - centre; at last l, kInfinity for a miss, or kOpen
  alignas(64) double width[kPadded];   ///< what the last step leaves open
  alignas(64) double per_slope[kPadded];
  alignas(64) float p[3][kPadded], q[3][kPadded];  ///< in floats: the point at `centre`, and d
  alignas(64) float start[kPadded];                ///< where it enters the first majorant, l - centre
  alignas(64) float guess[kPadded];                ///< of entry - centre
  std::int32_t ray[kPadded];                       ///< of the block
  std::size_t size = 0;
};

struct Block {
  Queue entries, exits;
  alignas(64) double in[kPadded], out[kPadded];  ///< by ray: as Queue::entry; out = kInfinity: not asked for
  alignas(64) double back[kPadded];              ///< l of the caller = l here * back
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

/// Fewer than 20 roundings go into each of a, b, c, relative to the sums of their terms' sizes, those of p, d
/// and the frame included; the majorant's own coefficients are within 8. The discriminant is within 2 * 32 u
/// of the sizes' b^2 + a c; in a, the sum of two negative terms, nothing cancels.
template <class V>
[[gnu::always_inline]] inline Quadratic<V> against(const Frame& frame, const Line<V>& x,
                                                   const Majorant<V>& q) {
  using S = Scalar<V>;
  const S per_height = static_cast<S>(frame.per_height), m2 = static_cast<S>(frame.m2);
  const V v = x.py * per_height;
  const V k = x.dy * per_height;
  const V s = v - q.at;
  const V size_s = abs(v) + q.at;
  const V square = fma(x.px, x.px, x.pz * x.pz);
  const V flat = fma(x.dx, x.dx, x.dz * x.dz);
  const V r1 = abs(q.r1), r2 = abs(q.r2);
  const V a = m2 * q.r2 * k * k - flat;
  const V b = m2 * fma(q.r2, s, S(0.5) * q.r1) * k - fma(x.px, x.dx, x.pz * x.dz);
  const V c = m2 * fma(s, fma(q.r2, s, q.r1), q.r0) - square;
  const V size_b = m2 * fma(r2, size_s, r1) * abs(k) + fma(abs(x.px), abs(x.dx), abs(x.pz) * abs(x.dz));
  const V size_c = m2 * fma(size_s, fma(r2, size_s, r1), q.r0 + r1 + r2) + square;
  return {a, b, c, fma(b, b, -(a * c)), 64 * kUnit<S> * fma(size_b, size_b, -a * size_c), size_b};
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

/// Two vectors of rays in the frame.
struct Rays {
  Lanes o[3], d[3];
  Lanes centre;
};

/// Recentres kLanes rays: lengths in the frame's unit, directions by a power of two with 1 <= max |d_i| < 2.
[[gnu::always_inline]] inline Rays read(const Frame& frame, const TeardropBatch& batch, const double* rays,
                                        double* back) {
  Lanes x[6];
  load_records(rays, x);
  const Lanes shrink = reciprocal_power(max(abs(x[3]), max(abs(x[4]), abs(x[5]))));
  store(back, shrink * batch.unit);
  const double scale = batch.inverse_unit;
  Rays r{{x[0] * scale, x[1] * scale, x[2] * scale}, {x[3] * shrink, x[4] * shrink, x[5] * shrink}, {}};
  const Lanes along = fma(r.o[0], r.d[0], fma(r.o[1] - frame.middle, r.d[1], r.o[2] * r.d[2]));
  r.centre = -along / fma(r.d[0], r.d[0], fma(r.d[1], r.d[1], r.d[2] * r.d[2]));
  return r;
}

[[gnu::always_inline]] inline Line<Floats> line_of(const Rays& a, const Rays& b) {
  const auto point = [](const Rays& r, int i) { return fma(r.centre, r.d[i], r.o[i]); };
  return {narrow(point(a, 0), point(b, 0)), narrow(point(a, 1), point(b, 1)),
          narrow(point(a, 2), point(b, 2)), narrow(a.d[0], b.d[0]),
          narrow(a.d[1], b.d[1]),           narrow(a.d[2], b.d[2])};
}

/// Appends the selected lanes of rays, or of the reversed rays, to a queue.
template <bool kReversed>
inline void append(Queue& queue, unsigned lanes, std::size_t at, const Rays& a, const Rays& b,
                   const Line<Floats>& line, Floats start) {
  const auto turned = [](auto x) { return kReversed ? -x : x; };
  const Floats p[] = {line.px, line.py, line.pz}, q[] = {line.dx, line.dy, line.dz};
  constexpr unsigned kHalf = (1U << kLanes) - 1;
  const unsigned low = lanes & kHalf, high = lanes >> kLanes;
  const std::size_t to = queue.size, then = to + static_cast<unsigned>(__builtin_popcount(low));
  for (std::size_t k = 0; k < 3; ++k) {
    store_selected(queue.o[k] + to, low, a.o[k]);
    store_selected(queue.o[k] + then, high, b.o[k]);
    store_selected(queue.d[k] + to, low, turned(a.d[k]));
    store_selected(queue.d[k] + then, high, turned(b.d[k]));
    store_selected(queue.p[k] + to, lanes, p[k]);
    store_selected(queue.q[k] + to, lanes, turned(q[k]));
  }
  store_selected(queue.centre + to, low, turned(a.centre));
  store_selected(queue.centre + then, high, turned(b.centre));
  store_selected(queue.start + to, lanes, turned(start));
  store_selected_numbers(queue.ray + to, lanes, static_cast<std::int32_t>(at));
  queue.size = to + static_cast<unsigned>(__builtin_popcount(lanes));
}

/// Rays against the first majorant, in floats: those that may hit are queued.
void cull(const Frame& frame, const TeardropBatch& batch, const Majorant<Floats>& ellipsoid,
          const double* rays, std::size_t at, std::size_t count, bool is_hard, Block& block) {
  // What lies behind the origin is proved to, and what is ahead is, by more than the roundings of 40
  // operations.
  constexpr float kMargin = 0x1p-16F;
  const Rays a = read(frame, batch, rays, &block.back[at]);
  const Rays b = read(frame, batch, rays + std::size_t{6} * kLanes, &block.back[at + kLanes]);
  const Line<Floats> line = line_of(a, b);
  const Quadratic<Floats> q = against(frame, line, ellipsoid);
  const FloatMask missed = q.discriminant < -q.error;
  // a < 0: entry before exit. The roots from the far side, so that "behind" is certain.
  const Floats root = sqrt(max(q.discriminant, Floats{}) + q.error) + kMargin * q.size;
  const Floats per_a = 1 / q.a;
  const Floats in_at = (root - q.b) * per_a, out_at = -(q.b + root) * per_a;
  const Floats centre = narrow(a.centre, b.centre);
  const FloatMask behind = out_at + kMargin * abs(out_at) < -centre - kMargin * abs(centre);
  const FloatMask ahead = in_at - kMargin * abs(in_at) > -centre + kMargin * abs(centre);
  for (std::size_t i = 0; i < kFloats; i += kLanes) {
    store(&block.in[at + i], all(kInfinity));
    store(&block.out[at + i], all(kInfinity));
  }
  const unsigned left = ((1U << count) - 1) & ~to_bits(missed | behind);
  // A line that is hard to see from one side may be easy to see from the other.
  const unsigned leaving = batch.both || is_hard ? left : left & ~to_bits(ahead);
  append<false>(block.entries, left, at, a, b, line, in_at);
  if (leaving != 0) append<true>(block.exits, leaving, at, a, b, line, out_at);
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
  const V next = select(cancels, q.c, sum) / select(cancels, sum, q.a);
  return select((q.discriminant < -q.error) & (q.a < 0), all(static_cast<Scalar<V>>(kInfinity)), next);
}

/// Euler's step: the root of the local parabola, which bends the right way near a double root. A proved miss
/// stays one.
template <class V>
[[gnu::always_inline]] inline V step_by_euler(const Frame& frame, const Line<V>& line, V delta) {
  using S = Scalar<V>;
  const Local<V> here = evaluate(frame, line, delta);
  const V under = max(fma(here.df, here.df, -2 * here.f * (here.ddf_t / here.t)), V{});
  const V next = delta - 2 * here.f / (here.df + sqrt(under));
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
    const Lanes next = delta - newton * fma(0.5 * newton * ddf, per_slope, all(1.0));
    store(&queue.entry[i], select(delta == kInfinity, delta, next));
    store(&queue.per_slope[i], per_slope);
    // Where F bends within the bracket its secant is no polish: those lines are left to the next tier.
    const Lanes width = 32 * kU * here.size * per_slope;
    store(&queue.width[i], select(64 * abs(ddf) * width < here.df, width, all(kInfinity)));
  }
}

/// The proof: outside before a bracket about the approximation, inside behind it. The solid is convex, so a
/// line that goes in is met nowhere else going in. Leaves l.
void certify(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kLanes) {
    const Lanes centre = load(&queue.centre[i]), delta = load(&queue.entry[i]);
    const Lanes l = centre + delta;
    // Wide enough for the bound on F, and for what l itself was rounded by.
    const Lanes width = load(&queue.width[i]) + 4 * kU * (abs(l) + abs(centre));
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

/// The lanes behind the last line compute too: on numbers, not on whatever lies there.
template <std::size_t kParts, class T>
void pad(T* const (&parts)[kParts], std::size_t size) {
  for (T* const part : parts) {
    for (std::size_t i = 0; i < kFloats; ++i) part[size + i] = 0;
  }
}
void pad(Queue& queue) {
  pad<8>({queue.o[0], queue.o[1], queue.o[2], queue.d[0], queue.d[1], queue.d[2], queue.centre, queue.entry},
         queue.size);
  pad<7>({queue.p[0], queue.p[1], queue.p[2], queue.q[0], queue.q[1], queue.q[2], queue.start}, queue.size);
}

void find(const Frame& frame, bool is_hard, Queue& queue) {
  if (queue.size == 0) return;
  pad(queue);
  if (is_hard) {
    guess_hard(frame, queue);
  } else {
    guess(frame, queue);
  }
  polish(frame, queue);
  certify(frame, queue);
}

/// From what is proved of the lines to what is proved of the rays.
std::size_t conclude(bool wants_both, std::size_t size, Block& block, const TeardropAnswers& to) {
  for (std::size_t i = 0; i < block.entries.size; ++i)
    block.in[block.entries.ray[i]] = block.entries.entry[i];
  for (std::size_t i = 0; i < block.exits.size; ++i) block.out[block.exits.ray[i]] = -block.exits.entry[i];
  const Mask both = all(wants_both ? 1.0 : 0.0) > 0;
  std::size_t open = 0;
  for (std::size_t i = 0; i < size; i += kLanes) {
    const Lanes in = load(&block.in[i]), out = load(&block.out[i]), back = load(&block.back[i]);
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
    store_bytes(to.hits + i, select(missed, Lanes{}, select(known, count, all(-1.0))));
    store(to.first + i, first);
    if (wants_both) store(to.second + i, second);
    const std::size_t rest = size - i;
    const unsigned real = rest < kLanes ? (1U << rest) - 1 : (1U << kLanes) - 1;
    open += static_cast<unsigned>(__builtin_popcount(to_bits(~(missed | known)) & real));
  }
  return open;
}

/// At most kBlock rays; returns how many it leaves open.
std::size_t solve_block(const Frame& frame, const TeardropBatch& batch, bool is_hard, Block& block,
                        const TeardropAnswers& to) {
  // The tangent ellipsoid at v = 0.42, where the body is widest but for 1 %: the fewest lines are left.
  const Majorant<Floats> ellipsoid = majorant_at(all(0.42F));
  block.entries.size = block.exits.size = 0;
  for_groups<kFloats>(&batch.rays->o.x, batch.count,
                      [&](const double* rays, std::size_t at, std::size_t count) {
                        cull(frame, batch, ellipsoid, rays, at, count, is_hard, block);
                      });
  find(frame, is_hard, block.entries);
  find(frame, is_hard, block.exits);
  return conclude(batch.both, batch.count, block, to);
}

/// Answers of a block that is not whole, or not in one place.
struct Aside {
  alignas(64) double first[kPadded], second[kPadded];
  alignas(64) std::int8_t hits[kPadded];
  Ray rays[kBlock];
  std::int32_t place[kBlock];

  [[nodiscard]] TeardropAnswers answers() { return {hits, first, second}; }
  void move(std::size_t from, const TeardropAnswers& to, std::size_t at, bool both) const {
    to.hits[at] = hits[from];
    to.first[at] = first[from];
    if (both) to.second[at] = second[from];
  }
};

/// The rays that most steps of the first look do not settle, gathered from all blocks, so that their loops
/// are long; returns how many stay open.
std::size_t look_again(const Frame& frame, const TeardropBatch& batch, Block& block, Aside& aside,
                       const TeardropAnswers& answers) {
  std::size_t open = 0, next = 0;
  while (next < batch.count) {
    std::size_t size = 0;
    for (; next < batch.count && size < kBlock; ++next) {
      if (answers.hits[next] >= 0) continue;
      aside.rays[size] = batch.rays[next];
      aside.place[size++] = static_cast<std::int32_t>(next);
    }
    if (size == 0) break;
    TeardropBatch hard = batch;
    hard.rays = aside.rays;
    hard.count = size;
    open += solve_block(frame, hard, true, block, aside.answers());
    for (std::size_t i = 0; i < size; ++i)
      aside.move(i, answers, static_cast<std::size_t>(aside.place[i]), batch.both);
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
    // Whole vectors are written: the last ones, where they would be too long, aside.
    const bool is_whole = part.count % kLanes == 0;
    open += solve_block(frame, part, false, block, is_whole ? to : aside.answers());
    for (std::size_t i = 0; !is_whole && i < part.count; ++i) aside.move(i, to, i, batch.both);
  }
  return open == 0 ? 0 : look_again(frame, batch, block, aside, answers);
}

}  // namespace graze::GRAZE_LANES
