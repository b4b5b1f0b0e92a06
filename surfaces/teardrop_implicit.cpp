#include <graze/surfaces/teardrop.hpp>

#include <algorithm>
#include <cmath>

#include <graze/surfaces/in_basis.hpp>

namespace graze {
namespace {

// -------------------------------------------------------------------------------------------- the equation

/// B = 4 H W - y ((2H - y)^2 + H y): on the surface -2 y (2H - y) sqrt(H y), on the other sheet its opposite.
template <class P>
auto side_of(const P& x, const P& y, const P& z, const P& h) {
  const auto far = 2.0 * h - y;
  return 4.0 * (h * (x * x + z * z)) - y * (far * far + h * y);
}

/// B^2 - 4 H y (y (2H - y))^2, homogeneous of degree 6 in lengths.
template <class P>
auto sextic_of(const P& x, const P& y, const P& z, const P& h) {
  const auto side = side_of(x, y, z, h);
  const auto bulk = y * (2.0 * h - y);
  return side * side - 4.0 * (h * y * (bulk * bulk));
}

template <class T>
T height_of(const TeardropProfile& profile) {
  return exactly<T>(6) * exactly<T>(profile.m);
}

/// The sextic on a part of the line: Bernstein coefficients are scaled ones (in_basis.hpp).
template <Basis kBasis, class T>
std::array<T, 7> sextic_in_basis(const TeardropProfile& profile, const LinePart& line) {
  const auto coordinate = [&](double o, double d) { return coordinate_in_basis<kBasis, T>(line, o, d); };
  return sextic_of(coordinate(line.o.x, line.d.x), coordinate(line.o.y, line.d.y),
                   coordinate(line.o.z, line.d.z), constant_in_basis<kBasis>(height_of<T>(profile)))
      .c;
}

template <class T>
using Constant = InBasis<Basis::power, T, 1>;

/// The ray starts at the low end, and the sextic may vanish there.
bool may_start_on_it(const TeardropProfile& profile, const LocalRay& ray, double lo) {
  using T = DoubleDoubleBall;
  const auto constant = [](double x) { return Constant<T>{{T(x)}}; };
  return ray.centre == 0 && lo == 0 &&
         sextic_of(constant(ray.o.x), constant(ray.o.y), constant(ray.o.z),
                   Constant<T>{{height_of<T>(profile)}})
             .c[0]
             .contains_zero();
}

/// Exact coefficients without `zeros` roots at the low end, where the ray starts on the surface: they are no
/// hits, and a solver could not tell on which side they lie.
template <Basis kBasis>
std::vector<Dyadic> exact_sextic(const TeardropProfile& profile, const LinePart& line, std::size_t zeros) {
  const auto all = sextic_in_basis<kBasis, Dyadic>(profile, line);
  std::vector<Dyadic> c(all.begin(), all.end());
  for (std::size_t i = 0; i < zeros; ++i) c = without_low_root<kBasis>(c);
  remove_binomials<kBasis, Dyadic>(c);
  return c;
}

template <Basis kBasis>
std::size_t count_low_roots(const TeardropProfile& profile, const LinePart& line) {
  std::size_t zeros = 0;
  std::vector<Dyadic> c = exact_sextic<kBasis>(profile, line, 0);
  // No line lies on the sextic's sheets, so that it is never zero as a whole.
  while (c.size() > 1 && low_value<kBasis>(c).is_zero()) c = exact_sextic<kBasis>(profile, line, ++zeros);
  return zeros;
}

/// Coefficients with bounds of their errors.
struct Balls {
  std::array<DoubleDoubleBall, 7> c;
  std::size_t size = 7;
  std::size_t zeros = 0;
};

template <Basis kBasis>
Balls sextic_balls(const TeardropProfile& profile, const LocalRay& ray, const LinePart& line) {
  Balls balls;
  if (may_start_on_it(profile, ray, line.lo)) balls.zeros = count_low_roots<kBasis>(profile, line);
  if (balls.zeros > 0) {
    const std::vector<Dyadic> exact = exact_sextic<kBasis>(profile, line, balls.zeros);
    balls.size = exact.size();
    std::transform(exact.begin(), exact.end(), balls.c.begin(),
                   [](const Dyadic& x) { return nearest_ball(x); });
  } else {
    balls.c = sextic_in_basis<kBasis, DoubleDoubleBall>(profile, line);
    remove_binomials<kBasis, DoubleDoubleBall>(balls.c);
  }
  // A horizontal ray has degree 4; a Bernstein form keeps its length.
  while (kBasis != Basis::bernstein && balls.size > 1 && balls.c[balls.size - 1].is_exact_zero())
    --balls.size;
  return balls;
}

/// The range of delta in which hits may lie, with some room: a solver proves a root at the very end of its
/// interval only by exact arithmetic, and hits at the poles and on the widest circle lie on the bounds.
bool roomy_range(const TeardropProfile& profile, const LocalRay& ray, double& lo, double& hi) {
  const Cylinder bounds = profile.bounds();
  const double room = 0x1p-10 * profile.m;
  const Cylinder roomy{bounds.radius + room, bounds.y_lo - room, bounds.y_hi + room};
  lo = -ray.centre;
  hi = std::numeric_limits<double>::infinity();
  return revolution::clip_slab(ray, roomy, lo, hi) && revolution::clip_cylinder(ray, roomy, lo, hi) &&
         lo < hi;
}

// ---------------------------------------------------------------------------------------------- the sheets

bool is_positive(const DoubleDoubleBall& x) { return !x.contains_zero() && x.value().hi > 0; }
bool is_negative(const DoubleDoubleBall& x) { return !x.contains_zero() && x.value().hi < 0; }

/// What tells the sheets apart, over the whole enclosure of a root.
struct Place {
  DoubleDoubleBall y, to_top, side;

