// What the tests of the formulas for cubics and quartics share: polynomials from their complex roots, and the
// two errors of computed roots, measured in long double.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <span>
#include <vector>

#include <graze/solvers/math/quadratic.hpp>
#include <graze/solvers/power_basis.hpp>

namespace graze::root_errors {

using Wide = std::complex<long double>;
using WideRoots = std::vector<Wide>;

/// Coefficients of prod (x - z), ascending.
inline std::vector<Wide> product_of(const WideRoots& z) {
  std::vector<Wide> c{1};
  for (const Wide& x : z) {
    c.insert(c.begin(), 0);
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= x * c[i + 1];
  }
  return c;
}

/// The same, rounded to T: roots off the axis come in pairs.
template <class T>
std::vector<T> coefficients_of(const WideRoots& z) {
  std::vector<T> c;
  for (const Wide& v : product_of(z)) c.push_back(static_cast<T>(v.real()));
  return c;
}

/// Max over i of |c_i - i-th coefficient of c_n prod (x - z)| in u of the sum of its terms' moduli.
template <class T>
double backward_error(const std::vector<T>& c, const WideRoots& z) {
  WideRoots moduli;
  for (const Wide& x : z) moduli.emplace_back(-std::abs(x));
  const std::vector<Wide> is = product_of(z), size = product_of(moduli);
  const auto leading = static_cast<long double>(c.back());
  long double worst = 0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const long double off = std::abs(is[i] * leading - static_cast<long double>(c[i]));
    if (off > 0) worst = std::max(worst, off / (size[i].real() * std::fabs(leading)));
  }
  return static_cast<double>(worst / static_cast<long double>(power_basis::kU<T>));
}

/// Largest |z - x| / |x| over the roots x, for the assignment that makes it least.
inline double relative_error(const WideRoots& z, const WideRoots& x) {
  std::vector<std::size_t> place(x.size());
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = i;
  long double best = std::numeric_limits<long double>::infinity();
  do {
    long double worst = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      worst = std::max(worst, std::abs(z[place[i]] - x[i]) / std::abs(x[i]));
    best = std::min(best, worst);
  } while (std::next_permutation(place.begin(), place.end()));
  return static_cast<double>(best);
}

/// What a relative change u of every coefficient makes of the roots relatively, to first order: the largest
/// sum |c_i x^i| / |x p'(x)| over the roots x.
inline double condition(const WideRoots& x) {
  const std::vector<Wide> c = product_of(x);
  long double worst = 0;
  for (const Wide& z : x) {
    Wide slope = 0;
    long double size = 0;
    for (std::size_t i = c.size(); i-- > 0;) {
      size = size * std::abs(z) + std::abs(c[i]);
      if (i > 0) slope = slope * z + static_cast<long double>(i) * c[i];
    }
    worst = std::max(worst, size / std::abs(z * slope));
  }
  return static_cast<double>(worst);
}

/// Roots by `solver(scaled coefficients, roots, steps)`, in the scale of c; empty where it fails.
template <class T, std::size_t N, class Solver>
WideRoots solve(const std::vector<T>& c, const Solver& solver, int* most_steps = nullptr) {
  std::array<T, N + 1> scaled{};
  const auto powers = power_basis::scale_coefficients<T>(c, scaled);
  std::array<ComplexRoot<T>, N> roots{};
  int steps = 0;
  if (!solver(scaled, roots, steps)) return {};
  if (most_steps != nullptr) *most_steps = std::max(*most_steps, steps);
  WideRoots wide;
  for (const auto& z : roots)
    wide.emplace_back(std::ldexp(static_cast<long double>(z.re), powers.shift),
                      std::ldexp(static_cast<long double>(z.im), powers.shift));
  return wide;
}

}  // namespace graze::root_errors
