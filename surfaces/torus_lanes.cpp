// Hits of many rays with a torus, proved in double. Compiled once for each instruction set; derivation
// and error analysis: surfaces/torus.md, "Kernel".
#include <graze/surfaces/torus_lanes.hpp>

#include <graze/solvers/math/lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kInfinity = __builtin_inf();
constexpr double kPay = 1 + 0x1p-48;   // pays for the roundings of a bound itself, fewer than 30
constexpr double kFarthest = 0x1p400;  // its square, times what else there is, is no overflow
constexpr std::size_t kBlock = 256;    // the queues of a block stay in the second cache level
constexpr std::size_t kPadded = kBlock + kLanes;
constexpr std::int8_t kOpen = -1;

/// f = K^2 + weight (y^2 - tube^2), K = |x|^2 - sum.
struct Frame {
  double ring, tube;
  double weight;         ///< 4 R^2
  double sum, sum_tail;  ///< R^2 + r^2
  double reach;          ///< 2 R r: |K| is no larger on the surface
  double flatness;       ///< R / r
  bool is_ring;          ///< F2 is nowhere small
};

Frame frame_of(double ring, double tube) {
  const double big = ring * ring, small = tube * tube;
  const double sum = big + small;
  // What the sum rounds off, and what the squares did.
  const double larger = big > small ? big : small, smaller = big > small ? small : big;
  const double tail =
      (smaller - (sum - larger)) + __builtin_fma(ring, ring, -big) + __builtin_fma(tube, tube, -small);
  return {ring, tube, 4 * big, sum, tail, 2 * ring * tube, ring / tube, ring - tube >= 0x1p-20};
}

/// Parts of a queue's entries. A line and a task have the first ten in common.
enum Part : std::size_t {
  kOx,
  kOy,
  kOz,
  kDx,
  kDy,
  kDz,
  kPy,
  kK,  ///< at delta = 0, the foot: y and K
  kCentre,
  kShift,  ///< their sum is l of the foot
  kBothHave,
  // A line: bounds on the errors of K and on |p.d| at the foot, |y|'s size, and |delta| of hits.
  kErrorK = kBothHave,
  kSlant,
  kSizeY,
  kExtent,
  kLineParts,
  // A task: where delta must not be exceeded, what f must exceed, and the approximation; then the answer.
  kLimit = kBothHave,
  kSlack,
  kDelta,
  kTaskParts,
  kOuter = kLimit,
  kInner = kSlack,
  kL = kDelta
};

/// Lines or roots to be found, as arrays.
struct Queue {
  alignas(64) double part[kLineParts][kPadded];
  std::uint16_t from[kPadded];  ///< lines: ray of the block; tasks: line
  std::size_t size = 0;
};

constexpr int kRough = 1, kClose = 6;  // Halley's steps

enum State : std::uint8_t { kNothing, kMissed, kFound };

/// What is known of the first hit of each line, in l of the line.
struct Ends {
  double l[kPadded], outer[kPadded], inner[kPadded];
  double well[kPadded];   ///< -delta of the left well's lowest point
  bool in_left[kPadded];  ///< falls into the left well
  std::uint8_t state[kPadded];
};

struct Block {
  Queue entries, exits, clean, hard, tasks, pairs;
  alignas(64) double back[kPadded];  ///< l of the caller = l here * back
  Ends in, out, second, third;
};

template <std::size_t N>
void append(Queue& queue, unsigned lanes, const Lanes (&values)[N], const std::uint16_t* from,
            std::size_t at) {
  for (std::size_t i = 0; i < N; ++i) store_selected(queue.part[i] + queue.size, lanes, values[i]);
  for (; lanes != 0; lanes &= lanes - 1) {
    const std::size_t which = at + static_cast<unsigned>(__builtin_ctz(lanes));
    queue.from[queue.size++] = from == nullptr ? static_cast<std::uint16_t>(which) : from[which];
  }
}

Lanes part(const Queue& queue, std::size_t which, std::size_t i) { return load(&queue.part[which][i]); }

unsigned lanes_left(const Queue& queue, std::size_t i) {
  return queue.size - i < kLanes ? (1U << (queue.size - i)) - 1 : (1U << kLanes) - 1;
}

// ----------------------------------------------------------------------------------------------- the quartic

/// f along a line about its foot, with what bounds its errors.
struct Shape {
  Lanes a, per_a, py, dy, k;
  Lanes error_k, slant, size_y, extent;
};

