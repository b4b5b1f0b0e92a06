// Real roots as eigenvalues of the balanced companion matrix.
//
// solves    p(x) = 0 on [lo, hi], power or Bernstein basis, any degree
// needs     finite coefficients
// returns   ok; coincident for the zero polynomial; failed if the ratios to the leading coefficient overflow
//           or the QR iteration does not converge
// error     measured: backward stable in the sense that each root is a root of a polynomial within
//           kBackward n u of the given coefficients (tests); nothing is proved
// cost      O(n^3): one eigenvalue-only QR; one evaluation an eigenvalue. Allocates above degree 8
// source    Edelman, Murakami, "Polynomial roots from companion matrix eigenvalues", Math. Comp. 64 (1995);
//           balancing after Parlett, Reinsch, Numer. Math. 13 (1969); eigenvalues by Eigen
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class Companion {
 public:
  /// An eigenvalue a + ib counts as the real root a if p(a) is zero within what a relative change of every
  /// coefficient by kBackward n u can do: |p(a)| <= kBackward n u sum |c_i a^i| (+ coefficient errors).
  /// Scale-free in p and in x; no threshold on |b|. 16: twice the largest backward error seen in tests.
  static constexpr double kBackward = 16;

  static SolverInfo info();
  explicit Companion(const Parameters& options);
  void solve(const PolynomialEquation& equation, Roots& roots) const;

 private:
  bool polish_;
};

static_assert(Solver<Companion>);

}  // namespace graze
