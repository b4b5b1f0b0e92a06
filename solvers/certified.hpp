// The right number of roots, proved, by ever more exact arithmetic: the solver to use unless there is a
// reason.
//
// solves    p(x) = 0 (form polynomial, any degree, either basis) or f(x) = 0 by inclusions (form interval) on
//           the closed interval [lo, hi]
// needs     what its tiers use: coefficients with bounds on their errors; for the last one the exact
//           coefficients (PolynomialEquation::exact, or c itself where c_error is empty)
// returns   ok: the roots, all of them and no other, with their multiplicities; uncertain: coefficients that
//           are not exact, or inclusions, leave the count open (the listed roots are proved still);
//           coincident for the zero polynomial; invalid for coefficients that are not finite
// error     radius proved; l within 3.5 eps |l| where ExactCoefficients::near is known, in the power basis;
//           the last tier's roots are the doubles nearest to the exact ones
// cost      tier 1, double: degree 1 and 2 by formula, else variations of sign; tier 2, double-double: the
//           same search where double leaves a piece open, 1 to 2 us a piece; tier 3, exact: integers,
//           microseconds to milliseconds, allocates. Counters::tier tells which one answered
// source    tiers 1 and 2: closed_form.hpp, descartes.hpp, interval_bisection.hpp; exact: exact_roots.hpp;
//           derivation: solvers/certified.md
#pragma once

#include <graze/solvers/descartes.hpp>
#include <graze/solvers/interval_bisection.hpp>
#include <graze/solvers/math/instruction_set.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class Certified {
 public:
  static SolverInfo info();
  explicit Certified(const Parameters& options);
  void solve(const PolynomialEquation& equation, Roots& roots) const;
  void solve(const IntervalEquation& equation, Roots& roots) const;

  /// Option instruction_set, for surfaces' kernels; throws std::invalid_argument for one that this processor
  /// lacks or a name that is none.
  static InstructionSet instruction_set(const Parameters& options);

 private:
  void solve_by_signs(const PolynomialEquation& equation, Roots& roots) const;

  bool double_double_;
  Descartes variations_;
  IntervalBisection inclusions_;
};

static_assert(Solver<Certified>);

}  // namespace graze
