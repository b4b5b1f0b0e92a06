// Peer: MPSolve, all complex roots to as many digits as asked, each with a radius.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree, the double coefficients as exact
//           rationals
// needs     finite coefficients; the equation passes through power_basis::solve as for our own methods
// returns   ok; failed if the peer reports an error; otherwise as power_basis::solve. A root is real if its
//           imaginary part is no more than its radius
// error     roots to 53 bits by the peer's word
// cost      a context is made for each equation, which costs more than the solving: one that is used again
//           writes beyond its memory (version 3.2.1, seen with valgrind)
// source    Bini, Robol, "Solving secular and polynomial equations: a multiprecision algorithm", J. Comput.
//           Appl. Math. 272 (2014); MPSolve 3.2.1
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class Mpsolve {
 public:
  static SolverInfo info();
  explicit Mpsolve(const Parameters& options);
  void solve(const PolynomialEquation& equation, Roots& roots) const;
};

static_assert(Solver<Mpsolve>);

}  // namespace graze
