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
constexpr std::size_t kBlock = 512;  // few vectors are part empty; 128 to 512 were equally fast
constexpr std::size_t kPadded = kBlock + kFloats;

template <class V>
using Scalar = std::remove_reference_t<decltype(V{}[0])>;

/// The profile in v = y / 6m: R^2 = m^2 rho(v), rho = 9 v g^2, g = 2 - v - sqrt(v).
struct Frame {
  double m;
  double m2;          ///< m^2
  double per_height;  ///< 1 / 6m
  double per_height_tail;
  double nine_m2;  ///< 9 m^2
  double above;    ///< no point of the surface is higher
  // The first majorant, an ellipsoid: |x_xz|^2 + stretch2 (y - middle)^2 <= radius2.
  float middle, stretch2, radius2;
};

/// rho / 9 <= r0 + r1 (v - at) + r2 (v - at)^2 on [0, 1]: tangent at `at`, through (1, 0).
template <class V>
struct Majorant {
  V at, r0, r1, r2;
};

/// At t^2. rho''' > 0, so the difference to the quadratic has no other zero in [0, 1] than those.
template <class V>
[[gnu::always_inline]] inline Majorant<V> majorant_at(V t) {
  const V v = t * t;
  const V g = 2 - v - t, turn = 2 - 3 * v - 2 * t;
  const V w = (2 + t) / (1 + t);
  return {v, v * g * g, g * turn, -w * (v * w + turn)};
}

/// Majorants are tangent at v from here to 1 less it: beyond, r0 and r1 have no digits.
constexpr double kEdge = 0x1p-20;
/// Of the tangent ellipsoid at v = 0.42, where the body is widest but for 1 %: the fewest lines are left.
constexpr double kFirst = 0.648;

/// (R^2)' in y, v = t^2 = y / 6m, is 1.5 m g turn.
template <class V>
[[gnu::always_inline]] inline V turn_at(V v, V t) {
  using S = Scalar<V>;
  return fma(v, all(S(-3)), fma(t, all(S(-2)), all(S(2))));
}
/// -(R^2)'' in y is bend / 4t.
template <class V>
[[gnu::always_inline]] inline V bend_at(V t) {
  using S = Scalar<V>;
  return fma(fma(fma(t, all(S(-6)), all(S(-7.5))), t, all(S(6))), t, all(S(3)));
}

Frame frame_of(double m) {
  const double height = 6 * m, height_tail = __builtin_fma(6, m, -height), per_height = 1 / height;
  const double m2 = m * m, nine_m2 = 9 * m2;
  const Majorant<double> q = majorant_at(kFirst);
  const double widest = q.at - 0.5 * q.r1 / q.r2;
  // Wider by more than all roundings of these constants and of `cull`.
  constexpr double kMargin = 1 + 0x1p-18;
  return {m,
          m2,
          per_height,
          (__builtin_fma(-per_height, height, 1) - per_height * height_tail) * per_height,
          nine_m2,
          height * (1 + 8 * kU),
          static_cast<float>(height * widest),
          static_cast<float>(-q.r2 / 4),
          static_cast<float>(kMargin * nine_m2 * (q.r0 - 0.25 * q.r1 * q.r1 / q.r2))};
}

/// x where it is a number, else none: infinity says a proved miss, which a division by zero is not.
template <class V>
[[gnu::always_inline]] inline V finite(V x) {
  return fma(x, V{}, x);
}

/// Lines that may hit, as arrays.
struct Lines {
  alignas(64) double o[3][kPadded], d[3][kPadded];
  alignas(64) double back[kPadded];                   ///< where d is scaled: l of the caller = l here * back
  alignas(64) float middle[kPadded], half2[kPadded];  ///< l in the first ellipsoid: middle +- sqrt(half2)
  std::int32_t ray[kPadded];                          ///< of the block
  std::size_t size = 0;
};

/// Where lines enter; an exit is the entry of the reversed line.
struct Search {
  alignas(64) double entry[kPadded];  ///< guess; at last l, kInfinity for a miss, or kOpen
  alignas(
      64) double near[kPadded];  ///< l where it enters the first ellipsoid; of the hard, where it is closest
  alignas(64) float p[3][kPadded], q[3][kPadded];  ///< in floats: the point at `near`, and d
  alignas(64) float guess[kPadded];                ///< of entry - near
};

