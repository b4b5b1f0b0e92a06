// First and second hits of many rays with the teardrop, proved in double. Compiled once for each instruction
// set; derivation and error analysis: surfaces/teardrop.md, "Kernel".
#include <graze/surfaces/teardrop_lanes.hpp>

#include <graze/solvers/math/lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kInfinity = __builtin_inf();
constexpr double kTiny = 0x1p-960;   // far above what underflow can add to a bound, far below what matters
constexpr std::size_t kBlock = 256;  // about 30 kB of lanes: the first cache level
constexpr std::size_t kPadded = kBlock + kLanes;

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
struct Majorant {
  Lanes at, r0, r1, r2;
};

/// rho''' > 0, so the difference to the quadratic has no other zero in [0, 1] than those.
Majorant majorant_at(Lanes v) {
  const Lanes t = sqrt(v);
  const Lanes g = 2 - v - t;
  const Lanes turn = 2 - 3 * v - 2 * t;
  const Lanes w = (2 + t) / (1 + t);
  return {v, 9 * v * g * g, 9 * g * turn, -9 * w * fma(v, w, turn)};
}

/// Lines whose entry is looked for, as arrays: an exit is the entry of the reversed line.
struct Queue {
  alignas(64) double o[3][kPadded], d[3][kPadded], p[3][kPadded];
  alignas(64) double centre[kPadded];  ///< l of p
  alignas(64) double delta[kPadded];   ///< approximation of the entry, l - centre
  alignas(64) double width[kPadded];   ///< what the last step leaves open
  std::uint16_t ray[kPadded];          ///< of the block
  std::uint8_t proved[kPadded];        ///< kFound, kMissed, or 0
  std::size_t size = 0;
};
enum : std::uint8_t { kNothing, kFound, kMissed };
constexpr std::int8_t kOpen = -1;

struct Block {
  Queue entries, exits, hard;
  alignas(64) double back[kPadded];  ///< l of the caller = l here * back
};

/// A line against a majorant: m^2 Q(v(delta)) - |x_xz|^2 = a delta^2 + 2 b delta + c.
struct Quadratic {
  Lanes a, b, c, discriminant;
  Lanes error;  ///< of the discriminant: what it would have to exceed to be sure
  Lanes size;   ///< of b, nothing cancelled
};

struct Line {
  Lanes px, py, pz, dx, dy, dz;
};

/// Fewer than 16 roundings go into each of a, b, c, relative to the sums of their terms' sizes; p adds one
/// rounding a coordinate, the majorant's own coefficients fewer than 8. The discriminant is within
/// 2 * 32 u of the sizes' b^2 + a c.
Quadratic against(const Frame& frame, const Line& x, const Majorant& q) {
  const Lanes v = x.py * frame.per_height;
  const Lanes k = x.dy * frame.per_height;
  const Lanes s = v - q.at;
  const Lanes size_s = abs(v) + q.at;
  const Lanes square = fma(x.px, x.px, x.pz * x.pz);
  const Lanes flat = fma(x.dx, x.dx, x.dz * x.dz);
  const Lanes r1 = abs(q.r1), r2 = abs(q.r2);
  const Lanes a = frame.m2 * q.r2 * k * k - flat;
  const Lanes b = frame.m2 * fma(q.r2, s, 0.5 * q.r1) * k - fma(x.px, x.dx, x.pz * x.dz);
  const Lanes c = frame.m2 * fma(s, fma(q.r2, s, q.r1), q.r0) - square;
  const Lanes size_a = frame.m2 * r2 * k * k + flat;
  const Lanes size_b =
      frame.m2 * fma(r2, size_s, r1) * abs(k) + fma(abs(x.px), abs(x.dx), abs(x.pz) * abs(x.dz));
  const Lanes size_c = frame.m2 * fma(size_s, fma(r2, size_s, r1), q.r0 + r1 + r2) + square;
  return {a, b, c, fma(b, b, -(a * c)), 64 * kU * fma(size_b, size_b, size_a * size_c), size_b};
}

/// F and what it depends on at a height, for steps: no error bound.
struct Local {
  Lanes f, df, ddf;
  Lanes size;  ///< of f's terms, nothing cancelled
};

