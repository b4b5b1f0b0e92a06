// Interval Newton's method with gap splitting, or Krawczyk's operator, with epsilons by region.
//
// solves    f(x) = 0 on [lo, hi] by inclusion functions (form interval)
// needs     inclusions of f and f'
// returns   ok: the listed roots are proved, each alone in [x - radius, x + radius], and there is no
//           other; uncertain: an interval could neither be proved empty nor shown to hold exactly one
//           root within its epsilon (touching roots always end here), or the budget was spent; the listed
//           roots are proved still; invalid for an interval that is none
// error     radius proved; at most half the root's region's eps, or half the grazing eps where the slope
//           is so shallow that rounding hides the root within the former; usually a few ulps. Defaults as
//           interval_bisection
// cost      3 evaluations a step; a step at least halves an interval, near a simple root it squares its
//           relative width; at most `budget` evaluations; no allocation after warm-up
// source    newton: Moore, Kearfott, Cloud, "Introduction to Interval Analysis", SIAM 2009, eq. (8.6) and
//           theorem 8.1, split by extended division section 8.1; krawczyk: Krawczyk, Computing 4 (1969),
//           and the book's eq. (8.13), theorem 8.2
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

class IntervalNewton {
 public:
  static SolverInfo info();
  explicit IntervalNewton(const Parameters& options);
  void solve(const IntervalEquation& equation, Roots& roots) const;

 private:
  bool krawczyk_;
  std::uint32_t budget_;
};

static_assert(Solver<IntervalNewton>);

}  // namespace graze
