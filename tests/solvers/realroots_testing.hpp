// What the tests of the methods that isolate real roots share: solving, random polynomials, exact scaling.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/parameters.hpp>
#include <graze/solvers/roots.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze::realroots {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All real roots, or those of [lo, hi].
template <class S, class T = double>
Roots solve(const S& solver, const std::vector<T>& c, double lo = -kInfinity, double hi = kInfinity,
            Basis basis = Basis::power) {
  BasicPolynomialEquation<T> equation;
  equation.c = c;
  equation.basis = basis;
  equation.lo = static_cast<T>(lo);
  equation.hi = static_cast<T>(hi);
  Roots roots;
  solver.solve(equation, roots);
  return roots;
}

/// A relative change of n u of every coefficient moves the simple root x by so much.
inline double condition_unit(const std::vector<double>& c, double x) {
  const WideValue p = evaluate_wide(c, static_cast<long double>(x));
  return static_cast<double>(c.size() - 1) * 0x1p-53 * static_cast<double>(p.size / std::fabs(p.derivative));
}

/// Largest error of an answer in condition units; infinite where it has another number of roots.
inline double worst_error(const HardPolynomial& p, const Roots& roots) {
  if (roots.list.size() != p.roots.size()) return kInfinity;
  double worst = 0;
  for (std::size_t i = 0; i < p.roots.size(); ++i) {
    const double x = p.roots[i];
    // The stored root itself is rounded to a double.
    const double unit = condition_unit(p.c, x) + 0x1p-53 * std::fabs(x);
    worst = std::max(worst, std::fabs(roots.list[i].x - x) / unit);
  }
  return worst;
}

inline std::size_t multiplicities(const Roots& roots) {
  std::size_t sum = 0;
  for (const Root& root : roots.list) sum += root.multiplicity;
  return sum;
}

inline std::vector<double> random_coefficients(Rng& rng, int degree, double lo = -1) {
  std::vector<double> c;
  for (int k = 0; k <= degree; ++k) c.push_back(rng.uniform(lo, 1));
  return c;
}

inline int sign_changes_on_a_grid(const std::vector<double>& c, double lo, double hi, int cells) {
  const auto value = [&](double x) { return evaluate_wide(c, static_cast<long double>(x)).value; };
  int count = 0;
  for (int i = 0; i < cells; ++i) {
    const double a = lo + (hi - lo) * i / cells, b = lo + (hi - lo) * (i + 1) / cells;
    count += (value(a) < 0) != (value(b) < 0) ? 1 : 0;
  }
  return count;
}

/// The same answer bit for bit for p 2^k, and x 2^-m with c_i 2^(i m).
template <class S>
bool scales_exactly(const S& solver, const std::vector<double>& c, int k, int m) {
  std::vector<double> scaled;
  for (std::size_t i = 0; i < c.size(); ++i) scaled.push_back(std::ldexp(c[i], k + static_cast<int>(i) * m));
  const Roots plain = solve(solver, c), other = solve(solver, scaled);
  if (plain.list.size() != other.list.size() || plain.status != other.status) return false;
  for (std::size_t i = 0; i < plain.list.size(); ++i)
    if (std::ldexp(other.list[i].x, m) != plain.list[i].x) return false;
  return true;
}

}  // namespace graze::realroots
