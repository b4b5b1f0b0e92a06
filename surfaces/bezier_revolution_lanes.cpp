// Hits of many rays with a revolved Bezier profile, proved in double. Compiled once for each instruction set;
// derivation and error analysis: surfaces/bezier_revolution.md, "Kernel".
#include <graze/surfaces/bezier_revolution_lanes.hpp>

#include <utility>

#include <graze/solvers/math/lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kInfinity = __builtin_inf();
constexpr double kTiny = 0x1p-960;  // far above what underflow can add to a bound, far below what matters
// Rays of a stage. With 256 or 512 arrays share sets of the cache: 2 % slower.
constexpr std::size_t kBlock = 384;
constexpr std::size_t kPadded = kBlock + kLanes;
constexpr std::size_t kSlots = 2 * kBlock + kLanes;  // a round asks at most two crossings of a line
constexpr std::int8_t kOpen = -1;

using Bits = std::uint64_t;

/// Lines that may hit, each run so that it does not fall: l of the ray is `way` times l of the line.
enum Field : std::size_t {
  kOx,
  kOy,
  kOz,
  kDx,
  kDy,
  kDz,
  kPx,
  kPy,
  kPz,
  kCentre,
  kLo,
  kHi,
  kCross2,
  kWay,
  kFields = 16
};
struct Lines {
  /// Origin, direction, p and its l (kCentre), l - centre beyond which there is no surface (kLo, kHi),
  /// |p_xz x d_xz|^2 rounded down (kCross2), kWay.
  alignas(64) double record[kPadded][kFields];
  Bits crossed[kPadded], rising[kPadded], peaks[kPadded], valleys[kPadded], open[kPadded];  ///< of intervals
  std::uint16_t ray[kPadded];                                                               ///< of the block
  std::size_t size = 0;
};

/// Intervals to be asked, and what was found.
struct Slots {
  std::uint16_t line[kSlots];
  std::uint8_t interval[kSlots];
  std::size_t size = 0;
};
struct Crossings : Slots {
  alignas(64) double delta[kSlots], sigma[kSlots];  ///< approximations, where there is another beside it
  alignas(64) double enters[kSlots];                ///< 1 where F rises along the line, else -1
  alignas(64) double l[kSlots], low[kSlots], high[kSlots];
  std::uint8_t found[kSlots];
  std::uint16_t from[kSlots];  ///< slot of the first look
  /// Of two beside an extremum -1 for the lower, 1 for the upper; 0 for the only one of its interval.
  alignas(64) double side[kSlots];
  bool is_alone[kSlots];  ///< its fellow beyond the extremum is not asked
};
struct Extrema : Slots {
  alignas(64) double sign[kSlots];  ///< 1 peak, -1 valley
  alignas(64) double delta[2][kSlots], sigma[2][kSlots];
  std::uint8_t is_missed[kSlots], is_passed[kSlots];
};

/// What a line is, once a ray of the block.
struct Hits {
  double l[BezierAnswers::kMost + 1];
  std::uint8_t count;
  bool is_open;
  bool is_done;  ///< with this track
};

struct Block {
  Lines lines;
  Crossings crossings, again;
  Extrema extrema;
  Hits hits[kPadded];
  double back[kPadded];  ///< l of the caller = l here * back
  std::uint16_t pending[kPadded];
};

/// What every stage needs of kLanes lines.
struct Line {
  Lanes px, py, pz, dx, dy, dz;
  Lanes flat2, along, square;  ///< |d_xz|^2, p_xz . d_xz, |p_xz|^2
};

Line complete(Lanes px, Lanes py, Lanes pz, Lanes dx, Lanes dy, Lanes dz) {
  return {px, py, pz, dx, dy, dz, fma(dx, dx, dz * dz), fma(px, dx, pz * dz), fma(px, px, pz * pz)};
}

/// How far l may be off where the line meets a height, as computed (three roundings, and that of p_y).
struct Margin {
  Lanes per_rise, reach, eps;
};

Margin margin_of(const BezierBatch& batch, const Line& x, Lanes lo, Lanes hi) {
  const Mask level = x.dy == 0;
  const Lanes per_rise = 1 / x.dy;
  const Lanes clip = max(abs(lo), abs(hi));
  const Lanes heights = (2 * batch.y_size + abs(x.py)) * per_rise;
  const Lanes reach = select(level, clip, min(clip, heights));
  const Lanes eps = select(level, Lanes{}, 8 * kU * (reach + heights));
  // Beyond this distance the clip's own rounding would count.
  return {per_rise, reach, select(x.square < 0x1p60, eps, all(kInfinity))};
}

Lanes outermost(const BezierBatch& batch, bool top) {
  double y = top ? -kInfinity : kInfinity;
  for (std::size_t k = 0; k < batch.track_count; ++k) {
    const double low = batch.intervals[batch.tracks[k].begin].y_low;
    const double high = batch.intervals[batch.tracks[k].end - 1].y_high;
    y = top ? (high > y ? high : y) : (low < y ? low : y);
  }
  return all(y);
}

/// Across: m[i][k] becomes m[k][i].
[[gnu::always_inline]] inline void turn(Lanes (&m)[kLanes]) {
  [[maybe_unused]] const auto swap = [&m](std::size_t step, auto low, auto high)
      __attribute__((always_inline)) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      if ((i & step) != 0) continue;
      const Lanes a = m[i], b = m[i + step];
      m[i] = low(a, b);
      m[i + step] = high(a, b);
    }
  };
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  swap(
      1, [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14); },
      [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15); });
  swap(
      2, [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13); },
      [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15); });
  swap(
      4, [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11); },
      [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15); });
#elif defined(__AVX2__) && defined(__FMA__)
  swap(
      1, [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 0, 4, 2, 6); },
      [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 1, 5, 3, 7); });
  swap(
      2, [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 0, 1, 4, 5); },
      [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 2, 3, 6, 7); });
#elif !defined(GRAZE_COUNTED_LANES)  // one lane has nothing to turn
  swap(
      1, [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 0, 2); },
      [](Lanes a, Lanes b) { return __builtin_shufflevector(a, b, 1, 3); });
#endif
}

/// The eight doubles at each of kLanes places, as eight lanes.
[[gnu::always_inline]] inline void across(const double* const (&from)[kLanes], std::size_t offset,
                                          Lanes* to) {
  for (std::size_t part = 0; part < 8; part += kLanes) {
    Lanes m[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) m[k] = load(from[k] + offset + part);
    turn(m);
    for (std::size_t k = 0; k < kLanes; ++k) to[part + k] = m[k];
  }
}

