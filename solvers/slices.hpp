// What the slice solvers share: random starts, acceptance of a converged point, clustering of equal roots.
// A method brings the local iteration from one start; document 003 suggests about 30 starts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/roots.hpp>

namespace graze::slices {

/// Unit roundoff.
template <class T>
inline constexpr T kU = std::numeric_limits<T>::epsilon() / 2;
/// A point is a root if its residual is no larger than the rounding of about this many operations on terms of
/// the equation's own size: scale-free, for the size comes with the equation.
inline constexpr int kNoise = 32;
inline constexpr int kDefaultTries = 30;  ///< document 003: "about 30 random heights suffice"

/// Solves M z = b for n <= 3 by Gaussian elimination with partial pivoting; false if M is singular.
template <class T>
bool solve_linear(BasicMatrix<T> m, BasicVector<T> b, int n, BasicVector<T>& z) {
  const auto size = static_cast<std::size_t>(n);
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size; ++i) {
      if (std::fabs(m[i][k]) > std::fabs(m[pivot][k])) pivot = i;
    }
    if (!(std::fabs(m[pivot][k]) > 0)) return false;
    std::swap(m[k], m[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < size; ++i) {
      const T factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < size; ++j) m[i][j] -= factor * m[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    T sum = b[k];
    for (std::size_t j = k + 1; j < size; ++j) sum -= m[k][j] * z[j];
    z[k] = sum / m[k][k];
  }
  return true;
}

/// max |f_i|.
template <class T>
T max_norm(const BasicVector<T>& f, int n) {
  T size = 0;
  for (int i = 0; i < n; ++i) size = std::max(size, std::fabs(f[static_cast<std::size_t>(i)]));
  return size;
}

/// What a residual of size `noise` leaves open about x[0]: noise times the first row of |J^-1|, but no more
/// than sqrt(noise * scale), the width of a touching root whose curvature is of the equation's own size.
/// Beyond that width the root counts as touching.
template <class T>
Root root_of_system(const BasicSystemEquation<T>& equation, const BasicVector<T>& x,
                    const BasicMatrix<T>& jacobian) {
  const T noise = kNoise * kU<T> * equation.residual_scale;
  const T touching_width = std::sqrt(noise * equation.residual_scale);
  T row = 0;
  for (int k = 0; k < equation.unknowns; ++k) {
    BasicVector<T> unit{};
    unit[static_cast<std::size_t>(k)] = 1;
    BasicVector<T> column{};
    const bool solved = solve_linear(jacobian, unit, equation.unknowns, column);
    row += solved ? std::fabs(column[0]) : std::numeric_limits<T>::infinity();
  }
  const bool touching = !(row * noise <= touching_width);
  return found_root(x[0], touching ? touching_width : row * noise, touching ? 2U : 1U, {x[1], x[2]});
}

/// Is the residual at x no more than rounding?
template <class T>
bool is_root(const BasicSystemEquation<T>& equation, const BasicVector<T>& f) {
  return max_norm(f, equation.unknowns) <= kNoise * kU<T> * equation.residual_scale;
}
/// What |f| may be at a number next to a root: the rounding of f, and what the spacing of x itself leaves.
template <class T>
T noise(T x, const BasicJet<T>& jet) {
  return 4 * (jet.f_error + kU<T> * std::fabs(x * jet.df));
}
template <class T>
bool is_root(T x, const BasicJet<T>& jet) {
  return std::fabs(jet.f) <= noise(x, jet);
}

/// The root at a converged x of a scalar equation. It touches where f' is too small to tell two roots apart:
/// f'^2 <= 2 |f''| noise, when the parabola through the point has its roots within noise of each other.
template <class T>
Root root_of_scalar(T x, const BasicJet<T>& jet) {
  const T open = noise(x, jet);
  const bool touching = jet.df * jet.df <= 2 * std::fabs(jet.ddf) * open;
  const T radius = touching ? 2 * std::sqrt(2 * open / std::fabs(jet.ddf)) : 2 * open / std::fabs(jet.df);
  return found_root(x, radius, touching ? 2U : 1U);
}

/// Adds a root unless it is one already found: |x - y| <= r_x + r_y. The sharper of two equals stays.
inline void add_distinct(Roots& roots, const Root& found) {
  for (Root& known : roots.list) {
    if (std::fabs(known.x - found.x) > known.radius + found.radius) continue;
    if (found.multiplicity > known.multiplicity || found.radius < known.radius) {
      const std::uint32_t multiplicity = std::max(known.multiplicity, found.multiplicity);
      if (found.radius <= known.radius) known = found;
      known.multiplicity = multiplicity;
    }
    return;
  }
  roots.list.push_back(found);
}

/// Starts `tries` times (T: float or double) from `start(rng)`, iterates by `local`, and collects the
/// distinct roots in ascending order. Ends early when max_roots are found. `local(x, root)` returns whether
/// it converged to a root.
template <class T, class Start, class Local>
void search(std::uint64_t seed, int tries, int max_roots, Roots& roots, const Start& start,
            const Local& local) {
  Rng rng(seed);
  for (int i = 0; i < tries; ++i) {
    BasicVector<T> x{};
    ++roots.counters.starts;
    Root root;
    if (start(rng, x) && local(x, root)) add_distinct(roots, root);
    if (max_roots > 0 && roots.list.size() >= static_cast<std::size_t>(max_roots)) break;
  }
  std::sort(roots.list.begin(), roots.list.end(), [](const Root& a, const Root& b) { return a.x < b.x; });
}

/// Keeps every unknown within its bounds.
inline void clamp(const SystemEquation& equation, Vector& x) {
  for (int i = 0; i < equation.unknowns; ++i) {
    const auto k = static_cast<std::size_t>(i);
    x[k] = std::clamp(x[k], equation.lo[k], equation.hi[k]);
  }
}

/// A step from x that would leave [lo, hi] goes half the way to the bound instead: the end itself may be
/// singular (a pole, where theta has no meaning), and half steps reach it as well if the root is there.
template <class T>
T step_inside(T x, T step, T lo, T hi) {
  const T next = x + step;
  if (next < lo) return (x + lo) / 2;
  if (next > hi) return (x + hi) / 2;
  return next;
}

}  // namespace graze::slices
