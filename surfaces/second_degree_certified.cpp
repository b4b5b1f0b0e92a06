#include <graze/surfaces/second_degree_certified.hpp>

#include <algorithm>
#include <cmath>

#include <graze/solvers/certified.hpp>

namespace graze {
namespace {

using second_degree::Coefficient;
using second_degree::QuadraticForm;
using Shape = SecondDegreeSurface::Shape;

/// More than the roundings of a dozen operations: bounds made here are rounded up by it.
constexpr double kUp = 1 + 0x1p-40;

bool is_zero(const double (&v)[3]) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

/// The form's numbers, with the other sign where that makes M's diagonal positive.
void copy_numbers(const QuadraticForm& form, SecondDegreeSurface& to) {
  const auto& m = form.m;
  const double s = m[0][0].value() < 0 && m[1][1].value() < 0 && m[2][2].value() < 0 ? -1 : 1;
  const auto copy = [s](const Coefficient& from, double& head, double& tail) {
    const DoubleDouble wide = from.as<DoubleDouble>();
    head = s * wide.hi;
    tail = s * wide.lo;
  };
  const Coefficient* const entries[] = {&m[0][0], &m[1][1], &m[2][2], &m[0][1], &m[0][2], &m[1][2]};
  for (std::size_t i = 0; i < 6; ++i) copy(*entries[i], to.m[i], to.m_tail[i]);
  for (std::size_t i = 0; i < 3; ++i) copy(form.g[i], to.g[i], to.g_tail[i]);
  copy(form.j, to.j, to.j_tail);
}

Shape shape_of(const SecondDegreeSurface& s) {
  if (s.m[3] != 0 || s.m[4] != 0 || s.m[5] != 0) return Shape::full;
  const double least = std::min({s.m[0], s.m[1], s.m[2]});
  if (!is_zero(s.g)) return Shape::diagonal;
  // The length must be the largest semi-axis: of all but singular matrices it is known less well.
  const bool is_long = s.length * s.length * least >= -s.j * (1 - 0x1p-8);
  return least > 0 && s.j < 0 && is_long ? Shape::axial : Shape::central;
}

/// What bounds on roundings rest on.
void set_sizes(SecondDegreeSurface& s) {
  const auto row = [&](int i, int j, int k) {
    return std::fabs(s.m[i]) + std::fabs(s.m[j]) + std::fabs(s.m[k]);
  };
  s.norm = kUp * std::max({row(0, 3, 4), row(3, 1, 5), row(4, 5, 2)});
  const double g2 = s.g[0] * s.g[0] + s.g[1] * s.g[1] + s.g[2] * s.g[2];
  s.gradient = kUp * std::sqrt(g2);
  s.linear = g2 > 0 ? 2 : 1;
  s.constant = kUp * (std::fabs(s.j) + g2 / s.norm);
}

/// Roundings in the value of f (surfaces/quadric.md), with 1/16 of them for what is of second order.
void set_roundings(SecondDegreeSurface& s) {
  constexpr double kMargin = 1.0625;
  const auto is_rounded = [](double tail) { return tail != 0; };
  const bool is_inexact = std::any_of(std::begin(s.m_tail), std::end(s.m_tail), is_rounded) ||
                          std::any_of(std::begin(s.g_tail), std::end(s.g_tail), is_rounded);
  const double inexact = is_inexact ? 1 : 0, linear = s.gradient > 0 ? 1 : 0;
  if (s.shape == Shape::full) {
    s.of_slope = kMargin * (2 + linear);
    s.of_size = kMargin * (2 + inexact + linear * (2 + inexact));
  } else {
    s.of_slope = kMargin * (2 + linear + inexact);
    s.of_size = kMargin * (2 + 3 * inexact);
  }
}

}  // namespace

SecondDegreeCertified::SecondDegreeCertified(Vec3 centre, double radius, int unit, const Parameters& options)
    : set_(Certified::instruction_set(options)) {
  surface_.shape = Shape::sphere;
  surface_.j = -radius * radius;
  surface_.j_tail = -std::fma(radius, radius, surface_.j);
  surface_.constant = -surface_.j;
  surface_.length = radius;
  set_frame(centre, unit);
}

SecondDegreeCertified::SecondDegreeCertified(const QuadraticForm& form, double size, int unit,
                                             const Parameters& options)
    : set_(Certified::instruction_set(options)) {
  copy_numbers(form, surface_);
  set_sizes(surface_);
  // A cone about the origin and its like have no length of their own: none is used, so that scaling a scene
  // by a power of two changes no answer.
  surface_.length = surface_.constant > 0 ? scale_by_power(size, -unit) * (2 - kUp) : 0;
  surface_.shape = shape_of(surface_);
  set_roundings(surface_);
  set_frame(form.centre, unit);
}

/// Units and limits. A point at distance |m| of a centre off the origin is rounded by u^2 |m| beside what is
/// relative to itself: with |m| <= 2^40 sqrt(constant / norm) by no more than 2^-13 u of that length.
void SecondDegreeCertified::set_frame(Vec3 centre, int unit) {
  constexpr double kFarthest2 = 0x1p80;
  // Below, products of four such numbers and u could underflow.
  constexpr double kSmallest = 0x1p-120;
  SecondDegreeSurface& s = surface_;
  s.centre[0] = centre.x;
  s.centre[1] = centre.y;
  s.centre[2] = centre.z;
  const double length2 = s.constant / s.norm;
  const bool needs_length = s.shape == Shape::sphere || s.shape == Shape::axial || !is_zero(s.centre);
  s.farthest2 = needs_length ? kFarthest2 * length2 : std::numeric_limits<double>::infinity();
  is_usable_ = unit > -1022 && unit < 1022 && s.norm > kSmallest && std::isfinite(s.norm) &&
               std::isfinite(s.constant) && is_finite(centre) &&
               (!needs_length || (length2 > 1 / kFarthest2 && s.constant > kSmallest));
  if (!is_usable_) return;
  s.unit = power_of_two(unit);
  s.inverse_unit = power_of_two(-unit);
}

void SecondDegreeCertified::intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers,
                                      std::size_t first) const {
  if (rays.empty()) return;
  const SecondDegreeAnswers to{&answers.hits[first], &answers.l[0][first], &answers.l[1][first],
                               &answers.tier[first]};
  const SecondDegreeBatch batch{rays.data(), rays.size(), all};
  if (!is_usable_) {
    std::fill_n(to.hits, rays.size(), KernelAnswers::kOpen);
    return;
  }
#if defined(__x86_64__)
  if (set_ == InstructionSet::avx512) return avx512::intersect_second_degree(surface_, batch, to);
  if (set_ == InstructionSet::avx2) return avx2::intersect_second_degree(surface_, batch, to);
#endif
  baseline::intersect_second_degree(surface_, batch, to);
}

}  // namespace graze
