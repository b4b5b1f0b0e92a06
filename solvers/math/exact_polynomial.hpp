// Polynomials with integer coefficients and their real roots, without rounding: what is left to ask when
// every faster method has answered "uncertain".
//
// Solves:  p(x) = 0 in a closed interval, ends dyadic or infinite: all distinct real roots with their
//          multiplicities, each as an exact dyadic or in an open interval that no other root shares, and
//          any number of its digits; greatest common divisors, resultants, square-free factors, signs,
//          images and order of roots.
// Needs:   p != 0 (the zero polynomial is the caller's `coincident`); coefficients exact: finite doubles,
//          dyadics, or integers, ascending.
// Returns: roots ascending. Every input has an answer; there is no status and no budget: subdivision ends
//          since roots of a square-free polynomial are apart (theorems of one and of two circles).
// Error:   none. A root's to_double() is the double nearest to the root.
// Cost:    isolation: about n^2/2 sums for each halving, halvings as many as separate the roots, each
//          adding at most n bits to n + 1 coefficients; a factor of 2^k between the sizes of two roots is k
//          halvings. Allocates. Measured (AMD EPYC, g++ 12 -O3), random doubles as coefficients, roots in
//          [0, 1], degree 4 / 6 / 8: isolated in 1.2 / 1.6 / 2.4 us, a root's nearest double 5 / 6 / 8 us
//          more; with a double root 27 / 45 / 91 us; with a pair 2^-60 apart 26 / 44 / 73 us.
// Source:  [CA] G. E. Collins, A. G. Akritas, "Polynomial real root isolation using Descartes' rule of
//          signs", SYMSAC 1976; [RZ] F. Rouillier, P. Zimmermann, "Efficient isolation of polynomial's real
//          roots", J. Comput. Appl. Math. 162, 2004; in the Bernstein basis: J. M. Lane, R. F. Riesenfeld,
//          BIT 21, 1981; [BT] W. S. Brown, J. F. Traub, "On Euclid's algorithm and the theory of
//          subresultants", J. ACM 18, 1971; D. Y. Y. Yun, "On square-free decomposition algorithms", SYMSAC
//          1976; [A] J. Abbott, "Quadratic interval refinement for real roots", ISSAC 2006 (poster); root
//          bound: M. Fujiwara 1916. Changed: a prime modulus shows first whether two polynomials are
//          coprime, which most are; all intervals are [k 2^e, (k+1) 2^e], so that a dyadic root is found as
//          itself.
#pragma once

#include <compare>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <graze/solvers/math/big_integer.hpp>

namespace graze {

/// sum c_i x^i with integer c_i.
class ExactPolynomial {
 public:
  ExactPolynomial() = default;  ///< zero
  /// From ascending coefficients; leading zeros are dropped.
  explicit ExactPolynomial(std::vector<BigInteger> c);
  /// From ascending coefficients, times the power of two that makes them integers without a common factor 2:
  /// the same roots and signs.
  explicit ExactPolynomial(std::span<const Dyadic> c);
  explicit ExactPolynomial(std::span<const double> c);
  /// The same for coefficients in the Bernstein basis on [0, 1].
  static ExactPolynomial from_bernstein(std::span<const Dyadic> b);

  [[nodiscard]] bool is_zero() const { return c_.empty(); }
  /// -1 for zero.
  [[nodiscard]] int degree() const { return static_cast<int>(c_.size()) - 1; }
  /// Ascending; the last one is not zero.
  [[nodiscard]] std::span<const BigInteger> coefficients() const { return c_; }
  /// Needs: not zero.
  [[nodiscard]] const BigInteger& leading() const { return c_.back(); }

  [[nodiscard]] ExactPolynomial derivative() const;
  /// The greatest common divisor of the coefficients, not negative.
  [[nodiscard]] BigInteger content() const;
  /// Without its content, and with a positive leading coefficient.
  [[nodiscard]] ExactPolynomial primitive_part() const;
  [[nodiscard]] Dyadic value_at(const Dyadic& x) const;
  /// -1, 0 or 1.
  [[nodiscard]] int sign_at(const Dyadic& x) const;

  friend ExactPolynomial operator+(const ExactPolynomial& p, const ExactPolynomial& q);
  friend ExactPolynomial operator-(const ExactPolynomial& p, const ExactPolynomial& q);
  friend ExactPolynomial operator*(const ExactPolynomial& p, const ExactPolynomial& q);
  friend ExactPolynomial operator*(const ExactPolynomial& p, const BigInteger& factor);
  friend bool operator==(const ExactPolynomial&, const ExactPolynomial&) = default;