  Place(const TeardropProfile& profile, const LocalRay& ray, const Root& root) {
    using T = DoubleDoubleBall;
    const T delta(DoubleDouble(root.x), root.radius);
    const std::array<T, 3> p = recentred_ball(ray);
    const auto coordinate = [&](std::size_t i, double d) { return p[i] + delta * T(d); };
    const T h = height_of<T>(profile);
    y = coordinate(1, ray.d.y);
    to_top = h - y;
    side = side_of(Constant<T>{{coordinate(0, ray.d.x)}}, Constant<T>{{y}},
                   Constant<T>{{coordinate(2, ray.d.z)}}, Constant<T>{{h}})
               .c[0];
  }

  /// A root with y < 0 is rounding: B^2 = 4 H y^3 (2H - y)^2 has none there.
  [[nodiscard]] bool is_mirrored() const { return is_negative(to_top) || is_positive(side); }
  [[nodiscard]] bool is_own() const {
    const bool below_top = is_positive(to_top) || to_top.is_exact_zero();
    return y.is_exact_zero() || (below_top && is_negative(side));
  }
  [[nodiscard]] bool may_be_bottom() const { return y.contains_zero(); }
  [[nodiscard]] bool may_be_apex() const { return to_top.contains_zero(); }
  /// What the middle says.
  [[nodiscard]] bool seems_own() const { return side.value().hi <= 0 && to_top.value().hi >= 0; }
};

/// Whether the line passes exactly through (0, height, 0): no rounding may decide on which sheet it leaves.
bool passes_through(const LocalRay& ray, const Dyadic& height) {
  const Dyadic x(ray.o.x), y = Dyadic(ray.o.y) - height, z(ray.o.z);
  const Dyadic dx(ray.d.x), dy(ray.d.y), dz(ray.d.z);
  return x * dy == y * dx && z * dy == y * dz && x * dz == z * dx;
}

/// Whether a line through the pole passes inside the body there: the bottom is flat, the apex a cone of slope
/// R' = -3/4.
bool passes_inside(const LocalRay& ray, bool at_apex) {
  const Dyadic x(ray.d.x), y(ray.d.y), z(ray.d.z);
  if (!at_apex) return !y.is_zero();
  return Dyadic(16.0) * (sqr(x) + sqr(z)) < Dyadic(9.0) * sqr(y);
}

enum class Verdict { own, mirrored, open };

Verdict verdict_on(const TeardropProfile& profile, const LocalRay& ray, const Root& root,
                   const Place& place) {
  if (place.is_mirrored()) return Verdict::mirrored;
  if (place.is_own()) return Verdict::own;
  // All sheets meet in a pole, and no other two points of them are one root.
  if (root.multiplicity > 1) {
    if (!root.certified) return Verdict::own;
    if (place.may_be_bottom() && passes_through(ray, Dyadic())) return Verdict::own;
    if (place.may_be_apex() && passes_through(ray, height_of<Dyadic>(profile))) return Verdict::own;
  }
  if (root.certified) return Verdict::open;
  return place.seems_own() ? Verdict::own : Verdict::mirrored;
}

constexpr std::string_view name_in(Basis basis) {
  return basis == Basis::power       ? "implicit_sextic"
         : basis == Basis::bernstein ? "implicit_sextic_bernstein"
                                     : "implicit_sextic_chebyshev";
}

constexpr std::string_view summary_in(Basis basis) {
  return basis == Basis::power
             ? "B^2 = 4 H y^3 (2H - y)^2 in l, recentred; mirrored sheets refused by the sign of B"
         : basis == Basis::bernstein
             ? "the implicit sextic in l, Bernstein basis on the ray's part of the bounds"
             : "the implicit sextic in l, Chebyshev basis on the ray's part of the bounds";
}

}  // namespace

template <Basis kBasis>
TeardropImplicitSextic<kBasis>::TeardropImplicitSextic(const Teardrop& surface) : profile(surface.profile) {}

template <Basis kBasis>
FormulationInfo TeardropImplicitSextic<kBasis>::info() {
  return {name_in(kBasis),
          summary_in(kBasis),
          "document 000, squared twice; coefficients in double-double",
          {Form::polynomial},
          6};
}

template <Basis kBasis>
void TeardropImplicitSextic<kBasis>::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!revolution::is_usable(ray)) return block.settle(Status::failed);
  double lo = 0, hi = 0;
  if (!roomy_range(profile, ray, lo, hi)) return;
  // The basis belongs to the interval, so that the interval is rounded first.
  if (block.precision() == Precision::binary32) {
    lo = static_cast<double>(detail::lower_end<float>(lo));
    hi = static_cast<double>(detail::upper_end<float>(hi));
  }
  if (!std::isfinite(lo) || !std::isfinite(hi)) return block.settle(Status::failed);
  const Balls balls = sextic_balls<kBasis>(profile, ray, line_part<DoubleDoubleBall>(ray, lo, hi));
  const std::size_t zeros = balls.zeros;
  const auto in_float = [&] {
    std::array<float, 7> c{};
    if (zeros > 0) {
      std::transform(balls.c.begin(), balls.c.end(), c.begin(),
                     [](const auto& x) { return static_cast<float>(static_cast<double>(x)); });
    } else {
      c = sextic_in_basis<kBasis, float>(profile, line_part<float>(ray, lo, hi));
      remove_binomials<kBasis, float>(c);
    }
    return c;
  };
  const auto exact = [this, where = &ray, lo, hi, zeros](std::span<Dyadic> to) {
    const std::vector<Dyadic> all = exact_sextic<kBasis>(profile, line_part<Dyadic>(*where, lo, hi), zeros);
    std::copy_n(all.begin(), to.size(), to.begin());
  };
  pose_in_basis(block, kBasis, {balls.c.data(), balls.size}, lo, hi, in_float, exact);
}

template <Basis kBasis>
void TeardropImplicitSextic<kBasis>::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                                          std::vector<LocalHit>& hits) const {
  const Place place(profile, ray, root);
  const Verdict verdict = verdict_on(profile, ray, root, place);
  if (verdict == Verdict::mirrored) return;
  LocalHit hit{.multiplicity = root.multiplicity,
               .delta = root.x,
               .t = profile.t_of_height(std::fma(root.x, ray.d.y, ray.p.y), 0),
               .is_root = true};
  if (root.multiplicity > 1 && (place.may_be_bottom() || place.may_be_apex()))
    hit.multiplicity = passes_inside(ray, place.may_be_apex()) ? 1 : 2;
  if (verdict == Verdict::open) {
    // A root of which nobody knows whether it is a hit at all: its enclosure says as much.
    hit.is_root = false;
    hit.error = std::numeric_limits<double>::infinity();
  }
  hits.push_back(hit);
}

template struct TeardropImplicitSextic<Basis::power>;
template struct TeardropImplicitSextic<Basis::bernstein>;
template struct TeardropImplicitSextic<Basis::chebyshev>;

}  // namespace graze