struct Block {
  Lines lines;
  Lines rest;  ///< of them: those whose exits are looked for too, where the first hit is wanted
  Search entries, exits;
  // What is proved of the rays of `lines`.
  alignas(64) double first[kPadded], second[kPadded], hits[kPadded];
  std::size_t place[kPadded];       ///< of the rest, among the lines
  unsigned left[kBlock / kFloats];  ///< a bit a ray: whether it is among the lines
};

template <class V>
struct Line {
  V px, py, pz, dx, dy, dz;
};

/// A line against a majorant: m^2 Q(v(delta)) - |x_xz|^2 = a delta^2 + 2 b delta + c.
struct Quadratic {
  Lanes a, b, c, discriminant;
  Lanes error;  ///< of the discriminant: what it would have to exceed to be sure
  Lanes size;   ///< of b, nothing cancelled
};

/// At most 24 roundings go into each of a, b, c, relative to the sums of their terms' sizes: that of p and
/// those of the frame included, 8 for the majorant's coefficients. So each is within 32 u, and the
/// discriminant within 64 u of the sizes' b^2 + a c; in a, the sum of two negative terms, nothing cancels.
[[gnu::always_inline]] inline Quadratic against(const Frame& frame, const Line<Lanes>& x,
                                                const Majorant<Lanes>& q) {
  const Lanes k = x.dy * frame.per_height;
  const Lanes s = x.py * frame.per_height - q.at;
  const Lanes size_s = abs(x.py) * frame.per_height + q.at;
  const Lanes flat = fma(x.dx, x.dx, x.dz * x.dz), square = fma(x.px, x.px, x.pz * x.pz);
  const Lanes r1 = abs(q.r1), r2 = abs(q.r2);
  const Lanes a = frame.nine_m2 * q.r2 * k * k - flat;
  const Lanes b = frame.nine_m2 * fma(q.r2, s, 0.5 * q.r1) * k - fma(x.px, x.dx, x.pz * x.dz);
  const Lanes c = frame.nine_m2 * fma(s, fma(q.r2, s, q.r1), q.r0) - square;
  const Lanes size_b =
      frame.nine_m2 * fma(r2, size_s, r1) * abs(k) + fma(abs(x.px), abs(x.dx), abs(x.pz * x.dz));
  const Lanes size_c = frame.nine_m2 * fma(size_s, fma(r2, size_s, r1), q.r0 + r1 + r2) + square;
  return {a, b, c, fma(b, b, -(a * c)), 64 * kU * fma(size_b, size_b, -a * size_c), size_b};
}

/// F and what it depends on at a point of a line, for steps: no error bound.
template <class V>
struct Local {
  V f, df;
  V bend;  ///< -F'' t / 2
  V t;
};

template <class V>
[[gnu::always_inline]] inline Local<V> evaluate(const Frame& frame, const Line<V>& x, V delta) {
  using S = Scalar<V>;
  constexpr S kLeast = S(0x1p-80);  // v below would give denormal floats
  const S per_height = static_cast<S>(frame.per_height), nine_m2 = static_cast<S>(frame.nine_m2);
  const S slope = static_cast<S>(1.5 * frame.m);
  const V px = fma(delta, x.dx, x.px), py = fma(delta, x.dy, x.py), pz = fma(delta, x.dz, x.pz);
  const V v = max(py * per_height, all(kLeast)), t = sqrt(v), g = 2 - v - t;
  return {fma(nine_m2 * v * g, g, -fma(px, px, pz * pz)),
          fma(all(S(-2)), fma(px, x.dx, pz * x.dz), slope * x.dy * g * turn_at(v, t)),
          fma(S(0.125) * x.dy * x.dy, bend_at(t), t * fma(x.dx, x.dx, x.dz * x.dz)), t};
}

/// Scales directions by a power of two to 1 <= max |d_i| < 2; returns the power.
[[gnu::always_inline]] inline Lanes scale_direction(Lanes (&x)[6]) {
  const Lanes shrink = reciprocal_power(max(abs(x[3]), max(abs(x[4]), abs(x[5]))));
  for (std::size_t i = 3; i < 6; ++i) x[i] *= shrink;
  return shrink;
}

