// All roots at once by the Ehrlich-Aberth iteration; the real ones by inclusion discs.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed where an approximation does not come to rest in
//           kSweeps sweeps (the list then holds what the discs say so far); invalid for coefficients that
//           are not finite
// error     every approximation is iterated until |p| is below the bound of its own rounding: its error is
//           that of a relative change of each coefficient by some n u. `radius` is a Gerschgorin radius,
//           n (|p| + rounding + coefficient errors) / |c_n prod (x - z_j)|, computed in T: an estimate with
//           its rounding accounted for to first order, no certificate
// cost      O(n^2) a sweep, 5 to 10 sweeps for simple roots, about 15 to 25 where a root is double; no
//           allocation up to degree 32 and for the power basis
// source    Aberth, "Iteration methods for finding all zeros of a polynomial simultaneously", Math. Comp.
//           27 (1973); Ehrlich, Comm. ACM 10 (1967); start, stop and reversal as in Bini, Numer. Algorithms
//           13 (1996); discs: Smith, J. ACM 17 (1970). Ours: scaling by powers of two, Horner's running error
//           bound for the stop, the rule for real clusters (math/complex_roots.hpp)
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Aberth {
 public:
  /// Budget. A root of multiplicity m is approached by a factor of about 1 - 1/m a sweep: 100 sweeps take
  /// multiplicity 12 to u^(1/12).
  static constexpr int kSweeps = 100;
  /// Largest backward error, in n u, of the roots of polynomials of degree 1 to 12 with coefficients uniform
  /// in [-1, 1] (measured; asserted in tests/solvers/aberth_test.cpp).
  static constexpr double kMeasuredBackward = 2;

  static SolverInfo info();
  explicit Aberth(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;
};

static_assert(Solver<Aberth>);

}  // namespace graze
