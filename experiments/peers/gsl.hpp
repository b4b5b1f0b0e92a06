// Peer: gsl_poly_complex_solve of the GNU Scientific Library.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients; the equation passes through power_basis::solve as for our own methods
// returns   ok; failed if the peer says that its QR iteration did not converge; otherwise as
//           power_basis::solve
// error     that of the peer; nothing is proved
// cost      one QR of the balanced companion matrix; allocates its workspace
// source    GSL 2.7, section "Polynomials: general"; balanced-QR reduction of the companion matrix
//
// Building one turns GSL's error handler off in this process: by default it would end the program.
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class Gsl {
 public:
  static SolverInfo info();
  explicit Gsl(const Parameters& options);
  void solve(const PolynomialEquation& equation, Roots& roots) const;
};

static_assert(Solver<Gsl>);

}  // namespace graze