void append(Lines& lines, unsigned lanes, std::size_t at, const Lanes (&values)[kFields]) {
  std::size_t to[kLanes], count = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<unsigned>(__builtin_ctz(lanes));
    to[count++] = lane;
    lines.ray[lines.size + count - 1] = static_cast<std::uint16_t>(at + lane);
  }
  for (std::size_t part = 0; part < kFields; part += kLanes) {
    Lanes m[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) m[k] = values[part + k];
    turn(m);
    for (std::size_t n = 0; n < count; ++n) store(lines.record[lines.size + n] + part, m[to[n]]);
  }
  lines.size += count;
}

/// Brings kLanes rays to the frame and against the bounding cylinder; queues those that may hit.
void cull(const BezierBatch& batch, Lanes bottom, Lanes top, const double* rays, std::size_t at,
          std::size_t count, Block& block, std::int8_t* hits) {
  Lanes from[6];
  load_records(rays, from);
  const Lanes qx = from[3], qy = from[4], qz = from[5];
  const Lanes shrink = reciprocal_power(max(abs(qx), max(abs(qy), abs(qz))));
  const double scale = batch.inverse_unit;
  const Lanes ox = from[0] * scale, oy = from[1] * scale, oz = from[2] * scale;
  const Mask falls = qy < 0;
  const Lanes way = select(falls, all(-1.0), all(1.0));
  const Lanes turned = shrink * way;
  const Lanes dx = qx * turned, dy = abs(qy * shrink), dz = qz * turned;
  const Lanes along = fma(ox, dx, fma(oy - batch.middle, dy, oz * dz));
  const Lanes centre = -along / fma(dx, dx, fma(dy, dy, dz * dz));
  const Line x = complete(fma(centre, dx, ox), fma(centre, dy, oy), fma(centre, dz, oz), dx, dy, dz);

  // No surface where |x_xz|^2 > g_most. The clip is wider than the cull, so that its root is far from 0.
  const Lanes cross = x.px * dz - x.pz * dx;
  const Lanes cross2 = fma(cross, cross, -(0x1p-40 * x.square * x.flat2));
  const Mask beside = cross2 > batch.g_most * (1 + 0x1p-10) * x.flat2;
  const Lanes root = sqrt(max(fma(all(batch.g_most * (1 + 0x1p-9)), x.flat2, -(cross * cross)), Lanes{}));
  const Mask steep = x.flat2 == 0;
  const Lanes per_flat2 = 1 / x.flat2;
  const Lanes lo = select(steep, all(-kInfinity), (-x.along - root) * per_flat2);
  const Lanes hi = select(steep, all(kInfinity), (root - x.along) * per_flat2);

  const Margin margin = margin_of(batch, x, lo, hi);
  const Lanes a = (bottom - x.py) * margin.per_rise, b = (top - x.py) * margin.per_rise;
  const Mask apart = (a > hi + margin.eps) | (b < lo - margin.eps);
  const Mask behind =
      (~falls & (min(b + margin.eps, hi) < -centre)) | (falls & (max(a - margin.eps, lo) > -centre));
  store(&block.back[at], shrink / batch.inverse_unit);

  const unsigned valid = (1U << count) - 1;
  const unsigned gone = to_bits(beside | apart | behind) & valid;
  for (std::size_t i = 0; i < count; ++i) hits[i] = (gone >> i & 1U) != 0 ? 0 : kOpen;
  append(block.lines, valid & ~gone, at,
         {ox, oy, oz, dx, dy, dz, x.px, x.py, x.pz, centre, lo, hi, cross2, way, Lanes{}, Lanes{}});
}

/// kLanes lines with all their fields.
struct Taken {
  Lanes field[kFields];
  Line x;

  Taken(const Lines& lines, const std::size_t (&line)[kLanes]) {
    const double* from[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) from[k] = lines.record[line[k]];
    across(from, 0, field);
    across(from, 8, field + 8);
    x = complete(field[kPx], field[kPy], field[kPz], field[kDx], field[kDy], field[kDz]);
  }
};

/// Where a line meets a height, cut to its clip.
struct Station {
  Lanes at;            ///< l - centre
  Lanes square, fall;  ///< |x_xz|^2 and its derivative there
  Mask below, above;   ///< certainly beyond the clip
};

/// A level line at this very height meets it nowhere in particular: no number, which proves nothing.
[[gnu::always_inline]] inline Station station_at(const Line& x, const Margin& margin, Lanes lo, Lanes hi,
                                                 Lanes height) {
  const Lanes delta = (height - x.py) * margin.per_rise;
  const Lanes at = min(hi, max(lo, delta));
  const Lanes half = fma(x.flat2, at, x.along);
  return {at, fma(at, half + x.along, x.square), 2 * half, (delta < lo - margin.eps),
          (delta > hi + margin.eps)};
}

/// What F = G(y) - |x_xz|^2 and F' are off by at stations, and where a line is sure to be beside the axis. A
/// station's place is off by at most eps, or 2 eps where it was cut without certainty.
struct Errors {
  Lanes f, df, off;

  Errors(const BezierBatch& batch, const Line& x, const Margin& margin) {
    const Lanes flat = abs(x.dx) + abs(x.dz);
    const Lanes size = fma(margin.reach, flat, abs(x.px) + abs(x.pz));
    const Lanes slip = 2 * flat * margin.eps;
    f = fma(32 * kU * size, size, fma(slip, 2 * size + slip, all(batch.g_error + kTiny)));
    df = 2 * flat * fma(all(8 * kU), size, slip);
    off = fma(all(8 * kU), size, slip);
  }
};

/// At a pole, where G is exactly 0, F < 0 unless the line meets the axis.
[[gnu::always_inline]] inline Mask is_beside(const Line& x, const Station& station, const Errors& errors) {
  const Lanes px = fma(station.at, x.dx, x.px), pz = fma(station.at, x.dz, x.pz);
  return max(abs(px), abs(pz)) > errors.off;
}

/// The signs of F'' by the range of d2G/dy2.
struct Bend {
  Mask concave, convex;
};
[[gnu::always_inline]] inline Bend bend_of(const Line& x, Lanes ddg_low, Lanes ddg_high) {
  const Lanes rise2 = x.dy * x.dy;
  return {(x.dy == 0) | (ddg_high * rise2 < 2 * (1 - 0x1p-30) * x.flat2),
          ddg_low * rise2 > 2 * (1 + 0x1p-30) * x.flat2};
}

void set_bits(Bits* to, Mask bits) { __builtin_memcpy(to, &bits, sizeof bits); }