/// Rays against the first ellipsoid, in floats throughout: those that may hit ahead become lines. Returns
/// whether each d has squares in range. A ray misses if its closest approach in the ellipsoid's own metric is
/// outside, or if it starts outside and goes away (surfaces/teardrop.md).
template <bool kScaled>
[[gnu::always_inline]] inline bool cull(const Frame& frame, const TeardropBatch& batch, const double* rays,
                                        std::size_t at, std::size_t count, Block& block) {
  constexpr float kLess = 1 - 0x1p-18F;                // more than all roundings of what is compared
  constexpr float kLeast = 0x1p-60F, kMost = 0x1p60F;  // of |d|^2: its square is no problem either
  const double scale = batch.inverse_unit;
  Lanes low[6], high[6];
  load_records(rays, low);
  load_records(rays + std::size_t{6} * kLanes, high);
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] *= scale;
    high[i] *= scale;
  }
  if constexpr (kScaled) {
    scale_direction(low);
    scale_direction(high);
  }
  const Floats ox = narrow(low[0], high[0]), oy = narrow(low[1], high[1]), oz = narrow(low[2], high[2]);
  const Floats dx = narrow(low[3], high[3]), dy = narrow(low[4], high[4]), dz = narrow(low[5], high[5]);
  const Floats up = oy - frame.middle, stretched_up = up * frame.stretch2, stretched_dy = dy * frame.stretch2;
  const Floats a = fma(dx, dx, fma(stretched_dy, dy, dz * dz));
  const Floats b = fma(ox, dx, fma(stretched_up, dy, oz * dz));
  const Floats far = fma(ox, ox, fma(stretched_up, up, oz * oz));
  const Floats c = finite(fma(far, all(kLess), all(-frame.radius2)));
  const FloatMask fits = (a > kLeast) & (a < kMost);
  const FloatMask missed = ((b * b < a * c) | ((b >= 0) & (c > 0))) & fits;
  const unsigned some = (1U << count) - 1, left = some & ~to_bits(missed);
  const Floats per_a = 1 / a, middle = -b * per_a;
  Lines& lines = block.lines;
  const std::size_t size = lines.size;
  store_selected(&lines.middle[size], left, middle);
  store_selected(&lines.half2[size], left, max(fma(middle, middle, -(c * per_a)), Floats{}));
  store_selected_numbers(&lines.ray[size], left, static_cast<std::int32_t>(at));
  lines.size = size + static_cast<unsigned>(__builtin_popcount(left));
  block.left[at / kFloats] = left;
  return (some & ~to_bits(fits)) == 0;
}

