// From exact hits to doubles within an ulp, for the last tiers of the kernels for `faithful`.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/kernel.hpp>

namespace graze {

/// The double for a hit that comes after one at `last`: the nearest, or the one on the other side, within an
/// ulp. `meets`: the next hit has the same nearest double; one that lies below it leaves it to the next. No
/// greater than `last`: none is left.
template <class ExactLength>
double double_behind(double last, ExactLength& exact, bool meets) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double nearest = exact.to_double();
  if (std::isinf(nearest) || (nearest > last && !meets)) return nearest;
  const int side = exact.compare_with(Dyadic(nearest));
  if (nearest <= last) return side > 0 ? std::nextafter(nearest, kInfinity) : nearest;
  const double below = std::nextafter(nearest, 0.0);
  return side < 0 && below > last ? below : nearest;
}

/// The doubles nearest to exact hits: `l` of each has to_double() and compare_with(Dyadic). Of hits that have
/// one nearest double, one moves to the other side of itself, so that none is further off than an ulp; those
/// for which no double is left are joined to the one before. False as HitsOfRay::add.
template <class ExactHits>
[[nodiscard]] bool add_nearest(ExactHits& exact, bool all, HitsOfRay& hits) {
  double last = 0;
  std::uint32_t multiplicity = 0;  // of the hits at `last`
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const bool meets = k + 1 < exact.size() && exact[k + 1].l.to_double() == exact[k].l.to_double();
    const double l = double_behind(last, exact[k].l, meets);
    if (multiplicity > 0 && l <= last) {
      multiplicity += exact[k].multiplicity;
      continue;
    }
    if (multiplicity > 0 && !hits.add(last, multiplicity)) return false;
    last = l;
    multiplicity = exact[k].multiplicity;
    if (!all) break;
  }
  return multiplicity == 0 || hits.add(last, multiplicity);
}

}  // namespace graze