/// Asks every interval of every track whether F vanishes in it, or once: told of most by F at the ends and by
/// the ranges of G and |x_xz|^2 between them. The others are left open.
void sift(const BezierBatch& batch, Lines& lines, std::size_t i) {
  std::size_t which[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) which[k] = i + k;
  const Taken taken(lines, which);
  const Line& x = taken.x;
  const Lanes lo = taken.field[kLo], hi = taken.field[kHi];
  const Margin margin = margin_of(batch, x, lo, hi);
  const Errors errors(batch, x, margin);
  const Lanes nearest = taken.field[kCross2] * (1 - 0x1p-20) / x.flat2;
  // Of what lies behind the ray's origin, one way or the other.
  const Mask falls = taken.field[kWay] < 0;
  const Lanes from = select(falls, all(-kInfinity), -taken.field[kCentre] - 2 * margin.eps);
  const Lanes until = select(falls, 2 * margin.eps - taken.field[kCentre], all(kInfinity));
  struct End {
    Lanes at, square;
    Mask below, above, in, out, near, far;  ///< near: |x_xz|^2 may fall beyond; far: may rise before
  };
  const auto end_at = [&](double height, double g) {
    const Station here = station_at(x, margin, lo, hi, all(height));
    const Lanes f = g - here.square;
    const Mask cut = here.below | here.above;
    const Mask beside = g == 0 ? is_beside(x, here, errors) : Mask{};
    return End{here.at,
               here.square,
               here.below,
               here.above,
               ~cut & (f > errors.f),
               cut | beside | (f < -errors.f),
               (here.fall < errors.df),
               (here.fall > -errors.df)};
  };
  Mask crossed{}, rising{}, open{};
  for (std::size_t track = 0; track < batch.track_count; ++track) {
    const std::size_t begin = batch.tracks[track].begin, end = batch.tracks[track].end;
    End a = end_at(batch.intervals[begin].y_low, batch.intervals[begin].g_low);
    for (std::size_t k = begin; k < end; ++k) {
      const BezierInterval& part = batch.intervals[k];
      const End b = end_at(part.y_high, part.g_high);
      // Both ends, not the lesser: one may be no number.
      const Lanes most = part.g_most + errors.f;
      const Mask outside =
          ((most < a.square) & (most < b.square) & ~(a.near & b.far)) | (nearest > part.g_most);
      const Mask inside = a.in & b.in & (part.g_least - errors.f > max(a.square, b.square));
      const Mask gone = b.below | a.above | (b.at < from) | (a.at > until);
      const Mask none = outside | inside | gone;
      const Bend bend = bend_of(x, all(part.ddg_low), all(part.ddg_high));
      const Mask dome = part.is_concave ? ~Mask{} : Mask{};
      const Mask rises = a.out & b.in, sinks = a.in & b.out;
      const Mask one = (rises | sinks) & (bend.concave | bend.convex | dome);
      const Mask bit = (Mask{} + (std::int64_t{1} << k)) & ~none;
      crossed |= one & bit;
      rising |= one & rises & bit;
      open |= bit & ~one;
      a = b;
    }
  }
  set_bits(&lines.crossed[i], crossed);
  set_bits(&lines.rising[i], rising);
  set_bits(&lines.open[i], open);
}

// ------------------------------------------------------------------------------- intervals of kLanes slots

/// kLanes slots: their lines and intervals.
struct Asked {
  const BezierInterval* part[kLanes];
  Taken line;
  Lanes y_low, y_high, g_low, g_high, bend, turn, sigma_low, sigma_high;

  Asked(const BezierBatch& batch, const Lines& lines, const Slots& slots, std::size_t i)
      : Asked(batch, lines, slots, i, Which(slots, i)) {}

  [[nodiscard]] Lanes operator[](Field field) const { return line.field[field]; }
  /// One of their rows of eight.
  void take(double (BezierInterval::*row)[8], Lanes (&to)[8]) const {
    const double* from[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) from[k] = part[k]->*row;
    across(from, 0, to);
  }

 private:
  struct Which {
    std::size_t line[kLanes];
    Which(const Slots& slots, std::size_t i) {
      for (std::size_t k = 0; k < kLanes; ++k) line[k] = slots.line[i + k];
    }
  };
  Asked(const BezierBatch& batch, const Lines& lines, const Slots& slots, std::size_t i, const Which& which)
      : line(lines, which.line) {
    for (std::size_t k = 0; k < kLanes; ++k) part[k] = batch.intervals + slots.interval[i + k];
    Lanes row[8];
    take(&BezierInterval::ends, row);
    y_low = row[0], y_high = row[1], g_low = row[2], g_high = row[3];
    bend = row[4], turn = row[5], sigma_low = row[6], sigma_high = row[7];
  }
};

/// The lanes behind the last slot compute too: on the first one.
void pad(Slots& slots) {
  for (std::size_t k = 0; k < kLanes; ++k) {
    slots.line[slots.size + k] = slots.line[0];
    slots.interval[slots.size + k] = slots.interval[0];
  }
}

