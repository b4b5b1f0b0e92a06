// The kernel of Bezier profiles for `faithful`: what its code for one instruction set takes
// (surfaces/bezier_revolution.md, "Kernel of faithful").
#pragma once

#include <cstddef>

#include <graze/surfaces/faithful_batch.hpp>

namespace graze {

inline constexpr std::size_t kMaxFaithfulBezierDegree = 16;

/// A polynomial in tau, 0 <= tau <= kMostTau, the profile's parameter counted from one of its ends. Computed
/// as in the lanes it is within error + step tau.
struct BezierPowers {
  static constexpr double kMostTau = 0.625;
  double c[kMaxFaithfulBezierDegree + 1] = {}, tail[kMaxFaithfulBezierDegree + 1] = {};
  double error = 0, step = 0;
};
struct BezierEnd {
  BezierPowers y, r;
};

/// Where the parameter of a height is looked for: tau + way s, where s slope + s^2 bend = |height - y|.
struct BezierCell {
  double y = 0, tau = 0, slope = 0, bend = 0, way = 0;
  double is_back = 0;  ///< 1: tau is counted from t = 1
};

/// A monotone piece of Y, its cells one upon another.
struct BezierMonotone {
  static constexpr std::size_t kCells = 16;
  double y_low = 0, y_high = 0;  ///< within 2^-40 of themselves
  double t_low = 0, t_high = 1;
  double tops[kCells - 1] = {};
  BezierCell cells[kCells];
};

/// The profile, lengths in units of 2^unit.
struct BezierFaithfulFrame {
  double unit = 1, inverse_unit = 1;  ///< 2^unit, 2^-unit
  std::size_t degree = 0;
  BezierEnd ends[2];
  double y_first = 0, r_first = 0;    ///< bounds of the sizes that Y' and R' are sums of
  double y_second = 0, r_second = 0;  ///< bounds of |Y''|, |R''|
  const BezierMonotone* pieces = nullptr;
  std::size_t count = 0;
};

namespace avx512 {
void correct_bezier(const BezierFaithfulFrame& profile, const FaithfulBatch& batch);
}
namespace avx2 {
void correct_bezier(const BezierFaithfulFrame& profile, const FaithfulBatch& batch);
}
namespace baseline {
void correct_bezier(const BezierFaithfulFrame& profile, const FaithfulBatch& batch);
}

}  // namespace graze