[[gnu::always_inline]] inline Shape shape_of(const Queue& lines, std::size_t i, double side) {
  const Lanes dx = part(lines, kDx, i), dy = part(lines, kDy, i), dz = part(lines, kDz, i);
  const Lanes a = fma(dx, dx, fma(dy, dy, dz * dz));
  return {a,
          1 / a,
          part(lines, kPy, i),
          side * dy,
          part(lines, kK, i),
          part(lines, kErrorK, i),
          part(lines, kSlant, i),
          part(lines, kSizeY, i),
          part(lines, kExtent, i)};
}

struct Value {
  Lanes f, df, ddf;
  Lanes error, slope_error;
};

[[gnu::always_inline]] inline Value evaluate(const Frame& frame, const Shape& s, Lanes delta) {
  const Lanes y = fma(delta, s.dy, s.py);
  const Lanes reach = s.a * delta, square = reach * delta;
  const Lanes k = fma(reach, delta, s.k);
  const Lanes drop = frame.weight * ((y - frame.tube) * (y + frame.tube));
  const Lanes lift = frame.weight * s.dy, swing = 4 * reach * k, tilt = 2 * lift * y;
  const Lanes bend = 8 * s.a * square + 4 * s.a * k + 2 * lift * s.dy;
  // Sizes and counts: surfaces/torus.md.
  const Lanes size_k = abs(k);
  const Lanes error_y = kU * (abs(y) + s.size_y);
  const Lanes error_k = fma(2 * s.slant, abs(delta), s.error_k) + kU * (6 * square + 3 * size_k);
  const Lanes error = fma(2 * size_k + error_k, error_k, frame.weight * (2 * abs(y) + error_y) * error_y) +
                      kU * (7 * abs(drop) + 2 * k * k);
  const Lanes slope_error = 4 * fma(abs(reach), error_k, s.slant * (size_k + error_k)) +
                            2 * abs(lift) * error_y + 7 * kU * (abs(swing) + abs(tilt));
  return {fma(k, k, drop), swing + tilt, bend, kPay * error, kPay * slope_error};
}

/// f'' >= 0 for |delta| >= edge; between, f'' <= bend. slack = bend edge^2 / 2: by so much f may lie below a
/// chord.
struct Region {
  Lanes turn;  ///< (a delta + b)^2 at the inflections
  Lanes turn_error;
  Lanes edge, bend, slack;
};

[[gnu::always_inline]] inline Region region_of(const Frame& frame, const Shape& s) {
  const Lanes lift = frame.weight * s.dy * s.dy;
  const Lanes ak = s.a * s.k;
  const Lanes turn = fma(2.0 + Lanes{}, ak, lift) * (-1.0 / 6);
  const Lanes error = kPay * (fma(s.a, s.error_k, 3 * kU * (abs(ak) + lift)) + s.slant * s.slant);
  const Lanes far = sqrt(max(turn + error, Lanes{})) + 2 * s.slant;
  const Lanes edge = kPay * (far * s.per_a);
  const Lanes wide = (far + s.slant) * (far + s.slant);
  const Lanes bend = kPay * 12 * (wide - turn + error + 8 * kU * (wide + abs(turn)));
  return {turn, error, edge, bend, kPay * 0.5 * bend * edge * edge};
}

/// The lowest point of f to the left of -edge, or -edge itself: -v.
struct Well {
  Lanes v, f, ddf;
  Mask clean;  ///< f > slack in all of [-extent, -edge]
};

[[gnu::always_inline]] inline Lanes clamp(Lanes v, const Shape& s, const Region& region) {
  return max(min(v, s.extent), region.edge);
}

/// f' = -4 a^2 (v^3 - 3 i v - j): Halley's steps to the largest root, from the sum of its size for j = 0 and
/// the first-order change.
[[gnu::always_inline]] inline Lanes find_well(const Frame& frame, const Shape& s, const Region& region,
                                              int steps) {
  const Lanes i = region.turn * s.per_a * s.per_a;
  const Lanes j = 0.5 * frame.weight * s.py * s.dy * s.per_a * s.per_a;
  const Lanes weight = select(i > 0, 6 * i, -3 * i);
  Lanes v = clamp(sqrt(max(3 * i, Lanes{})) + j / weight, s, region);
  for (int step = 0; step < steps; ++step) {
    const Lanes square = v * v;
    const Lanes h = fma(fma(-3.0 + Lanes{}, i, square), v, -j), dh = 3 * (square - i);
    v = clamp(v - h * dh / fma(dh, dh, -3 * h * v), s, region);
  }
  // h grows from the edge on: without a sign change f has no lowest point beyond it.
  const Lanes at_edge = fma(fma(-3.0 + Lanes{}, i, region.edge * region.edge), region.edge, -j);
  return select(at_edge >= 0, region.edge, v);
}