/// How often F vanishes in intervals that `sift` left open, by F at their ends and the ranges of F' and F''
/// between them.
void classify(const BezierBatch& batch, Lines& lines, Slots& slots) {
  pad(slots);
  for (std::size_t i = 0; i < slots.size; i += kLanes) {
    const Asked asked(batch, lines, slots, i);
    Lanes row[8];
    asked.take(&BezierInterval::ranges, row);
    const Lanes g_most = row[0], dg_low = row[1], dg_high = row[2], ddg_low = row[3], ddg_high = row[4];
    const Mask dome = row[5] > 0;
    const Line& x = asked.line.x;
    const Lanes lo = asked[kLo], hi = asked[kHi];
    const Margin margin = margin_of(batch, x, lo, hi);
    const Errors errors(batch, x, margin);
    const Station a = station_at(x, margin, lo, hi, asked.y_low);
    const Station b = station_at(x, margin, lo, hi, asked.y_high);
    const Lanes f_a = select(a.below, g_most, asked.g_low) - a.square;
    const Lanes f_b = select(b.above, g_most, asked.g_high) - b.square;
    const Mask off_a = (asked.g_low == 0) & is_beside(x, a, errors);
    const Mask off_b = (asked.g_high == 0) & is_beside(x, b, errors);
    const Mask out_a = a.below | off_a | (f_a < -errors.f), in_a = ~a.below & (f_a > errors.f);
    const Mask out_b = b.above | off_b | (f_b < -errors.f), in_b = ~b.above & (f_b > errors.f);
    // F' lies in [least, most], F'' as its sign says.
    const Lanes most = fma(dg_high, x.dy, errors.df - a.fall);
    const Lanes least = fma(dg_low, x.dy, -errors.df - b.fall);
    const Mask monotone = (most < 0) | (least > 0);
    const Bend bend = bend_of(x, ddg_low, ddg_high);
    // Outside at both ends, F lies under two lines: where they cross they are below 0.
    const Lanes gap = (b.at - a.at) + 4 * margin.eps;
    const Lanes fall = -(most * least) * gap * (1 + 0x1p-40);
    const Mask under = fall < fma(f_a + errors.f, least, -(most * (f_b + errors.f)));
    // Inside at both ends, it lies over two.
    const Mask over = fall < fma(f_a - errors.f, most, -(least * (f_b - errors.f)));
    const Mask both_out = out_a & out_b, both_in = in_a & in_b;
    const Mask none =
        (both_out & (monotone | bend.convex | under)) | (both_in & (monotone | bend.concave | dome | over));
    const Mask rises = out_a & in_b, sinks = in_a & out_b;
    const Mask one = (rises | sinks) & (monotone | bend.concave | bend.convex | dome);
    const Mask peak = both_out & bend.concave & ~none, valley = both_in & bend.convex & ~none;
    const unsigned ones = to_bits(one), rising = to_bits(one & rises), peaks = to_bits(peak),
                   valleys = to_bits(valley), open = to_bits(~(none | one | peak | valley));
    for (std::size_t k = 0; k < kLanes && i + k < slots.size; ++k) {
      const std::size_t line = slots.line[i + k];
      const auto bit = [&](unsigned lanes) { return Bits{lanes >> k & 1U} << slots.interval[i + k]; };
      lines.crossed[line] |= bit(ones);
      lines.rising[line] |= bit(rising);
      lines.peaks[line] |= bit(peaks);
      lines.valleys[line] |= bit(valleys);
      lines.open[line] |= bit(open);
    }
  }
  slots.size = 0;
}

/// Asks every interval of every line.
void classify_all(const BezierBatch& batch, Lines& lines, Slots& slots) {
  for (std::size_t i = 0; i < lines.size; i += kLanes) sift(batch, lines, i);
  slots.size = 0;
  for (std::size_t line = 0; line < lines.size; ++line) {
    if (slots.size + kMaxBezierIntervals > kSlots - kLanes) classify(batch, lines, slots);
    for (Bits left = std::exchange(lines.open[line], 0); left != 0; left &= left - 1) {
      slots.line[slots.size] = static_cast<std::uint16_t>(line);
      slots.interval[slots.size++] = static_cast<std::uint8_t>(__builtin_ctzll(left));
    }
    lines.peaks[line] = lines.valleys[line] = 0;
  }
  if (slots.size > 0) classify(batch, lines, slots);
}

/// Y and R of kLanes intervals as polynomials in sigma.
template <std::size_t kDegree>
struct Profile {
  Lanes y[kDegree + 1], r[kDegree + 1];

  explicit Profile(const Asked& asked) {
    const double* from[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) from[k] = asked.part[k]->powers;
    for (std::size_t i = 0; i <= kDegree; i += 4) {
      Lanes row[8];
      across(from, 2 * i, row);
      for (std::size_t k = 0; k < 4 && i + k <= kDegree; ++k) {
        y[i + k] = row[2 * k];
        r[i + k] = row[2 * k + 1];
      }
    }
  }
};

/// Value without the constant term, and derivative.
struct Value {
  Lanes rest, first;
};

template <std::size_t kDegree>
Value evaluate(const Lanes (&c)[kDegree + 1], Lanes sigma) {
  Lanes value = c[kDegree], first = c[kDegree];
  for (std::size_t i = kDegree - 1; i > 0; --i) {
    value = fma(value, sigma, c[i]);
    first = fma(first, sigma, value);
  }
  return {value * sigma, first};
}

template <std::size_t kDegree>
Lanes second_derivative(const Lanes (&c)[kDegree + 1], Lanes sigma) {
  Lanes sum{};
  for (std::size_t i = kDegree; i > 1; --i) sum = fma(sum, sigma, static_cast<double>(i * (i - 1)) * c[i]);
  return sum;
}

/// F and the interval's ends along kLanes lines, for approximations: G between the ends is a parabola.
struct Chord {
  Lanes at, gap;      ///< lower end, l - centre, and distance to the upper one
  Lanes f_a, f_b;     ///< F at the ends
  Lanes bend;         ///< F''
  Mask below, above;  ///< the ends are the clip's
};

Chord chord_of(const Asked& asked, const Margin& margin) {
  const Line& x = asked.line.x;
  const Lanes lo = asked[kLo], hi = asked[kHi];
  const Lanes low = (asked.y_low - x.py) * margin.per_rise, high = (asked.y_high - x.py) * margin.per_rise;
  const Lanes a = min(max(low, lo), hi), b = max(min(high, hi), lo);
  const Lanes steep = (asked.g_high - asked.g_low) / (asked.y_high - asked.y_low);
  const auto f_at = [&](Lanes at) {
    const Lanes g = fma(steep, fma(at, x.dy, x.py) - asked.y_low, asked.g_low);
    return g - fma(at, fma(x.flat2, at, 2 * x.along), x.square);
  };
  return {a,
          b - a,
          f_at(a),
          f_at(b),
          asked.bend * x.dy * x.dy - 2 * x.flat2,
          (low < lo - margin.eps),
          (high > hi + margin.eps)};
}

/// sigma of a height, as if Y were linear, or quadratic where it turns at sigma = 0.
Lanes sigma_at(const Asked& asked, Lanes y) {
  const Lanes low = asked.sigma_low, high = asked.sigma_high;
  const Lanes share = min(max((y - asked.y_low) / (asked.y_high - asked.y_low), Lanes{}), all(1.0));
  const Lanes linear = fma(high - low, share, low);
  return select(low == 0, high * sqrt(share), select(high == 0, low * sqrt(1 - share), linear));
}

/// First approximations of crossings: the root of F's parabola, but where there is one already.
void start(const BezierBatch& batch, const Asked& asked, Crossings& to, std::size_t i) {
  const Line& x = asked.line.x;
  const Chord chord = chord_of(asked, margin_of(batch, x, asked[kLo], asked[kHi]));
  const Lanes slope = (chord.f_b - chord.f_a) / chord.gap - 0.5 * chord.bend * chord.gap;
  const Lanes root = sqrt(max(fma(slope, slope, -2 * chord.bend * chord.f_a), Lanes{}));
  const Lanes step = -2 * chord.f_a / fma(load(&to.enters[i]), root, slope);
  const Lanes delta = chord.at + max(min(step, chord.gap), Lanes{});
  const Mask alone = load(&to.side[i]) == 0;
  store(&to.delta[i], select(alone, delta, load(&to.delta[i])));
  store(&to.sigma[i], select(alone, sigma_at(asked, fma(delta, x.dy, x.py)), load(&to.sigma[i])));
}

