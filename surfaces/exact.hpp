// Decisions and numbers that are right whatever the rounding: a formula generic over the number type is tried
// in intervals first, and in exact expansions where those cannot tell.
//
// A formula is called with a number of the type to compute in, and forms its operands by exactly<T>:
//   exact_sign([&](auto number) { using T = decltype(number); return exactly<T>(a) * exactly<T>(b) - ...; })
// Range: exact as long as no product leaves the range that solvers/math/expansion.hpp states.
#pragma once

#include <cmath>

#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/surfaces/coefficients.hpp>

namespace graze {

/// The sign of the formula's exact value: -1, 0, 1.
template <class Formula>
int exact_sign(const Formula& formula) {
  const Interval quick = formula(Interval{});
  if (quick.lo > 0) return 1;
  if (quick.hi < 0) return -1;
  if (quick.lo == 0 && quick.hi == 0) return 0;
  return formula(Expansion{}).sign();
}

/// An enclosure of the formula's exact value whose width is at most `relative` times its magnitude; exactly
/// zero where the value is.
template <class Formula>
Interval exact_enclosure(const Formula& formula, double relative = 0x1p-46) {
  const Interval quick = formula(Interval{});
  if (width(quick) <= relative * mig(quick)) return quick;
  const Expansion exact = formula(Expansion{});
  if (exact.is_zero()) return {};
  const double value = exact.value();
  return {next_below(value), next_above(value)};
}

/// An enclosure as a number of type T: itself, or its middle rounded.
template <class T>
T middle_as(const Interval& x) {
  if constexpr (std::is_same_v<T, Interval>) {
    return x;
  } else {
    return static_cast<T>(mid(x));
  }
}

}  // namespace graze
