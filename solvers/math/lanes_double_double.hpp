// Double-double numbers in lanes: the algorithms of solvers/math/double_double.hpp with its error bounds,
// many numbers at a time, the same bits on every instruction set.
//
// needs     what lanes.hpp needs; numbers as in double_double.hpp. Included by sources that are compiled for
//           one instruction set each, which must not share the scalar functions (lanes.hpp)
// error     relative, u = 2^-53: sums 3 u^2, with a double 2; products 5, with a double 2; quotients 15, by a
//           double 3; roots 25/8
// cost      operations as in double_double.hpp, a vector each
// source    as double_double.hpp: Joldes, Muller, Popescu, ACM TOMS 44(2), 2017; Lefevre et al., ACM TOMS
// 49(1), 2023
#pragma once

#include <graze/solvers/math/lanes.hpp>

namespace graze::GRAZE_LANES {

/// hi + lo, hi = fl(hi + lo), a lane.
struct Wide {
  Lanes hi, lo;
};

inline Wide wide(Lanes x) { return {x, Lanes{}}; }
inline Wide wide(double x) { return wide(all(x)); }

inline Wide two_sum(Lanes a, Lanes b) {
  const Lanes s = a + b;
  const Lanes b_part = s - a;
  return {s, (a - (s - b_part)) + (b - b_part)};
}
inline Wide quick_two_sum(Lanes a, Lanes b) {
  const Lanes s = a + b;
  return {s, b - (s - a)};
}
inline Wide two_prod(Lanes a, Lanes b) {
  const Lanes p = a * b;
  return {p, fma(a, b, -p)};
}

inline Wide operator-(const Wide& x) { return {-x.hi, -x.lo}; }
inline Wide operator+(const Wide& x, Lanes y) {
  const Wide s = two_sum(x.hi, y);
  return quick_two_sum(s.hi, x.lo + s.lo);
}
inline Wide operator+(const Wide& x, const Wide& y) {
  const Wide s = two_sum(x.hi, y.hi);
  const Wide t = two_sum(x.lo, y.lo);
  const Wide v = quick_two_sum(s.hi, s.lo + t.hi);
  return quick_two_sum(v.hi, t.lo + v.lo);
}
inline Wide operator-(const Wide& x, const Wide& y) { return x + -y; }
inline Wide operator*(const Wide& x, Lanes y) {
  const Wide c = two_prod(x.hi, y);
  return quick_two_sum(c.hi, fma(x.lo, y, c.lo));
}
inline Wide operator*(const Wide& x, const Wide& y) {
  const Wide c = two_prod(x.hi, y.hi);
  const Lanes low = fma(x.lo, y.hi, fma(x.hi, y.lo, x.lo * y.lo));
  return quick_two_sum(c.hi, c.lo + low);
}
inline Wide sqr(const Wide& x) { return x * x; }
inline Wide operator/(const Wide& x, Lanes y) {
  const Lanes t = x.hi / y;
  const Wide p = two_prod(t, y);
  const Lanes remainder = ((x.hi - p.hi) - p.lo) + x.lo;
  return quick_two_sum(t, remainder / y);
}
inline Wide operator/(const Wide& x, const Wide& y) {
  const Lanes t = x.hi / y.hi;
  const Wide c = two_prod(y.hi, t);
  const Wide v = quick_two_sum(c.hi, y.lo * t);
  const Wide r = quick_two_sum(v.hi, v.lo + c.lo);
  const Lanes remainder = (x.hi - r.hi) + (x.lo - r.lo);
  return quick_two_sum(t, remainder / y.hi);
}

inline Wide select(Mask mask, const Wide& a, const Wide& b) {
  return {select(mask, a.hi, b.hi), select(mask, a.lo, b.lo)};
}
inline Mask operator<(const Wide& a, const Wide& b) {
  return (a.hi < b.hi) | ((a.hi == b.hi) & (a.lo < b.lo));
}
inline Mask operator>(const Wide& a, const Wide& b) { return b < a; }

/// Needs x >= 0.
inline Wide sqrt(const Wide& x) {
  const Lanes s = sqrt(x.hi);
  const Lanes remainder = x.lo + fma(-s, s, x.hi);
  return select(x.hi == 0, x, quick_two_sum(s, remainder / (2 * s)));
}

}  // namespace graze::GRAZE_LANES