/// `polish`: a last step of Newton's, to where f' is positive for certain: nothing is lost to the right of
/// it.
[[gnu::always_inline]] inline Well well_of(const Frame& frame, const Shape& s, const Region& region,
                                           int steps, bool polish) {
  Lanes v = find_well(frame, s, region, steps);
  if (polish) {
    const Value near = evaluate(frame, s, -v);
    v = clamp(v + (near.df - 2 * near.slope_error) / near.ddf, s, region);
  }
  const Value at = evaluate(frame, s, -v);
  // f lies above its tangent; to the left, where f'' grows, above its parabola.
  const Lanes to_right = max(at.slope_error - at.df, Lanes{}) * (v - region.edge);
  const Lanes rise = max(at.df + at.slope_error, Lanes{});
  const Lanes av = s.a * v;
  const Lanes bend_error =
      12 * (region.turn_error + s.slant * (2 * av + s.slant) + 4 * kU * (av * av + abs(region.turn)));
  const Lanes to_left = min(select(at.ddf > 2 * bend_error, rise * rise / at.ddf, all(kInfinity)),
                            rise * max(s.extent - v, Lanes{}));
  return {v, at.f, at.ddf, at.f - at.error - region.slack > kPay * (to_left + to_right)};
}

/// Where f falls to zero beside the well at z (side -1: the left one), by e^2 = -f(z) / (f''/2 + a^2 e (e - 4
/// z)).
[[gnu::always_inline]] inline Lanes start_beside(const Shape& s, const Well& well, double side) {
  const Lanes half = 0.5 * well.ddf, lead = s.a * s.a;
  const Lanes depth = max(-well.f, Lanes{});
  Lanes e = min(sqrt(depth / half), s.extent);
  for (int step = 0; step < 2; ++step)
    e = sqrt(depth / max(fma(lead * e, e - 4 * side * well.v, half), 0.25 * half));
  return fma(side + Lanes{}, well.v, -e);
}

// ---------------------------------------------------------------------------------------------------- stages

/// Brings kLanes rays to the frame; queues those that may hit.
void cull(const Frame& frame, const TorusBatch& batch, double unit, const double* rays, std::size_t at,
          std::size_t count, Block& block, std::int8_t* hits) {
  Lanes x[6];
  load_records(rays, x);
  const Lanes shrink = reciprocal_power(max(abs(x[3]), max(abs(x[4]), abs(x[5]))));
  const double scale = batch.inverse_unit;
  const Lanes ox = x[0] * scale, oy = x[1] * scale, oz = x[2] * scale;
  const Lanes dx = x[3] * shrink, dy = x[4] * shrink, dz = x[5] * shrink;
  const Lanes a = fma(dx, dx, fma(dy, dy, dz * dz)), per_a = 1 / a;
  // The foot, in two steps: the second takes what the rounding of a far centre left.
  const Lanes centre = -per_a * fma(ox, dx, fma(oy, dy, oz * dz));
  const Lanes bx = fma(centre, dx, ox), by = fma(centre, dy, oy), bz = fma(centre, dz, oz);
  const Lanes shift = -per_a * fma(bx, dx, fma(by, dy, bz * dz));
  const Lanes px = fma(shift, dx, bx), py = fma(shift, dy, by), pz = fma(shift, dz, bz);
  const Lanes sx = abs(px) + abs(bx), sy = abs(py) + abs(by), sz = abs(pz) + abs(bz);
  const Lanes b = fma(px, dx, fma(py, dy, pz * dz));
  const Lanes size_b = fma(sx, abs(dx), fma(sy, abs(dy), sz * abs(dz)));
  const Lanes slant = kPay * fma(5 * kU + Lanes{}, size_b, abs(b));
  const Lanes size_p = fma(sx, sx, fma(sy, sy, sz * sz));
  const Lanes k = (fma(px, px, fma(py, py, pz * pz)) - frame.sum) - frame.sum_tail;
  const Lanes error_k = kPay * kU * (6 * size_p + 3 * abs(k));

  // Outside of |delta| <= extent K exceeds 2 R r; where that is everywhere, the line misses the sphere.
  const Lanes room = (frame.reach - k) + error_k + 8 * kU * (frame.reach + abs(k));
  const Lanes extent = kPay * fma(2 * slant, per_a, sqrt(max(room, Lanes{}) * per_a));
  const Lanes away = abs(py) - frame.tube;
  const Lanes climb = extent * abs(dy);
  // |x|^2 + R/r y^2 <= (R + r)^2 holds the torus.
  const Lanes tall = frame.flatness * py;
  const Lanes ea = fma(frame.flatness * dy, dy, a), eb = fma(tall, dy, b),
              ec = fma(tall, py, k - frame.reach);
  const Lanes size_eb = fma(frame.flatness * sy, abs(dy), size_b);
  const Lanes size_ec = fma(frame.flatness * sy, sy, size_p) + (frame.sum + frame.reach);
  const Mask missed = (room < -2 * slant * slant * per_a) |
                      (away > climb + 8 * kU * (sy + climb + frame.tube)) |
                      (fma(eb, eb, -(ea * ec)) < -64 * kU * fma(size_eb, size_eb, ea * size_ec));
  const Lanes origin = -centre - shift;
  const Lanes edge = extent + 8 * kU * (abs(centre) + abs(shift) + extent);
  const Mask behind = origin > edge, ahead = origin < -edge;
  const Lanes size_d = max(abs(dx), max(abs(dy), abs(dz)));
  const Mask usable = (max(abs(ox), max(abs(oy), abs(oz))) < kFarthest) & (size_d >= 1) & (size_d < 2);
  store(&block.back[at], shrink * unit);

  const unsigned valid = ((1U << count) - 1) & to_bits(usable);
  const unsigned gone = to_bits(missed | behind) & valid;
  for (unsigned none = gone; none != 0; none &= none - 1) hits[__builtin_ctz(none)] = 0;
  const unsigned left = valid & ~gone;
  append(block.entries, left, {ox, oy, oz, dx, dy, dz, py, k, centre, shift, error_k, slant, sy, extent},
         nullptr, at);
  const unsigned leaving = batch.all ? left : left & ~to_bits(ahead);
  if (leaving != 0)
    append(block.exits, leaving,
           {ox, oy, oz, -dx, -dy, -dz, py, k, -centre, -shift, error_k, slant, sy, extent}, nullptr, at);
}

