// The upper tiers of ladders: a polynomial equation solved in integers, and roots placed to the last digit.
//
// solves    p(x) = 0 on the closed interval [lo, hi], from the equation's exact coefficients
// needs     a usable polynomial equation
// returns   all distinct roots with their multiplicities, ascending in l = origin + x, each `placed`;
//           coincident for the zero polynomial
// error     none in count and multiplicity. fl(origin + x + tail) is the double nearest to l; of two roots
//           with one nearest double, one moves to its neighbour, so that both are within 1 ulp; more than two
//           that share two doubles are joined, with the sum of their multiplicities
// cost      as math/exact_polynomial.hpp: microseconds to milliseconds; allocates
// source    math/exact_polynomial.hpp
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/exact_polynomial.hpp>
#include <graze/solvers/roots.hpp>

namespace graze {

/// The equation's polynomial in powers of x, times a positive constant; none where nobody knows its
/// coefficients without error.
std::optional<ExactPolynomial> exact_polynomial(const PolynomialEquation& equation);

/// Appends the roots of p, the equation's exact polynomial, and sets the status.
void add_exact_roots(const ExactPolynomial& p, const PolynomialEquation& equation, Roots& roots);

/// The double that a root's l becomes.
double place_of(const PolynomialEquation& equation, const Root& root);

/// Places a simple root that lies alone within its radius by one interval Newton step, its residual in
/// double-double; false, and nothing done, where that proves no place (faithful.md has the proof).
bool place_root(const PolynomialEquation& equation, Root& root);

/// Calls place(root) for every root, ascending; false where one call is, or where two roots get one l.
template <class Place>
bool place_each(const PolynomialEquation& equation, std::span<Root> roots, const Place& place) {
  double last = -std::numeric_limits<double>::infinity();
  return std::all_of(roots.begin(), roots.end(), [&](Root& root) {
    if (!place(root)) return false;
    const double l = place_of(equation, root);
    const bool ascends = l > last;
    last = l;
    return ascends;
  });
}

}  // namespace graze
