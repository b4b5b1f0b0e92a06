#include <graze/solvers/closed_form.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/cubic.hpp>
#include <graze/solvers/math/quadratic.hpp>
#include <graze/solvers/math/quartic.hpp>
#include <graze/solvers/power_basis.hpp>

namespace graze {
namespace {

constexpr std::size_t kMostCoefficients = 5;
template <class T>
using FiveCoefficients = std::array<T, kMostCoefficients>;

/// What errors of the coefficients leave open about a simple root: sum e_i |x|^i / |p'(x)|.
template <class T>
T data_error(std::span<const T> c, std::span<const T> c_error, T x) {
  if (c_error.empty()) return 0;
  T sum = 0, slope = 0;
  for (std::size_t i = c.size(); i-- > 0;) {
    sum = sum * std::fabs(x) + c_error[i];
    if (i > 0) slope = slope * x + static_cast<T>(i) * c[i];
  }
  return sum / std::fabs(slope);
}

/// Degree 1 or 2, without leading zeros.
template <class T>
void solve_quadratic(std::span<const T> c, std::span<const T> c_error, T lo, T hi, Roots& roots) {
  std::array<T, 2> x{};
  int count = 0;
  ++roots.counters.evaluations;  // of the formula
  if (c.size() == 2) {
    x[0] = -c[0] / c[1];
    count = 1;
  } else if (c.size() == 3) {
    count = scaled_quadratic(c[2], c[1] / 2, c[0], x);
  }
  const bool is_double = c.size() == 3 && count == 1;
  for (int i = 0; i < count; ++i) {
    const T root = x[static_cast<std::size_t>(i)];
    if (!(lo <= root && root <= hi) || !std::isfinite(root)) continue;
    const T rounding =
        static_cast<T>(ClosedForm::kError) * std::numeric_limits<T>::epsilon() * std::fabs(root);
    const T radius = rounding + (is_double ? T{0} : data_error(c, c_error, root));
    roots.list.push_back(found_root(root, radius, is_double ? 2U : 1U));
  }
}

/// Appends the real roots of a polynomial of degree 3 or 4 whose coefficients are scaled and not zero at
/// either end.
template <class T>
void solve_scaled(const power_basis::Problem<T>& problem, Roots& roots) {
  const auto append = [&](bool solved, const auto& approximations) {
    if (!solved) roots.status = Status::failed;
    if (!solved) return;
    for (const ComplexRoot<T>& z : approximations)
      power_basis::add_if_real(problem, {z.re, z.im}, /*polish=*/false, roots);
  };
  int steps = 0;
  const auto& c = problem.c;
  if (problem.degree() == 3) {
    std::array<ComplexRoot<T>, 3> found;
    append(cubic_roots<T>({c[0], c[1], c[2], c[3]}, found, steps), found);
  } else {
    std::array<ComplexRoot<T>, 4> found;
    append(quartic_roots<T>({c[0], c[1], c[2], c[3], c[4]}, found, steps), found);
  }
  roots.counters.iterations += static_cast<std::uint32_t>(steps);
  ++roots.counters.evaluations;  // of the formula
  power_basis::sort_and_merge(problem, roots);
}

/// Degree 3 or 4, neither end zero: by a polynomial of scaled coefficients and unknown.
template <class T>
void solve_higher(std::span<const T> c, std::span<const T> c_error, T lo, T hi, Roots& roots) {
  FiveCoefficients<T> scaled{}, scaled_error{};
  const std::span<T> c_scaled{scaled.data(), c.size()}, error_scaled{scaled_error.data(), c_error.size()};
  const power_basis::PowersOfTwo powers = power_basis::scale_coefficients(c, c_scaled);
  for (std::size_t i = 0; i < c_error.size(); ++i)
    error_scaled[i] = std::ldexp(c_error[i], static_cast<int>(i) * powers.shift - powers.power);
  solve_scaled<T>({c_scaled, error_scaled, std::ldexp(lo, -powers.shift), std::ldexp(hi, -powers.shift)},
                  roots);
  for (Root& root : roots.list) {
    const T x = std::ldexp(static_cast<T>(root.x), powers.shift);
    root.x = static_cast<double>(std::clamp(x, lo, hi));
    root.radius = std::ldexp(root.radius, powers.shift);
  }
}

/// k trailing zeros of a cubic or quartic are the root 0 of multiplicity k; what is left is solved by itself.
template <class T>
void solve_with_zeros(std::span<const T> c, std::span<const T> c_error, T lo, T hi, Roots& roots) {
  std::size_t zeros = 0;
  while (c[zeros] == 0) ++zeros;
  const auto cut = [zeros](std::span<const T> v) { return v.empty() ? v : v.subspan(zeros); };
  const std::span<const T> rest = cut(c), rest_error = cut(c_error);
  if (rest.size() > 3) {
    solve_higher(rest, rest_error, lo, hi, roots);
  } else if (rest.size() > 1) {
    solve_quadratic(rest, rest_error, lo, hi, roots);
  }
  if (zeros == 0 || !(lo <= 0 && 0 <= hi)) return;
  // A root that underflowed to zero is the same one.
  const auto place =
      std::find_if(roots.list.begin(), roots.list.end(), [](const Root& r) { return r.x >= 0; });
  if (place != roots.list.end() && place->x == 0) {
    place->multiplicity += static_cast<std::uint32_t>(zeros);
  } else {
    roots.list.insert(place, {.x = 0, .others = {}, .multiplicity = static_cast<std::uint32_t>(zeros)});
  }
}

template <class T>
void solve_power(std::span<const T> c, std::span<const T> c_error, T lo, T hi, Roots& roots) {
  while (!c.empty() && c.back() == 0) c = c.first(c.size() - 1);
  if (!c_error.empty()) c_error = c_error.first(c.size());
  if (c.empty()) {
    roots.status = Status::coincident;
  } else if (c.size() > kMostCoefficients) {
    roots.status = Status::failed;
  } else if (c.size() > 3) {
    solve_with_zeros(c, c_error, lo, hi, roots);
  } else {
    solve_quadratic(c, c_error, lo, hi, roots);
  }
}

/// Power coefficients on [0, 1] of a cubic or quartic in Bernstein form, changed in double, with bounds on
/// their errors.
template <class T>
void solve_higher_bernstein(std::span<const T> b, std::span<const T> b_error, Roots& roots) {
  FiveCoefficients<double> from{}, from_error{}, to{}, to_error{};
  const auto wide = [](T x) { return static_cast<double>(x); };
  std::transform(b.begin(), b.end(), from.begin(), wide);
  std::transform(b_error.begin(), b_error.end(), from_error.begin(), wide);
  const auto used = [&](auto& v) { return std::span(v).first(b.size()); };
  bernstein_to_power(used(from), std::span<const double>(from_error).first(b_error.size()), used(to),
                     used(to_error));
  FiveCoefficients<T> c{}, c_error{};
  for (std::size_t i = 0; i < b.size(); ++i) {
    c[i] = static_cast<T>(to[i]);
    c_error[i] = static_cast<T>(to_error[i] + std::fabs(static_cast<double>(c[i]) - to[i]));
  }
  solve_power<T>(used(c), used(c_error), 0, 1, roots);
}

/// Chebyshev on [lo, hi]: power basis on [-1, 1], changed in double, then back.
template <class T>
void solve_chebyshev(const BasicPolynomialEquation<T>& equation, Roots& roots) {
  std::size_t size = equation.c.size();
  while (size > 1 && equation.c[size - 1] == 0) --size;
  if (size > kMostCoefficients) {
    roots.status = Status::failed;
    return;
  }
  std::array<double, kMostCoefficients> c{}, power{}, error{};
  std::transform(equation.c.begin(), equation.c.begin() + static_cast<std::ptrdiff_t>(size), c.begin(),
                 [](T x) { return static_cast<double>(x); });
  chebyshev_to_power({c.data(), size}, {}, {power.data(), size}, {error.data(), size});
  FiveCoefficients<T> rounded{};
  std::transform(power.begin(), power.end(), rounded.begin(), [](double v) { return static_cast<T>(v); });
  solve_power<T>({rounded.data(), size}, {}, T{-1}, T{1}, roots);
  power_basis::detail::bring_back(equation, -1, roots);
}

}  // namespace

SolverInfo ClosedForm::info() {
  SolverInfo info;
  info.summary = "formulas for degrees up to 4 without cancellation";
  info.source = "Kahan 1986, 2004; Orellana, De Michele, ACM TOMS 46(2), 2020 (Algorithm 1010)";
  info.page = "solvers/closed_form.md";
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  info.max_degree = 4;
  return info;
}

ClosedForm::ClosedForm(const Parameters& /*options*/) {}

template <class T>
void ClosedForm::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
    return;
  }
  if (equation.basis == Basis::power) {
    return solve_power(equation.c, equation.c_error, equation.lo, equation.hi, roots);
  }
  if (equation.basis == Basis::chebyshev) return solve_chebyshev(equation, roots);
  // Bernstein on [lo, hi]: power basis in s = (x - lo) / (hi - lo), then back.
  std::span<const T> b = equation.c;
  // A constant of any nominal degree.
  if (std::adjacent_find(b.begin(), b.end(), std::not_equal_to<>()) == b.end()) b = b.first(1);
  if (b.size() > kMostCoefficients) {
    roots.status = Status::failed;
    return;
  }
  if (b.size() > 3) {
    solve_higher_bernstein(b, equation.c_error, roots);
  } else {
    std::array<T, 3> c{};
    if (b.size() == 1) c = {b[0], 0, 0};
    if (b.size() == 2) c = {b[0], b[1] - b[0], 0};
    if (b.size() == 3) c = {b[0], 2 * (b[1] - b[0]), (b[0] - b[1]) + (b[2] - b[1])};
    solve_power<T>(c, {}, 0, 1, roots);
  }
  power_basis::detail::bring_back(equation, 0, roots);
}

template void ClosedForm::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void ClosedForm::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