void append_task(Queue& tasks, const Queue& lines, std::size_t i, unsigned lanes, Lanes limit, Lanes slack,
                 Lanes delta, const std::uint16_t* from) {
  append(tasks, lanes,
         {part(lines, kOx, i), part(lines, kOy, i), part(lines, kOz, i), part(lines, kDx, i),
          part(lines, kDy, i), part(lines, kDz, i), part(lines, kPy, i), part(lines, kK, i),
          part(lines, kCentre, i), part(lines, kShift, i), limit, slack, delta},
         from, i);
}

void append_line(Queue& to, const Queue& lines, std::size_t i, unsigned lanes, const std::uint16_t* from) {
  if (lanes == 0) return;
  Lanes parts[kLineParts];
  for (std::size_t n = 0; n < kLineParts; ++n) parts[n] = part(lines, n, i);
  append(to, lanes, parts, from, i);
}

/// Where lines go that have been looked at.
struct Sorted {
  Queue& tasks;  ///< fall into the well
  Queue& clean;  ///< pass it for certain
  Queue& hard;   ///< neither is sure
};

/// How a line is looked at: `from` are the lines' numbers, or none if they are counted from 0.
struct Look {
  int steps;
  bool polish;
  const std::uint16_t* from;
};

void look_left(const Frame& frame, const Queue& lines, Look look, const Sorted& to, Ends& ends) {
  for (std::size_t i = 0; i < lines.size; i += kLanes) {
    const Shape s = shape_of(lines, i, 1);
    const Region region = region_of(frame, s);
    const Well well = well_of(frame, s, region, look.steps, look.polish);
    const unsigned valid = lanes_left(lines, i);
    const unsigned falls = to_bits(well.f < 0) & valid, passes = to_bits(well.clean) & valid & ~falls;
    if (falls != 0)
      append_task(to.tasks, lines, i, falls, -region.edge, Lanes{}, start_beside(s, well, -1), look.from);
    alignas(64) double v[kLanes];
    store(v, well.v);
    for (unsigned left = falls; left != 0; left &= left - 1) {
      const unsigned n = static_cast<unsigned>(__builtin_ctz(left));
      const std::size_t line = look.from == nullptr ? i + n : look.from[i + n];
      ends.in_left[line] = true;
      ends.well[line] = v[n];
    }
    append_line(to.clean, lines, i, passes, look.from);
    append_line(to.hard, lines, i, valid & ~(falls | passes), look.from);
  }
}

