// Root after root by the real three-stage algorithm of Jenkins and Traub.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed where no zero is reached from kShifts shifts
//           (the list then holds the real roots found before); invalid for coefficients that are not finite
// error     measured (solvers/jenkins_traub.md): each zero is one of the deflated polynomial to within the
//           rounding of its evaluation; zeros come smallest first, roughly, so that forward deflation is
//           stable. Real ones are polished on the polynomial as given unless polish=false. `radius` is the
//           first-order estimate of power_basis
// cost      some 10 to 20 steps of 6 n flops a zero or pair; no allocation up to degree 32 and for the
//           power basis
// source    Jenkins, Traub, "A three-stage algorithm for real polynomials using quadratic iteration", SIAM
//           J. Numer. Anal. 7 (1970); tests and limits of the stages from Jenkins, "Algorithm 493: Zeros of a
//           real polynomial", ACM TOMS 1 (1975). Ours: steps written without divisions and K rescaled by
//           powers of two; sigma from two linear equations modulo sigma; running error bounds
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class JenkinsTraub {
 public:
  /// Budget: fixed shifts tried for one zero; the k-th gets 20 k steps (both from Algorithm 493).
  static constexpr int kShifts = 20;
  /// Largest backward error, in n u, of the roots of polynomials of degree 1 to 12 with coefficients uniform
  /// in [-1, 1] (measured; asserted in tests/solvers/jenkins_traub_test.cpp).
  static constexpr double kMeasuredBackward = 2;

  static SolverInfo info();
  explicit JenkinsTraub(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  bool polish_;
};

static_assert(Solver<JenkinsTraub>);

}  // namespace graze