/// sigma cut to its interval: from 0 or -1 to 1.
Lanes within(Lanes least, Lanes sigma) { return min(max(sigma, least), all(1.0)); }

Lanes least_sigma(const Asked& asked) { return min(asked.sigma_low, asked.sigma_high); }

/// Newton's steps in (l, sigma) for y = Y(sigma), |x_xz|^2 = R(sigma)^2; unsquared beside a tip, where the
/// squares have nearly double roots.
template <std::size_t kDegree>
void polish(const Profile<kDegree>& profile, const Line& x, Lanes least, int steps, bool squared,
            Lanes& delta, Lanes& sigma) {
  for (int step = 0; step < steps; ++step) {
    const Value y = evaluate<kDegree>(profile.y, sigma), r = evaluate<kDegree>(profile.r, sigma);
    const Lanes px = fma(delta, x.dx, x.px), py = fma(delta, x.dy, x.py), pz = fma(delta, x.dz, x.pz);
    const Lanes radius = profile.r[0] + r.rest;
    const Lanes high = (py - profile.y[0]) - y.rest;
    Lanes turn = 2 * radius * r.first, fall = 2 * fma(px, x.dx, pz * x.dz), out;
    if (squared) {
      out = fma(px, px, fma(pz, pz, -(radius * radius)));
    } else {
      const Lanes distance = sqrt(fma(px, px, pz * pz));
      out = distance - abs(radius);
      turn /= 2 * abs(radius);
      fall /= 2 * distance;
    }
    const Lanes per = 1 / (fall * y.first - turn * x.dy);
    delta += (turn * high - y.first * out) * per;
    sigma = within(least, sigma + (fall * high - x.dy * out) * per);
  }
}

/// F at doubles l of the ray itself near a profile point, with a bound on its error.
template <std::size_t kDegree>
struct Nearby {
  Lanes ox, oy, oz, dx, dy, dz;
  Lanes y0, y_tail, r0, r_tail;
  Lanes y_rest, r_rest, y_fixed, r_fixed;  ///< errors but for the last rounding
  Lanes per, slope;                        ///< 1 / Y', R' / Y'
  Lanes unsure, curved;                    ///< of the slope relative to 2^-47; of the second order
  Lanes room;                              ///< what of sigma's range lies beyond
  Lanes y2, y_first;
  Mask steady;

  Nearby(const Asked& asked, const Profile<kDegree>& profile, Lanes sigma) {
    Lanes row[8];
    asked.take(&BezierInterval::errors, row);
    ox = asked[kOx], oy = asked[kOy], oz = asked[kOz];
    dx = asked[kDx], dy = asked[kDy], dz = asked[kDz];
    const Value y = evaluate<kDegree>(profile.y, sigma), r = evaluate<kDegree>(profile.r, sigma);
    y0 = profile.y[0], r0 = profile.r[0];
    y_tail = row[0], r_tail = row[1];
    const Lanes away = abs(sigma);
    y_fixed = fma(row[3], away, row[2]);
    r_fixed = fma(row[5], away, row[4]);
    y_rest = y.rest, r_rest = r.rest;
    per = 1 / y.first;
    slope = r.first * per;
    // The sums of the sizes of Y' and R': what their roundings are relative to.
    y2 = row[6];
    const Lanes r2 = row[7];
    const Lanes y1 = fma(y2, away, abs(profile.y[1])), r1 = fma(r2, away, abs(profile.r[1]));
    unsure = 0x1p-47 * fma(abs(slope), y1, r1) * abs(per);
    curved = fma(abs(slope), y2, r2);
    room = 1 + 0x1p-10 - away;
    y_first = abs(y.first);
    steady = y_first > 0x1p-30 * y1;
  }

  struct At {
    Lanes f, error;
    Lanes rounding;  ///< the error's part that more steps do not make smaller
    Lanes x, y, z, r, r_error, rise, tau;
    Mask holds;  ///< the bound is one
  };

  [[nodiscard]] At at(Lanes l) const {
    const Lanes x = fma(l, dx, ox), y = fma(l, dy, oy), z = fma(l, dz, oz);
    const Lanes rise = (y - y0) - (y_tail + y_rest);
    const Lanes r = r0 + (r_tail + fma(slope, rise, r_rest));
    const Lanes y_error = fma(all(kU), abs(y), y_fixed), r_error = fma(all(kU), abs(r), r_fixed);
    const Lanes tau = (1 + 0x1p-9) * (abs(rise) + y_error) * abs(per);
    const Lanes rounded = fma(abs(slope), y_error, r_error);
    const Lanes spread = rounded + fma(unsure, abs(rise), curved * tau * tau);
    const Lanes square = fma(x, x, z * z), r2 = r * r;
    const Lanes base = fma(all(8 * kU), r2 + square, all(kTiny));
    return {r2 - square,
            fma(fma(all(2.0), abs(r), spread), spread, base),
            fma(fma(all(2.0), abs(r), rounded), rounded, base),
            x,
            y,
            z,
            r,
            spread,
            rise,
            tau,
            steady & (tau < room) & (y2 * tau < 0x1p-10 * y_first)};
  }
};