/// The right well of lines that have nothing to the left of it.
void look_right(const Frame& frame, const Queue& lines, Look look, const Sorted& to, Ends& ends) {
  for (std::size_t i = 0; i < lines.size; i += kLanes) {
    const Shape s = shape_of(lines, i, -1);
    const Region region = region_of(frame, s);
    const Well well = well_of(frame, s, region, look.steps, look.polish);
    const unsigned valid = lanes_left(lines, i);
    const unsigned falls = to_bits(well.f < 0) & valid, passes = to_bits(well.clean) & valid & ~falls;
    if (falls != 0)
      append_task(to.tasks, lines, i, falls, all(kInfinity), region.slack, start_beside(s, well, 1),
                  look.from);
    for (unsigned missed = passes; missed != 0; missed &= missed - 1)
      ends.state[look.from[i + static_cast<unsigned>(__builtin_ctz(missed))]] = kMissed;
    append_line(to.hard, lines, i, valid & ~(falls | passes), look.from);
  }
}

/// Euler's step to the root of the local parabola at which it falls.
void step(const Frame& frame, Queue& tasks) {
  for (std::size_t i = 0; i < tasks.size; i += kLanes) {
    const Lanes delta = part(tasks, kDelta, i);
    const Lanes dx = part(tasks, kDx, i), dy = part(tasks, kDy, i), dz = part(tasks, kDz, i);
    const Lanes reach = fma(dx, dx, fma(dy, dy, dz * dz)) * delta;
    const Lanes y = fma(delta, dy, part(tasks, kPy, i));
    const Lanes k = fma(reach, delta, part(tasks, kK, i));
    const Lanes lift = frame.weight * dy;
    const Lanes f = fma(k, k, frame.weight * ((y - frame.tube) * (y + frame.tube)));
    const Lanes df = fma(4 * reach, k, 2 * lift * y);
    const Lanes ddf = 8 * reach * reach + fma(4 * k, fma(dx, dx, fma(dy, dy, dz * dz)), 2 * lift * dy);
    store(&tasks.part[kDelta][i], delta - 2 * f / (df - sqrt(max(fma(df, df, -2 * f * ddf), Lanes{}))));
  }
}

/// f = G other at the double l of the ray itself, G the factor that is nearer to zero and other > 0:
/// F1 = (rho - R)^2 + y^2 - r^2 of the outer sheet, or -F2, F2 = (rho + R)^2 + y^2 - r^2, of the inner one.
struct Place {
  Lanes g, error;
  Lanes dg, bend;            ///< slope, and the size of the second derivative
  Lanes other, other_error;  ///< a ring torus is far enough from F2 = 0 to need no error
  Mask is_inner;             ///< G is -F2
};

/// `same`: a place of which the sheet is to be taken, or none.
template <bool kRing>
[[gnu::always_inline]] inline Place place_at(const Frame& frame, const Queue& tasks, std::size_t i, Lanes l,
                                             const Place* same) {
  const Lanes dx = part(tasks, kDx, i), dy = part(tasks, kDy, i), dz = part(tasks, kDz, i);
  const Lanes x = fma(l, dx, part(tasks, kOx, i)), y = fma(l, dy, part(tasks, kOy, i)),
              z = fma(l, dz, part(tasks, kOz, i));
  const Lanes rho = sqrt(fma(x, x, z * z));
  const Lanes drop = (y - frame.tube) * (y + frame.tube);
  const Lanes flat = 3 * y * y + 5 * abs(drop);
  const auto error_of = [&](Lanes out) {
    return kPay * kU * (7 * (abs(out) + 8 * kU * rho) * rho + 4 * out * out + flat);
  };
  Lanes out = rho - frame.ring, in = rho + frame.ring;
  const Lanes outer = fma(out, out, drop), inner = fma(in, in, drop);
  Place place{outer, error_of(out), out, out, inner, Lanes{}, Mask{}};
  if constexpr (!kRing) {
    const Mask is_inner = same == nullptr ? abs(inner) < abs(outer) : same->is_inner;
    place.is_inner = is_inner;
    place.other_error = error_of(select(is_inner, out, in));
    out = select(is_inner, in, out);
    place.error = error_of(out);
    place.g = select(is_inner, -inner, outer);
    place.other = select(is_inner, -outer, inner);
    place.dg = select(is_inner, all(-2.0), all(2.0));
  } else {
    place.dg = all(2.0);
  }
  const Lanes per_rho = 1 / rho;
  place.dg *= fma(out * per_rho, fma(x, dx, z * dz), y * dy);
  place.bend = 2 * fma(dx, dx, fma(dy, dy, dz * dz)) * (1 + abs(out) * per_rho);
  return place;
}

