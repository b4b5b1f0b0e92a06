// Changes of sign, each refined by a bracketing method.
//
// solves    p(x) = 0 (form polynomial, either basis) or f(x) = 0 (form scalar) on [lo, hi]
// needs     polynomial: finite coefficients; scalar: f smooth, with its derivatives and error bound
// returns   ok; coincident for the zero polynomial; failed if a bracket is not narrow within kBudget
//           evaluations, with the roots found; invalid for numbers that are not a question
// error     a root lies within about 2 ulps of where the computed f changes sign; radius = that, plus
//           what the error bound of f leaves open. Touching roots: an extremum where |f| is no more than
//           its error
// misses    polynomial: none that the rounding of p lets one see; scalar: pairs of roots between two
//           neighbouring samples at which f and f' show nothing of them
// cost      polynomial: at most n (n + 1) / 2 brackets (p and its derivatives); scalar: `pieces` + 1
//           evaluations and about 8 a root. No allocation up to degree 32
// source    toms748: Alefeld, Potra, Shi, ACM TOMS 21 (1995), algorithm 4.2, by Boost.Math; itp and
//           chandrupatla: solvers/bracket_methods.hpp
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Bracketed {
 public:
  /// Evaluations for one bracket: bisection alone needs 160 to reach the resolution, 4 u^3 of the reach.
  static constexpr int kBudget = 300;

  enum class Method : std::uint8_t { toms748, itp, chandrupatla };

  static SolverInfo info();
  explicit Bracketed(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;
  template <class T>
  void solve(const BasicScalarEquation<T>& equation, Roots& roots) const;

 private:
  Method method_;
  int pieces_;
};

static_assert(Solver<Bracketed>);

}  // namespace graze
