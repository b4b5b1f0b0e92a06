#include <graze/solvers/closed_form.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace graze {
namespace {

/// a b - c d with a relative error of at most 2u (Kahan), if nothing under- or overflows.
template <class T>
T difference_of_products(T a, T b, T c, T d) {
  const T cd = c * d;
  const T error = std::fma(-c, d, cd);
  return std::fma(a, b, -cd) + error;
}

/// The exponent of x: |x| = 2^k m, 1 <= m < 2; a very small one for zero.
template <class T>
int exponent(T x) {
  return x == 0 ? -4 * std::numeric_limits<T>::max_exponent : std::ilogb(x);
}

/// Roots of a x^2 + 2 b x + c, a != 0, ascending; the count is returned: 0, 1 (double root) or 2.
template <class T>
int quadratic(T a, T b, T c, std::array<T, 2>& x) {
  const T discriminant = difference_of_products(b, b, a, c);
  if (discriminant < 0) return 0;
  if (discriminant == 0) {
    x[0] = -b / a;
    return 1;
  }
  // The larger root by addition of equal signs, the smaller one from the product of both.
  const T q = -(b + std::copysign(std::sqrt(discriminant), b));
  x = {q / a, c / q};
  if (x[1] < x[0]) std::swap(x[0], x[1]);
  return 2;
}

/// The same with powers of two taken out first, so that no product leaves the range: x = 2^m y with |a| and
/// |c| alike, then the largest of |a|, |b|, |c| near 1. Exact, short of parts 2^-1000 below the largest.
template <class T>
int scaled_quadratic(T a, T b, T c, std::array<T, 2>& x) {
  if (b == 0 && c == 0) return 1;  // x = 0, twice
  const int m = c == 0 ? exponent(b) - exponent(a) : (exponent(c) - exponent(a)) / 2;
  const int largest = std::max({exponent(a) + 2 * m, exponent(b) + m, exponent(c)});
  const auto scaled = [](T v, int k) { return v == 0 ? v : std::ldexp(v, k); };
  const int count = quadratic(scaled(a, 2 * m - largest), scaled(b, m - largest), scaled(c, -largest), x);
  for (T& root : x) root = std::ldexp(root, m);
  return count;
}

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

template <class T>
void solve_power(std::span<const T> c, std::span<const T> c_error, T lo, T hi, Roots& roots) {
  while (!c.empty() && c.back() == 0) c = c.first(c.size() - 1);
  if (c.empty()) {
    roots.status = Status::coincident;
    return;
  }
  if (c.size() > 3) {
    roots.status = Status::failed;
    return;
  }
  std::array<T, 2> x{};
  int count = 0;
  roots.counters.evaluations = 1;  // of the formula
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

}  // namespace

SolverInfo ClosedForm::info() {
  SolverInfo info;
  info.summary = "the quadratic formula without cancellation";
  info.source = "Kahan 2004; Jeannerod, Louvet, Muller, Math. Comp. 82 (2013)";
  info.page = "solvers/closed_form.md";
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  info.max_degree = 2;
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
  // Bernstein on [lo, hi]: power basis in s = (x - lo) / (hi - lo), then back.
  std::span<const T> b = equation.c;
  // A constant of any nominal degree.
  if (std::adjacent_find(b.begin(), b.end(), std::not_equal_to<>()) == b.end()) b = b.first(1);
  std::array<T, 3> c{};
  if (b.size() > c.size()) {
    roots.status = Status::failed;
    return;
  }
  if (b.size() == 1) c = {b[0], 0, 0};
  if (b.size() == 2) c = {b[0], b[1] - b[0], 0};
  if (b.size() == 3) c = {b[0], 2 * (b[1] - b[0]), (b[0] - b[1]) + (b[2] - b[1])};
  solve_power<T>(c, {}, 0, 1, roots);
  const auto lo = static_cast<double>(equation.lo), hi = static_cast<double>(equation.hi);
  for (Root& root : roots.list) {
    root.x = root.x == 1 ? hi : std::fma(root.x, hi - lo, lo);
    root.radius *= hi - lo;
  }
}

template void ClosedForm::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void ClosedForm::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
