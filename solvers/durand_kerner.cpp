#include <graze/solvers/durand_kerner.hpp>

#include <cstdint>
#include <stdexcept>
#include <string>

#include <graze/solvers/math/complex_roots.hpp>

namespace graze {
namespace {

using complex_roots::Complex;
using power_basis::Coefficients;

/// Fujiwara's bound on all roots' magnitudes, 2 max |c_{n-k} / c_n|^(1/k), the last ratio halved.
template <class T>
T root_bound(Coefficients<T> c) {
  const std::size_t n = c.size() - 1;
  T largest = 0;
  for (std::size_t k = 1; k <= n; ++k) {
    if (c[n - k] == 0) continue;
    const T height = std::log2(std::fabs(c[n - k])) - std::log2(std::fabs(c[n])) - (k == n ? T{1} : T{0});
    largest = std::max(largest, std::exp2(height / static_cast<T>(k)));
  }
  return 2 * largest;
}

/// n points on the circle about the roots' mean, -c_{n-1} / (n c_n), as wide as any root can lie from 0;
/// turned off the axis.
template <class T>
void circle_points(Coefficients<T> c, std::span<Complex<T>> z) {
  const std::size_t n = c.size() - 1;
  const T degree = static_cast<T>(n);
  const T centre = -(c[n - 1] / c[n]) / degree;
  const T radius = root_bound(c);
  for (std::size_t k = 0; k < n; ++k) {
    const T angle = 2 * std::numbers::pi_v<T> * static_cast<T>(k) / degree +
                    static_cast<T>(complex_roots::kPhase) / degree;
    z[k] = {centre + radius * std::cos(angle), radius * std::sin(angle)};
  }
}

/// One step of z[i] in place; true: it has come to rest, |p| below its rounding or the step below u |z|.
template <class T>
bool step(Coefficients<T> c, std::span<Complex<T>> z, std::size_t i) {
  const auto p = complex_roots::evaluate_scaled(c, z[i]);
  if (complex_roots::magnitude(p.value) <= p.error) return true;
  const Complex<T> correction = complex_roots::weierstrass<T>(c, z, i, p.value, p.reversed);
  if (!complex_roots::is_finite(correction)) return false;
  z[i] -= correction;
  return complex_roots::magnitude(correction) <= power_basis::kU<T> * complex_roots::magnitude(z[i]);
}

}  // namespace

SolverInfo DurandKerner::info() {
  SolverInfo info;
  info.summary = "all complex roots at once, Weierstrass's iteration, real ones by inclusion discs";
  info.source = "Durand (1960); Kerner, Numer. Math. 8 (1966)";
  info.page = "solvers/durand_kerner.md";
  info.options = {{"start", "circle", "start values: circle, or polygon (Newton polygon, as aberth)"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

DurandKerner::DurandKerner(const Parameters& options) {
  const std::string start = options.word("start", "circle");
  if (start != "circle" && start != "polygon") {
    throw std::invalid_argument("durand_kerner: start is circle or polygon, not " + start);
  }
  from_polygon_ = start == "polygon";
}

template <class T>
void DurandKerner::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  complex_roots::solve_scaled(equation, roots, [this](const power_basis::Problem<T>& problem, Roots& found) {
    power_basis::Scratch<Complex<T>> memory(static_cast<std::size_t>(problem.degree()));
    const std::span<Complex<T>> z = memory.span();
    if (from_polygon_) {
      complex_roots::newton_polygon_points(problem.c, z);
    } else {
      circle_points(problem.c, z);
    }
    const bool rests = complex_roots::sweep_to_rest(z.size(), sweeps(problem.degree()), found.counters,
                                                    [&](std::size_t i) { return step(problem.c, z, i); });
    if (!rests) found.status = Status::failed;
    complex_roots::add_real_ones(problem, z, found);
  });
}

template void DurandKerner::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void DurandKerner::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
