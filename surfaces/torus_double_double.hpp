// The torus and one line in double-double: the middle tier of the certified ladder (surfaces/torus.md).
//
// solves    which points of o + l d lie on the torus, for the lines that lanes of doubles leave open: grazing
//           ones, origins near the surface, tori that are no ring
// needs     a ray and a torus in units in which R + r is in [1, 2), max |d_i| in [1, 2)
// returns   `open`, or the brackets of the line's crossings, all of them and no other: none where it misses.
//           Touches are open
// error     brackets are at most a few double-double ulps of the point, over |n.d|, wide, or 2^-56
// cost      10 to 30 evaluations of about 60 ns; no allocation
// source    graze; double-double arithmetic as in solvers/math/double_double.hpp
#pragma once

#include <array>
#include <cstdint>

#include <graze/solvers/math/double_double.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// f has different signs at lo and hi, l = centre + delta.
struct TorusCrossing {
  DoubleDouble lo, hi;
};

struct TorusLineAnswer {
  bool open = true;
  DoubleDouble centre;
  std::size_t count = 0;
  std::array<TorusCrossing, 4> crossings;  ///< ascending
};

/// `first_only`: of a line whose first crossing is ahead of the origin no other is looked for.
TorusLineAnswer prove_torus_line(const Ray& local, double ring, double tube, bool first_only);

}  // namespace graze
