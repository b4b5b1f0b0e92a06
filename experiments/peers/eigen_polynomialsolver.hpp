// Peer: Eigen's PolynomialSolver, a module of its `unsupported` part.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients; the equation passes through power_basis::solve as for our own methods
// returns   ok; failed if a ratio to the leading coefficient or a root is not finite; otherwise as
//           power_basis::solve
// error     that of the peer; nothing is proved
// cost      one QR of the companion matrix with its eigenvectors; allocates
// source    Eigen 3.4, unsupported/Eigen/Polynomials (Manuel Yguel)
#pragma once

#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class EigenPolynomialsolver {
 public:
  static SolverInfo info();
  explicit EigenPolynomialsolver(const Parameters& options);
  template <class T>  // double, float
  void solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const;

 private:
  bool own_rule_;
};

static_assert(Solver<EigenPolynomialsolver>);

}  // namespace graze