/// The proof: outside before a bracket about the approximation, inside behind it. Leaves l and the bracket.
template <bool kRing>
void certify(const Frame& frame, Queue& tasks, Ends& ends) {
  for (std::size_t i = 0; i < tasks.size; i += kLanes) {
    const Lanes centre = part(tasks, kCentre, i), shift = part(tasks, kShift, i);
    const Lanes slack = part(tasks, kSlack, i);
    const Lanes l0 = centre + (shift + part(tasks, kDelta, i));
    const Place at = place_at<kRing>(frame, tasks, i, l0, nullptr);
    const Lanes per_slope = 1 / (at.other * at.dg);
    const Lanes l = l0 - at.g * (at.other * per_slope);
    // Wide enough for the bound on G and for f > slack, and for what l itself was rounded by.
    const Lanes grain = 4 * kU * (abs(l) + abs(centre) + abs(shift));
    const Lanes width = grain - 4 * fma(at.error, at.other, slack) * per_slope;
    const Lanes low = l - width, high = l + width;
    const Place a = place_at<kRing>(frame, tasks, i, low, &at);
    const Place b = place_at<kRing>(frame, tasks, i, high, &at);
    const Mask outside = (a.g > a.error) & ((a.g - a.error) * (a.other - a.other_error) > 2 * slack);
    const Mask inside = (b.g < -b.error) & (b.other > b.other_error);
    const Lanes rounding = 8 * kU * (abs(high) + abs(centre) + abs(shift));
    const Mask within = ((high - centre) - shift) + rounding < part(tasks, kLimit, i);
    // A bracket that holds the origin does not say whether the hit is ahead of it; one in which G bends by
    // more than an eighth of its error is no place for a secant.
    const Mask straight =
        (64 * width * at.bend < -at.dg) & (4 * width * width * at.bend < at.error - grain * at.dg);
    const Mask decided = ((low > 0) | (high < 0)) & straight;
    const Lanes better = low + (high - low) * (a.g / (a.g - b.g));
    store(&tasks.part[kL][i], select((better >= low) & (better <= high), better, l));
    store(&tasks.part[kOuter][i], low);
    store(&tasks.part[kInner][i], high);
    unsigned found = to_bits(outside & inside & within & decided & (low < high)) & lanes_left(tasks, i);
    for (; found != 0; found &= found - 1) {
      const std::size_t task = i + static_cast<unsigned>(__builtin_ctz(found));
      const std::size_t line = tasks.from[task];
      ends.state[line] = kFound;
      ends.l[line] = tasks.part[kL][task];
      ends.outer[line] = tasks.part[kOuter][task];
      ends.inner[line] = tasks.part[kInner][task];
    }
  }
}

/// The lanes behind the last line compute too: on numbers, not on whatever lies there.
void pad(Queue& queue) {
  for (auto& one : queue.part) store(one + queue.size, Lanes{});
}

void find_roots(const Frame& frame, Queue& tasks, Ends& ends, int steps) {
  pad(tasks);
  for (int n = 0; n < steps; ++n) step(frame, tasks);
  if (frame.is_ring) {
    certify<true>(frame, tasks, ends);
  } else {
    certify<false>(frame, tasks, ends);
  }
}

/// The first hit of every line. A rough look at the wells settles most lines, a close one most others.
void find(const Frame& frame, Queue& lines, Block& block, Ends& ends) {
  if (lines.size == 0) return;
  __builtin_memset(ends.state, kNothing, sizeof ends.state);
  __builtin_memset(ends.in_left, 0, sizeof ends.in_left);
  Queue &clean = block.clean, &hard = block.hard, &never = block.pairs;
  block.tasks.size = clean.size = hard.size = 0;
  pad(lines);
  look_left(frame, lines, {kRough, false, nullptr}, {block.tasks, clean, hard}, ends);
  pad(hard);
  look_left(frame, hard, {kClose, true, hard.from}, {block.tasks, clean, never}, ends);
  hard.size = 0;
  pad(clean);
  look_right(frame, clean, {kRough, false, clean.from}, {block.tasks, never, hard}, ends);
  pad(hard);
  look_right(frame, hard, {kClose, true, hard.from}, {block.tasks, never, never}, ends);
  never.size = 0;
  find_roots(frame, block.tasks, ends, 3);
}

// ------------------------------------------------------------------------------- between first and last hit

/// A line whose first and last hit are found, and what lies between them.
struct Pair {
  std::uint16_t entry, exit;
  bool two_wells;
};
enum Between : std::uint8_t { kUnknown, kInside, kPerhapsFour };

struct Pairs {
  Pair pair[kPadded];
  double until[kPadded];  ///< inner end of the last hit's bracket, in l of the line that falls to the left
  std::uint8_t between[kPadded];
};

void copy_line(Queue& to, const Queue& from, std::size_t line, std::size_t parts) {
  for (std::size_t n = 0; n < parts; ++n) to.part[n][to.size] = from.part[n][line];
}

