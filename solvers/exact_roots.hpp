// The last tier of ladders: a polynomial equation solved in integers, each root placed to the last digit.
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

#include <optional>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/exact_polynomial.hpp>
#include <graze/solvers/roots.hpp>

namespace graze {

/// The equation's polynomial in powers of x, times a positive constant; none where nobody knows its
/// coefficients without error.
std::optional<ExactPolynomial> exact_polynomial(const PolynomialEquation& equation);

/// Appends the roots of p, the equation's exact polynomial, and sets the status.
void add_exact_roots(const ExactPolynomial& p, const PolynomialEquation& equation, Roots& roots);

/// Both; false, and nothing done, where the exact polynomial is not known.
bool solve_exactly(const PolynomialEquation& equation, Roots& roots);

}  // namespace graze
