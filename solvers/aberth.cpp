#include <graze/solvers/aberth.hpp>

#include <graze/solvers/math/complex_roots.hpp>

namespace graze {
namespace {

using complex_roots::Complex;
using power_basis::Coefficients;

/// sum 1 / (z_i - z_j) over the other approximations; one that coincides repels no more.
template <class T>
Complex<T> repulsion(std::span<const Complex<T>> z, std::size_t i) {
  Complex<T> sum{};
  for (std::size_t j = 0; j < z.size(); ++j) {
    if (z[j] != z[i]) sum += complex_roots::quotient(Complex<T>{1, 0}, z[i] - z[j]);
  }
  return sum;
}

/// One step of z[i] in place; true: it has come to rest, |p| below its rounding or the step below u |z|.
template <class T>
bool step(Coefficients<T> c, std::span<Complex<T>> z, std::size_t i) {
  const auto p = complex_roots::evaluate_scaled(c, z[i]);
  if (complex_roots::magnitude(p.value) <= p.error) return true;
  const Complex<T> slope = p.derivative - complex_roots::product(p.value, repulsion<T>(z, i));
  const Complex<T> correction = complex_roots::quotient(p.value, slope);
  if (!complex_roots::is_finite(correction)) return false;  // stationary: the others will move on
  z[i] -= correction;
  return complex_roots::magnitude(correction) <= power_basis::kU<T> * complex_roots::magnitude(z[i]);
}

}  // namespace

SolverInfo Aberth::info() {
  SolverInfo info;
  info.summary = "all complex roots at once, Ehrlich-Aberth, real ones by inclusion discs";
  info.source = "Aberth, Math. Comp. 27 (1973); Bini, Numer. Algorithms 13 (1996)";
  info.page = "solvers/aberth.md";
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Aberth::Aberth(const Parameters& /*options*/) {}

template <class T>
void Aberth::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  complex_roots::solve_scaled(equation, roots, [](const power_basis::Problem<T>& problem, Roots& found) {
    power_basis::Scratch<Complex<T>> memory(static_cast<std::size_t>(problem.degree()));
    const std::span<Complex<T>> z = memory.span();
    complex_roots::newton_polygon_points(problem.c, z);
    const bool rests = complex_roots::sweep_to_rest(z.size(), kSweeps, found.counters,
                                                    [&](std::size_t i) { return step(problem.c, z, i); });
    if (!rests) found.status = Status::failed;
    complex_roots::add_real_ones(problem, z, found);
  });
}

template void Aberth::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Aberth::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
