// Halley's method from equidistant starts; for polynomials from outside all roots, with Maehly's
// suppression.
//
// solves    p(x) = 0 (form polynomial, either basis) or f(x) = 0 (form scalar) on [lo, hi]
// needs     polynomial: finite coefficients; scalar: f smooth, with its derivatives and error bound
// returns   ok with the distinct roots it found: nothing says that there are no others; coincident for
//           the zero polynomial; invalid for numbers that are not a question. A start that leads nowhere
//           is no failure: that is how the method sees that no root is there
// error     measured (solvers/halley.md); radius = what the error bound of f leaves open
// cost      polynomial: about 6 steps a root of all real roots, inside the interval or not, and `starts`
//           more descents where some roots are not real; scalar: `starts` descents. Allocates for the
//           list of all roots of a polynomial
// source    Halley 1694; Traub, "Iterative Methods for the Solution of Equations" (1964), section 5.2;
//           Maehly 1954
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Halley {
 public:
  static SolverInfo info();
  explicit Halley(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;
  template <class T>
  void solve(const BasicScalarEquation<T>& equation, Roots& roots) const;

 private:
  int starts_;
};

static_assert(Solver<Halley>);

}  // namespace graze