/// The proof: F of one sign before a bracket about the approximation, of the other behind it.
template <std::size_t kDegree>
void certify(const Asked& asked, const Profile<kDegree>& profile, Lanes delta, Lanes sigma, Crossings& to,
             std::size_t i) {
  const Nearby<kDegree> near(asked, profile, sigma);
  const Lanes centre = asked[kCentre];
  const Lanes enters = load(&to.enters[i]);
  const Lanes l = centre + delta;
  const auto here = near.at(l);
  const Lanes df = 2 * (here.r * near.slope * near.dy - fma(here.x, near.dx, here.z * near.dz));
  const Lanes better = l - here.f / df;
  // Three times what F may be off, and what l itself is rounded by.
  const Lanes ulps = 4 * kU * (abs(l) + abs(centre));
  const Lanes width = 3 * here.error / abs(df) + ulps;
  const Lanes low = better - width, high = better + width;
  const auto a = near.at(low), b = near.at(high);
  const Lanes side = load(&to.side[i]);
  // y is within u |y|. Beyond the interval's end the sign is that at the end, which is known.
  const Lanes y_a = 4 * kU * abs(a.y), y_b = 4 * kU * abs(b.y);
  const Mask a_inside = (a.y - y_a > asked.y_low) & (a.y + y_a < asked.y_high);
  const Mask b_inside = (b.y - y_b > asked.y_low) & (b.y + y_b < asked.y_high);
  const Mask before =
      (a_inside & a.holds & (a.f * enters < -a.error)) | ((side <= 0) & (a.y + y_a < asked.y_low));
  const Mask behind =
      (b_inside & b.holds & (b.f * enters > b.error)) | ((side >= 0) & (b.y - y_b > asked.y_high));
  const Mask proved = before & behind;
  // Accurate where the second order moves l by no more than half of what its rounding and F's do.
  const Lanes allowed = fma(abs(df), 0.125 * ulps, 1.5 * here.rounding);
  // Beside a tip the roundings shrink with R: those at `l` are to be like those at the crossing.
  const Mask settled = (here.error < allowed) & (here.rounding < 4 * min(a.rounding, b.rounding));
  const Lanes bow = abs(a.f + b.f), span = abs(b.f - a.f);
  const Mask straight = bow < 0.25 * span;
  const Lanes secant = low + (high - low) * (a.f / (a.f - b.f));
  // The secant over the bracket averages the roundings at its ends, unless F bends there.
  const Mask is_polish =
      (bow < 0x1p-5 * span) & (max(a.error, b.error) < allowed) & (secant >= low) & (secant <= high);
  store(&to.l[i], select(is_polish, secant, better));
  store(&to.low[i], low);
  store(&to.high[i], high);
  const unsigned found = to_bits(proved & settled & straight & (low < high));
  for (std::size_t k = 0; k < kLanes; ++k) to.found[i + k] = static_cast<std::uint8_t>(found >> k & 1U);
}

/// A step without the rounding of p, for what is steep.
template <std::size_t kDegree>
void refine(const Asked& asked, const Profile<kDegree>& profile, Lanes least, Lanes& delta, Lanes& sigma) {
  const Lanes centre = asked[kCentre];
  for (int step = 0; step < 2; ++step) {
    const Nearby<kDegree> near(asked, profile, sigma);
    const auto here = near.at(centre + delta);
    const Lanes df = 2 * (here.r * near.slope * near.dy - fma(here.x, near.dx, here.z * near.dz));
    const Lanes change = -here.f / df;
    delta += change;
    sigma = within(least, fma(fma(near.dy, change, here.rise), near.per, sigma));
  }
}

template <std::size_t kDegree>
void solve(const BezierBatch& batch, const Lines& lines, Crossings& to, bool again) {
  pad(to);
  for (std::size_t i = 0; i < to.size; i += kLanes) {
    const Asked asked(batch, lines, to, i);
    const Profile<kDegree> profile(asked);
    if (!again) start(batch, asked, to, i);
    Lanes delta = load(&to.delta[i]), sigma = load(&to.sigma[i]);
    const Lanes least = least_sigma(asked);
    polish(profile, asked.line.x, least, again ? 9 : 3, !again, delta, sigma);
    if (again) refine(asked, profile, least, delta, sigma);
    certify(asked, profile, delta, sigma, to, i);
  }
}

/// Most crossings are settled by the fewest steps; the others get a second look, from where the first began.
template <std::size_t kDegree>
void find(const BezierBatch& batch, Block& block) {
  Crossings& to = block.crossings;
  if (to.size == 0) return;
  solve<kDegree>(batch, block.lines, to, false);
  Crossings& again = block.again;
  again.size = 0;
  for (std::size_t i = 0; i < to.size; ++i) {
    if (to.found[i] != 0) continue;
    again.from[again.size] = static_cast<std::uint16_t>(i);
    again.line[again.size] = to.line[i];
    again.interval[again.size] = to.interval[i];
    again.delta[again.size] = to.delta[i];
    again.sigma[again.size] = to.sigma[i];
    again.side[again.size] = to.side[i];
    again.enters[again.size++] = to.enters[i];
  }
  if (again.size == 0) return;
  solve<kDegree>(batch, block.lines, again, true);
  for (std::size_t i = 0; i < again.size; ++i) {
    to.found[again.from[i]] = again.found[i];
    to.l[again.from[i]] = again.l[i];
    to.low[again.from[i]] = again.low[i];
    to.high[again.from[i]] = again.high[i];
  }
}

/// Where F' vanishes, or the end of the interval towards which it would.
struct Extremum {
  Lanes delta, sigma, half_bend;
  Lanes from, until;  ///< the interval, less what its ends may be off
  Lanes inset;        ///< how much that is
};

/// Newton's steps in (l, sigma) for y = Y(sigma), F' = 0.
template <std::size_t kDegree>
Extremum seek(const BezierBatch& batch, const Asked& asked, const Profile<kDegree>& profile) {
  const Line& x = asked.line.x;
  const Margin margin = margin_of(batch, x, asked[kLo], asked[kHi]);
  const Chord chord = chord_of(asked, margin);
  // The ends of the clip are exact.
  const Lanes inset_a = select(chord.below, Lanes{}, 4 * margin.eps);
  const Lanes inset_b = select(chord.above, Lanes{}, 4 * margin.eps);
  const Lanes from = chord.at + inset_a, until = chord.at + chord.gap - inset_b;
  const Lanes mid = 0.5 * chord.gap - (chord.f_b - chord.f_a) / (chord.bend * chord.gap);
  const Lanes least = least_sigma(asked);
  Lanes delta = chord.at + max(min(mid, chord.gap), Lanes{});
  Lanes sigma = sigma_at(asked, fma(delta, x.dy, x.py));
  Lanes half_bend{};
  for (int step = 0; step < 5; ++step) {
    const Value y = evaluate<kDegree>(profile.y, sigma), r = evaluate<kDegree>(profile.r, sigma);
    const Lanes per = 1 / y.first;
    const Lanes radius = profile.r[0] + r.rest;
    const Lanes high = (fma(delta, x.dy, x.py) - profile.y[0]) - y.rest;
    const Lanes half = fma(radius * r.first * per, x.dy, -fma(x.flat2, delta, x.along));
    const Lanes turn = (fma(r.first, r.first, radius * second_derivative<kDegree>(profile.r, sigma)) -
                        radius * r.first * per * second_derivative<kDegree>(profile.y, sigma)) *
                       per * x.dy;
    half_bend = fma(turn * per, x.dy, -x.flat2);
    const Lanes next = min(max(delta - fma(turn * per, high, half) / half_bend, from), until);
    sigma = within(least, fma(fma(x.dy, next - delta, high), per, sigma));
    delta = next;
  }
  return {delta, sigma, half_bend, from, until, max(inset_a, inset_b)};
}

