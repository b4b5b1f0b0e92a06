// The teardrop and one ray in exact integers: the last tier of the certified ladder (surfaces/teardrop.md).
//
// solves    the implicit sextic of the line: with H = 6s, y and W = x^2 + z^2 as polynomials in l,
//           B^2 - 4 H y^3 (2H - y)^2 = 0, B = 4 H W - y ((2H - y)^2 + H y); the surface's own roots are those
//           with 0 <= y <= H and B <= 0, the others lie on the mirrored sheets
// needs     a ray of finite numbers, d != 0; s > 0
// returns   every hit with l > 0, ascending, with its multiplicity: 2 for a touch; at a pole 2 if the line
//           touches there, 1 if it passes inside
// error     none; to_double() of a hit is the double nearest to its l
// cost      about 250 us (measured by tests/experiments/teardrop_exact_test.cpp); allocates
// source    document 000's surface, squared once (surfaces/teardrop.md, implicit_sextic); isolation as in
//           solvers/math/exact_polynomial.hpp
#pragma once

#include <vector>

#include <graze/solvers/math/exact_polynomial.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

struct ExactHit {
  RealRoot l;  ///< in units of |d|
  std::uint32_t multiplicity = 1;
};

std::vector<ExactHit> exact_teardrop_hits(const Ray& ray, double s);

/// 1 where the point at l, finite, is inside the solid, 0 on its surface, -1 outside: by the exact signs of B
/// and the sextic. About 20 operations on integers of up to 2000 bits.
int side_of_teardrop(const Ray& ray, double s, double l);

}  // namespace graze
