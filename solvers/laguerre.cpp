#include <graze/solvers/laguerre.hpp>

#include <optional>

#include <graze/solvers/math/complex_roots.hpp>

namespace graze {
namespace {

using complex_roots::Complex;
using complex_roots::magnitude;
using complex_roots::product;
using complex_roots::quotient;
using power_basis::Coefficients;
using power_basis::Problem;

/// Laguerre's correction n / (G +- sqrt((n-1)(n H - G^2))) with the sign of the larger divisor, G = p'/p,
/// H = G^2 - p''/p; not finite where G = H = 0.
template <class T>
Complex<T> correction(int degree, const complex_roots::ScaledValue<T>& p) {
  const auto n = static_cast<T>(degree);
  const Complex<T> G = quotient(p.derivative, p.value);
  const Complex<T> H = product(G, G) - quotient(p.second, p.value);
  const Complex<T> root = std::sqrt((n - 1) * (n * H - product(G, G)));
  const Complex<T> plus = G + root, minus = G - root;
  return quotient(Complex<T>{n, 0}, magnitude(plus) >= magnitude(minus) ? plus : minus);
}

/// |c_0 / c_n|^(1/n), the roots' geometric mean: one root at least is no larger, and one no smaller.
template <class T>
T mean_magnitude(Coefficients<T> c) {
  const T height = std::log2(std::fabs(c.front())) - std::log2(std::fabs(c.back()));
  return std::exp2(height / static_cast<T>(c.size() - 1));
}

/// Laguerre's iteration from z; nothing where the budget is spent. Where p' and p'' (nearly) vanish, as for
/// x^n + c_0 at 0, the step is endless or far longer than the roots are large: then the iteration starts
/// anew on the circle of their mean magnitude, in a new direction each time.
template <class T>
std::optional<Complex<T>> iterate(Coefficients<T> c, Complex<T> z, Counters& counters) {
  constexpr int kCycle = 10;  // every tenth step is halved, which breaks the rare cycles
  const int n = static_cast<int>(c.size()) - 1;
  const T mean = mean_magnitude(c), longest = static_cast<T>(n) * mean;
  for (int step = 1; step <= Laguerre::kSteps; ++step) {
    const auto p = complex_roots::evaluate_scaled<true>(c, z);
    ++counters.evaluations;
    // Adams: |p| is nothing but rounding.
    if (magnitude(p.value) <= p.error) return z;
    ++counters.iterations;
    Complex<T> dz = correction(n, p);
    if (!(magnitude(dz) <= magnitude(z) + longest)) {
      const T angle = static_cast<T>(complex_roots::kPhase) * static_cast<T>(step);
      z = {mean * std::cos(angle), mean * std::sin(angle)};
      continue;
    }
    if (step % kCycle == 0) dz *= static_cast<T>(0.5);
    z -= dz;
    if (magnitude(dz) <= power_basis::kU<T> * magnitude(z)) return z;
  }
  return std::nullopt;
}

/// Where |c_r z^r| is largest: coefficients above are taken from the division by descending, those below
/// from the division by ascending powers, so that the remainder falls on the largest term.
template <class T>
std::size_t join(Coefficients<T> c, T size_z) {
  const T scale = std::log2(size_z);
  std::size_t r = 0;
  T largest = -std::numeric_limits<T>::infinity();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const T term = std::log2(std::fabs(c[i])) + static_cast<T>(i) * scale;
    if (term > largest) {
      largest = term;
      r = i;
    }
  }
  return r;
}

/// c / (x - z) into c, one shorter: forward for the coefficients from r on, backward below.
template <class T>
std::span<T> deflate(std::span<T> c, T z) {
  const std::size_t n = c.size() - 1, r = join<T>(c, std::fabs(z));
  // Backward: d_0 = -c_0 / z, d_i = (d_{i-1} - c_i) / z.
  T below = 0;
  for (std::size_t i = 0; i < r; ++i) c[i] = below = (below - c[i]) / z;
  // Forward: d_{n-1} = c_n, d_{i-1} = c_i + z d_i; kept one place too high, then moved down.
  for (std::size_t i = n; i-- > r + 1;) c[i] += z * c[i + 1];
  for (std::size_t i = r; i < n; ++i) c[i] = c[i + 1];
  return c.first(n);
}

/// c / (x^2 - 2 Re(z) x + |z|^2) into c, two shorter, joined likewise.
template <class T>
std::span<T> deflate(std::span<T> c, Complex<T> z) {
  const std::size_t n = c.size() - 1, r = std::min(join<T>(c, magnitude(z)), n - 1);
  const T s = 2 * z.real(), m = z.real() * z.real() + z.imag() * z.imag();
  // Backward: m d_i = c_i + s d_{i-1} - d_{i-2}.
  T before = 0, below = 0;
  for (std::size_t i = 0; i < r; ++i) {
    const T next = (c[i] + s * below - before) / m;
    before = below;
    c[i] = below = next;
  }
  // Forward: d_{i-2} = c_i + s d_{i-1} - m d_i; kept two places too high, then moved down.
  for (std::size_t i = n; i-- > r + 2;) {
    c[i] += s * c[i + 1] - (i + 2 <= n ? m * c[i + 2] : T{0});
  }
  for (std::size_t i = r; i + 2 <= n; ++i) c[i] = c[i + 2];
  return c.first(n - 1);
}

/// Is the real part a root by itself, by the rule of power_basis, and a simple one of what is left? By the
/// parabola there, a change of q by its tolerance does not make it two: q'^2 > 2 |q''| times it.
template <class T>
bool is_simple_real(const Problem<T>& problem, Coefficients<T> left, Complex<T> z, Counters& counters) {
  if (z.imag() == 0) return true;
  ++counters.evaluations;
  const T x = z.real();
  if (!(std::fabs(power_basis::evaluate(problem.c, x).value) <= problem.tolerance(x))) return false;
  const auto q = complex_roots::evaluate_scaled<true>(left, Complex<T>{x, 0});
  const T slope = q.derivative.real(), bend = q.second.real();
  return slope * slope > 2 * std::fabs(bend) * static_cast<T>(power_basis::kBackward) * q.error;
}

/// Root after root: found on what is left, polished on p, divided off with its conjugate; false: budget.
template <class T>
bool find_all(const Problem<T>& problem, bool polish, std::span<T> left, Roots& found) {
  while (left.size() > 1) {
    ++found.counters.starts;
    const auto rough = iterate<T>(left, Complex<T>{}, found.counters);
    if (!rough) return false;
    // A polish that runs away or takes too long leaves the root as it was.
    const auto fine = polish ? iterate<T>(problem.c, *rough, found.counters) : rough;
    const bool is_near =
        fine && magnitude(*fine - *rough) <= std::sqrt(std::sqrt(power_basis::kU<T>)) * magnitude(*rough);
    Complex<T> z = is_near ? *fine : *rough;
    if (left.size() == 2) z = z.real();
    if (left.size() == 2 || is_simple_real<T>(problem, left, z, found.counters)) {
      const T x = polish ? power_basis::polished(problem, z.real(), found.counters) : z.real();
      add_if_real(problem, Complex<T>{x, 0}, false, found);
      left = deflate(left, x);
    } else {
      // A pair: no root, or a touching one.
      add_if_real(problem, Complex<T>{z.real(), std::fabs(z.imag())}, false, found);
      left = deflate(left, z);
    }
  }
  return true;
}

}  // namespace

SolverInfo Laguerre::info() {
  SolverInfo info;
  info.summary = "Laguerre's method root after root, with deflation and a polish on the given polynomial";
  info.source = "Laguerre (1880); Adams, Comm. ACM 10 (1967); Peters, Wilkinson (1971)";
  info.page = "solvers/laguerre.md";
  info.options = {{"polish", "true", "iterate each root once more on the polynomial as given"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Laguerre::Laguerre(const Parameters& options) : polish_(options.flag("polish", true)) {}

template <class T>
void Laguerre::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  complex_roots::solve_scaled(equation, roots, [this](const Problem<T>& problem, Roots& found) {
    power_basis::Scratch<T> memory(problem.c.size());
    const std::span<T> left = memory.span();
    std::copy(problem.c.begin(), problem.c.end(), left.begin());
    if (!find_all(problem, polish_, left, found)) found.status = Status::failed;
  });
}

template void Laguerre::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Laguerre::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