/// A proof that F, which bends one way, keeps its sign: by a bound of |F''| it lies on one side of a
/// parabola, or it falls from one end to the other.
template <std::size_t kDegree>
Mask is_missed(const Asked& asked, const Nearby<kDegree>& near, const typename Nearby<kDegree>::At& here,
               const Extremum& top, Lanes sign) {
  const Line& x = asked.line.x;
  // At sigma itself: what the height is off by is in the bound.
  const Lanes g1 = 2 * (near.r0 + (near.r_tail + near.r_rest)) * near.slope * near.dy;
  const Lanes df = g1 - 2 * fma(here.x, near.dx, here.z * near.dz);
  const Lanes df_error =
      2 * near.dy * fma(here.r_error, abs(near.slope) + near.unsure, abs(here.r) * near.unsure) +
      asked.turn * near.dy * here.tau +
      8 * kU * (abs(g1) + 2 * fma(abs(here.x), abs(near.dx), abs(here.z) * abs(near.dz)));
  const Lanes sure_df = abs(df) + df_error;
  Lanes ddg;
  for (std::size_t k = 0; k < kLanes; ++k)
    ddg[k] = sign[k] > 0 ? asked.part[k]->ddg_high : asked.part[k]->ddg_low;
  const Lanes bound = select(x.dy == 0, Lanes{}, ddg * (x.dy * x.dy));
  const Lanes least_bend = sign * (2 * x.flat2 - bound) - 0x1p-40 * (2 * x.flat2 + abs(bound));
  const Mask under = here.f * sign < -(here.error + sure_df * sure_df * (1 + 0x1p-40) / (2 * least_bend));
  const Mask lower = here.f * sign < -fma(2 * top.inset, sure_df, here.error);
  const Mask falls = lower & (top.delta <= top.from) & (sign * df < -df_error);
  const Mask climbs = lower & (top.delta >= top.until) & (sign * df > df_error);
  const Mask inside = (top.from <= top.until) & (here.y >= asked.y_low) & (here.y <= asked.y_high);
  return here.holds & inside & (least_bend > 0) & (under | falls | climbs);
}

/// The extrema: a proof that there is no crossing, or where the two are.
template <std::size_t kDegree>
void climb(const BezierBatch& batch, const Lines& lines, Extrema& to) {
  pad(to);
  for (std::size_t i = 0; i < to.size; i += kLanes) {
    const Asked asked(batch, lines, to, i);
    const Profile<kDegree> profile(asked);
    const Extremum top = seek(batch, asked, profile);
    const Nearby<kDegree> near(asked, profile, top.sigma);
    const auto here = near.at(asked[kCentre] + top.delta);
    const Lanes sign = load(&to.sign[i]);
    const Lanes half_chord = sqrt(max(-here.f / top.half_bend, Lanes{}));
    for (std::size_t side = 0; side < 2; ++side) {
      const Lanes change = side == 0 ? -half_chord : half_chord;
      store(&to.delta[side][i], top.delta + change);
      store(&to.sigma[side][i], within(least_sigma(asked), fma(change * near.dy, near.per, top.sigma)));
    }
    const unsigned missed = to_bits(is_missed(asked, near, here, top, sign));
    const unsigned passed = to_bits((here.f * sign > 0) & (top.half_bend * sign < 0));
    for (std::size_t k = 0; k < kLanes; ++k) {
      to.is_missed[i + k] = static_cast<std::uint8_t>(missed >> k & 1U);
      to.is_passed[i + k] = static_cast<std::uint8_t>(passed >> k & 1U);
    }
  }
}

// ------------------------------------------------------------------------------------- rounds and answers

Bits track_bits(const BezierTrack& track) {
  return (~Bits{0} >> (64 - (track.end - track.begin))) << track.begin;
}

/// Asks the next interval of every pending line, in the order in which its ray meets them. Without branches,
/// which would be guessed wrongly as often as not.
void ask(Block& block, Bits track, std::size_t pending) {
  Lines& lines = block.lines;
  Crossings& crossings = block.crossings;
  Extrema& extrema = block.extrema;
  for (std::size_t n = 0; n < pending; ++n) {
    const std::size_t line = block.pending[n];
    const Bits left =
        track & (lines.crossed[line] | lines.peaks[line] | lines.valleys[line] | lines.open[line]);
    const int last = 63 - __builtin_clzll(left), first = __builtin_ctzll(left);
    const int k = lines.record[line][kWay] > 0 ? first : last;
    const auto is_in = [k](Bits bits) {
      return static_cast<unsigned>(bits >> static_cast<unsigned>(k)) & 1U;
    };
    crossings.line[crossings.size] = extrema.line[extrema.size] = static_cast<std::uint16_t>(line);
    crossings.interval[crossings.size] = extrema.interval[extrema.size] = static_cast<std::uint8_t>(k);
    crossings.side[crossings.size] = 0;
    crossings.enters[crossings.size] = is_in(lines.rising[line]) != 0 ? 1 : -1;
    crossings.is_alone[crossings.size] = false;
    extrema.sign[extrema.size] = is_in(lines.peaks[line]) != 0 ? 1 : -1;
    crossings.size += is_in(lines.crossed[line]);
    extrema.size += is_in(lines.peaks[line] | lines.valleys[line]);
    block.hits[line].is_open |= is_in(lines.open[line]) != 0;
    const Bits rest = ~(Bits{1} << static_cast<unsigned>(k));
    lines.crossed[line] &= rest;
    lines.peaks[line] &= rest;
    lines.valleys[line] &= rest;
  }
}

/// The two crossings beside each extremum that the line reaches. The far one is asked only where it may be
/// wanted.
void ask_beside(const BezierBatch& batch, Block& block) {
  const Extrema& extrema = block.extrema;
  Crossings& to = block.crossings;
  for (std::size_t i = 0; i < extrema.size; ++i) {
    const std::size_t line = extrema.line[i];
    if (extrema.is_missed[i] != 0) continue;
    if (extrema.is_passed[i] == 0) {
      block.hits[line].is_open = true;
      continue;
    }
    const double way = block.lines.record[line][kWay];
    const std::size_t near = way > 0 ? 0 : 1;
    const bool alone = !batch.both && (block.lines.record[line][kCentre] + extrema.delta[near][i]) * way >
                                          0.25 * (extrema.delta[1][i] - extrema.delta[0][i]);
    for (const std::size_t side : {near, 1 - near}) {
      if (side != near && alone) continue;
      to.is_alone[to.size] = alone;
      to.side[to.size] = side == 0 ? -1 : 1;
      to.line[to.size] = extrema.line[i];
      to.interval[to.size] = extrema.interval[i];
      to.delta[to.size] = extrema.delta[side][i];
      to.sigma[to.size] = extrema.sigma[side][i];
      to.enters[to.size++] = side == 0 ? extrema.sign[i] : -extrema.sign[i];
    }
  }
}

