// The four forms in which an equation reaches a solver, in double or in float. An equation is a small view:
// what it points to (coefficients, the object behind `self`) lives in the block that made it and outlives the
// call. In float the coefficients, the unknown and every value of the function are floats: a solver that
// takes BasicX<float> computes in float throughout. Interval equations are in double only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze {

enum class Form : std::uint8_t { polynomial, scalar, interval, system };

/// "polynomial", "scalar", ...
std::string_view to_string(Form form);

/// The arithmetic of an equation and of the solver that takes it.
enum class Precision : std::uint8_t { binary64, binary32 };

/// "double", "float".
std::string_view to_string(Precision precision);

/// Part of the unknown's range with its own epsilon, for solvers that work to a tolerance.
/// `end` closes the part (parts follow one another in ascending order from the interval's low end);
/// `eps` is a width in the unknown's own unit: it scales with the equation, so it is no absolute tolerance.
struct Region {
  double end = std::numeric_limits<double>::infinity();
  double eps = 0;
};

/// The epsilons of an equation. Where the slope is shallow, |f'| <= shallow (a grazing ray), `grazing_eps`
/// replaces the part's own. All empty: the solver uses its default, relative to the interval.
struct Epsilons {
  std::span<const Region> parts;
  double grazing_eps = 0;
  double shallow = 0;
};

/// What a solver asks of a polynomial equation beside c: nothing; ExactCoefficients::near; or that, and that
/// it is left to tell apart the roots whose l round to one double (Root::placed).
enum class Digits : std::uint8_t { rounded, near, placed };

enum class Basis : std::uint8_t { power, bernstein, chebyshev };

class Dyadic;  // math/big_integer.hpp

/// Where a solver gets the coefficients without rounding, if it must: `get` fills c, as many as the equation
/// has, in its basis. Null: the surface cannot say. A root's place is l = origin + x, the number whose digits
/// count (Root::placed). `near` are the same coefficients in double-double, with bounds, or more of them, for
/// solvers that place roots; empty: not known.
struct ExactCoefficients {
  const void* self = nullptr;
  void (*get)(const void* self, std::span<Dyadic> c) = nullptr;
  double origin = 0;
  std::span<const DoubleDoubleBall> near{};
};

/// sum_i c[i] x^i = 0 (power, ascending), sum_i c[i] B_{i,n}((x - lo)/(hi - lo)) = 0 (Bernstein), or
/// sum_i c[i] T_i(2 (x - lo)/(hi - lo) - 1) = 0 (Chebyshev, degree up to kMaxChebyshevDegree), wanted on the
/// closed interval [lo, hi]; lo = -inf, hi = inf asks for all real roots (power only).
/// `c_error` is empty (the coefficients are exact numbers) or bounds |c[i] - true c[i]|.
template <class T>
struct BasicPolynomialEquation {
  std::span<const T> c;
  std::span<const T> c_error;
  Basis basis = Basis::power;
  T lo = -std::numeric_limits<T>::infinity();
  T hi = std::numeric_limits<T>::infinity();
  Epsilons epsilons;
  ExactCoefficients exact{};
};
using PolynomialEquation = BasicPolynomialEquation<double>;

/// Finite coefficients and errors, and an interval that is not empty (NaN is none either).
template <class T>
bool is_usable(const BasicPolynomialEquation<T>& equation) {
  const auto finite = [](T v) { return std::isfinite(v); };
  return std::all_of(equation.c.begin(), equation.c.end(), finite) &&
         std::all_of(equation.c_error.begin(), equation.c_error.end(), finite) && equation.lo <= equation.hi;
}

/// f with two derivatives at a point, and a bound on the rounding error of f.
template <class T>
struct BasicJet {
  T f = 0;
  T df = 0;
  T ddf = 0;
  T f_error = 0;
};
using Jet = BasicJet<double>;

/// f(x) = 0 on the closed interval [lo, hi] for a smooth f that may touch zero.
/// `eval(self, x)` is valid for x in [lo, hi]. `seed` names the equation: a solver that draws random
/// numbers starts its generator from it, so that the same ray gets the same answer in any order or thread.
/// `max_roots` > 0: there are no more distinct ones than that; a search may stop there.
template <class T>
struct BasicScalarEquation {
  const void* self = nullptr;
  BasicJet<T> (*eval)(const void* self, T x) = nullptr;
  T lo = 0;
  T hi = 0;
  int max_roots = 0;
  std::uint64_t seed = 0;

  [[nodiscard]] BasicJet<T> operator()(T x) const { return eval(self, x); }
};
using ScalarEquation = BasicScalarEquation<double>;

/// f(x) = 0 on [lo, hi] by inclusion functions.
struct IntervalEquation {
  const void* self = nullptr;
  Interval (*value)(const void* self, Interval x) = nullptr;       ///< encloses f over x
  Interval (*derivative)(const void* self, Interval x) = nullptr;  ///< encloses f' over x
  double lo = 0;
  double hi = 0;
  Epsilons epsilons;
};

inline constexpr int kMaxUnknowns = 3;
template <class T>
using BasicVector = std::array<T, kMaxUnknowns>;
template <class T>
using BasicMatrix = std::array<std::array<T, kMaxUnknowns>, kMaxUnknowns>;
using Vector = BasicVector<double>;
using Matrix = BasicMatrix<double>;

/// F(x) = 0 for n unknowns and n equations. x[0] is the unknown by which roots are told apart and sorted.
/// Bounds hold for every unknown; a period > 0 says that x and x + period are the same value.
/// `residual_scale` is the size of the terms that cancel in F: |F| <= k eps residual_scale is rounding.
template <class T>
struct BasicSystemEquation {
  const void* self = nullptr;
  int unknowns = 0;
  void (*eval)(const void* self, const BasicVector<T>& x, BasicVector<T>& f,
               BasicMatrix<T>& jacobian) = nullptr;
  /// A start value from the surface's own generator (a random slice); false: this draw gives none.
  bool (*start)(const void* self, Rng& rng, BasicVector<T>& x) = nullptr;
  BasicVector<T> lo{};
  BasicVector<T> hi{};
  BasicVector<T> period{};
  T residual_scale = 1;
  int max_roots = 0;  ///< as in ScalarEquation
  std::uint64_t seed = 0;
};
using SystemEquation = BasicSystemEquation<double>;

}  // namespace graze
