// The step that the kernels for `faithful` share, in lanes: one of Newton's from an l that is nearly right,
// with a proof that the new one is within an ulp of a zero. Derivation: surfaces/teardrop.md, "Kernel".
//
// needs     a frame with unit, inverse_unit and residual(Line, l), which states f, f' and bounds at l
// returns   l corrected; open where nothing is proved
// error     one ulp of the exact l
// cost      the residual and about 40 operations
// source    graze; the proof is interval Newton's (R. E. Moore, Interval Analysis, 1966) about a step
#pragma once

#include <graze/solvers/math/lanes_double_double.hpp>
#include <graze/surfaces/faithful_batch.hpp>

namespace graze::GRAZE_LANES {

/// kLanes rays in a surface's units, the largest |d_i| in [1, 2).
struct Line {
  Lanes o[3], d[3];
};

/// f along a line near l, with what is known of it. A bound that is no number proves nothing.
struct Residual {
  Lanes f, error;            ///< f(l) and a bound on its error
  Lanes slope, slope_error;  ///< f'(l) likewise
  Lanes bend;                ///< at least |f''| / 2 where |x - l| <= reach
  Lanes reach;
  /// The l given is within spread + spread_by_slope / |f'| of its hit, by `certified`.
  Lanes spread, spread_by_slope;
};

/// A coordinate of the point at l, within u^2 (|x| + |l d|), and l d.
struct Coordinate {
  Wide x;
  Lanes moved;
};
[[gnu::always_inline]] inline Coordinate coordinate_at(Lanes o, Lanes d, Lanes l) {
  const Wide moved = two_prod(l, d), sum = two_sum(moved.hi, o);
  return {quick_two_sum(sum.hi, sum.lo + moved.lo), moved.hi};
}

struct Corrected {
  Lanes l;
  Mask proved, closer;  ///< closer: a step that converges, whatever it proves
};

/// With s = l* - l: f' changes by less than half of itself within 2 (|f| + error) / |f'|, so there is one
/// zero there, and f + f' s + M s^2 = 0 says how far it is from l - f/f'.
[[gnu::always_inline]] inline Corrected correct(Lanes l, const Residual& at, bool is_alone) {
  constexpr double kU = 0x1p-53;
  constexpr double kPay = 1 + 0x1p-40;  // for the roundings of a bound itself, fewer than 20
  constexpr double kHalf = 0.4375;      // with room for the same
  const Lanes per_slope = 1 / at.slope, per_size = abs(per_slope);
  const Lanes step = -at.f * per_slope;
  const Wide sum = two_sum(l, step);
  const Lanes radius = 2 * kPay * fma(at.error, per_size, abs(step));
  const Lanes hit_within = is_alone ? fma(at.spread_by_slope, per_size, at.spread) : Lanes{};
  const Lanes around = max(radius, hit_within);
  const Mask is_straight =
      (fma(2 * at.bend, around, at.slope_error) <= kHalf * abs(at.slope)) & (around <= at.reach);
  const Lanes bent = fma(at.bend, radius, at.slope_error) * radius;
  const Lanes doubt = kPay * fma(at.error + bent, per_size, 4 * kU * abs(step));
  // The smaller of the gaps beside the new l.
  const Lanes gap = sum.hi - from_bits(bits_of(sum.hi) - 1);
  const Mask closer = is_straight & (sum.hi > 0);
  return {sum.hi, closer & (abs(sum.lo) + doubt <= (1 - 0x1p-20) * gap), closer};
}

/// Corrects all l of a batch, kLanes at a time; the last group repeats its last ray.
template <class Frame>
[[gnu::always_inline]] inline void correct_all(const Frame& frame, const FaithfulBatch& batch) {
  constexpr double kNormal = 0x1p-1022, kInfinity = __builtin_inf();
  constexpr double kLargest = 0x1p1000;  // scaling by such a power of two and back is exact
  const double* const rays = &batch.rays->o.x;
  for (std::size_t i = 0; i < batch.count; i += kLanes) {
    const std::size_t size = batch.count - i < kLanes ? batch.count - i : kLanes;
    std::uint32_t last[kLanes];
    for (std::size_t k = 0; size < kLanes && k < kLanes; ++k)
      last[k] = batch.which[i + (k < size ? k : size - 1)];
    const std::uint32_t* const which = size < kLanes ? last : batch.which + i;
    Lanes x[6];
    load_records_at([&](std::size_t k) { return rays + std::size_t{6} * which[k]; }, x);
    double gathered[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) gathered[k] = batch.l[which[k]];
    const Lanes given = load(gathered);

    const Lanes shrink = reciprocal_power(max(abs(x[3]), max(abs(x[4]), abs(x[5]))));
    const Lanes back = shrink * frame.unit;
    const Line line{{x[0] * frame.inverse_unit, x[1] * frame.inverse_unit, x[2] * frame.inverse_unit},
                    {x[3] * shrink, x[4] * shrink, x[5] * shrink}};
    const Lanes l = given * reciprocal_power(back);
    const Corrected corrected = correct(l, frame.residual(line, l), batch.is_alone);
    const Lanes better = corrected.l * back;
    const Mask fits = (back > 1 / kLargest) & (back < kLargest) & (corrected.l >= kNormal) &
                      (better >= kNormal) & (better < kInfinity);
    store(gathered, select(corrected.closer & fits, better, given));
    for (std::size_t k = 0; k < size; ++k) batch.l[which[k]] = gathered[k];
    unsigned open = to_bits(~(corrected.proved & fits)) & ((1U << size) - 1);
    for (; open != 0; open &= open - 1) batch.open[which[__builtin_ctz(open)]] = 1;
  }
}

}  // namespace graze::GRAZE_LANES
