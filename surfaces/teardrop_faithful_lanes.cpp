// The teardrop's step of `faithful`. Compiled once for each instruction set; derivation and error analysis:
// surfaces/teardrop.md, "Kernel".
#include <graze/surfaces/teardrop_faithful_lanes.hpp>

#include <graze/surfaces/faithful_lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kU2 = kU * kU;
constexpr double kTiny = 0x1p-960;  // far above what underflow can add to a bound, far below what matters
constexpr double kLow = 0x1p-36;    // below, R^2 is a straight line in y but for 2^-13 of its slope
constexpr double kFar2 = 64;        // no point of the surface is so far from the axis: W < (4 m)^2

/// F = R^2 - |x_xz|^2, to twice the digits where it is nearly zero.
struct Equation {
  double m, unit, inverse_unit;
  double height, height_tail;  ///< 6m
  double per_height;

  explicit Equation(const TeardropFrame& frame)
      : m(frame.m),
        unit(frame.unit),
        inverse_unit(frame.inverse_unit),
        height(6 * frame.m),
        height_tail(__builtin_fma(6, frame.m, -height)),
        per_height(1 / height) {}

  /// R(t), R = 3m t (1 - t)(2 + t), within 50 u^2 of itself; g = (1 - t)(2 + t).
  struct Profile {
    Wide r;
    Lanes g;
  };
  [[gnu::always_inline]] [[nodiscard]] inline Profile profile_at(Lanes t) const {
    const Wide b = quick_two_sum(all(1.0), -t), c = quick_two_sum(all(2.0), t);
    const Wide g = two_prod(b.hi, c.hi), k = two_prod(all(0.5 * height), t);
    const Lanes g_tail = g.lo + fma(b.hi, c.lo, b.lo * c.hi);
    const Lanes k_tail = fma(t, all(0.5 * height_tail), k.lo);
    const Wide r = two_prod(k.hi, g.hi);
    return {{r.hi, r.lo + fma(k.hi, g_tail, k_tail * g.hi)}, g.hi};
  }

  /// R^2 at t, any double near sqrt(y/6m), and the rest of y by R^2's slope: so R^2 goes on below the bottom
  /// as the straight line 6m y, and F has no zero there.
  [[gnu::always_inline]] [[nodiscard]] inline Residual residual(const Line& line, Lanes l) const {
    const auto [x, px] = coordinate_at(line.o[0], line.d[0], l);
    const auto [y, py] = coordinate_at(line.o[1], line.d[1], l);
    const auto [z, pz] = coordinate_at(line.o[2], line.d[2], l);
    const Lanes v = y.hi * per_height, t = sqrt(max(v, Lanes{}));
    const Wide square = two_prod(t, t), near = two_prod(all(height), square.hi);
    const Lanes near_tail = fma(square.lo, all(height), fma(square.hi, all(height_tail), near.lo));
    const Lanes rest = ((y.hi - near.hi) - near_tail) + y.lo;
    const Profile at = profile_at(t);
    const Lanes turn = fma(t, fma(t, all(-3.0), all(-2.0)), all(2.0));
    const Lanes by_height = 1.5 * m * at.g * turn;

    const Wide rr = two_prod(at.r.hi, at.r.hi), xx = two_prod(x.hi, x.hi), zz = two_prod(z.hi, z.hi);
    const Wide first = two_sum(rr.hi, -xx.hi), f = two_sum(first.hi, -zz.hi);
    const Lanes twice = 2 * fma(at.r.hi, at.r.lo, -fma(x.hi, x.lo, z.hi * z.lo));
    const Lanes tails = (rr.lo - xx.lo - zz.lo) + (first.lo + f.lo);
    const Lanes value = f.hi + (tails + fma(by_height, rest, twice));

    // Sizes and counts: surfaces/teardrop.md.
    const Lanes w = xx.hi + zz.hi;
    const Lanes ex = kU2 * (abs(x.hi) + abs(px)), ez = kU2 * (abs(z.hi) + abs(pz));
    const Lanes beside = fma(fma(abs(x.hi), all(2.125), ex), ex, fma(abs(z.hi), all(2.125), ez) * ez);
    const Lanes size = fma(abs(v), all(0x1p15 * m * m), fma(w, all(0x1p8), 6.25 * m * abs(py)));
    const Lanes error = fma(size, all(kU2), beside) + (8 * kU * m * max(-y.hi, Lanes{}) + kTiny);
    const Lanes slope = fma(by_height, line.d[1], -2 * fma(x.hi, line.d[0], z.hi * line.d[2]));
    const Lanes room = 0.25 * (min(y.hi, height - y.hi) - 8 * kU * height);
    const Mask is_low = abs(y.hi) < kLow;
    return {value,
            error,
            slope,
            select(is_low, all(0x1p-13), all(0x1p-42)),
            select(is_low, all(8.0), 30 * reciprocal_power(t)),
            select(w < kFar2, select(is_low, all(0.25 * kLow), room), all(-1.0)),
            0x1p-44 * fma(abs(l), all(2.0), all(16.0)),
            all(0x1p-35)};
  }
};

}  // namespace

void correct_teardrop(const TeardropFrame& surface, const FaithfulBatch& batch) {
  correct_all(Equation(surface), batch);
}

}  // namespace graze::GRAZE_LANES
