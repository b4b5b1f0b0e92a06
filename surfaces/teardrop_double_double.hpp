// The teardrop and one line in double-double: the middle tier of the certified ladder (surfaces/teardrop.md).
//
// solves    which points of o + l d lie on the solid's surface, for the few lines that lanes of doubles leave
//           open: grazing ones, those past a pole, origins near the surface
// needs     a ray in units in which s = m is in [1, 2) and max |d_i| in [1, 2)
// returns   `open`, or what is proved of the line: that it misses, or brackets of its entry and exit
// error     brackets are at most a few double-double ulps of the point, over |n.d|, wide, or 2^-60
// cost      10 to 25 evaluations of about 60 ns; no allocation
// source    graze; double-double arithmetic as in solvers/math/double_double.hpp
#pragma once

#include <cstdint>

#include <graze/solvers/math/double_double.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// A crossing: lo and hi are on different sides of the surface, delta between them.
struct LineCrossing {
  DoubleDouble delta;
  DoubleDouble lo, hi;
};

struct LineAnswer {
  enum class Proved : std::uint8_t { open, misses, crosses } proved = Proved::open;
  enum class Origin : std::uint8_t { on, inside, outside } origin = Origin::on;  ///< on: or not known
  double centre = 0;                                                             ///< l = centre + delta
  LineCrossing entry, exit;
};

/// `first_only`: the exit is not looked for where the entry is ahead of the origin.
LineAnswer prove_line(const Ray& local, double m, bool first_only);

}  // namespace graze
