// The step of `faithful` for Bezier profiles. Compiled once for each instruction set; derivation and error
// analysis: surfaces/bezier_revolution.md, "Kernel of faithful".
#include <graze/surfaces/bezier_revolution_faithful_lanes.hpp>

#include <graze/surfaces/faithful_lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kU2 = kU * kU;
constexpr double kTiny = 0x1p-960;  // far above what underflow can add to a bound, far below what matters
constexpr double kInfinity = __builtin_inf();

/// Y or R, each lane's from the end of the profile that is nearer to it.
struct Powers {
  Lanes c[kMaxFaithfulBezierDegree + 1], tail[kMaxFaithfulBezierDegree + 1];
  Lanes error, step;
  std::size_t degree;

  Powers(const BezierPowers& front, const BezierPowers& back, Mask is_back, std::size_t n)
      : error(select(is_back, all(back.error), all(front.error))),
        step(select(is_back, all(back.step), all(front.step))),
        degree(n) {
    for (std::size_t i = 0; i <= n; ++i) {
      c[i] = select(is_back, all(back.c[i]), all(front.c[i]));
      tail[i] = select(is_back, all(back.tail[i]), all(front.tail[i]));
    }
  }

  /// By Horner's rule with the roundings kept: hi + lo, and the derivative in double.
  struct Value {
    Lanes hi, lo, first, error;
  };
  [[gnu::always_inline]] [[nodiscard]] inline Value at(Lanes tau) const {
    Lanes sum = c[degree], rest = tail[degree], first{};
    for (std::size_t i = degree; i-- > 0;) {
      first = fma(first, tau, sum);
      const Wide product = two_prod(sum, tau), next = two_sum(product.hi, c[i]);
      rest = fma(rest, tau, (product.lo + next.lo) + tail[i]);
      sum = next.hi;
    }
    return {sum, rest, first, fma(step, tau, error)};
  }

  /// One of Newton's steps towards a height, in double.
  [[gnu::always_inline]] [[nodiscard]] inline Lanes step_to(Lanes height, Lanes tau) const {
    Lanes sum = c[degree], first{};
    for (std::size_t i = degree - 1; i > 0; --i) {
      first = fma(first, tau, sum);
      sum = fma(sum, tau, c[i]);
    }
    first = fma(first, tau, sum);
    return tau + fma(-sum, tau, height - c[0]) / first;
  }
};

Lanes in_range(Lanes tau) { return min(max(tau, Lanes{}), all(BezierPowers::kMostTau)); }

/// About where a piece reaches a height.
struct Guess {
  Lanes tau;
  Mask is_back;
};
[[gnu::always_inline]] inline Guess guess_at(const BezierMonotone& piece, Lanes y) {
  Mask minus{};  // the number of cells below
  for (const double top : piece.tops) minus += y > all(top);
  std::int64_t cells[kLanes];
  __builtin_memcpy(cells, &minus, sizeof cells);
  Lanes cell[6];
  load_records_at([&](std::size_t k) { return &piece.cells[-cells[k]].y; }, cell);
  const Lanes rise = abs(y - cell[0]), slope = cell[2];
  const Lanes root = sqrt(max(fma(slope, slope, 4 * cell[3] * rise), Lanes{}));
  return {in_range(fma(2 * rise / (slope + root), cell[4], cell[1])), cell[5] > 0.5};
}

/// F = R^2 - |x_xz|^2 on the piece of the profile that passes nearest, to twice the digits where it is nearly
/// zero.
struct Equation {
  const BezierFaithfulFrame& profile;
  double unit, inverse_unit;

  explicit Equation(const BezierFaithfulFrame& frame)
      : profile(frame), unit(frame.unit), inverse_unit(frame.inverse_unit) {}

  struct Point {
    Coordinate x, y, z;
    Lanes beside;  ///< bound of the error of |x_xz|^2
  };
  [[gnu::always_inline]] static inline Point point_at(const Line& line, Lanes l) {
    const Coordinate x = coordinate_at(line.o[0], line.d[0], l);
    const Coordinate z = coordinate_at(line.o[2], line.d[2], l);
    const auto error_of = [](const Coordinate& of) {
      const Lanes e = kU2 * (abs(of.x.hi) + abs(of.moved));
      return fma(abs(of.x.hi), all(2.125), e) * e;
    };
    return {x, coordinate_at(line.o[1], line.d[1], l), z, error_of(x) + error_of(z)};
  }

