// What methods that find all complex roots share: scaling, start values, values with error bounds, discs
// that hold the roots, and the rule by which discs become real roots.
//
// solves    nothing by itself; serves aberth, durand_kerner, laguerre, jenkins_traub
// needs     sum c_i z^i, ascending, c_0 != 0 != c_n, n >= 1 (`Problem` of power_basis.hpp)
// returns   see each function
// error     `evaluate_scaled` states a running bound on its rounding; `inclusion_radius` includes it
// cost      evaluation: n steps of 8 to 20 flops; start values: n logarithms; discs: O(n^2). No allocation
//           up to degree power_basis::kInline
// source    start values: Bini, "Numerical computation of polynomial zeros by means of Aberth's method",
//           Numer. Algorithms 13 (1996); discs: Smith, "Error bounds for zeros of a polynomial
//           based upon Gerschgorin's theorems", J. ACM 17 (1970)
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <span>

#include <graze/solvers/power_basis.hpp>

namespace graze::complex_roots {

using power_basis::Coefficients;
using power_basis::kU;
using power_basis::Problem;
using power_basis::Scratch;

template <class T>
using Complex = std::complex<T>;

/// |z| for numbers that neither over- nor underflow when squared, which those of a scaled problem do not.
template <class T>
T magnitude(Complex<T> z) {
  return std::sqrt(z.real() * z.real() + z.imag() * z.imag());
}

/// a b without the search for infinities that the standard asks of complex products.
template <class T>
Complex<T> product(Complex<T> a, Complex<T> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// a / b by Smith's method, safe from overflow of |b|^2; not finite for b = 0.
template <class T>
Complex<T> quotient(Complex<T> a, Complex<T> b) {
  if (std::fabs(b.real()) < std::fabs(b.imag())) {
    return quotient(Complex<T>{a.imag(), -a.real()}, Complex<T>{b.imag(), -b.real()});
  }
  const T ratio = b.imag() / b.real();
  const T divisor = b.real() + b.imag() * ratio;
  return {(a.real() + a.imag() * ratio) / divisor, (a.imag() - a.real() * ratio) / divisor};
}

template <class T>
bool is_finite(Complex<T> z) {
  return std::isfinite(z.real()) && std::isfinite(z.imag());
}

// ------------------------------------------------------------------------------------------------- scaling

/// Poses the equation to `method(const Problem<T>& scaled, Roots&)` with x = 2^shift y and the largest
/// coefficient in [1, 2). The shift is the floor of (log2|c_0| - log2|c_n|) / n in whole exponents: a power
/// of two in x or in p changes no bit of what the method sees.
template <class T, class Method>
void solve_scaled(const BasicPolynomialEquation<T>& equation, Roots& roots, const Method& method) {
  power_basis::solve(equation, roots, [&method](const Problem<T>& problem, Roots& found) {
    const int n = problem.degree();
    Scratch<T> c_memory(problem.c.size()), e_memory(problem.c_error.size());
    const std::span<T> c = c_memory.span(), e = e_memory.span();
    power_basis::PowersOfTwo scaling = power_basis::scale_coefficients(problem.c, c);
    // Towards minus infinity: a quotient rounded to zero would depend on where the scale of x starts.
    if (std::ilogb(c.front()) < std::ilogb(c.back())) {
      --scaling.shift;
      int largest = std::numeric_limits<int>::min();
      for (std::size_t i = 0; i < c.size(); ++i) {
        c[i] = std::ldexp(c[i], n - static_cast<int>(i));
        if (c[i] != 0) largest = std::max(largest, std::ilogb(c[i]));
      }
      for (T& v : c) v = std::ldexp(v, -largest);
      scaling.power += largest - n;
    }
    for (std::size_t i = 0; i < e.size(); ++i) {
      e[i] = std::ldexp(problem.c_error[i], static_cast<int>(i) * scaling.shift - scaling.power);
    }
    const std::size_t before = found.list.size();
    method(Problem<T>{c, e, std::ldexp(problem.lo, -scaling.shift), std::ldexp(problem.hi, -scaling.shift)},
           found);
    for (std::size_t i = before; i < found.list.size(); ++i) {
      found.list[i].x = std::ldexp(found.list[i].x, scaling.shift);
      found.list[i].radius = std::ldexp(found.list[i].radius, scaling.shift);
    }
  });
}

// ---------------------------------------------------------------------------------------------- evaluation

/// p(z), p'(z), p''(z) over z^k with k = 0 where |z| <= 1 and k = n elsewhere: there the reversed polynomial
/// is evaluated at 1/z, so that nothing overflows; |value - exact| <= error for the z at hand, or, where
/// |z| > 1, for a point within 4u |z| of it (the rounding of 1/z).
template <class T>
struct ScaledValue {
  Complex<T> value, derivative, second;
  T error = 0;
  bool reversed = false;
};

namespace detail {

/// Horner's rule with derivatives; `at(i)` is the coefficient of z^i. The error grows as
/// E <- |z| (E + sqrt(5) u |s|) + u |s'| from one partial value s to the next, s': a complex product errs
/// by sqrt(5) u (Brent, Percival, Zimmermann, Math. Comp. 76 (2007)), a real summand rounds once.
template <bool kSecond, class T, class At>
ScaledValue<T> horner(int n, Complex<T> z, const At& at) {
  const T sqrt_5 = static_cast<T>(2.2360679774997898);  // rounded up in double; slack below covers float
  const T size_z = magnitude(z);
  ScaledValue<T> p;
  p.value = at(n);
  T size = std::fabs(p.value.real()), bound = 0;
  for (int i = n - 1; i >= 0; --i) {
    if constexpr (kSecond) p.second = product(p.second, z) + p.derivative;
    p.derivative = product(p.derivative, z) + p.value;
    p.value = product(p.value, z) + at(i);
    bound = size_z * (bound + sqrt_5 * size);
    size = magnitude(p.value);
    bound += size;
  }
  p.second *= T{2};
  // The bound's own roundings, 5 a step, and that of |z|.
  p.error = kU<T> * bound * (1 + 8 * static_cast<T>(n + 1) * kU<T>);
  return p;
}

}  // namespace detail

/// See ScaledValue; `second` is zero unless kSecond.
template <bool kSecond = false, class T>
ScaledValue<T> evaluate_scaled(Coefficients<T> c, Complex<T> z) {
  const int n = static_cast<int>(c.size()) - 1;
  if (!(magnitude(z) > 1)) {
    return detail::horner<kSecond, T>(n, z, [&](int i) { return c[static_cast<std::size_t>(i)]; });
  }
  const Complex<T> w = quotient(Complex<T>{1, 0}, z);
  ScaledValue<T> r =
      detail::horner<kSecond, T>(n, w, [&](int i) { return c[static_cast<std::size_t>(n - i)]; });
  // p = z^n R(1/z), differentiated once and twice.
  const T degree = static_cast<T>(n);
  const Complex<T> first = product(w, r.derivative);
  const Complex<T> second = product(w, product(w, r.second));
  r.derivative = product(w, degree * r.value - first);
  r.second = product(product(w, w), degree * (degree - 1) * r.value - 2 * (degree - 1) * first + second);
  r.reversed = true;
  return r;
}

// -------------------------------------------------------------------------------------------- start values

/// Bini's phase offset: keeps start values off the axis and off symmetry, in which no real root is found.
inline constexpr double kPhase = 0.7;

/// n start values on circles whose radii are the slopes of the upper convex hull of (i, log2 |c_i|): as
/// many on each circle as the edge is long. They are within a small factor of the roots' magnitudes however
/// much these differ.
template <class T>
void newton_polygon_points(Coefficients<T> c, std::span<Complex<T>> z) {
  const std::size_t n = c.size() - 1;
  const auto height = [&c](std::size_t i) { return std::log2(std::fabs(c[i])); };
  const auto slope = [&](std::size_t i, std::size_t j) {
    return (height(j) - height(i)) / static_cast<T>(j - i);
  };
  constexpr T kTurn = 2 * std::numbers::pi_v<T>;
  for (std::size_t i = 0; i < n;) {
    // The edge from i ends where its slope is steepest, as far off as possible.
    std::size_t j = i + 1;
    while (c[j] == 0) ++j;
    for (std::size_t k = j + 1; k <= n; ++k) {
      if (c[k] != 0 && slope(i, k) >= slope(i, j)) j = k;
    }
    const T radius = std::exp2(-slope(i, j));
    for (std::size_t k = i; k < j; ++k) {
      const T angle =
          kTurn * (static_cast<T>(k - i) / static_cast<T>(j - i) + static_cast<T>(i) / static_cast<T>(n)) +
          static_cast<T>(kPhase);
      z[k] = {radius * std::cos(angle), radius * std::sin(angle)};
    }
    i = j;
  }
}

// --------------------------------------------------------------------------------------------------- discs

/// A product or quotient of many numbers, with its exponent kept apart so that it cannot overflow.
template <class T>
class LongProduct {
 public:
  explicit LongProduct(Complex<T> value) : value_(value) { settle(); }
  void multiply(Complex<T> factor) {
    value_ = product(value_, factor);
    settle();
  }
  void divide(Complex<T> factor) {
    value_ = quotient(value_, factor);
    settle();
  }
  [[nodiscard]] Complex<T> value() const {
    return {std::ldexp(value_.real(), exponent_), std::ldexp(value_.imag(), exponent_)};
  }

 private:
  // A quarter of the exponent range: within it, factors of up to three quarters are taken as they come.
  static constexpr int kFar = std::numeric_limits<T>::max_exponent / 4;
  void settle() {
    const T size = std::max(std::fabs(value_.real()), std::fabs(value_.imag()));
    const bool is_far = size > std::ldexp(T{1}, kFar) || size < std::ldexp(T{1}, -kFar);
    if (!is_far || size == 0 || !std::isfinite(size)) return;
    const int step = -std::ilogb(size);
    value_ = {std::ldexp(value_.real(), step), std::ldexp(value_.imag(), step)};
    exponent_ -= step;
  }

  Complex<T> value_;
  int exponent_ = 0;
};

/// value z^k / (c_n prod_{j != i} (z_i - z_j)), `value` being p(z_i) / z_i^k: Weierstrass's correction.
/// Points that coincide count as sqrt(u) |z| apart.
template <class T>
Complex<T> weierstrass(Coefficients<T> c, std::span<const Complex<T>> z, std::size_t i, Complex<T> value,
                       bool reversed) {
  LongProduct<T> w(value / c.back());
  if (reversed) w.multiply(z[i]);
  for (std::size_t j = 0; j < z.size(); ++j) {
    if (j == i) continue;
    Complex<T> apart = z[i] - z[j];
    if (apart == Complex<T>{}) apart = std::sqrt(kU<T>) * magnitude(z[i]);
    w.divide(apart);
    if (reversed) w.multiply(z[i]);
  }
  return w.value();
}

/// n (|p(z_i)| + bound) / |c_n prod (z_i - z_j)|, where the bound holds the rounding of p and the errors of
/// the coefficients: the discs of these radii hold all roots, and every connected part of k discs holds k.
template <class T>
T inclusion_radius(const Problem<T>& problem, std::span<const Complex<T>> z, std::size_t i) {
  const ScaledValue<T> p = evaluate_scaled(problem.c, z[i]);
  const T size_z = magnitude(z[i]);
  T bound = p.error;
  if (!problem.c_error.empty()) {
    T spread = 0;
    const std::size_t n = problem.c_error.size() - 1;
    for (std::size_t k = 0; k <= n; ++k) {
      spread = p.reversed ? spread / size_z + problem.c_error[k] : spread * size_z + problem.c_error[n - k];
    }
    bound += spread;
  }
  const Complex<T> top{magnitude(p.value) + bound, 0};
  const auto n = static_cast<T>(problem.degree());
  // Six roundings a factor of the product; 4u |z| for the rounding of 1/z.
  return n * magnitude(weierstrass(problem.c, z, i, top, p.reversed)) * (1 + 16 * n * kU<T>)+4 * kU<T> *
         size_z;
}

/// Makes every set of discs that hang together, or do so with their mirror images across the axis, share a
/// label. Only discs that meet the axis are mirrored: the others cannot hold a real root.
template <class T>
void label_clusters(std::span<const Complex<T>> z, std::span<const T> radius, std::span<int> label) {
  const auto meets_axis = [&](std::size_t i) { return !(std::fabs(z[i].imag()) > radius[i]); };
  const auto near = [&](std::size_t i, std::size_t j) {
    const T reach = radius[i] + radius[j];
    return !(magnitude(z[i] - z[j]) > reach) ||
           ((meets_axis(i) || meets_axis(j)) && !(magnitude(z[i] - std::conj(z[j])) > reach));
  };
  for (std::size_t i = 0; i < z.size(); ++i) label[i] = static_cast<int>(i);
  for (std::size_t i = 0; i < z.size(); ++i) {
    for (std::size_t j = i + 1; j < z.size(); ++j) {
      if (label[i] != label[j] && near(i, j)) std::replace(label.begin(), label.end(), label[j], label[i]);
    }
  }
}

/// The real roots of a cluster of m > 1 discs that meets the axis: its members whose real parts count as
/// roots by the backward error of power_basis, if they are as many as m up to an even number (complex roots
/// come in pairs); else one root of multiplicity m at their mean.
template <class T, class Visit>
void add_cluster(const Problem<T>& problem, std::span<const Complex<T>> z, std::span<const T> radius,
                 const Visit& visit_members, Roots& roots) {
  std::uint32_t members = 0, real = 0;
  T mean = 0;
  const auto counts = [&](T x) {
    ++roots.counters.evaluations;
    return std::fabs(power_basis::evaluate(problem.c, x).value) <= problem.tolerance(x);
  };
  visit_members([&](std::size_t i) {
    ++members;
    mean += z[i].real();
    real += counts(z[i].real()) ? 1U : 0U;
  });
  mean /= static_cast<T>(members);
  if ((members - real) % 2 == 0) {
    visit_members([&](std::size_t i) {
      if (counts(z[i].real())) add_real(problem, z[i].real(), radius[i], 1, roots);
    });
  } else {
    T reach = 0;
    visit_members([&](std::size_t i) { reach = std::max(reach, magnitude(z[i] - mean) + radius[i]); });
    add_real(problem, mean, reach, members, roots);
  }
}

/// Files the real ones of n approximations of all roots. A disc that meets the axis and is apart from all
/// others and their mirror images holds one root, which then is its own conjugate: real. It is moved to the
/// axis, polished there, and its disc is taken anew. Clusters: see above.
template <class T>
void add_real_ones(const Problem<T>& problem, std::span<Complex<T>> z, Roots& roots) {
  const std::size_t n = z.size();
  Scratch<T> radius_memory(n);
  Scratch<int> label_memory(n);
  const std::span<T> radius = radius_memory.span();
  const std::span<int> label = label_memory.span();
  for (std::size_t i = 0; i < n; ++i) radius[i] = inclusion_radius<T>(problem, z, i);
  roots.counters.evaluations += static_cast<std::uint32_t>(n);
  label_clusters<T>(z, radius, label);
  const auto size_of = [&](std::size_t i) { return std::count(label.begin(), label.end(), label[i]); };
  const auto is_real = [&](std::size_t i) { return !(std::fabs(z[i].imag()) > radius[i]); };
  for (std::size_t i = 0; i < n; ++i) {
    if (size_of(i) == 1 && is_real(i)) z[i] = power_basis::polished(problem, z[i].real(), roots.counters);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (size_of(i) == 1) {
      if (!is_real(i)) continue;
      ++roots.counters.evaluations;
      add_real(problem, z[i].real(), inclusion_radius<T>(problem, z, i), 1, roots);
    } else if (std::find(label.begin(), label.end(), label[i]) - label.begin() == static_cast<long>(i)) {
      const auto visit_members = [&](const auto& visit) {
        for (std::size_t k = i; k < n; ++k) {
          if (label[k] == label[i]) visit(k);
        }
      };
      bool meets = false;
      visit_members([&](std::size_t k) { meets = meets || is_real(k); });
      if (meets) add_cluster<T>(problem, z, radius, visit_members, roots);
    }
  }
}

/// Sweeps of a simultaneous iteration over the approximations still moving, each step using the newest values
/// of the others: step(i) moves z[i] and says whether it has come to rest. False: the budget is spent.
template <class Step>
bool sweep_to_rest(std::size_t count, int budget, Counters& counters, const Step& step) {
  power_basis::Scratch<std::uint8_t> rests_memory(count);
  const std::span<std::uint8_t> rests = rests_memory.span();
  std::size_t moving = count;
  for (int sweep = 0; sweep < budget && moving > 0; ++sweep) {
    ++counters.iterations;
    for (std::size_t i = 0; i < count; ++i) {
      if (rests[i] != 0) continue;
      ++counters.evaluations;
      rests[i] = step(i) ? 1 : 0;
      if (rests[i] != 0) --moving;
    }
  }
  return moving == 0;
}

}  // namespace graze::complex_roots