/// The rays that became lines, as arrays.
void gather(const TeardropBatch& batch, bool scaled, Lines& lines) {
  if (lines.size == 0) return;
  // The lanes behind the last line compute too, up to a vector of floats: on a line that is there.
  for (std::size_t i = 0; i < kFloats; ++i) lines.ray[lines.size + i] = lines.ray[0];
  store(&lines.middle[lines.size], all(lines.middle[0]));
  store(&lines.half2[lines.size], all(lines.half2[0]));
  std::size_t i = 0;
  for (; i < lines.size; i += kLanes) {
    Lanes x[6];
    load_records_at([&](std::size_t k) { return &batch.rays[lines.ray[i + k]].o.x; }, x);
    if (scaled) store(&lines.back[i], scale_direction(x) * batch.unit);
    for (std::size_t k = 0; k < 3; ++k) {
      store(&lines.o[k][i], x[k] * batch.inverse_unit);
      store(&lines.d[k][i], x[3 + k]);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    store(&lines.o[k][i], all(lines.o[k][0]));
    store(&lines.d[k][i], all(lines.d[k][0]));
  }
}

/// Has the rays of the next block fetched, those that are as far on in it as `rays` is in this one: they come
/// from memory while this block is computed. Behind the last block is likely the caller's next batch, and
/// fetching what is not costs nothing.
[[gnu::always_inline]] inline void fetch_next(const double* rays) {
  constexpr std::size_t kLine = 64 / sizeof(double);
  for (std::size_t k = 0; k < 6 * kFloats; k += kLine) __builtin_prefetch(rays + 6 * kBlock + k);
}

template <bool kScaled>
bool cull_all(const Frame& frame, const TeardropBatch& batch, Block& block) {
  bool fits = true;
  block.lines.size = 0;
  for_groups<kFloats>(&batch.rays->o.x, batch.count,
                      [&](const double* rays, std::size_t at, std::size_t count) {
                        fetch_next(rays);
                        fits &= cull<kScaled>(frame, batch, rays, at, count, block);
                      });
  return fits;
}

/// A line through its point at l, from there on.
template <bool kReversed>
[[gnu::always_inline]] inline Line<Lanes> line_at(const Lines& lines, std::size_t i, Lanes l) {
  const auto turned = [](Lanes x) { return kReversed ? -x : x; };
  const Lanes dx = turned(load(&lines.d[0][i])), dy = turned(load(&lines.d[1][i])),
              dz = turned(load(&lines.d[2][i]));
  return {fma(l, dx, load(&lines.o[0][i])),
          fma(l, dy, load(&lines.o[1][i])),
          fma(l, dz, load(&lines.o[2][i])),
          dx,
          dy,
          dz};
}
Line<Floats> floats_at(const Search& search, std::size_t i) {
  return {load(&search.p[0][i]), load(&search.p[1][i]), load(&search.p[2][i]),
          load(&search.q[0][i]), load(&search.q[1][i]), load(&search.q[2][i])};
}

/// A line against the majorant that is tangent at the height of one of its points.
[[gnu::always_inline]] inline Quadratic against_local(const Frame& frame, const Line<Lanes>& line,
                                                      Lanes delta) {
  const Lanes v = fma(delta, line.dy, line.py) * frame.per_height;
  return against(frame, line, majorant_at(sqrt(min(max(v, all(kEdge)), all(1 - kEdge)))));
}

/// A majorant step: it proves most of the misses that are left (kInfinity), and never passes the entry.
[[gnu::always_inline]] inline Lanes step_by_majorant(const Frame& frame, const Line<Lanes>& line,
                                                     Lanes delta) {
  const Quadratic q = against_local(frame, line, delta);
  const Lanes root = sqrt(max(q.discriminant, Lanes{}));
  const Mask cancels = q.b > 0;
  // Of -b + root and -b - root the one without cancellation; the other root of the two by their product.
  const Lanes sum = select(cancels, -(q.b + root), root - q.b);
  const Lanes next = finite(select(cancels, q.c, sum) / select(cancels, sum, q.a));
  return select((q.discriminant < -q.error) & (q.a < 0), all(kInfinity), next);
}

/// Euler's step: the root of the local parabola, which bends the right way near a double root. A proved miss
/// stays one.
[[gnu::always_inline]] inline Lanes step_by_euler(const Frame& frame, const Line<Lanes>& line, Lanes delta) {
  const Local<Lanes> here = evaluate(frame, line, delta);
  const Lanes under = max(fma(here.df, here.df, 4 * here.f * (here.bend / here.t)), Lanes{});
  const Lanes next = finite(delta - 2 * here.f / (here.df + sqrt(under)));
  return select(delta == kInfinity, delta, next);
}

/// A majorant step from the point itself, as `step_by_majorant` but for a bound on the discriminant's error
/// that takes the coefficients' greatest sizes, and for digits where the line goes away.
[[gnu::always_inline]] inline Floats first_step(const Frame& frame, const Line<Floats>& line) {
  constexpr auto kLowest = static_cast<float>(kEdge);
  const auto per_height = static_cast<float>(frame.per_height), nine_m2 = static_cast<float>(frame.nine_m2);
  const auto size_c = static_cast<float>(800 * frame.m2);
  const Floats v = line.py * per_height, k = line.dy * per_height;
  const Majorant<Floats> q = majorant_at(sqrt(min(max(v, all(kLowest)), all(1 - kLowest))));
  const Floats s = v - q.at, r1 = nine_m2 * q.r1, r2 = nine_m2 * q.r2;
  const Floats flat = fma(line.dx, line.dx, line.dz * line.dz);
  const Floats square = fma(line.px, line.px, line.pz * line.pz);
  const Floats a = fma(r2 * k, k, -flat);
  const Floats b = fma(fma(r2, s, 0.5F * r1), k, -fma(line.px, line.dx, line.pz * line.dz));
  const Floats c = fma(s, fma(r2, s, r1), nine_m2 * q.r0) - square;
  const Floats discriminant = fma(b, b, -(a * c));
  const Floats error = 0x1p-16F * fma(line.dy, line.dy, flat) * (square + size_c);
  const Floats next = finite(-c / (b + sqrt(max(discriminant, Floats{}))));
  const FloatMask missed = (discriminant < -error) & (a < 0) & (abs(s) <= 2);
  return select(missed, all(static_cast<float>(kInfinity)), next);
}

/// Halley's step: one division.
[[gnu::always_inline]] inline Floats step_by_halley(const Frame& frame, const Line<Floats>& line,
                                                    Floats delta) {
  const Local<Floats> here = evaluate(frame, line, delta);
  const Floats rise = here.df * here.t;
  const Floats next = finite(delta - here.f * rise / fma(here.df, rise, here.f * here.bend));
  return select(delta == static_cast<float>(kInfinity), delta, next);
}

/// Two vectors of lines through their points at l, in floats.
template <bool kReversed>
[[gnu::always_inline]] inline Line<Floats> floats_at(const Lines& lines, std::size_t i, const TwoLanes& l) {
  const Line<Lanes> a = line_at<kReversed>(lines, i, l.first);
  const Line<Lanes> b = line_at<kReversed>(lines, i + kLanes, l.second);
  return {narrow(a.px, b.px), narrow(a.py, b.py), narrow(a.pz, b.pz),
          narrow(a.dx, b.dx), narrow(a.dy, b.dy), narrow(a.dz, b.dz)};
}

/// Where a line enters the first ellipsoid, from any of its points: by way of its closest approach.
[[gnu::always_inline]] inline Lanes enter_ellipsoid(const Frame& frame, const Line<Lanes>& x) {
  const auto middle = static_cast<double>(frame.middle), stretch2 = static_cast<double>(frame.stretch2);
  const Lanes a = fma(x.dx, x.dx, fma(stretch2 * x.dy, x.dy, x.dz * x.dz));
  const auto along = [&](Lanes px, Lanes py, Lanes pz) {
    return fma(px, x.dx, fma((py - middle) * stretch2, x.dy, pz * x.dz));
  };
  const Lanes l = -along(x.px, x.py, x.pz) / a;
  const Lanes px = fma(l, x.dx, x.px), py = fma(l, x.dy, x.py), pz = fma(l, x.dz, x.pz);
  const Lanes b = along(px, py, pz), up = py - middle;
  const Lanes c = fma(px, px, fma(up * up, all(stretch2), pz * pz)) - static_cast<double>(frame.radius2);
  return l - (b + sqrt(max(fma(b, b, -(a * c)), Lanes{}))) / a;
}

/// Two vectors of lines where they enter the first ellipsoid.
struct Start {
  TwoLanes near;
  Line<Floats> line;
};

/// From afar floats do not tell where: what they say is near the ellipsoid for all others.
template <bool kReversed>
[[gnu::always_inline]] inline Start start_of(const Frame& frame, const Lines& lines, std::size_t i) {
  const Floats middle = load(&lines.middle[i]), half = sqrt(load(&lines.half2[i]));
  TwoLanes l = widen(finite(kReversed ? -(middle + half) : middle - half));
  const Line<Floats> at = floats_at<kReversed>(lines, i, l);
  const Floats up = at.py - frame.middle;
  const Floats distance2 = fma(at.px, at.px, fma(up * frame.stretch2, up, at.pz * at.pz));
  const FloatMask is_off = distance2 > 1.5F * frame.radius2;
  if (to_bits(is_off) == 0) return {l, at};
  const TwoLanes off = widen(select(is_off, all(1.0F), Floats{}));
  const Lanes first = enter_ellipsoid(frame, line_at<kReversed>(lines, i, l.first));
  const Lanes second = enter_ellipsoid(frame, line_at<kReversed>(lines, i + kLanes, l.second));
  l.first = finite(l.first + select(off.first > 0, first, Lanes{}));
  l.second = finite(l.second + select(off.second > 0, second, Lanes{}));
  return {l, floats_at<kReversed>(lines, i, l)};
}

/// Guesses in floats: what is left to double is one step with its proof. A loop for each step, so that the
/// long chains of neighbours overlap.
template <bool kReversed>
void guess(const Frame& frame, const Lines& lines, Search& search) {
  for (std::size_t i = 0; i < lines.size; i += kFloats) {
    const auto [near, line] = start_of<kReversed>(frame, lines, i);
    store(&search.near[i], near.first);
    store(&search.near[i + kLanes], near.second);
    store(&search.p[0][i], line.px);
    store(&search.p[1][i], line.py);
    store(&search.p[2][i], line.pz);
    store(&search.q[0][i], line.dx);
    store(&search.q[1][i], line.dy);
    store(&search.q[2][i], line.dz);
    store(&search.guess[i], first_step(frame, line));
  }
  for (std::size_t i = 0; i < lines.size; i += kFloats)
    store(&search.guess[i], step_by_halley(frame, floats_at(search, i), load(&search.guess[i])));
  for (std::size_t i = 0; i < lines.size; i += kFloats) {
    const auto delta = widen(step_by_halley(frame, floats_at(search, i), load(&search.guess[i])));
    store(&search.entry[i], load(&search.near[i]) + delta.first);
    store(&search.entry[i + kLanes], load(&search.near[i + kLanes]) + delta.second);
  }
}

/// Whether a line is inside the majorant at the entry's height only below the bottom or above the apex.
Mask passes_beside(const Frame& frame, const Line<Lanes>& line, Lanes delta) {
  constexpr double kMargin = 0x1p-40;  // far more than the roundings of 40 operations
  const Quadratic q = against_local(frame, line, delta);
  const Lanes root = sqrt(max(q.discriminant, Lanes{}) + q.error) + kMargin * q.size;
  const Lanes in = (root - q.b) / q.a * line.dy, out = -(q.b + root) / q.a * line.dy;
  const Lanes margin = kMargin * (abs(line.py) + abs(in) + abs(out));
  const Lanes high = line.py + max(in, out) + margin, low = line.py + min(in, out) - margin;
  return (q.a < 0) & ((high < 0) | (low > frame.above));
}

/// The same in doubles with more steps, for the few that those do not settle.
template <bool kReversed>
void guess_hard(const Frame& frame, const Lines& lines, Search& search) {
  constexpr int kMajorants = 5, kEulers = 4;
  const auto each = [&](const auto& step) {
    for (std::size_t i = 0; i < lines.size; i += kLanes) {
      const Line<Lanes> line = line_at<kReversed>(lines, i, load(&search.near[i]));
      store(&search.entry[i], step(line, load(&search.entry[i])));
    }
  };
  for (std::size_t i = 0; i < lines.size; i += kLanes) {
    const Line<Lanes> ray = line_at<kReversed>(lines, i, Lanes{});
    const Lanes up = ray.py - static_cast<double>(frame.middle);
    const Lanes square = fma(ray.dx, ray.dx, fma(ray.dy, ray.dy, ray.dz * ray.dz));
    store(&search.near[i], -fma(ray.px, ray.dx, fma(up, ray.dy, ray.pz * ray.dz)) / square);
  }
  each([&](const Line<Lanes>& line, Lanes) {
    const Quadratic q = against(frame, line, majorant_at(all(kFirst)));
    return finite((sqrt(max(q.discriminant, Lanes{})) - q.b) / q.a);
  });
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
  for (std::size_t i = 0; i < lines.size; i += kLanes)
    store(&search.entry[i], finite(load(&search.near[i])) + load(&search.entry[i]));
}

/// The proof, and Chebyshev's step, of third order, from one evaluation of F, F' and F'' at a double l of the
/// ray itself: F is negative before a bracket about l + step and positive behind it, by Taylor's formula with
/// a bound on all that is neglected (surfaces/teardrop.md). The solid is convex, so a line that goes in is
/// met nowhere else going in.
template <bool kReversed>
void certify(const Frame& frame, const Lines& lines, Search& search) {
  const double per_m = 1 / frame.m, top = 6 * frame.m * (1 - 16 * kU);
  for (std::size_t i = 0; i < lines.size; i += kLanes) {
    const Lanes l = load(&search.entry[i]);
    const Line<Lanes> at = line_at<kReversed>(lines, i, l);
    // g = 2 - v - t is all digits of the tip: v with the tail of its constant, and no rounding of 2 - v.
    const Lanes v = fma(at.py, all(frame.per_height), at.py * frame.per_height_tail);
    const Lanes nine_v = at.py * (1.5 * frame.m);
    const Lanes t = sqrt(v), g = (1 - v) + (1 - t);
    const Lanes square = fma(at.px, at.px, at.pz * at.pz), flat = fma(at.dx, at.dx, at.dz * at.dz);
    const Lanes f = fma(nine_v * g, g, -square);
    const Lanes df =
        fma(all(-2.0), fma(at.px, at.dx, at.pz * at.dz), at.dy * (1.5 * frame.m) * (g * turn_at(v, t)));
    // 1/t and 1/F' by one division.
    const Lanes per_both = 1 / (t * df);
    const Lanes per_t = per_both * df, per_slope = per_both * t;
    const Lanes half_ddf = -fma(0.125 * at.dy * at.dy, bend_at(t) * per_t, flat);

    const Lanes newton = f * per_slope;
    const Lanes chebyshev = -newton * fma(newton * half_ddf, per_slope, all(1.0));
    const Lanes left = fma(chebyshev, fma(chebyshev, half_ddf, df), f);
    const Lanes step = fma(-left, per_slope, chebyshev), entry = l + step;
    // Wide enough for the bound on F, and for what l itself is rounded by; positive also past the apex, g <
    // 0.
    const Lanes allowed = 32 * kU * fma(nine_v, abs(g) + 16 * kU, square);
    const Lanes width = fma(allowed, per_slope, 4 * kU * abs(entry));
    const Lanes reach = abs(step) + width, rise = abs(at.dy) * reach, rise_t = rise * per_t;
    // 256/3 of |q| / 32 and of the third order, and 16/3 of 96 u of the rest (surfaces/teardrop.md): they are
    // to be below 6 u S, and 32 u S is at hand.
    const Lanes third = (7.5 * per_m) * rise_t * (rise_t * rise_t);
    const Lanes rounded = fma(flat * reach, reach, fma(rise, all(2 * frame.m), abs(f)));
    const Lanes error = fma(rounded, all(512 * kU), fma(abs(left), all(2.75), third)) + kTiny;

    const Mask near =
        (df > 0) & (abs(half_ddf) * reach <= 0x1p-7 * df) & (16 * rise <= at.py) & (at.py + rise <= top);
    // A bracket that holds the origin does not say whether the hit is ahead of it.
    const Mask found = near & (error < allowed) & (abs(entry) > width);
    store(&search.entry[i], select(l == kInfinity, l, select(found, entry, all(kOpen))));
  }
}

template <bool kReversed>
void find(const Frame& frame, bool is_hard, const Lines& lines, Search& search) {
  if (is_hard) {
    guess_hard<kReversed>(frame, lines, search);
  } else {
    guess<kReversed>(frame, lines, search);
  }
  certify<kReversed>(frame, lines, search);
}

/// Lines whose entry does not say what the first hit is: it is behind the origin, or it is open and it is
/// hard, as a line that is hard to see from one side may be easy to see from the other.
void collect_rest(bool is_hard, Block& block) {
  const Lines& from = block.lines;
  Lines& to = block.rest;
  const auto unanswered = [&](std::size_t i) {
    const Lanes entry = load(&block.entries.entry[i]);
    return to_bits(is_hard ? ~(entry > 0) : entry <= 0);
  };
  to.size = 0;
  for (std::size_t i = 0; i < from.size; i += kLanes) {
    unsigned rest = unanswered(i);
    if (from.size - i < kLanes) rest &= (1U << (from.size - i)) - 1;
    for (; rest != 0; rest &= rest - 1) {
      const std::size_t line = i + static_cast<unsigned>(__builtin_ctz(rest)), next = to.size++;
      to.ray[next] = from.ray[line];
      to.middle[next] = from.middle[line];
      to.half2[next] = from.half2[line];
      block.place[next] = line;
    }
  }
}

/// Of a line that may not enter ahead of the origin, where it is first hit; kInfinity: nowhere.
double first_hit(double in, double out) {
  if (out < 0) return kInfinity;
  return in < 0 && out > 0 ? out : kOpen;
}

/// Leaves of each line where it is first hit.
void find_first(const Frame& frame, const TeardropBatch& batch, bool is_hard, bool scaled, Block& block) {
  collect_rest(is_hard, block);
  if (block.rest.size == 0) return;
  gather(batch, scaled, block.rest);
  find<true>(frame, is_hard, block.rest, block.exits);
  for (std::size_t i = 0; i < block.rest.size; ++i) {
    double& entry = block.entries.entry[block.place[i]];
    entry = first_hit(entry, -block.exits.entry[i]);
  }
}

/// From what is proved of lines to what is proved of rays: their first hits. Returns a bit for each that is
/// open: also what leaves the range of double in the caller's units.
[[gnu::always_inline]] inline unsigned decide_first(Lanes back, std::size_t i, Block& block) {
  const Lanes l = load(&block.entries.entry[i]), first = l * back;
  const Mask missed = l == kInfinity, known = missed | ((first > 0) & (first < kInfinity));
  store(&block.first[i], first);
  store(&block.hits[i], select(known, select(missed, Lanes{}, all(1.0)), all(-1.0)));
  return to_bits(~known);
}

/// The same of all hits, from where lines enter and leave the solid.
[[gnu::always_inline]] inline unsigned decide_both(Lanes back, std::size_t i, Block& block) {
  const Lanes in = load(&block.entries.entry[i]), out = -load(&block.exits.entry[i]);
  const Mask missed = (in == kInfinity) | (out == -kInfinity);
  const Mask ahead = in > 0, gone = out < 0;
  const Lanes first = select(ahead, in, out) * back, second = out * back;
  const Mask fits = gone | ((first > 0) & (second < kInfinity));
  const Mask known = missed | ((in < out) & fits);
  const Lanes count = select(missed | gone, Lanes{}, select(ahead, all(2.0), all(1.0)));
  store(&block.first[i], first);
  store(&block.second[i], second);
  store(&block.hits[i], select(known, count, all(-1.0)));
  return to_bits(~known);
}

/// What is proved of the lines, by their own order; returns how many are open.
template <bool kBoth>
std::size_t decide_all(const TeardropBatch& batch, bool scaled, Block& block) {
  const std::size_t size = block.lines.size;
  std::size_t open = 0;
  for (std::size_t i = 0; i < size; i += kLanes) {
    const Lanes back = scaled ? load(&block.lines.back[i]) : all(batch.unit);
    unsigned bits = kBoth ? decide_both(back, i, block) : decide_first(back, i, block);
    if (size - i < kLanes) bits &= (1U << (size - i)) - 1;
    open += static_cast<unsigned>(__builtin_popcount(bits));
  }
  return open;
}

/// Answers of all rays of the block from those of its lines.
void spread(const TeardropBatch& batch, const Block& block, const TeardropAnswers& to) {
  std::size_t line = 0;
  const auto put = [&](unsigned left, std::int8_t* hits, double* first, double* second) {
    for (unsigned k = 0; k < kFloats; k += kLanes) {
      const unsigned bits = left >> k & ((1U << kLanes) - 1);
      store_bytes(hits + k, load_selected(&block.hits[line], bits));
      store(first + k, load_selected(&block.first[line], bits));
      if (batch.both) store(second + k, load_selected(&block.second[line], bits));
      line += static_cast<unsigned>(__builtin_popcount(bits));
    }
  };
  std::size_t ray = 0;
  for (; ray + kFloats <= batch.count; ray += kFloats)
    put(block.left[ray / kFloats], to.hits + ray, to.first + ray, to.second + ray);
  if (ray == batch.count) return;
  std::int8_t hits[kFloats];
  double first[kFloats], second[kFloats];
  put(block.left[ray / kFloats], hits, first, second);
  const std::size_t some = batch.count - ray;
  __builtin_memcpy(to.hits + ray, hits, some);
  __builtin_memcpy(to.first + ray, first, some * sizeof *first);
  if (batch.both) __builtin_memcpy(to.second + ray, second, some * sizeof *second);
}

/// At most kBlock rays; returns how many it leaves open.
std::size_t solve_block(const Frame& frame, const TeardropBatch& batch, bool is_hard, Block& block,
                        const TeardropAnswers& to) {
  const bool scaled = is_hard || !cull_all<false>(frame, batch, block);
  if (scaled) cull_all<true>(frame, batch, block);
  gather(batch, scaled, block.lines);
  find<false>(frame, is_hard, block.lines, block.entries);
  std::size_t open = 0;
  if (batch.both) {
    find<true>(frame, is_hard, block.lines, block.exits);
    open = decide_all<true>(batch, scaled, block);
  } else {
    find_first(frame, batch, is_hard, scaled, block);
    open = decide_all<false>(batch, scaled, block);
  }
  spread(batch, block, to);
  return open;
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
