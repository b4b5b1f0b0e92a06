// All roots at once by Weierstrass's iteration (Durand, Kerner); the real ones by inclusion discs.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed where an approximation does not come to rest in
//           sweeps(n) sweeps (the list then holds what the discs say so far); invalid for coefficients that
//           are not finite
// error     as for aberth: iterated until |p| is below the bound of its own rounding, real ones polished;
//           `radius` is n |Weierstrass's correction| with the rounding of p, an estimate, no certificate
// cost      O(n^2) a sweep; 2.5 n sweeps and more from the circle, 8 to 20 from the Newton polygon; no
//           allocation up to degree 32 and for the power basis
// source    Weierstrass, Sitzungsberichte Akad. Berlin (1891); Durand, "Solutions numeriques des equations
//           algebriques" I (1960); Kerner, "Ein Gesamtschrittverfahren zur Berechnung der Nullstellen von
//           Polynomen", Numer. Math. 8 (1966). Ours: scaling, stop and real roots as in aberth, newest
//           values at once
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class DurandKerner {
 public:
  /// Budget: coming in from the circle takes some n sweeps for each factor of e, roots of multiplicity m
  /// shrink their distance by 1 - 1/m a sweep.
  static constexpr int sweeps(int degree) { return 100 + 20 * degree; }
  /// Largest backward error, in n u, of the roots of polynomials of degree 1 to 12 with coefficients uniform
  /// in [-1, 1] (measured; asserted in tests/solvers/durand_kerner_test.cpp).
  static constexpr double kMeasuredBackward = 2;

  static SolverInfo info();
  explicit DurandKerner(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  bool from_polygon_;
};

static_assert(Solver<DurandKerner>);

}  // namespace graze
