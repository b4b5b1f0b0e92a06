// Inclusion by intervals and bisection, with epsilons by region.
//
// solves    f(x) = 0 on [lo, hi] by inclusion functions (form interval), or p(x) = 0 (form polynomial, with
//           the coefficients' error bounds); unbounded polynomials within their root bound
// returns   ok: the listed roots are proved, each alone in [x - radius, x + radius], and there is no other;
//           uncertain: an interval could neither be proved empty nor shown to hold exactly one root within
//           its epsilon (touching roots always end here); the listed roots are proved still; coincident for
//           the zero polynomial
// error     radius proved; at most half the root's region's eps (Epsilons), or half the grazing eps where the
//           slope is so shallow that rounding hides the signs within the former. Defaults where the equation
//           brings none: kDefaultEps and kDefaultGrazingEps, times the largest |x| asked for
// cost      about 2 evaluations a bisection, log2(length/eps) bisections a root and more near a grazing one;
//           at most `budget` evaluations; no allocation after warm-up
// source    Moore, Kearfott, Cloud, "Introduction to Interval Analysis", SIAM 2009, ch. 5 and 8; per-region
//           epsilons after document 003
#pragma once

#include <graze/solvers/interval_search.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

class IntervalBisection {
 public:
  static constexpr double kDefaultEps = inclusion::kDefaultEps;
  static constexpr double kDefaultGrazingEps = inclusion::kDefaultGrazingEps;

  static SolverInfo info();
  explicit IntervalBisection(const Parameters& options);
  void solve(const IntervalEquation& equation, Roots& roots) const;
  void solve(const PolynomialEquation& equation, Roots& roots) const;

 private:
  std::uint32_t budget_;
};

static_assert(Solver<IntervalBisection>);

}  // namespace graze
