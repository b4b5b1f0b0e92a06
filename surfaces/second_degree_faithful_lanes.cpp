// The step of `faithful` for surfaces of second degree. Compiled once for each instruction set; derivation
// and error analysis: surfaces/quadric.md, "Kernel".
#include <graze/surfaces/second_degree_faithful_lanes.hpp>

#include <graze/surfaces/faithful_lanes.hpp>

namespace graze::GRAZE_LANES {
namespace {

using Surface = SecondDegreeSurface;
using Shape = SecondDegreeSurface::Shape;

constexpr double kU = 0x1p-53;
constexpr double kU2 = kU * kU;
constexpr double kTiny = 0x1p-960;  // far above what underflow can add to a bound, far below what matters

/// A sum whose terms' roundings are kept.
struct Sum {
  Lanes hi, lo;

  [[gnu::always_inline]] inline void add(Lanes term, Lanes tail) {
    const Wide next = two_sum(hi, term);
    hi = next.hi;
    lo += next.lo + tail;
  }
  /// (c + c_tail) a, a within u of itself: a_tail is the rest.
  [[gnu::always_inline]] inline void add_product(double c, double c_tail, Lanes a, Lanes a_tail) {
    const Wide product = two_prod(all(c), a);
    add(product.hi, fma(a_tail, all(c), fma(a, all(c_tail), product.lo)));
  }
};

/// f at y = x - centre, to twice the digits where it is nearly zero.
template <Shape kShape, bool kCentral>
struct Equation {
  static constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};  // of M's entries 3, 4, 5

  Surface s;
  double unit, inverse_unit;

  explicit Equation(const Surface& surface)
      : s(surface), unit(surface.unit), inverse_unit(surface.inverse_unit) {}

  /// As coordinate_at, off the centre: within u^2 (3 |y| + 4 |l d|).
  [[gnu::always_inline]] [[nodiscard]] inline Coordinate coordinate(const Line& line, std::size_t i,
                                                                    Lanes l) const {
    if constexpr (kCentral) return coordinate_at(line.o[i], line.d[i], l);
    const Wide o = two_sum(line.o[i], all(-s.centre[i]));
    const Wide moved = two_prod(l, line.d[i]), sum = two_sum(moved.hi, o.hi);
    return {two_sum(sum.hi, sum.lo + (moved.lo + o.lo)), moved.hi};
  }

  /// Half the gradient.
  [[gnu::always_inline]] inline void slopes(const Coordinate (&y)[3], Lanes (&n)[3]) const {
    for (std::size_t i = 0; i < 3; ++i) {
      n[i] = kShape == Shape::sphere ? y[i].x.hi : s.m[i] * y[i].x.hi;
      if constexpr (kShape == Shape::full || kShape == Shape::diagonal) n[i] += s.g[i];
    }
    if constexpr (kShape != Shape::full) return;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = kPairs[k];
      n[i] = fma(y[j].x.hi, all(s.m[3 + k]), n[i]);
      n[j] = fma(y[i].x.hi, all(s.m[3 + k]), n[j]);
    }
  }

  [[gnu::always_inline]] [[nodiscard]] inline Lanes value(const Coordinate (&y)[3], const Lanes (&n)[3],
                                                          Lanes& square) const {
    Sum f{all(s.j), all(s.j_tail)};
    square = Lanes{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Wide yy = two_prod(y[i].x.hi, y[i].x.hi);
      square += yy.hi;
      if constexpr (kShape == Shape::sphere) {
        f.add(yy.hi, yy.lo);
      } else {
        f.add_product(s.m[i], s.m_tail[i], yy.hi, yy.lo);
      }
      if constexpr (kShape == Shape::full || kShape == Shape::diagonal)
        f.add_product(2 * s.g[i], 2 * s.g_tail[i], y[i].x.hi, Lanes{});
    }
    for (std::size_t k = 0; kShape == Shape::full && k < 3; ++k) {
      const Wide yy = two_prod(y[kPairs[k][0]].x.hi, y[kPairs[k][1]].x.hi);
      f.add_product(2 * s.m[3 + k], 2 * s.m_tail[3 + k], yy.hi, yy.lo);
    }
    const Lanes rest = fma(n[0], y[0].x.lo, fma(n[1], y[1].x.lo, n[2] * y[2].x.lo));
    return f.hi + (f.lo + 2 * rest);
  }

  [[gnu::always_inline]] [[nodiscard]] inline Residual residual(const Line& line, Lanes l) const {
    const Coordinate y[3] = {coordinate(line, 0, l), coordinate(line, 1, l), coordinate(line, 2, l)};
    Lanes n[3];
    slopes(y, n);
    Lanes square;
    const Lanes f = value(y, n, square);

    // Sizes and counts: surfaces/quadric.md. steep is at least the sum of |M| |y| + |g| over its coordinates,
    // which is no less than |n|; |l d_i| < 2 |l|.
    const Lanes sizes = abs(y[0].x.hi) + (abs(y[1].x.hi) + abs(y[2].x.hi)), way = abs(l);
    const Lanes steep = fma(sizes, all(s.norm), all(1.75 * s.gradient));
    const Lanes size = fma(square, all(s.linear * s.norm), all(s.constant));
    const Lanes moved = fma(way, all(2.0), sizes), far = 4.25 * kU2 * fma(way, all(6.0), sizes);
    const Lanes error =
        fma(size, all(512 * kU2), fma(9 * kU2 * steep, moved, s.norm * far * far)) + kTiny * (1 + s.norm);
    const Lanes slope = 2 * fma(n[0], line.d[0], fma(n[1], line.d[1], n[2] * line.d[2]));
    return {f,
            error,
            slope,
            fma(steep, all(48 * kU), all(kTiny)),
            all(12 * s.norm),
            all(__builtin_inf()),
            0x1p-48 * abs(l),
            0x1p-47 * s.length * steep};
  }
};

template <Shape kShape>
void correct_shape(const Surface& surface, const FaithfulBatch& batch) {
  const bool is_central = surface.centre[0] == 0 && surface.centre[1] == 0 && surface.centre[2] == 0;
  if (is_central) return correct_all(Equation<kShape, true>(surface), batch);
  correct_all(Equation<kShape, false>(surface), batch);
}

}  // namespace

void correct_second_degree(const SecondDegreeSurface& surface, const FaithfulBatch& batch) {
  if (surface.shape == Shape::sphere) return correct_shape<Shape::sphere>(surface, batch);
  if (surface.shape == Shape::axial || surface.shape == Shape::central)
    return correct_shape<Shape::central>(surface, batch);
  if (surface.shape == Shape::diagonal) return correct_shape<Shape::diagonal>(surface, batch);
  correct_shape<Shape::full>(surface, batch);
}

}  // namespace graze::GRAZE_LANES