Local evaluate(const Frame& frame, const Line& x, Lanes delta) {
  constexpr double kLeast = 0x1p-80;  // keeps 1/t a number
  const Lanes px = fma(delta, x.dx, x.px), py = fma(delta, x.dy, x.py), pz = fma(delta, x.dz, x.pz);
  const Lanes v = max(py * frame.per_height, all(kLeast));
  const Lanes k = x.dy * frame.per_height;
  const Lanes t = sqrt(v);
  const Lanes g = 2 - v - t;
  const Lanes turn = 2 - 3 * v - 2 * t;
  const Lanes per_t = 1 / t;
  const Lanes slope = frame.nine_m2 * g * turn;
  const Lanes bend = frame.nine_m2 * -(fma(0.5 * per_t, turn, turn) + g * (3 + per_t));
  return {fma(frame.nine_m2 * v * g, g, -fma(px, px, pz * pz)), fma(slope, k, -2 * fma(px, x.dx, pz * x.dz)),
          fma(bend, k * k, -2 * fma(x.dx, x.dx, x.dz * x.dz)),
          fma(frame.nine_m2 * v, abs(g) + 16 * kU, fma(px, px, pz * pz))};
}

/// F = R^2 - |x_xz|^2 at the double l of the ray itself, with a bound on its error (surfaces/teardrop.md).
struct Sign {
  Lanes f, error;
  Mask beside;  ///< below the bottom or above the apex: outside whatever F says
};

Sign sign_at(const Frame& frame, const Queue& queue, std::size_t i, Lanes l) {
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

/// Appends the selected lanes to a queue.
void append(Queue& queue, unsigned lanes, std::size_t at, const Lanes (&values)[11]) {
  double* const to[] = {queue.o[0], queue.o[1], queue.o[2], queue.d[0],   queue.d[1], queue.d[2],
                        queue.p[0], queue.p[1], queue.p[2], queue.centre, queue.delta};
  for (std::size_t i = 0; i < 11; ++i) store_selected(to[i] + queue.size, lanes, values[i]);
  for (; lanes != 0; lanes &= lanes - 1)
    queue.ray[queue.size++] = static_cast<std::uint16_t>(at + static_cast<unsigned>(__builtin_ctz(lanes)));
}

/// Brings kLanes rays to the frame and against the first majorant; queues those that may hit.
void cull(const Frame& frame, const TeardropBatch& batch, const Majorant& ellipsoid, const double* rays,
          std::size_t at, std::size_t count, Block& block, std::int8_t* hits) {
  const Lanes qx = load_strided(rays + 3, 6), qy = load_strided(rays + 4, 6), qz = load_strided(rays + 5, 6);
  const Lanes shrink = reciprocal_power(max(abs(qx), max(abs(qy), abs(qz))));
  const Lanes ox = load_strided(rays, 6) * batch.inverse_unit,
              oy = load_strided(rays + 1, 6) * batch.inverse_unit,
              oz = load_strided(rays + 2, 6) * batch.inverse_unit;
  const Lanes dx = qx * shrink, dy = qy * shrink, dz = qz * shrink;
  const Lanes along = fma(ox, dx, fma(oy - frame.middle, dy, oz * dz));
  const Lanes centre = -along / fma(dx, dx, fma(dy, dy, dz * dz));
  const Line line{fma(centre, dx, ox), fma(centre, dy, oy), fma(centre, dz, oz), dx, dy, dz};
  const Quadratic q = against(frame, line, ellipsoid);
  const Mask missed = q.discriminant < -q.error;
  // a < 0: entry before exit. The roots from the far side, so that "behind" is certain.
  const Lanes root = sqrt(max(q.discriminant, Lanes{}) + q.error) + 0x1p-40 * q.size;
  const Lanes per_a = 1 / q.a;
  const Lanes in_at = (root - q.b) * per_a, out_at = -(q.b + root) * per_a;
  const Mask behind = out_at < -centre - 0x1p-40 * abs(centre);
  const Mask ahead = in_at > -centre;
  store(&block.back[at], shrink / batch.inverse_unit);

  const unsigned valid = (1U << count) - 1;
  const unsigned gone = to_bits(missed | behind) & valid;
  for (std::size_t i = 0; i < count; ++i) hits[i] = (gone >> i & 1U) != 0 ? 0 : kOpen;
  const unsigned left = valid & ~gone;
  append(block.entries, left, at, {ox, oy, oz, dx, dy, dz, line.px, line.py, line.pz, centre, in_at});
  const unsigned leaving = batch.both ? left : left & ~to_bits(ahead);
  if (leaving != 0)
    append(block.exits, leaving, at,
           {ox, oy, oz, -dx, -dy, -dz, line.px, line.py, line.pz, -centre, -out_at});
}

Line line_at(const Queue& queue, std::size_t i) {
  return {load(&queue.p[0][i]), load(&queue.p[1][i]), load(&queue.p[2][i]),
          load(&queue.d[0][i]), load(&queue.d[1][i]), load(&queue.d[2][i])};
}

/// A majorant step: it proves most of the misses that are left, and never passes the entry.
void step_by_majorant(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kLanes) {
    const Line line = line_at(queue, i);
    const Lanes delta = load(&queue.delta[i]);
    const Lanes height = fma(delta, line.dy, line.py) * frame.per_height;
    const Majorant majorant = majorant_at(min(max(height, all(0x1p-20)), all(1 - 0x1p-20)));
    const Quadratic q = against(frame, line, majorant);
    const Lanes root = sqrt(max(q.discriminant, Lanes{}));
    const Mask cancels = q.b > 0;
    // Of -b + root and -b - root the one without cancellation; the other root of the two by their product.
    const Lanes sum = select(cancels, -(q.b + root), root - q.b);
    store(&queue.delta[i], select(cancels, q.c, sum) / select(cancels, sum, q.a));
    const unsigned missed = to_bits((q.discriminant < -q.error) & (q.a < 0));
    for (std::size_t k = 0; k < kLanes; ++k)
      queue.proved[i + k] |= (missed >> k & 1U) != 0 ? kMissed : kNothing;
  }
}