/// What the round's crossings say of their lines.
void collect(const BezierBatch& batch, Block& block) {
  const Crossings& from = block.crossings;
  for (std::size_t i = 0; i < from.size; ++i) {
    const std::size_t line = from.line[i];
    Hits& hits = block.hits[line];
    const double way = block.lines.record[line][kWay];
    const double low = way * from.low[i], high = way * from.high[i];
    const double near = low < high ? low : high, far = low < high ? high : low;
    if (from.found[i] == 0 ||
        (!(near > 0) && !(far < 0))) {  // a bracket that holds the origin decides nothing
      hits.is_open = true;
    } else if (!(near > 0)) {
      hits.is_open = hits.is_open || from.is_alone[i];
    } else {
      const double l = way * from.l[i];
      hits.is_done = !batch.both;
      if (hits.is_done && hits.count > 0) {
        hits.l[0] = l < hits.l[0] ? l : hits.l[0];
      } else if (hits.count == BezierAnswers::kMost) {
        hits.is_open = true;
      } else {
        hits.l[hits.count++] = l;
      }
    }
  }
}

template <std::size_t kDegree>
void run_track(const BezierBatch& batch, Block& block, Bits track) {
  Lines& lines = block.lines;
  // Hits of earlier tracks stay: of this one's the first is looked for anew.
  for (std::size_t line = 0; line < lines.size; ++line) block.hits[line].is_done = false;
  std::size_t candidates = lines.size;
  for (std::size_t n = 0; n < lines.size; ++n) block.pending[n] = static_cast<std::uint16_t>(n);
  while (true) {
    std::size_t pending = 0;
    for (std::size_t n = 0; n < candidates; ++n) {
      const std::size_t line = block.pending[n];
      const Bits open = lines.open[line] & track;
      const Bits left = track & (lines.crossed[line] | lines.peaks[line] | lines.valleys[line]);
      Hits& hits = block.hits[line];
      hits.is_open |= batch.both && open != 0;
      block.pending[pending] = static_cast<std::uint16_t>(line);
      pending += hits.is_open || hits.is_done || (left | open) == 0 ? 0 : 1;
    }
    if (pending == 0) return;
    candidates = pending;
    block.crossings.size = block.extrema.size = 0;
    ask(block, track, pending);
    if (block.extrema.size > 0) {
      climb<kDegree>(batch, lines, block.extrema);
      ask_beside(batch, block);
    }
    find<kDegree>(batch, block);
    collect(batch, block);
  }
}

/// From the first hit of a line to the answer of its ray. What leaves the range of double is left open.
void conclude_first(const Block& block, std::size_t line, std::size_t begin, const BezierAnswers& answers) {
  const Hits& hits = block.hits[line];
  const std::size_t ray = block.lines.ray[line];
  const double l = hits.l[0] * block.back[ray];
  const bool is_answer = !hits.is_open && (hits.count == 0 || (l > 0 && l < kInfinity));
  answers.l[0][begin + ray] = l;
  answers.hits[begin + ray] = is_answer ? static_cast<std::int8_t>(hits.count) : kOpen;
}

/// The same of all hits, which the tracks give one track after another.
void conclude_all(const BezierBatch& batch, Block& block, std::size_t line, std::size_t begin,
                  const BezierAnswers& answers) {
  Hits& hits = block.hits[line];
  if (hits.is_open) return;
  for (std::size_t i = 1; i < hits.count; ++i) {
    for (std::size_t k = i; k > 0 && hits.l[k] < hits.l[k - 1]; --k) {
      const double l = hits.l[k];
      hits.l[k] = hits.l[k - 1];
      hits.l[k - 1] = l;
    }
  }
  const std::size_t ray = block.lines.ray[line];
  for (std::size_t k = 0; k < hits.count; ++k) {
    const double l = hits.l[k] * block.back[ray];
    if (!(l > 0 && l < kInfinity)) return;
    // What two tracks share, where Y turns, is one hit: neighbours are left open.
    const double apart = batch.track_count > 1 ? 0x1p-40 * (1 + hits.l[k]) : 0;
    if (k > 0 && !(hits.l[k] - hits.l[k - 1] > apart)) return;
    answers.l[k][begin + ray] = l;
  }
  answers.hits[begin + ray] = static_cast<std::int8_t>(hits.count);
}

template <std::size_t kDegree>
void run(const BezierBatch& batch, const BezierAnswers& answers) {
  const Lanes bottom = outermost(batch, false), top = outermost(batch, true);
  Block block;
  for (std::size_t begin = 0; begin < batch.count; begin += kBlock) {
    const std::size_t size = batch.count - begin < kBlock ? batch.count - begin : kBlock;
    Lines& lines = block.lines;
    lines.size = 0;
    for_groups<kLanes>(&batch.rays[begin].o.x, size,
                       [&](const double* rays, std::size_t at, std::size_t count) {
                         cull(batch, bottom, top, rays, at, count, block, answers.hits + begin + at);
                       });
    // The lanes behind the last line compute too, on zeros.
    __builtin_memset(lines.record[lines.size], 0, kLanes * sizeof lines.record[0]);
    classify_all(batch, lines, block.crossings);
    for (std::size_t k = 0; k < lines.size; ++k) block.hits[k] = {{}, 0, false, false};
    for (std::size_t k = 0; k < batch.track_count; ++k)
      run_track<kDegree>(batch, block, track_bits(batch.tracks[k]));
    for (std::size_t k = 0; k < lines.size; ++k) {
      if (batch.both) {
        conclude_all(batch, block, k, begin, answers);
      } else {
        conclude_first(block, k, begin, answers);
      }
    }
  }
}

}  // namespace

void intersect_bezier(const BezierBatch& batch, const BezierAnswers& answers) {
  if (batch.degree <= 4) return run<4>(batch, answers);
  run<kMaxBezierDegree>(batch, answers);
}

}  // namespace graze::GRAZE_LANES