  /// On one piece. Sizes and counts: surfaces/bezier_revolution.md.
  [[gnu::always_inline]] [[nodiscard]] inline Residual on_piece(const BezierMonotone& piece, const Line& line,
                                                                const Point& at, Lanes l) const {
    const Wide x = at.x.x, y = at.y.x, z = at.z.x;
    const Guess guess = guess_at(piece, y.hi);
    const Powers heights(profile.ends[0].y, profile.ends[1].y, guess.is_back, profile.degree);
    Lanes tau = guess.tau;
    for (int step = 0; step < 3; ++step) tau = in_range(heights.step_to(y.hi, tau));
    const Powers radii(profile.ends[0].r, profile.ends[1].r, guess.is_back, profile.degree);
    const Powers::Value height = heights.at(tau), radius = radii.at(tau);
    const Wide r = two_sum(radius.hi, radius.lo);

    // What is left of the height goes by the slope of R^2.
    const Lanes rest = ((y.hi - height.hi) - height.lo) + y.lo;
    const Lanes per = 1 / height.first, lean = radius.first * per, by_height = 2 * r.hi * lean;
    const Wide rr = two_prod(r.hi, r.hi), xx = two_prod(x.hi, x.hi), zz = two_prod(z.hi, z.hi);
    const Wide first = two_sum(rr.hi, -xx.hi), f = two_sum(first.hi, -zz.hi);
    const Lanes twice = 2 * fma(r.hi, r.lo, -fma(x.hi, x.lo, z.hi * z.lo));
    const Lanes tails = (rr.lo - xx.lo - zz.lo) + (first.lo + f.lo);
    const Lanes value = f.hi + (tails + fma(by_height, rest, twice));

    // Y' keeps three quarters of itself within `room` of tau, so R^2 is a function of the height there.
    const Lanes steep = abs(height.first), size = abs(r.hi);
    const Lanes off = fma(all(8 * kU2), abs(y.hi) + abs(at.y.moved), height.error) + kTiny;
    const Lanes wrong = abs(rest) + off;
    const Lanes t = select(guess.is_back, 1 - tau, tau);
    const Mask steady = (steep > 0x1p-40 * profile.y_first) & (t >= piece.t_low) & (t <= piece.t_high);
    const Lanes room = min(min(tau, all(0.375)), 0.125 * steep / profile.y_second);
    const Lanes r_first =
        abs(radius.first) + fma(room, all(profile.r_second), all(0x1p-40 * profile.r_first));
    const Lanes r_most = fma(room, r_first, size + radius.error), per_size = abs(per);
    const Lanes sum = 2 * fma(r_first, r_first, r_most * profile.r_second);
    const Lanes bend = per * per * fma(2.5 * r_most * r_first, profile.y_second * per_size, sum);

    const Lanes sizes = 2 * size * per_size * fma(abs(lean), all(profile.y_first), all(profile.r_first));
    const Lanes radial = fma(2 * size, radius.error, radius.error * radius.error);
    const Lanes by_rest = fma(abs(by_height), off, fma(0x1p-47 * sizes, abs(rest), bend * wrong * wrong));
    const Lanes rounded = 40 * kU2 * (rr.hi + xx.hi + zz.hi);
    const Lanes error = (at.beside + radial) + (by_rest + rounded) + kTiny;
    const Lanes slope = fma(by_height, line.d[1], -2 * fma(x.hi, line.d[0], z.hi * line.d[2]));
    const Lanes slope_error = fma(all(0x1p-46), sizes, 4 * fma(abs(lean), radius.error, bend * wrong)) +
                              0x1p-49 * (abs(x.hi) + abs(z.hi));
    const Lanes flat2 = fma(line.d[0], line.d[0], line.d[2] * line.d[2]);
    const Lanes reach = fma(0.375 * room, steep, -wrong), leaning = 0x1p-43 * (1 + abs(lean));
    return {value,
            error,
            slope,
            slope_error,
            fma(bend * line.d[1], line.d[1], 1.0625 * flat2),
            select(steady, reach, all(-1.0)),
            0x1p-46 * (abs(l) + 8),
            8 * leaning * (1 + leaning)};
  }

  /// How far from l there is surely no zero of a piece's F.
  [[gnu::always_inline]] static inline Lanes clear_of(const Residual& at) {
    const Lanes size = abs(at.f) - at.error;
    const Lanes by_slope = 0.25 * size / (abs(at.slope) + at.slope_error);
    return max(min(min(by_slope, sqrt(max(0.25 * size / at.bend, Lanes{}))), at.reach), Lanes{});
  }

  [[gnu::always_inline]] static inline Residual select_residual(Mask mask, const Residual& a,
                                                                const Residual& b) {
    return {select(mask, a.f, b.f),           select(mask, a.error, b.error),
            select(mask, a.slope, b.slope),   select(mask, a.slope_error, b.slope_error),
            select(mask, a.bend, b.bend),     select(mask, a.reach, b.reach),
            select(mask, a.spread, b.spread), select(mask, a.spread_by_slope, b.spread_by_slope)};
  }

  /// A line may meet several pieces: the nearest is taken, and the hit is its own where the others are clear.
  [[gnu::always_inline]] [[nodiscard]] inline Residual residual(const Line& line, Lanes l) const {
    const Point at = point_at(line, l);
    if (profile.count == 1) return on_piece(profile.pieces[0], line, at, l);
    Residual best{};
    best.f = best.reach = all(-kInfinity);
    Lanes best_clear = all(kInfinity), clear = all(kInfinity);
    for (std::size_t k = 0; k < profile.count; ++k) {
      const BezierMonotone& piece = profile.pieces[k];
      // Beyond the piece's heights; |d_y| < 2.
      const Lanes beyond = max(piece.y_low - at.y.x.hi, at.y.x.hi - piece.y_high);
      const Lanes away = 0.5 * (beyond - 0x1p-40 * (1 + abs(at.y.x.hi)));
      const Mask is_away = away > 0x1p-30;
      if (to_bits(~is_away) == 0) {
        clear = min(clear, away);
        continue;
      }
      const Residual here = on_piece(piece, line, at, l);
      const Lanes here_clear = select(is_away, away, clear_of(here));
      const Mask nearer = ~is_away & (abs(here.f * best.slope) <= abs(best.f * here.slope));
      clear = min(clear, select(nearer, best_clear, here_clear));
      best_clear = select(nearer, here_clear, best_clear);
      best = select_residual(nearer, here, best);
    }
    const Lanes spread = fma(best.spread_by_slope, 1 / abs(best.slope), best.spread);
    best.spread = select(clear > 4 * spread, best.spread, all(kInfinity));
    return best;
  }
};

}  // namespace

void correct_bezier(const BezierFaithfulFrame& profile, const FaithfulBatch& batch) {
  correct_all(Equation(profile), batch);
}

}  // namespace graze::GRAZE_LANES
