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
};

/// f at y = x - centre, to twice the digits where it is nearly zero.
template <Shape kShape, bool kCentral>
struct Equation {
  static constexpr std::size_t kPairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};  // of M's entries 3, 4, 5

  Surface s;
  double unit, inverse_unit;
  double radius;  ///< of a sphere, rounded up

  explicit Equation(const Surface& surface)
      : s(surface),
        unit(surface.unit),
        inverse_unit(surface.inverse_unit),
        radius(kShape == Shape::sphere ? (1 + 0x1p-40) * __builtin_sqrt(-surface.j) : 0) {}

  /// Off the centre, within u^2 (3 |y| + 4 |l d|). The rounding of o + l d, which is known at once, is what
  /// is left of o - y + l d.
  [[gnu::always_inline]] [[nodiscard]] inline Wide coordinate(const Line& line, std::size_t i,
                                                              Lanes l) const {
    const Wide o = kCentral ? wide(line.o[i]) : two_sum(line.o[i], all(-s.centre[i]));
    const Lanes y = fma(l, line.d[i], o.hi);
    const Wide way = two_sum(o.hi, -y);
    const Lanes rest = fma(l, line.d[i], way.hi);
    if constexpr (kCentral) return {y, rest + way.lo};
    return two_sum(y, rest + (way.lo + o.lo));
  }

  /// Half the gradient.
  [[gnu::always_inline]] inline void slopes(const Wide (&y)[3], Lanes (&n)[3]) const {
    for (std::size_t i = 0; i < 3; ++i) {
      n[i] = kShape == Shape::sphere ? y[i].hi : s.m[i] * y[i].hi;
      if constexpr (kShape == Shape::full || kShape == Shape::diagonal) n[i] += s.g[i];
    }
    if constexpr (kShape != Shape::full) return;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = kPairs[k];
      n[i] = fma(y[j].hi, all(s.m[3 + k]), n[i]);
      n[j] = fma(y[i].hi, all(s.m[3 + k]), n[j]);
    }
  }

  /// (c + c_tail) a, a within u of itself: a_tail is the rest.
  [[gnu::always_inline]] static inline Wide product(double c, double c_tail, Lanes a, Lanes a_tail) {
    const Wide p = two_prod(all(c), a);
    return {p.hi, fma(a_tail, all(c), fma(a, all(c_tail), p.lo))};
  }

  /// The last sum, with j, may round: relative to f that is one rounding.
  [[gnu::always_inline]] [[nodiscard]] inline Lanes value(const Wide (&y)[3], const Lanes (&n)[3],
                                                          Lanes& square) const {
    Sum f{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Wide yy = two_prod(y[i].hi, y[i].hi);
      const Wide term = kShape == Shape::sphere ? yy : product(s.m[i], s.m_tail[i], yy.hi, yy.lo);
      square = i == 0 ? yy.hi : square + yy.hi;
      if (i == 0) {
        f = {term.hi, term.lo};
      } else {
        f.add(term.hi, term.lo);
      }
      if constexpr (kShape == Shape::full || kShape == Shape::diagonal) {
        const Wide along = product(2 * s.g[i], 2 * s.g_tail[i], y[i].hi, Lanes{});
        f.add(along.hi, along.lo);
      }
    }
    for (std::size_t k = 0; kShape == Shape::full && k < 3; ++k) {
      const Wide yy = two_prod(y[kPairs[k][0]].hi, y[kPairs[k][1]].hi);
      const Wide term = product(2 * s.m[3 + k], 2 * s.m_tail[3 + k], yy.hi, yy.lo);
      f.add(term.hi, term.lo);
    }
    const Lanes rest = fma(n[0], y[0].lo, fma(n[1], y[1].lo, n[2] * y[2].lo));
    return (f.hi + s.j) + fma(rest, all(2.0), f.lo + s.j_tail);
  }

  /// The same bounds where |y|^2 < 1.25 r^2, so that sum |y_i| < 2 r and they are constants but for l.
  [[gnu::always_inline]] [[nodiscard]] inline Residual on_sphere(Lanes f, Lanes slope, Lanes l,
                                                                 Lanes square) const {
    const Lanes way = abs(l), far = fma(way, all(25.5 * kU2), all(8.5 * kU2 * radius));
    const double fixed = 1200 * kU2 * radius * radius + 2 * kTiny;
    return {f,
            fma(far, far, fma(way, all(36 * kU2 * radius), all(fixed))),
            slope,
            all(96 * kU * radius + kTiny),
            all(12.0),
            select(square < -1.25 * s.j, all(__builtin_inf()), all(-1.0)),
            0x1p-48 * way,
            all(0x1p-46 * s.length * radius)};
  }

  [[gnu::always_inline]] [[nodiscard]] inline Residual residual(const Line& line, Lanes l) const {
    const Wide y[3] = {coordinate(line, 0, l), coordinate(line, 1, l), coordinate(line, 2, l)};
    Lanes n[3];
    slopes(y, n);
    Lanes square;
    const Lanes f = value(y, n, square);

    const Lanes slope = 2 * fma(n[0], line.d[0], fma(n[1], line.d[1], n[2] * line.d[2]));
    if constexpr (kShape == Shape::sphere) return on_sphere(f, slope, l, square);

    // Sizes and counts: surfaces/quadric.md. steep is at least the sum of |M| |y| + |g| over its coordinates,
    // which is no less than |n|; |l d_i| < 2 |l|.
    const Lanes sizes = abs(y[0].hi) + (abs(y[1].hi) + abs(y[2].hi)), way = abs(l);
    const Lanes steep = fma(sizes, all(s.norm), all(1.75 * s.gradient));
    const Lanes size = fma(square, all(s.linear * s.norm), all(s.constant));
    const Lanes moved = fma(way, all(2.0), sizes), far = 4.25 * kU2 * fma(way, all(6.0), sizes);
    const Lanes error =
        fma(size, all(512 * kU2), fma(9 * kU2 * steep, moved, s.norm * far * far)) + kTiny * (1 + s.norm);
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
