// The teardrop and lines in double-double lanes: the middle tier of the certified ladder
// (surfaces/teardrop.md).
//
// solves    which points of o + l d lie on the solid's surface, for the few lines that lanes of doubles leave
//           open: grazing ones, those past a pole, origins near the surface
// needs     lines in units in which s = m is in [1, 2) and max |d_i| in [1, 2)
// returns   by line: `open`, or what is proved of it: that it misses, or brackets of its entry and exit; and
//           on which side of the surface its origin is
// error     a bracket is 2^-51 (|l| + 1) wide, or as narrow as the sign of the equation can be told
// cost      8 to 20 evaluations of about 500 operations in double-double, shared by the lanes; no allocation
// source    graze; double-double arithmetic as in solvers/math/lanes_double_double.hpp
#pragma once

#include <cstddef>
#include <cstdint>

#include <graze/surfaces/ray.hpp>

namespace graze {

struct TeardropLines {
  const Ray* lines = nullptr;
  std::size_t count = 0;
  double m = 1;
  bool first_only = false;  ///< the exit is not wanted where the entry is ahead of the origin
};

/// A crossing: l is about its place, lo and hi are on different sides of the surface; each rounded once, so
/// that its sign is right.
struct LineCrossing {
  double l = 0, lo = 0, hi = 0;
};

struct LineAnswer {
  enum class Proved : std::uint8_t { open, misses, crosses } proved = Proved::open;
  enum class Origin : std::uint8_t { on, inside, outside } origin = Origin::on;  ///< on: or not known
  LineCrossing entry, exit;
};

namespace avx512 {
void prove_teardrop_lines(const TeardropLines& lines, LineAnswer* answers);
}
namespace avx2 {
void prove_teardrop_lines(const TeardropLines& lines, LineAnswer* answers);
}
namespace baseline {
void prove_teardrop_lines(const TeardropLines& lines, LineAnswer* answers);
}

}  // namespace graze
