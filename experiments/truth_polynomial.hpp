// Exact polynomials in one unknown: the machinery under certified truth. No rounding anywhere in this file.
//
// Polynomials are integer coefficients in ascending order without a leading zero; the empty list is zero.
// Numbers of the form m / 2^k stand for all points that are tried, so evaluation stays in the integers.
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace graze::truth {

using Integer = boost::multiprecision::number<boost::multiprecision::gmp_int, boost::multiprecision::et_off>;
using Rational =
    boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
using Polynomial = std::vector<Integer>;

inline int sign(const Integer& a) { return mpz_sgn(a.backend().data()); }
/// Bits of |a|: |a| < 2^bits(a); 0 for zero.
long bits(const Integer& a);
/// a 2^k for k >= 0.
Integer shifted(const Integer& a, long k);

/// An exact double m 2^e with m odd, or m = 0.
struct Dyadic {
  std::int64_t m = 0;
  long e = 0;
};
Dyadic exact(double x);

inline long degree(const Polynomial& p) { return static_cast<long>(p.size()) - 1; }
void trim(Polynomial& p);
Polynomial add(const Polynomial& a, const Polynomial& b);
Polynomial multiply(const Polynomial& a, const Polynomial& b);
Polynomial scaled(const Polynomial& p, const Integer& factor);
Polynomial derivative(const Polynomial& p);
/// p(x + a).
Polynomial taylor_shift(Polynomial p, const Integer& a);
/// 2^(k deg p) p(m / 2^k); for k < 0 it is p(m 2^-k). Horner, deg p multiplications.
Integer value_at(const Polynomial& p, const Integer& m, long k);
/// q with p = q b over the integers, if there is one; b != 0.
std::optional<Polynomial> divide_exact(const Polynomial& p, const Polynomial& b);
/// p without its integer content, leading coefficient positive.
Polynomial primitive(Polynomial p);

/// Greatest common divisor, primitive. Computed modulo primes and joined by the Chinese remainder theorem;
/// proved by trial division (Brown 1971), so an unlucky prime costs time and never correctness.
Polynomial gcd(const Polynomial& a, const Polynomial& b);
/// p = constant * product of factor^multiplicity, factors square-free and coprime (Yun 1976).
/// A gcd modulo one prime proves the usual case, square-free p, at once.
std::vector<std::pair<Polynomial, std::uint32_t>> square_free(const Polynomial& p);
/// Res_t(p(t), w - f(t)) as polynomial in w: its roots are f(t_i) at the roots t_i of p. deg p, deg f >= 1.
Polynomial image_resultant(const Polynomial& p, const Polynomial& f);

/// A real root with proof: exactly m / 2^k, or the only root of *p in the open interval (m, m + 1) / 2^k,
/// simple, and *p is not zero at both ends.
struct Root {
  std::shared_ptr<const Polynomial> p;
  Integer m;
  long k = 0;
  bool exact = false;
  int left_sign = 0;  ///< sign of *p at m / 2^k
  std::uint32_t multiplicity = 1;
  long step = 1;  ///< bits that the next refinement tries to gain
};

/// All roots in the closed interval [0, 1], ascending, with their multiplicities in p. p != 0.
/// Descartes' rule of signs in the Bernstein basis, bisection by de Casteljau over the integers.
std::vector<Root> roots_in_unit_interval(const Polynomial& p);
/// All real roots, ascending, with their multiplicities in p. p != 0. Positive and negative roots are first
/// parted by powers of two, so that 1e-300 beside 1e300 costs no thousand bisections.
std::vector<Root> all_real_roots(const Polynomial& p);

/// Narrows the interval to 2^-k or less. Quadratic interval refinement (Abbott 2014): the secant names a cell
/// of a grid, two exact signs prove it, and the next grid is squared.
void refine(Root& root, long k);
/// f(root) = 0, decided exactly by gcd.
bool vanishes_at(const Root& root, const Polynomial& f);
/// Sign of f(root), decided exactly; narrows the root as needed.
int sign_at(Root& root, const Polynomial& f);
/// f(a) = f(b) for roots in [0, 1], decided exactly: both values are roots of one resultant, equal when one
/// interval that holds a single root of it holds both.
bool equal_images(Root& a, Root& b, const Polynomial& f);
/// A bound of |f'| on [0, 1].
Integer lipschitz_bound(const Polynomial& f);
/// Some t in [0, 1] has f(t) > 0.
bool takes_positive_value(const Polynomial& f);

}  // namespace graze::truth