/// Both hits of the left well, or one of each well: is the line inside all the way?
void look_between(const Frame& frame, const Queue& lines, Pairs& pairs) {
  for (std::size_t i = 0; i < lines.size; i += kLanes) {
    const Shape s = shape_of(lines, i, 1);
    const Region region = region_of(frame, s);
    // One well: f is convex up to -edge, and if it still rises at the end it has risen all the way from
    // there.
    const Lanes centre = part(lines, kCentre, i), shift = part(lines, kShift, i),
                until = load(&pairs.until[i]);
    const Lanes end = ((until - centre) - shift) + 8 * kU * (abs(until) + abs(centre) + abs(shift));
    const Value at_end = evaluate(frame, s, min(end, region.edge));
    const unsigned one_well = to_bits(
        (end < -region.edge) | (at_end.df - at_end.slope_error > kPay * 2 * region.bend * region.edge));
    // Two wells: the summit between them.
    const Lanes turn = region.turn * s.per_a * s.per_a;
    const Lanes j = 0.5 * frame.weight * s.py * s.dy * s.per_a * s.per_a;
    Lanes top{};
    for (int n = 0; n < 5; ++n) {
      const Lanes square = top * top;
      top -= fma(fma(-3.0 + Lanes{}, turn, square), top, j) / (3 * (square - turn));
      top = max(min(top, region.edge), -region.edge);
    }
    const Value summit = evaluate(frame, s, top);
    const Mask under =
        summit.f + summit.error +
            kPay * (2 * (abs(summit.df) + summit.slope_error) * region.edge + 4 * region.slack) <
        0;
    // What looks like a well at an edge from which f only rises is the way out of the other one.
    const Value left = evaluate(frame, s, -region.edge), right = evaluate(frame, s, region.edge);
    const Lanes change = kPay * 2 * region.bend * region.edge;
    const Mask rises = (right.df - right.slope_error > change) & (right.f < -right.error);
    const Mask falls = (-left.df - left.slope_error > change) & (left.f < -left.error);
    const unsigned above = to_bits(summit.f > 0), below = to_bits(under | rises | falls);
    for (std::size_t n = 0; n < kLanes && i + n < lines.size; ++n) {
      const Between one = (one_well >> n & 1U) != 0 ? kInside : kUnknown;
      const Between two = (below >> n & 1U) != 0 ? kInside : (above >> n & 1U) != 0 ? kPerhapsFour : kUnknown;
      pairs.between[i + n] = pairs.pair[i + n].two_wells ? two : one;
    }
  }
}

/// From the lowest point of a right well, which is in delta, to where f falls into it.
void start_from_wells(const Frame& frame, Queue& tasks) {
  pad(tasks);
  for (std::size_t i = 0; i < tasks.size; i += kLanes) {
    const Lanes dx = part(tasks, kDx, i), dz = part(tasks, kDz, i);
    Shape s{};
    s.dy = part(tasks, kDy, i);
    s.a = fma(dx, dx, fma(s.dy, s.dy, dz * dz));
    s.py = part(tasks, kPy, i);
    s.k = part(tasks, kK, i);
    Well well{};
    well.v = part(tasks, kDelta, i);
    s.extent = 2 * abs(well.v);
    const Value value = evaluate(frame, s, well.v);
    well.f = value.f;
    well.ddf = value.ddf;
    store(&tasks.part[kDelta][i], start_beside(s, well, 1));
  }
}

void find_inner(const Frame& frame, const Queue& lines, const Pairs& pairs, std::size_t count, bool reversed,
                const Ends& other, Queue& tasks, Ends& ends) {
  tasks.size = 0;
  for (std::size_t n = 0; n < count; ++n) {
    ends.state[n] = kNothing;
    if (pairs.between[n] != kPerhapsFour) continue;
    const Pair& pair = pairs.pair[n];
    copy_line(tasks, lines, reversed ? pair.exit : pair.entry, kBothHave);
    tasks.part[kLimit][tasks.size] = kInfinity;
    tasks.part[kSlack][tasks.size] = 0;
    tasks.part[kDelta][tasks.size] = other.well[reversed ? pair.entry : pair.exit];
    tasks.from[tasks.size++] = static_cast<std::uint16_t>(n);
  }
  if (tasks.size == 0) return;
  start_from_wells(frame, tasks);
  find_roots(frame, tasks, ends, 4);
}

// ----------------------------------------------------------------------------------------------- conclusions

/// Hits of a line in ascending order, as hits of the ray.
void answer(const TorusBatch& batch, const double* l, int count, double back, std::size_t to,
            const TorusAnswers& answers) {
  int hits = 0;
  for (int n = 0; n < count; ++n) {
    if (l[n] < 0) continue;
    // What leaves the range of double in the caller's units is left open.
    const double here = l[n] * back;
    if (!(here > 0 && here < kInfinity)) return;
    answers.l[hits++][to] = here;
    if (!batch.all) break;
  }
  answers.hits[to] = static_cast<std::int8_t>(hits);
}