/// Euler's step: the root of the local parabola, which bends the right way near a double root.
void step_by_euler(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kLanes) {
    const Lanes delta = load(&queue.delta[i]);
    const Local here = evaluate(frame, line_at(queue, i), delta);
    const Lanes under = max(fma(here.df, here.df, -2 * here.f * here.ddf), Lanes{});
    const Lanes slope = sqrt(under);
    store(&queue.delta[i], delta - 2 * here.f / (here.df + slope));
    // Where F bends within the bracket its secant is no polish: those lines are left to the next tier.
    const Lanes width = 32 * kU * here.size / here.df;
    store(&queue.width[i], select(64 * abs(here.ddf) * width < here.df, width, all(kInfinity)));
  }
}

/// The proof: outside before a bracket about the approximation, inside behind it. The solid is convex, so a
/// line that goes in is met nowhere else going in. Leaves l in delta.
void certify(const Frame& frame, Queue& queue) {
  for (std::size_t i = 0; i < queue.size; i += kLanes) {
    const Lanes centre = load(&queue.centre[i]);
    const Lanes l = centre + load(&queue.delta[i]);
    // Wide enough for the bound on F, and for what l itself was rounded by.
    const Lanes width = load(&queue.width[i]) + 4 * kU * (abs(l) + abs(centre));
    const Lanes low = l - width, high = l + width;
    const Sign a = sign_at(frame, queue, i, low);
    const Sign b = sign_at(frame, queue, i, high);
    const Mask outside = a.f < -a.error;
    const Mask inside = ~b.beside & (b.f > b.error);
    // A bracket that holds the origin does not say whether the hit is ahead of it.
    const Mask decided = (low > 0) | (high < 0);
    // Inside the bracket F is a line to all digits: its secant is the polish.
    const Lanes better = low + (high - low) * (a.f / (a.f - b.f));
    store(&queue.delta[i], select((better >= low) & (better <= high), better, l));
    const unsigned found = to_bits(outside & inside & decided & (low < high));
    for (std::size_t k = 0; k < kLanes; ++k) {
      if ((found >> k & 1U) != 0 && queue.proved[i + k] == kNothing) queue.proved[i + k] = kFound;
    }
  }
}

/// The lanes behind the last line compute too: on numbers, not on whatever lies there.
void pad(Queue& queue) {
  double* const parts[] = {queue.o[0], queue.o[1], queue.o[2], queue.d[0],   queue.d[1], queue.d[2],
                           queue.p[0], queue.p[1], queue.p[2], queue.centre, queue.delta};
  for (double* const part : parts) store(part + queue.size, Lanes{});
}

