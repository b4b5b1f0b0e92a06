// Peers: the root finders of Boost.Math, each on the changes of sign between equidistant samples.
//
// solves    f(x) = 0 (form scalar) or p(x) = 0 (form polynomial, either basis) on [lo, hi], cut into `pieces`
//           uniform pieces as our `bracketed` and `newton` do; a polynomial's interval ends at the root bound
// needs     toms748 and bisect values only, newton f', halley f'' as well; those two start from the middle of
//           a piece and keep inside it
// returns   ok; failed if the peer throws or leaves a bracket wider than 2^-49 of the interval's far end;
//           invalid for numbers that are not a question; a polynomial also as power_basis::solve says
// misses    touching roots, and pairs of roots inside one piece: nothing but changes of sign is looked for
// cost      `pieces` + 1 evaluations and those of the peer, at most kBudget a root
// source    Boost.Math 1.81, boost/math/tools/roots.hpp and toms748_solve.hpp, with the tolerances that its
//           manual recommends
#pragma once

#include <graze/solvers/solver.hpp>

namespace graze {

namespace boost_roots {

/// What the four have in common; Method is a tag of boost_roots.cpp.
template <class Method>
class BoostSearch {
 public:
  static SolverInfo info();
  explicit BoostSearch(const Parameters& options);
  void solve(const PolynomialEquation& equation, Roots& roots) const;
  void solve(const ScalarEquation& equation, Roots& roots) const;

 private:
  int pieces_;
};

struct Toms748;
struct Bisect;
struct NewtonRaphson;
struct HalleyIterate;

}  // namespace boost_roots

using BoostToms748 = boost_roots::BoostSearch<boost_roots::Toms748>;
using BoostBisect = boost_roots::BoostSearch<boost_roots::Bisect>;
using BoostNewton = boost_roots::BoostSearch<boost_roots::NewtonRaphson>;
using BoostHalley = boost_roots::BoostSearch<boost_roots::HalleyIterate>;

static_assert(Solver<BoostToms748> && Solver<BoostBisect> && Solver<BoostNewton> && Solver<BoostHalley>);

}  // namespace graze