/// Answers what the first and the last hit alone decide, and gathers the other lines as pairs.
void conclude_ends(const TorusBatch& batch, Block& block, Pairs& pairs, std::size_t begin,
                   const TorusAnswers& answers) {
  std::size_t exit = 0;
  for (std::size_t entry = 0; entry < block.entries.size; ++entry) {
    const std::uint16_t ray = block.entries.from[entry];
    const bool has_exit = exit < block.exits.size && block.exits.from[exit] == ray;
    const std::size_t last = exit;
    exit += has_exit ? 1 : 0;
    const std::uint8_t in = block.in.state[entry],
                       out = has_exit ? block.out.state[last] : std::uint8_t{kNothing};
    if (in == kMissed || out == kMissed) answers.hits[begin + ray] = 0;
    if (in != kFound) continue;
    const double from = block.in.l[entry];
    if (!batch.all && from > 0) answer(batch, &from, 1, block.back[ray], begin + ray, answers);
    if (out != kFound || (!batch.all && from > 0)) continue;
    if (-block.out.l[last] < 0) {
      answers.hits[begin + ray] = 0;
      continue;
    }
    // The line is looked at from the side on which it falls into the left well.
    const bool left = block.in.in_left[entry], right = block.out.in_left[last];
    if (!left && !right) continue;
    const std::size_t n = block.pairs.size;
    pairs.pair[n] = {static_cast<std::uint16_t>(entry), static_cast<std::uint16_t>(last), left && right};
    pairs.until[n] = left ? -block.out.inner[last] : -block.in.inner[entry];
    copy_line(block.pairs, left ? block.entries : block.exits, left ? entry : last, kLineParts);
    ++block.pairs.size;
  }
}

void conclude_pairs(const Frame& frame, const TorusBatch& batch, Block& block, Pairs& pairs,
                    std::size_t begin, const TorusAnswers& answers) {
  const std::size_t count = block.pairs.size;
  if (count == 0) return;
  pad(block.pairs);
  store(&pairs.until[count], Lanes{});
  look_between(frame, block.pairs, pairs);
  find_inner(frame, block.exits, pairs, count, true, block.in, block.tasks, block.second);
  find_inner(frame, block.entries, pairs, count, false, block.out, block.tasks, block.third);
  for (std::size_t n = 0; n < count; ++n) {
    const Pair& pair = pairs.pair[n];
    const std::uint16_t ray = block.entries.from[pair.entry];
    const double first = block.in.l[pair.entry], last = -block.out.l[pair.exit];
    if (!(block.in.inner[pair.entry] < -block.out.inner[pair.exit])) continue;
    if (pairs.between[n] == kInside) {
      const double l[] = {first, last};
      answer(batch, l, 2, block.back[ray], begin + ray, answers);
    }
    if (pairs.between[n] != kPerhapsFour || block.second.state[n] != kFound || block.third.state[n] != kFound)
      continue;
    // Four changes of sign in brackets that do not meet are all that a quartic has.
    if (!(block.in.inner[pair.entry] < -block.second.inner[n] &&
          -block.second.outer[n] < block.third.outer[n] &&
          block.third.inner[n] < -block.out.inner[pair.exit]))
      continue;
    const double l[] = {first, -block.second.l[n], block.third.l[n], last};
    answer(batch, l, 4, block.back[ray], begin + ray, answers);
  }
}

}  // namespace

void intersect_torus(const TorusBatch& batch, const TorusAnswers& answers) {
  const Frame frame = frame_of(batch.ring, batch.tube);
  const double unit = 1 / batch.inverse_unit;
  Block block;
  Pairs pairs;
  for (std::size_t begin = 0; begin < batch.count; begin += kBlock) {
    const std::size_t size = batch.count - begin < kBlock ? batch.count - begin : kBlock;
    block.entries.size = block.exits.size = block.pairs.size = 0;
    __builtin_memset(answers.hits + begin, kOpen, size);
    for_groups<kLanes>(&batch.rays[begin].o.x, size,
                       [&](const double* rays, std::size_t at, std::size_t count) {
                         cull(frame, batch, unit, rays, at, count, block, answers.hits + begin + at);
                       });
    find(frame, block.entries, block, block.in);
    find(frame, block.exits, block, block.out);
    conclude_ends(batch, block, pairs, begin, answers);
    conclude_pairs(frame, batch, block, pairs, begin, answers);
  }
}

}  // namespace graze::GRAZE_LANES
