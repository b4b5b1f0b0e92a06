// From exact hits to doubles within an ulp, for the last tiers of the kernels for `faithful`.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/kernel.hpp>

namespace graze {

/// The doubles nearest to exact hits: `l` of each has to_double() and compare_with(Dyadic). Of two hits x
/// rounds from both, the one that is further from it moves by an ulp: neither is then further from its own
/// than that. False as HitsOfRay::add.
template <class ExactHits>
[[nodiscard]] bool add_nearest(ExactHits& exact, bool all, HitsOfRay& hits) {
  for (std::size_t k = 0; k < exact.size(); ++k) {
    double l = exact[k].l.to_double();
    const bool meets = k + 1 < exact.size() && exact[k + 1].l.to_double() == l;
    if (meets && exact[k + 1].l.compare_with(Dyadic(l)) < 0) l = std::nextafter(l, 0.0);
    if (!hits.add(l, std::min(exact[k].multiplicity, 2U))) return false;
    if (!all) break;
  }
  return true;
}

}  // namespace graze