void look(const Frame& frame, Queue& queue, int majorants, int eulers) {
  pad(queue);
  __builtin_memset(queue.proved, kNothing, sizeof queue.proved);
  for (int step = 0; step < majorants; ++step) step_by_majorant(frame, queue);
  for (int step = 0; step < eulers; ++step) step_by_euler(frame, queue);
  certify(frame, queue);
}

/// Most lines are settled by the fewest steps; the others get a second look, from where the first one began.
void find(const Frame& frame, Queue& queue, Queue& hard) {
  if (queue.size == 0) return;
  alignas(64) double start[kPadded];
  __builtin_memcpy(start, queue.delta, sizeof start);
  look(frame, queue, 1, 3);
  hard.size = 0;
  for (std::size_t i = 0; i < queue.size; ++i) {
    if (queue.proved[i] != kNothing) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      hard.o[k][hard.size] = queue.o[k][i];
      hard.d[k][hard.size] = queue.d[k][i];
      hard.p[k][hard.size] = queue.p[k][i];
    }
    hard.centre[hard.size] = queue.centre[i];
    hard.delta[hard.size] = start[i];
    hard.ray[hard.size++] = static_cast<std::uint16_t>(i);
  }
  if (hard.size == 0) return;
  look(frame, hard, 5, 5);
  for (std::size_t i = 0; i < hard.size; ++i) {
    queue.proved[hard.ray[i]] = hard.proved[i];
    queue.delta[hard.ray[i]] = hard.delta[i];
  }
}

/// From what is proved of the line to what is proved of the ray. `exit`: its index in that queue, if any.
void conclude(const TeardropBatch& batch, const Block& block, std::size_t entry, std::size_t exit,
              std::size_t to, const TeardropAnswers& answers) {
  const bool has_exit = exit < block.exits.size;
  const std::uint8_t in = block.entries.proved[entry];
  const std::uint8_t out = has_exit ? block.exits.proved[exit] : in;
  if (in == kMissed || out == kMissed) {
    answers.hits[to] = 0;
    return;
  }
  if (in != kFound || out != kFound) return;
  const double from = block.entries.delta[entry];
  const double until = has_exit ? -block.exits.delta[exit] : kInfinity;
  if (!(from < until) || (!has_exit && from < 0)) return;
  // What leaves the range of double in the caller's units is left open.
  const double back = block.back[block.entries.ray[entry]];
  const double first = (from > 0 ? from : until) * back, second = until * back;
  const bool two = batch.both && from > 0;
  if (until > 0 && !(first > 0 && first < kInfinity)) return;
  if (two && !(second < kInfinity)) return;
  answers.hits[to] = until < 0 ? 0 : two ? 2 : 1;
  answers.first[to] = first;
  if (two) answers.second[to] = second;
}

}  // namespace

void intersect_teardrop(const TeardropBatch& batch, const TeardropAnswers& answers) {
  const Frame frame = frame_of(batch.m);
  // The tangent ellipsoid at v = 0.42, where the body is widest but for 1 %: the fewest lines are left.
  const Majorant ellipsoid = majorant_at(all(0.42));
  Block block;
  for (std::size_t begin = 0; begin < batch.count; begin += kBlock) {
    const std::size_t size = batch.count - begin < kBlock ? batch.count - begin : kBlock;
    block.entries.size = block.exits.size = 0;
    const double* const rays = &batch.rays[begin].o.x;
    std::size_t i = 0;
    for (; i + kLanes <= size; i += kLanes)
      cull(frame, batch, ellipsoid, rays + 6 * i, i, kLanes, block, answers.hits + begin + i);
    if (i < size) {
      double last[6 * kLanes] = {};
      __builtin_memcpy(last, rays + 6 * i, 6 * sizeof(double) * (size - i));
      cull(frame, batch, ellipsoid, last, i, size - i, block, answers.hits + begin + i);
    }
    find(frame, block.entries, block.hard);
    find(frame, block.exits, block.hard);
    std::size_t exit = 0;
    for (std::size_t k = 0; k < block.entries.size; ++k) {
      const bool leaves = exit < block.exits.size && block.exits.ray[exit] == block.entries.ray[k];
      conclude(batch, block, k, leaves ? exit : kPadded, begin + block.entries.ray[k], answers);
      exit += leaves ? 1 : 0;
    }
  }
}

}  // namespace graze::GRAZE_LANES
