// A Bezier profile and one line in double-doubles with bounds: the middle tier of the certified ladder
// (surfaces/bezier_revolution.md, "Kernel").
//
// solves    E(t) = d_y^2 R(t)^2 - |d_xz (Y(t) - p_y) + d_y p_xz|^2 = 0 in [0, 1]; where the line is nearly
//           level Y(t) = y and |x_xz|^2 = R(t)^2: for the few lines that doubles leave open, grazing ones,
//           those past or through a pole, origins near the surface
// needs     a profile of degree at most kMaxDegree in units in which its size is in [1, 2); a line with
//           max |d_i| in [1, 2)
// returns   all hits ahead of the origin, ascending, or nothing where that is not proved
// error     of l: its enclosure is at most 2^-54 (l + 1/4) wide on either side of it
// cost      surfaces/bezier_revolution.md; no allocation
// source    graze; isolation by Descartes' rule in the Bernstein basis: J. M. Lane, R. F. Riesenfeld, BIT 21,
//           1981. Changed: a cell with two changes of sign is split where E' is about zero
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/surfaces/bezier_revolution.hpp>

namespace graze {

class BezierDoubleDouble {
 public:
  static constexpr std::size_t kMaxDegree = 16;
  static constexpr std::size_t kMaxHits = 2 * kMaxDegree;

  struct Hit {
    DoubleDouble l;    ///< in the line's units
    double error = 0;  ///< of l; less than |l|
    std::uint32_t multiplicity = 1;
  };
  struct Hits {
    std::array<Hit, kMaxHits> list;
    std::size_t count = 0;
  };

  explicit BezierDoubleDouble(const BezierProfile& profile);
  /// False: nothing is proved.
  [[nodiscard]] bool find(Vec3 o, Vec3 d, Hits& hits) const;

 private:
  class Line;

  std::size_t degree_ = 0;
  double middle_ = 0;  ///< height near which lines are recentred
  std::array<double, kMaxDegree + 1> r_{}, y_{};
  std::array<double, kMaxDegree + 1> choose_{};  ///< C(n, i)
};

}  // namespace graze