 private:
  std::vector<BigInteger> c_;
};

/// lc(b)^(deg a - deg b + 1) a mod b, for b != 0; a itself where deg a < deg b.
ExactPolynomial pseudo_remainder(const ExactPolynomial& a, const ExactPolynomial& b);
/// a / b where b divides a over the integers.
ExactPolynomial exact_quotient(const ExactPolynomial& a, const ExactPolynomial& b);
/// The greatest common divisor over the rationals, primitive, positive leading coefficient; zero of two
/// zeros. Subresultants [BT].
ExactPolynomial gcd(const ExactPolynomial& a, const ExactPolynomial& b);

/// The resultant: 0 where a and b have a common root, or one of them is zero. Subresultants [BT].
BigInteger resultant(const ExactPolynomial& a, const ExactPolynomial& b);
/// The polynomial of degree deg f whose roots are p(x) for the complex roots x of f, with their
/// multiplicities: Res_x(f(x), y - p(x)) from its values at deg f + 1 integers y. Needs: f != 0.
ExactPolynomial image_polynomial(const ExactPolynomial& f, const ExactPolynomial& p);

/// `polynomial` has only simple roots, and each is a root of the given multiplicity.
struct SquareFreeFactor {
  ExactPolynomial polynomial;
  int multiplicity = 1;
};
/// Pairwise coprime factors by ascending multiplicity, whose product of powers is p but for a constant
/// (Yun). None for a constant. A square-free p is its own factor, as it is.
std::vector<SquareFreeFactor> square_free_factors(const ExactPolynomial& p);

/// A closed interval; an absent end is infinite.
struct DyadicInterval {
  std::optional<Dyadic> lo, hi;
};
/// From doubles, infinite ones included; not NaN.
DyadicInterval dyadic_interval(double lo, double hi);

/// A real root: an exact dyadic, or the one root of a square-free polynomial in an open interval with
/// dyadic ends, where that polynomial has opposite signs.
class RealRoot {
 public:
  /// The root x.
  RealRoot(std::shared_ptr<const ExactPolynomial> p, const Dyadic& x, int multiplicity);
  /// The only root of p in (lo, lo + 2^width); lo is a multiple of 2^width, p(lo) and p(hi) differ in sign.
  RealRoot(std::shared_ptr<const ExactPolynomial> p, const Dyadic& lo, long width, int multiplicity);

  [[nodiscard]] bool is_exact() const { return lo_ == hi_; }
  /// lo < root < hi, or all equal.
  [[nodiscard]] const Dyadic& lo() const { return lo_; }
  [[nodiscard]] const Dyadic& hi() const { return hi_; }
  [[nodiscard]] int multiplicity() const { return multiplicity_; }
  /// Square-free; a divisor of the polynomial that was solved.
  [[nodiscard]] const ExactPolynomial& polynomial() const { return *polynomial_; }

  /// Makes hi - lo <= 2^width. Doubles the number of digits with two evaluations once it converges [A].
  void refine(long width);
  /// -1, 0, 1: the sign of root - x. One evaluation at most.
  [[nodiscard]] int compare_with(const Dyadic& x) const;
  /// The double nearest to the root, ties to even; refines as far as that takes.
  double to_double() { return to_double_from(Dyadic()); }
  /// The double nearest to origin + root, ties to even.
  double to_double_from(const Dyadic& origin);
  /// The double-double that the root rounds to (Dyadic::to_double_double).
  DoubleDouble to_double_double();

 private:
  struct Ends;
  void refine_once(long most_bits, Ends& values);
  void bisect(Ends& values);
  void become(const Dyadic& x) { lo_ = hi_ = x; }
  bool narrow_to(const BigInteger& cell, long bits, Ends& values);
  template <class Number>
  Number rounded(Number (Dyadic::*round)() const, const Dyadic& origin, long digits);

  std::shared_ptr<const ExactPolynomial> polynomial_;
  Dyadic lo_, hi_;
  long width_ = 0;  ///< hi - lo = 2^width, unless exact
  long jump_ = 1;   ///< the next refinement tries to win this many bits
  int multiplicity_ = 1;
};

/// The order of two roots, of one polynomial or of two.
std::strong_ordering compare(RealRoot a, RealRoot b);
/// The sign of q at the root x: -1, 0 or 1.
int sign_at(const ExactPolynomial& q, RealRoot x);

/// p(x), between two dyadics that are equal where x is exact; off by at most |p'| times the width of x.
struct DyadicBounds {
  Dyadic lo, hi;
};
DyadicBounds bounds_at(const ExactPolynomial& p, const RealRoot& x);
/// p(a) = p(b), decided by the image polynomial of both roots.
bool have_equal_images(RealRoot a, RealRoot b, const ExactPolynomial& p);

/// All distinct real roots of p in the interval, ascending. Of an isolating interval, only the root is sure
/// to lie in `interval`. No roots for p = 0.
std::vector<RealRoot> isolate_roots(const ExactPolynomial& p, const DyadicInterval& interval = {});

/// The number of distinct real roots in the interval.
std::size_t count_roots(const ExactPolynomial& p, const DyadicInterval& interval = {});

}  // namespace graze
