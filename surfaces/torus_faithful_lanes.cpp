// The torus's step of `faithful`. Compiled once for each instruction set; derivation and error analysis:
// surfaces/torus.md, "Kernel".
#include <graze/surfaces/torus_faithful_lanes.hpp>

#include <graze/surfaces/faithful_lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

constexpr double kU = 0x1p-53;
constexpr double kU2 = kU * kU;
constexpr double kTiny = 0x1p-960;  // far above what underflow can add to a bound, far below what matters
constexpr double kFarthest2 = 4.1;  // |x| <= R + r < 2 on the surface

/// f = K^2 + 4 R^2 (y^2 - r^2), K = |x|^2 - (R^2 + r^2), to twice the digits where it is nearly zero.
struct Equation {
  Wide sum, tube2;  ///< R^2 + r^2, r^2
  double unit, inverse_unit;
  double weight, weight_tail;  ///< 4 R^2

  explicit Equation(const TorusFrame& frame)
      : unit(frame.unit), inverse_unit(frame.inverse_unit), weight(4 * frame.ring * frame.ring) {
    const Lanes ring = all(frame.ring), tube = all(frame.tube);
    const Wide ring2 = two_prod(ring, ring);
    tube2 = two_prod(tube, tube);
    sum = ring2 + tube2;
    weight_tail = 4 * ring2.lo[0];
  }

  [[gnu::always_inline]] [[nodiscard]] inline Residual residual(const Line& line, Lanes l) const {
    const auto [x, px] = coordinate_at(line.o[0], line.d[0], l);
    const auto [y, py] = coordinate_at(line.o[1], line.d[1], l);
    const auto [z, pz] = coordinate_at(line.o[2], line.d[2], l);
    const Wide xx = two_prod(x.hi, x.hi), yy = two_prod(y.hi, y.hi), zz = two_prod(z.hi, z.hi);
    const Wide first = two_sum(xx.hi, zz.hi), second = two_sum(yy.hi, -sum.hi);
    const Wide third = two_sum(first.hi, second.hi);
    const Lanes twice = 2 * fma(x.hi, x.lo, fma(y.hi, y.lo, z.hi * z.lo));
    const Lanes tails = ((xx.lo + zz.lo) + (yy.lo - sum.lo)) + ((first.lo + second.lo) + third.lo);
    const Wide k = two_sum(third.hi, tails + twice);

    const Wide drop = two_sum(yy.hi, -tube2.hi);
    const Lanes drop_tail = (drop.lo + (yy.lo - tube2.lo)) + 2 * y.hi * y.lo;
    const Wide kk = two_prod(k.hi, k.hi), fall = two_prod(all(weight), drop.hi);
    const Wide f = two_sum(kk.hi, fall.hi);
    const Lanes kk_tail = fma(2 * k.hi, k.lo, kk.lo);
    const Lanes fall_tail = fma(drop_tail, all(weight), fma(drop.hi, all(weight_tail), fall.lo));
    const Lanes value = f.hi + (f.lo + (kk_tail + fall_tail));

    // Sizes and counts: surfaces/torus.md.
    const auto error_of = [](const Wide& at, Lanes moved) {
      const Lanes e = kU2 * (abs(at.hi) + abs(moved));
      return fma(abs(at.hi), all(2.125), e) * e;
    };
    const Lanes ey = error_of(y, py);
    const Lanes square = xx.hi + (yy.hi + zz.hi);
    const Lanes k_error = fma(square + sum.hi, all(96 * kU2), error_of(x, px) + (ey + error_of(z, pz)));
    const Lanes size_k = abs(k.hi);
    const Lanes fall_error = fma(yy.hi + tube2.hi, all(96 * kU2), 1.0625 * ey);
    const Lanes error =
        fma(fma(size_k, all(2.125), k_error), k_error, fma(fall_error, all(weight), 32 * kU2 * k.hi * k.hi)) +
        kTiny;
    const Lanes along = fma(x.hi, line.d[0], fma(y.hi, line.d[1], z.hi * line.d[2]));
    const Lanes along_size =
        fma(abs(x.hi), abs(line.d[0]), fma(abs(y.hi), abs(line.d[1]), abs(z.hi * line.d[2])));
    const Lanes swing = 4 * k.hi, tilt = 2 * weight * y.hi * line.d[1];
    const Lanes slope_error =
        fma(8 * along_size, k_error, 16 * kU * fma(abs(swing), along_size, abs(tilt))) + kTiny;
    return {value,
            error,
            fma(swing, along, tilt),
            slope_error,
            all(0x1p9),
            select(square < kFarthest2, all(0x1p-10), all(-1.0)),
            0x1p-44 * fma(abs(l), all(2.0), all(16.0)),
            all(0x1p-35)};
  }
};

}  // namespace

void correct_torus(const TorusFrame& surface, const FaithfulBatch& batch) {
  correct_all(Equation(surface), batch);
}

}  // namespace graze::GRAZE_LANES
