// Exact coefficients of rays against surfaces of second degree, for builds with a solver that ends in
// integers.
#include <algorithm>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/second_degree.hpp>
#include <graze/surfaces/sphere.hpp>

namespace graze::second_degree {
namespace {

/// C, B and A.
template <class Form>
Triple<Dyadic> exactly_along(const Form& form, const LocalRay& ray) {
  return form.along(point_on<Dyadic>(ray), direction_of<Dyadic>(ray));
}

/// C, 2 B and A times the power of two that makes the largest of them less than 1.
std::array<Dyadic, 3> brought_into_range(const Triple<Dyadic>& q) {
  std::array<Dyadic, 3> c{q[0], Dyadic(2.0) * q[1], q[2]};
  long highest = std::numeric_limits<long>::min();
  for (const Dyadic& x : c) {
    if (!x.is_zero()) highest = std::max(highest, x.top_exponent());
  }
  for (Dyadic& x : c) x = scale_by_power(x, -highest - 1);
  return c;
}

/// No real root, or none ahead of the ray's origin: Descartes' rule of signs.
bool has_no_hit(const Triple<Dyadic>& q, double centre) {
  if ((q[1] * q[1] - q[0] * q[2]).sign() < 0) return true;
  const auto has_sign = [&](int sign) {
    return std::any_of(q.begin(), q.end(), [sign](const Dyadic& x) { return x.sign() == sign; });
  };
  return centre == 0 && !(has_sign(1) && has_sign(-1));
}

/// Whether a root ahead of the origin may be beyond double in local units, by Fujiwara's bound: it would be
/// lost. Where B and A have one sign the root ahead is the smaller one, less than sqrt|C/A| and |C/2B|.
bool may_overflow(std::span<const Dyadic> c, double centre) {
  constexpr long kHighest = 1020;
  const long degree = static_cast<long>(c.size()) - 1;
  const auto is_beyond = [&](std::size_t i, std::size_t k) {
    if (c[i].is_zero()) return false;
    return c[i].top_exponent() - c[k].top_exponent() > kHighest * static_cast<long>(k - i);
  };
  if (centre == 0 && degree == 2 && c[1].sign() * c[2].sign() > 0) return is_beyond(0, 1) && is_beyond(0, 2);
  return is_beyond(0, c.size() - 1) || (degree == 2 && is_beyond(1, 2));
}

/// Exponents that bound those of the roots that are not zero; none where low > high.
struct RootExponents {
  long low = 1, high = -1;
};

/// Newton's polygon: neighbouring coefficients c_i, c_k that are not zero have roots about (c_i/c_k)^(1/(k -
/// i)). Two more for the sums of three terms, and for rounding the exponents.
RootExponents exponents_of_roots(const Triple<Dyadic>& q) {
  constexpr long kRoom = 4;
  RootExponents found;
  bool is_first = true;
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (std::size_t k = i + 1; k < q.size(); ++k) {
      if (q[i].is_zero() || q[k].is_zero()) continue;
      const long exponent = (q[i].top_exponent() - q[k].top_exponent()) / static_cast<long>(k - i);
      const RootExponents one{exponent - kRoom, exponent + kRoom};
      found = is_first ? one : RootExponents{std::min(found.low, one.low), std::max(found.high, one.high)};
      is_first = false;
    }
  }
  return found;
}

Interval enclosure_of(const Dyadic& x) { return {x.round_down(), x.round_up()}; }

}  // namespace

template <class Form>
ExactCoefficients exact_coefficients(EquationBlock& block, const Form& form, const LocalRay& ray,
                                     Slice slice) {
  return exact_by(block, ray.centre, [self = &form, where = &ray, slice](std::span<Dyadic> to) {
    const Triple<Dyadic> q = exactly_along(*self, *where);
    for (std::size_t i = 0; i < to.size(); ++i) {
      const std::size_t power = i + slice.first;
      to[i] = power == 1 ? Dyadic(slice.factor) * q[1] : q[power];
    }
  });
}

template <class Form>
void keep_in_range(const Form& form, LocalRay& ray) {
  constexpr long kMost = 1000;  // exponents that leave room for the bounds of roots
  if (!is_finite(ray.world.o)) return;
  const RootExponents roots = exponents_of_roots(exactly_along(form, ray));
  // As far as it takes, if that leaves the others where they are numbers.
  const bool is_high = roots.high > kMost && roots.low - (roots.high - kMost) >= -kMost;
  const bool is_low = roots.low < -kMost && roots.high - (roots.low + kMost) <= kMost;
  if (is_high) measure_l(ray, static_cast<int>(roots.high - kMost));
  if (is_low) measure_l(ray, static_cast<int>(roots.low + kMost));
}

template <class Form>
bool pose_beyond_range(EquationBlock& block, const Form& form, const LocalRay& ray) {
  const bool is_asked = block.form() == graze::Form::polynomial && block.precision() == Precision::binary64 &&
                        block.wants_coefficient_errors();
  if (!is_asked || !std::isfinite(ray.centre)) return false;
  const Triple<Dyadic> q = exactly_along(form, ray);
  std::size_t first = 0, size = 3;
  while (size > 0 && q[size - 1].is_zero()) --size;
  if (size == 0) {
    block.settle(Status::coincident);
    return true;
  }
  // Roots at the ray's origin are no hits.
  while (ray.centre == 0 && q[first].is_zero()) ++first;
  if (has_no_hit(q, ray.centre)) return true;
  const std::array<Dyadic, 3> c = brought_into_range(q);
  const std::span<const Dyadic> own = std::span(c).subspan(first, size - first);
  if (own.size() < 2) return true;
  if (may_overflow(own, ray.centre)) {
    block.settle(Status::uncertain);
    return true;
  }
  const std::span<Interval> enclosures = block.arena().array<Interval>(own.size());
  std::transform(own.begin(), own.end(), enclosures.begin(), enclosure_of);
  detail::pose_stored(block, kSimple, Basis::power, -ray.centre, std::numeric_limits<double>::infinity(),
                      sharp_epsilons(block.arena(), 1, 0),
                      detail::store_coefficients(block.arena(), std::span<const Interval>(enclosures)),
                      exact_coefficients(block, form, ray, {first, 2}));
  return true;
}

template ExactCoefficients exact_coefficients(EquationBlock&, const SphereForm&, const LocalRay&, Slice);
template ExactCoefficients exact_coefficients(EquationBlock&, const QuadraticForm&, const LocalRay&, Slice);
template void keep_in_range(const SphereForm&, LocalRay&);
template void keep_in_range(const QuadraticForm&, LocalRay&);
template bool pose_beyond_range(EquationBlock&, const SphereForm&, const LocalRay&);
template bool pose_beyond_range(EquationBlock&, const QuadraticForm&, const LocalRay&);

}  // namespace graze::second_degree
