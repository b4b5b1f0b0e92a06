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
  const Lanes per_slope = -1 / at.slope, per_size = abs(per_slope);
  const Lanes step = at.f * per_slope;
  const Wide sum = quick_two_sum(l, step);
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
  const Mask is_whole = abs(step) <= l;  // the sum, by quick_two_sum
  return {sum.hi, closer & is_whole & (abs(sum.lo) + doubt <= (1 - 0x1p-20) * gap), closer};
}

/// kLanes rays of a batch, on their way through the stages.
struct Group {
  std::uint32_t which[kLanes];  ///< a last group repeats its last ray
  Line line;
  Lanes given, l, back;  ///< l of the caller, in the line's units, and what leads back
};

/// Rays from `at` on, in the surface's units.
template <class Frame>
[[gnu::always_inline]] inline void take(const Frame& frame, const FaithfulBatch& batch, std::size_t at,
                                        Group& group) {
  const double* const rays = &batch.rays->o.x;
  double gathered[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    group.which[k] = batch.which[at + k < batch.count ? at + k : batch.count - 1];
    gathered[k] = batch.l[group.which[k]];
  }
  Lanes x[6];
  load_records_at([&](std::size_t k) { return rays + std::size_t{6} * group.which[k]; }, x);
  group.given = load(gathered);
  const Lanes shrink = reciprocal_power(max(abs(x[3]), max(abs(x[4]), abs(x[5]))));
  group.back = shrink * frame.unit;
  group.line = {{x[0] * frame.inverse_unit, x[1] * frame.inverse_unit, x[2] * frame.inverse_unit},
                {x[3] * shrink, x[4] * shrink, x[5] * shrink}};
  group.l = group.given * reciprocal_power(group.back);
}

/// What became of the l of a group's first `size` rays.
[[gnu::always_inline]] inline void put(const FaithfulBatch& batch, const Group& group,
                                       const Corrected& corrected, std::size_t size) {
  constexpr double kNormal = 0x1p-1022, kInfinity = __builtin_inf();
  constexpr double kLargest = 0x1p1000;  // scaling by such a power of two and back is exact
  const Lanes better = corrected.l * group.back;
  const Mask fits = (group.back > 1 / kLargest) & (group.back < kLargest) & (corrected.l >= kNormal) &
                    (better >= kNormal) & (better < kInfinity);
  double scattered[kLanes];
  store(scattered, select(corrected.closer & fits, better, group.given));
  for (std::size_t k = 0; k < kLanes; ++k) batch.l[group.which[k]] = scattered[k];
  unsigned open = to_bits(~(corrected.proved & fits)) & ((1U << size) - 1);
  for (; open != 0; open &= open - 1) batch.open[group.which[__builtin_ctz(open)]] = 1;
}

/// Corrects all l of a batch, kLanes at a time. A stage after another over several groups: the long chains of
/// neighbours overlap.
template <class Frame>
[[gnu::always_inline]] inline void correct_all(const Frame& frame, const FaithfulBatch& batch) {
  constexpr std::size_t kGroups = 16;  // 18 kB of lanes
  Group groups[kGroups];
  Residual residuals[kGroups];
  for (std::size_t i = 0; i < batch.count; i += kGroups * kLanes) {
    const std::size_t left = batch.count - i, size = left < kGroups * kLanes ? left : kGroups * kLanes;
    const std::size_t count = (size + kLanes - 1) / kLanes;
    for (std::size_t n = 0; n < count; ++n) take(frame, batch, i + n * kLanes, groups[n]);
    for (std::size_t n = 0; n < count; ++n) residuals[n] = frame.residual(groups[n].line, groups[n].l);
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t rest = size - n * kLanes;
      put(batch, groups[n], correct(groups[n].l, residuals[n], batch.is_alone),
          rest < kLanes ? rest : kLanes);
    }
  }
}

}  // namespace graze::GRAZE_LANES
