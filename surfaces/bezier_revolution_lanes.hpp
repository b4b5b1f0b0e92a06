// The kernel of Bezier profiles: what its code for one instruction set takes and gives
// (surfaces/bezier_revolution.md, "Kernel").
#pragma once

#include <cstddef>
#include <cstdint>

#include <graze/surfaces/ray.hpp>

namespace graze {

inline constexpr std::size_t kMaxBezierDegree = 8;
inline constexpr std::size_t kMaxBezierIntervals = 48;  ///< of all tracks: one bit each in 64

/// A part of the profile between two heights, on which Y is monotone. With t = origin + length sigma, Y and R
/// are polynomials in sigma, in [-1, 1]; G = R^2 is a function of the height. Bounds are rounded outward and
/// hold for |sigma| < 1 + 2^-10. In `errors`: what the constant terms of Y and R were rounded by (y_tail,
/// r_tail); Y is off by at most y_error + y_step |sigma| + u |Y|, and R likewise; bounds of |Y''|, |R''| (y2,
/// r2). In `ends`: about d2G/dy2 (bend), and a bound of |d(dG/dy)/dsigma| (turn).
struct BezierInterval {
  // Rows of eight, which the lanes take side by side from several intervals.
  double ends[8];     ///< y_low, y_high, G there, bend, turn, sigma there
  double ranges[8];   ///< g_most, dg_low, dg_high, ddg_low, ddg_high, 1 if is_concave, 0, 0
  double errors[8];   ///< y_tail, r_tail, y_error, y_step, r_error, r_step, y2, r2
  double powers[24];  ///< of Y and R in turn, ascending

  double y_low, y_high;      ///< ends
  double g_low, g_high;      ///< G there, within BezierBatch::g_error; exactly 0 where they are 0
  double g_least, g_most;    ///< range of G
  double dg_low, dg_high;    ///< range of dG/dy
  double ddg_low, ddg_high;  ///< range of d2G/dy2
  bool is_concave;           ///< |R| is a concave function of the height
};
static_assert(2 * (kMaxBezierDegree + 1) <= 24);

/// Intervals of one monotone piece of Y, one upon another.
struct BezierTrack {
  std::size_t begin = 0, end = 0;
};

/// Rays of one profile: lengths in units of 2^unit.
struct BezierBatch {
  const Ray* rays = nullptr;
  std::size_t count = 0;
  bool both = false;        ///< all hits wanted; else the first
  double inverse_unit = 1;  ///< 2^-unit
  double middle = 0;        ///< height near which rays are recentred
  double y_size = 0;        ///< bound of |Y|
  double g_most = 0;        ///< bound of G
  double g_error = 0;       ///< of every interval's g_low and g_high
  std::size_t degree = 0;   ///< at most kMaxBezierDegree
  const BezierInterval* intervals = nullptr;
  const BezierTrack* tracks = nullptr;
  std::size_t track_count = 0;
};

/// Where answers go: the proved number of hits of each ray (of at most one, unless all are wanted) or -1, and
/// their l in units of |d|, ascending.
struct BezierAnswers {
  static constexpr std::size_t kMost = 4;
  std::int8_t* hits = nullptr;
  double* l[kMost] = {};
};

namespace avx512 {
void intersect_bezier(const BezierBatch& batch, const BezierAnswers& answers);
}
namespace avx2 {
void intersect_bezier(const BezierBatch& batch, const BezierAnswers& answers);
}
namespace baseline {
void intersect_bezier(const BezierBatch& batch, const BezierAnswers& answers);
}

}  // namespace graze
