// Kernels of second degree: what their code for one instruction set takes and gives (surfaces/quadric.md).
#pragma once

#include <cstddef>
#include <cstdint>

#include <graze/surfaces/ray.hpp>

namespace graze {

/// f(x) = y.(M y) + 2 g.y + j, y = x - centre, lengths in units of 2^unit; every number is within u = 2^-53
/// of the exact one, relative to itself, or is that.
struct SecondDegreeSurface {
  /// sphere: M = 1; axial: M > 0 diagonal, g = 0, j < 0; central: M diagonal, g = 0; diagonal: M is; full:
  /// any.
  enum class Shape : std::uint8_t { sphere, axial, central, diagonal, full };

  Shape shape = Shape::full;
  double unit = 1, inverse_unit = 1;  ///< 2^unit, 2^-unit
  double centre[3] = {};
  double m[6] = {1, 1, 1, 0, 0, 0}, m_tail[6] = {};  ///< xx, yy, zz, xy, xz, yz
  double g[3] = {}, g_tail[3] = {};
  double j = 0, j_tail = 0;  ///< of a sphere -radius^2
  double norm = 1;           ///< at least the norm of |M|, the largest sum of a row
  double gradient = 0;       ///< at least |g|
  double constant = 1;       ///< at least |j| + |g|^2 / norm
  double linear = 1;         ///< 2 where g is not zero
  /// f at y is computed within u (of_slope sum |y_i (M y + g)_i| + of_size size + 3 |j|);
  double of_slope = 0;
  double of_size = 0;    ///< size: |y|.(|M| |y| + |g|) if full, |g|.|y| if diagonal
  double length = 0;     ///< at most the length of condition units; 0: none
  double farthest2 = 0;  ///< |o - centre|^2 beyond which rays are left open
};

struct SecondDegreeBatch {
  const Ray* rays = nullptr;
  std::size_t count = 0;
  bool both = false;  ///< all hits wanted; else the first
};

/// Where answers go: the proved number of hits of each ray (of at most one, unless both are wanted) or -1,
/// and their l in units of |d|, ascending.
struct SecondDegreeAnswers {
  std::int8_t* hits = nullptr;
  double* first = nullptr;
  double* second = nullptr;
  std::uint8_t* tier = nullptr;  ///< 2 is written where double-doubles answered
};

namespace avx512 {
void intersect_second_degree(const SecondDegreeSurface& surface, const SecondDegreeBatch& batch,
                             const SecondDegreeAnswers& answers);
}
namespace avx2 {
void intersect_second_degree(const SecondDegreeSurface& surface, const SecondDegreeBatch& batch,
                             const SecondDegreeAnswers& answers);
}
namespace baseline {
void intersect_second_degree(const SecondDegreeSurface& surface, const SecondDegreeBatch& batch,
                             const SecondDegreeAnswers& answers);
}

}  // namespace graze
