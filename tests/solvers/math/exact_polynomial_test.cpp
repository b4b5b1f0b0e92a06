// Exact real roots: against roots known by construction, Sturm's sequences over the rationals, and the
// published hard polynomials with their 40 digits.
#include <gtest/gtest.h>

#include <boost/property_tree/json_parser.hpp>
#include <boost/property_tree/ptree.hpp>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <graze/solvers/math/exact_polynomial.hpp>

#include "exact.hpp"
#include "gmp_integers.hpp"

namespace graze {
namespace {

using namespace test;
using Integers = std::vector<BigInteger>;

BigInteger integer(const Gmp& x) {
  BigInteger value;
  Gmp rest = abs(x);
  for (std::size_t shift = 0; rest != 0; shift += 32, rest >>= 32)
    value += BigInteger(static_cast<std::uint64_t>(rest & 0xffff'ffffU)) << shift;
  return x < 0 ? -value : value;
}
Exact exact(const Dyadic& x) {
  const Gmp power = Gmp(1) << static_cast<unsigned>(std::labs(x.exponent()));
  return x.exponent() < 0 ? Exact(gmp(x.mantissa()), power) : Exact(Gmp(gmp(x.mantissa()) * power));
}
std::vector<Exact> exact(const ExactPolynomial& p) {
  std::vector<Exact> c;
  for (const BigInteger& x : p.coefficients()) c.push_back(Exact(gmp(x)));
  return c;
}

ExactPolynomial polynomial(std::initializer_list<long> c) {
  Integers integers;
  for (const long x : c) integers.emplace_back(x);
  return ExactPolynomial(std::move(integers));
}
ExactPolynomial polynomial(const std::vector<double>& c) {
  return ExactPolynomial(std::span<const double>(c));
}
ExactPolynomial power_of(const ExactPolynomial& p, int k) {
  ExactPolynomial result = polynomial({1});
  for (int i = 0; i < k; ++i) result = result * p;
  return result;
}
/// q x - r for the root r/q.
ExactPolynomial factor_with_root(const Exact& root) {
  return ExactPolynomial(Integers{integer(Gmp(-numerator(root))), integer(Gmp(denominator(root)))});
}
ExactPolynomial random_polynomial(Rng& rng, int degree, std::int64_t most) {
  Integers c;
  const auto range = static_cast<std::uint64_t>(2 * most + 1);
  for (int i = 0; i <= degree; ++i) c.emplace_back(static_cast<std::int64_t>(rng.next() % range) - most);
  return ExactPolynomial(std::move(c));
}

// -------------------------------------------------------------------------------------------
// Sturm's theorem over the rationals: counts distinct roots, by a way of its own.

using Rational = std::vector<Exact>;

void trim(Rational& p) {
  while (!p.empty() && p.back() == 0) p.pop_back();
}
Rational remainder_of(Rational a, const Rational& b) {
  while (a.size() >= b.size()) {
    const Exact factor = a.back() / b.back();
    const std::size_t offset = a.size() - b.size();
    for (std::size_t i = 0; i < b.size(); ++i) a[i + offset] -= factor * b[i];
    a.pop_back();
    trim(a);
  }
  return a;
}
std::vector<Rational> sturm_sequence(const ExactPolynomial& p) {
  std::vector<Rational> sequence{exact(p), exact(p.derivative())};
  while (!sequence.back().empty()) {
    Rational next = remainder_of(sequence[sequence.size() - 2], sequence.back());
    for (Exact& x : next) x = -x;
    sequence.push_back(std::move(next));
  }
  sequence.pop_back();
  return sequence;
}
int variations(const std::vector<Rational>& sequence, const Exact& x) {
  int changes = 0, last = 0;
  for (const Rational& p : sequence) {
    const Exact value = power_value(p, x);
    if (value == 0) continue;
    const int sign = value < 0 ? -1 : 1;
    changes += last != 0 && sign != last ? 1 : 0;
    last = sign;
  }
  return changes;
}
/// Distinct roots in [lo, hi]; Sturm counts (lo, hi] where neither end is a root.
std::size_t sturm_count(const ExactPolynomial& p, const Dyadic& lo, const Dyadic& hi) {
  const auto sequence = sturm_sequence(p);
  // An end that may be a root moves outward by 2^-2000: far less than roots of such small numbers are apart.
  const auto moved = [&](const Dyadic& x, long k, int side) {
    return exact(x + Dyadic(BigInteger(side), k));
  };
  const long fine = -2000;
  return static_cast<std::size_t>(variations(sequence, moved(lo, fine, -1)) -
                                  variations(sequence, moved(hi, fine, 1)));
}

// --------------------------------------------------------------------------------- What every answer must be

/// Ascending, each in an interval of its own with a change of sign, exact roots zeros; as many as said.
void expect_well_formed(const ExactPolynomial& p, const std::vector<RealRoot>& roots) {
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const RealRoot& root = roots[i];
    EXPECT_TRUE(pseudo_remainder(p, root.polynomial()).is_zero());
    if (root.is_exact()) {
      EXPECT_EQ(root.polynomial().sign_at(root.lo()), 0);
    } else {
      EXPECT_EQ(root.polynomial().sign_at(root.lo()) * root.polynomial().sign_at(root.hi()), -1);
    }
    if (i > 0) {
      EXPECT_LE(exact(roots[i - 1].hi()), exact(root.lo()));
    }
  }
}

bool encloses(const RealRoot& root, const Exact& x) {
  return root.is_exact() ? exact(root.lo()) == x : exact(root.lo()) < x && x < exact(root.hi());
}

/// Is x the double nearest to q?
bool is_nearest(double x, const Exact& q) {
  const Exact error = abs(test::exact(x) - q);
  return error <= abs(test::exact(next_below(x)) - q) && error <= abs(test::exact(next_above(x)) - q);
}

// -------------------------------------------------------------------------------------------

TEST(ExactPolynomial, CoefficientsAreIntegersInTheRatioOfTheDoubles) {
  const ExactPolynomial p = polynomial(std::vector<double>{0x1p-1074, 0, -0x1.8p-1072, 0x1p-1070, 0});
  EXPECT_EQ(p, polynomial({1, 0, -6, 16}));
  EXPECT_TRUE(polynomial(std::vector<double>{0, 0}).is_zero());
  EXPECT_EQ(polynomial({3, 0}).degree(), 0);
}

TEST(ExactPolynomial, ValuesAreThoseOfRationals) {
  Rng rng = seeded(1);
  for (int i = 0; i < 2000; ++i) {
    const ExactPolynomial p = random_polynomial(rng, static_cast<int>(rng.next() % 12), 1'000'000'000);
    const Dyadic x(log_uniform(rng, -60, 60));
    ASSERT_EQ(exact(p.value_at(x)), power_value(exact(p), exact(x)));
    ASSERT_EQ(p.sign_at(x), p.value_at(x).sign());
  }
}

TEST(ExactPolynomial, BernsteinCoefficientsGiveTheSameValuesButForAPowerOfTwo) {
  Rng rng = seeded(2);
  for (int i = 0; i < 300; ++i) {
    std::vector<Dyadic> b;
    const std::size_t size = 1 + rng.next() % 12;
    for (std::size_t k = 0; k < size; ++k) b.emplace_back(rng.uniform(-1, 1));
    const ExactPolynomial p = ExactPolynomial::from_bernstein(b);
    std::vector<Exact> rational;
    for (const Dyadic& x : b) rational.push_back(exact(x));
    const Exact ratio = power_value(exact(p), 0) / rational[0];
    for (const double t : {0.25, 0.5, 1.0, 3.0})
      ASSERT_EQ(power_value(exact(p), Exact(t)), ratio * bernstein_value_exact(rational, Exact(t)));
    const Gmp power(numerator(ratio) * denominator(ratio));
    ASSERT_TRUE(power > 0 && (power & (power - 1)) == 0);
  }
}

TEST(ExactPolynomial, APseudoRemainderDiffersByAMultipleOfTheDivisor) {
  Rng rng = seeded(3);
  for (int i = 0; i < 500; ++i) {
    const ExactPolynomial a = random_polynomial(rng, 7, 50), b = random_polynomial(rng, 4, 50);
    if (b.degree() < 1 || a.degree() < b.degree()) continue;
    const ExactPolynomial rest = pseudo_remainder(a, b);
    ASSERT_LT(rest.degree(), b.degree());
    ExactPolynomial multiple = a;
    for (int k = 0; k <= a.degree() - b.degree(); ++k) multiple = multiple * b.leading();
    multiple = multiple - rest;
    ASSERT_EQ(exact_quotient(multiple, b) * b, multiple);
  }
}

TEST(ExactPolynomial, TheGreatestCommonDivisorIsTheOneMultipliedIn) {
  Rng rng = seeded(4);
  for (int i = 0; i < 500; ++i) {
    const ExactPolynomial a = random_polynomial(rng, 5, 1'000'000), b = random_polynomial(rng, 3, 1000);
    const ExactPolynomial g = random_polynomial(rng, static_cast<int>(rng.next() % 5), 1000);
    if (a.is_zero() || b.is_zero() || g.is_zero()) continue;
    const ExactPolynomial common = gcd(a * g, b * g), rest = gcd(a, b);
    ASSERT_EQ(common, (g * rest).primitive_part());
    ASSERT_TRUE(pseudo_remainder(a, rest).is_zero());
  }
  EXPECT_EQ(gcd(polynomial({}), polynomial({2, -4})), polynomial({-1, 2}));
  EXPECT_EQ(gcd(polynomial({4}), polynomial({2})), polynomial({1}));
  EXPECT_TRUE(gcd(polynomial({}), polynomial({})).is_zero());
}

TEST(ExactPolynomial, ACommonDivisorIsFoundWhereDegreesDropByMoreThanOne) {
  // Knuth's example, 4.6.1: coprime, with remainders that lose two degrees at once; and the same times x^3
  // - 2.
  const ExactPolynomial a = polynomial({-5, 2, 8, -3, -3, 0, 1, 0, 1}),
                        b = polynomial({21, -9, -4, 0, 5, 0, 3});
  EXPECT_EQ(gcd(a, b), polynomial({1}));
  const ExactPolynomial g = polynomial({-2, 0, 0, 1});
  EXPECT_EQ(gcd(a * g, b * g), g);
}

TEST(ExactPolynomial, APrimeThatDividesALeadingCoefficientDoesNotMislead) {
  // (2^61 - 1) x + 1 is a constant modulo the prime that the quick test uses.
  const ExactPolynomial p(Integers{1, (BigInteger(1) << 61U) - 1});
  EXPECT_EQ(gcd(p * polynomial({-1, 1}), p * polynomial({1, 1})), p);
  ASSERT_EQ(square_free_factors(p * p).size(), 1U);
  EXPECT_EQ(square_free_factors(p * p)[0].multiplicity, 2);
}

TEST(ExactPolynomial, AResultantIsTheProductOfTheOthersValuesAtTheRoots) {
  // 3 (x - 1)(x - 2)(x + 4) and 2 x^2 + x + 5: 3^2 g(1) g(2) g(-4).
  const ExactPolynomial f(Integers{24, -30, 3, 3}), g(Integers{5, 1, 2}), h(Integers{-2, 1, 0, 7});
  EXPECT_EQ(resultant(f, g), BigInteger(9 * 8 * 15 * 33));
  EXPECT_EQ(resultant(g, f), BigInteger(9 * 8 * 15 * 33));
  EXPECT_EQ(resultant(f, h), BigInteger(27 * 6 * 56 * -454));
  EXPECT_EQ(resultant(h, f), BigInteger(-27 * 6 * 56 * -454));
  EXPECT_EQ(resultant(f, ExactPolynomial(Integers{-2, 1}) * g), 0);
  EXPECT_EQ(resultant(f, ExactPolynomial(Integers{-7})), -343);
  EXPECT_EQ(resultant(ExactPolynomial(Integers{-7}), f), -343);
  EXPECT_EQ(resultant(f, ExactPolynomial()), 0);
  // A remainder that drops two degrees at once: x^4 - 1 and x^3 + 2.
  EXPECT_EQ(resultant(ExactPolynomial(Integers{-1, 0, 0, 0, 1}), ExactPolynomial(Integers{2, 0, 0, 1})), 15);
}

TEST(ExactPolynomial, AnImagePolynomialHasTheValuesAtTheRoots) {
  // (x^2 - 2)(x - 3) and x^2: 2 twice and 9.
  const ExactPolynomial f(Integers{6, -2, -3, 1}), square(Integers{0, 0, 1});
  EXPECT_EQ(image_polynomial(f, square).primitive_part(), ExactPolynomial(Integers{-36, 40, -13, 1}));
}

TEST(RealRoots, EqualImagesAreTold) {
  // x^2 takes one value at both square roots of 2, and another one at the fourth root of 5 next to them.
  const ExactPolynomial square(Integers{0, 0, 1});
  const auto roots =
      isolate_roots(ExactPolynomial(Integers{-2, 0, 1}) * ExactPolynomial(Integers{-5, 0, 0, 0, 1}) *
                    ExactPolynomial(Integers{-1, 0, 1}));
  ASSERT_EQ(roots.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_EQ(have_equal_images(roots[i], roots[k], square), i == k || i + k == 5) << i << " " << k;
  }
  // A dyadic root, and one that is none.
  const auto half = isolate_roots(ExactPolynomial(Integers{-3, 2}));
  const auto other = isolate_roots(ExactPolynomial(Integers{-9, 4, 4}));
  EXPECT_TRUE(have_equal_images(half[0], half[0], square));
  EXPECT_FALSE(have_equal_images(half[0], other[0], square));
  RealRoot refined = half[0];
  refined.refine(-4);
  const DyadicBounds bounds = bounds_at(square, refined);
  EXPECT_EQ(bounds.lo, Dyadic(2.25));
  EXPECT_EQ(bounds.hi, Dyadic(2.25));
}

TEST(ExactPolynomial, SquareFreeFactorsAreThoseMultipliedTogether) {
  Rng rng = seeded(5);
  for (int i = 0; i < 100; ++i) {
    // Irreducible by Eisenstein's criterion for different primes, so coprime.
    const std::map<int, ExactPolynomial> parts{{1, polynomial({3, 0, 3, 1})},
                                               {2, polynomial({-2, 4, 1})},
                                               {3, polynomial({-5, 1})},
                                               {5, polynomial({7, 0, 1})}};
    ExactPolynomial p = polynomial({-6});
    std::vector<std::pair<int, ExactPolynomial>> expected;
    for (const auto& [multiplicity, part] : parts) {
      if (rng.next() % 3 == 0) continue;
      p = p * power_of(part, multiplicity);
      expected.emplace_back(multiplicity, part);
    }
    const auto factors = square_free_factors(p);
    ASSERT_EQ(factors.size(), expected.size());
    for (std::size_t k = 0; k < factors.size(); ++k) {
      EXPECT_EQ(factors[k].multiplicity, expected[k].first);
      EXPECT_EQ(factors[k].polynomial.primitive_part(), expected[k].second);
    }
  }
}

TEST(RealRoots, AConstantHasNone) {
  EXPECT_TRUE(isolate_roots(polynomial({5})).empty());
  EXPECT_TRUE(isolate_roots(polynomial({})).empty());
  EXPECT_TRUE(isolate_roots(polynomial({1, 0, 1})).empty());
}

TEST(RealRoots, ProductsOfKnownFactorsGiveTheirRootsWithMultiplicities) {
  Rng rng = seeded(6);
  for (int i = 0; i < 400; ++i) {
    // Rational roots, every other one dyadic, some close to each other, times a factor without roots.
    std::map<Exact, int> expected;
    ExactPolynomial p = i % 3 == 0 ? polynomial({2, -1, 1}) : polynomial({-3});
    const std::size_t factors = 1 + rng.next() % 5;
    for (std::size_t k = 0; k < factors; ++k) {
      const Gmp denominator = rng.next() % 2 == 0 ? Gmp(Gmp(1) << static_cast<unsigned>(rng.next() % 40))
                                                  : Gmp(1 + rng.next() % 100);
      const Exact root(Gmp(static_cast<std::int64_t>(rng.next() % 2001) - 1000), denominator);
      const int multiplicity = 1 + static_cast<int>(rng.next() % 3);
      expected[root] += multiplicity;
      p = p * power_of(factor_with_root(root), multiplicity);
    }
    auto roots = isolate_roots(p);
    expect_well_formed(p, roots);
    ASSERT_EQ(roots.size(), expected.size());
    std::size_t k = 0;
    for (const auto& [x, multiplicity] : expected) {
      RealRoot& root = roots[k++];
      ASSERT_TRUE(encloses(root, x)) << x;
      ASSERT_EQ(root.multiplicity(), multiplicity);
      ASSERT_TRUE(is_nearest(root.to_double(), x)) << x;
      root.refine(-200);
      ASSERT_TRUE(encloses(root, x)) << x;
      const Gmp denominator(boost::multiprecision::denominator(x));
      ASSERT_EQ(root.is_exact(), (denominator & (denominator - 1)) == 0) << x;
    }
  }
}

TEST(RealRoots, CountsAreThoseOfSturmInEveryInterval) {
  Rng rng = seeded(7);
  std::size_t total = 0;
  for (int i = 0; i < 600; ++i) {
    const int degree = 1 + static_cast<int>(rng.next() % 10);
    ExactPolynomial p = random_polynomial(rng, degree, i % 2 == 0 ? 3 : 1000);
    if (i % 5 == 0) p = p * power_of(random_polynomial(rng, 2, 3), 2);
    if (p.degree() < 1) continue;
    // Ends on a coarse grid, where roots of small polynomials are, too.
    const Dyadic a(std::ldexp(std::round(rng.uniform(-16, 16)), -static_cast<int>(rng.next() % 4)));
    const Dyadic b(std::ldexp(std::round(rng.uniform(-16, 16)), -static_cast<int>(rng.next() % 4)));
    const Dyadic lo = std::min(a, b), hi = std::max(a, b), far = Dyadic::power_of_two(200);
    const auto roots = isolate_roots(p, {lo, hi});
    expect_well_formed(p, roots);
    for (const RealRoot& root : roots) {
      EXPECT_GE(root.compare_with(lo), 0);
      EXPECT_LE(root.compare_with(hi), 0);
    }
    ASSERT_EQ(roots.size(), sturm_count(p, lo, hi)) << i;
    ASSERT_EQ(count_roots(p, {{}, hi}), sturm_count(p, -far, hi));
    ASSERT_EQ(count_roots(p, {lo, {}}), sturm_count(p, lo, far));
    ASSERT_EQ(count_roots(p), sturm_count(p, -far, far));
    total += roots.size();
  }
  EXPECT_GT(total, 300U);
}

TEST(RealRoots, RandomDoublesAsCoefficientsCountAsSturm) {
  Rng rng = seeded(8);
  for (int i = 0; i < 150; ++i) {
    std::vector<double> c;
    const std::size_t size = 2 + rng.next() % 8;
    for (std::size_t k = 0; k < size; ++k) c.push_back(log_uniform(rng, -20, 20));
    const ExactPolynomial p = polynomial(c);
    const Dyadic far = Dyadic::power_of_two(300);
    ASSERT_EQ(count_roots(p), sturm_count(p, -far, far));
    ASSERT_EQ(count_roots(p, dyadic_interval(0, 1)), sturm_count(p, Dyadic(), Dyadic(1.0)));
  }
}

TEST(RealRoots, AnEndThatIsARootBelongsToTheInterval) {
  const ExactPolynomial p = polynomial({0, 2, -3, 1});  // x (x - 1) (x - 2)
  const auto count = [&](double lo, double hi) { return count_roots(p, dyadic_interval(lo, hi)); };
  EXPECT_EQ(count(0, 2), 3U);
  EXPECT_EQ(count(0, 1), 2U);
  EXPECT_EQ(count(1, 1), 1U);
  EXPECT_EQ(count(0, 0), 1U);
  EXPECT_EQ(count(0x1p-1074, 2), 2U);
  EXPECT_EQ(count(-1, -0x1p-1074), 0U);
  EXPECT_EQ(count(1, next_below(2)), 1U);
  EXPECT_EQ(count(next_above(1), next_below(2)), 0U);
  EXPECT_EQ(count(2, kInfinity), 1U);
  EXPECT_EQ(count(-kInfinity, 0), 1U);
  EXPECT_EQ(count(-kInfinity, kInfinity), 3U);
  EXPECT_EQ(count(2, 1), 0U);
  EXPECT_EQ(count(kInfinity, kInfinity), 0U);
}

TEST(RealRoots, AnEndThatIsARootBelongsToTheIntervalInsideACellToo) {
  const ExactPolynomial p = polynomial({-3, 1});
  for (const auto& [lo, hi] : {std::pair{1.0, 3.0}, {3.0, 5.0}, {2.5, 3.0}, {3.0, 3.5}, {-7.0, 3.0}}) {
    const auto roots = isolate_roots(p, dyadic_interval(lo, hi));
    ASSERT_EQ(roots.size(), 1U) << lo << " " << hi;
    EXPECT_EQ(roots[0].compare_with(Dyadic(3.0)), 0);
    EXPECT_EQ(count_roots(p, dyadic_interval(lo == 3 ? next_above(3) : lo, hi == 3 ? next_below(3) : hi)),
              0U);
  }
}

TEST(RealRoots, EndsWithinAnIsolatingIntervalDecideOnTheRoot) {
  // The root of 3x - 1 between ends that no power of two separates from it for long.
  const ExactPolynomial p = polynomial({-1, 3});
  const double third = 1.0 / 3;  // below 1/3
  EXPECT_EQ(count_roots(p, dyadic_interval(third, next_above(third))), 1U);
  EXPECT_EQ(count_roots(p, dyadic_interval(0.25, third)), 0U);
  EXPECT_EQ(count_roots(p, dyadic_interval(next_above(third), 0.75)), 0U);
  EXPECT_EQ(count_roots(p, dyadic_interval(-5, third)), 0U);
  EXPECT_EQ(count_roots(p, dyadic_interval(-5, 0x1p900)), 1U);
}

TEST(RealRoots, WilkinsonsRootsAreTheIntegers) {
  for (const int n : {12, 20, 40, 64}) {
    ExactPolynomial p = polynomial({1});
    for (int k = 1; k <= n; ++k) p = p * polynomial({-k, 1});
    auto roots = isolate_roots(p);
    ASSERT_EQ(roots.size(), static_cast<std::size_t>(n));
    for (int k = 1; k <= n; ++k) EXPECT_EQ(roots[static_cast<std::size_t>(k - 1)].to_double(), k);
  }
}

TEST(RealRoots, MignottesPairsAreToldApart) {
  // x^n - 2 (a x - 1)^2: two roots near 1/a, about 2 a^-(n+2)/2 apart.
  for (const int n : {3, 8, 17, 32, 64}) {
    for (const long a : {5L, 1000L, 1'000'003L}) {
      Integers c(static_cast<std::size_t>(n) + 1);
      c[0] = -2;
      c[1] = 4 * a;
      c[2] = -2 * a * a;
      c[static_cast<std::size_t>(n)] += 1;
      const ExactPolynomial p(std::move(c));
      auto roots = isolate_roots(p, dyadic_interval(0, 1));
      expect_well_formed(p, roots);
      ASSERT_EQ(roots.size(), 2U) << n << " " << a;
      EXPECT_LT(exact(roots[0].lo()), Exact(1, a));
      EXPECT_GT(exact(roots[1].hi()), Exact(1, a));
    }
  }
}

TEST(RealRoots, ClustersAboutOneKeepTheirMembers) {
  for (const long k : {2L, 26L, 53L, 200L, 1000L}) {
    // (x - 1)^2 - 2^-2k and (x - 1) times it, exactly.
    const ExactPolynomial linear(Integers{-1, 1});
    const ExactPolynomial unit(Integers{BigInteger::power_of_two(static_cast<std::size_t>(2 * k))});
    const ExactPolynomial pair = linear * linear * unit - polynomial({1});
    for (const ExactPolynomial& p : {pair, pair * linear, pair * power_of(linear, 3)}) {
      auto roots = isolate_roots(p);
      ASSERT_EQ(roots.size(), p == pair ? 2U : 3U);
      roots.front().refine(-k - 5);
      roots.back().refine(-k - 5);
      EXPECT_EQ(roots.front().lo(), Dyadic(1.0) - Dyadic::power_of_two(-k));
      EXPECT_EQ(roots.back().hi(), Dyadic(1.0) + Dyadic::power_of_two(-k));
      EXPECT_TRUE(roots.front().is_exact() && roots.back().is_exact());
    }
  }
}

TEST(RealRoots, NearlyTouchingIsNotTouching) {
  for (const long k : {10L, 60L, 500L}) {
    const ExactPolynomial square(Integers{BigInteger::power_of_two(static_cast<std::size_t>(k)) * 1,
                                          BigInteger::power_of_two(static_cast<std::size_t>(k)) * -2,
                                          BigInteger::power_of_two(static_cast<std::size_t>(k))});
    EXPECT_EQ(count_roots(square - polynomial({1})), 2U);
    EXPECT_EQ(count_roots(square - polynomial({-1})), 0U);
    const auto roots = isolate_roots(square);
    ASSERT_EQ(roots.size(), 1U);
    EXPECT_EQ(roots[0].multiplicity(), 2);
  }
}

TEST(RealRoots, ChebyshevPolynomialsOfDegreeSixtyFourHaveAllTheirRoots) {
  ExactPolynomial before = polynomial({1}), here = polynomial({0, 1});
  for (int n = 1; n < 64; ++n) {
    ExactPolynomial next = polynomial({0, 2}) * here - before;
    before = std::exchange(here, std::move(next));
  }
  auto roots = isolate_roots(here, dyadic_interval(-1, 1));
  ASSERT_EQ(roots.size(), 64U);
  for (std::size_t i = 0; i < 64; ++i) {
    const double x = std::cos(3.14159265358979323846 * (2 * static_cast<double>(64 - i) - 1) / 128);
    EXPECT_NEAR(roots[i].to_double(), x, 4e-16);
  }
}

TEST(RealRoots, MagnitudesOfManyHundredBinaryDigitsDoNotMatter) {
  for (const int k : {-900, -400, 0, 400, 900}) {
    const double scale = std::ldexp(1.0, k);
    const auto roots = isolate_roots(polynomial(std::vector<double>{2 * scale, -3 * scale, scale}));
    ASSERT_EQ(roots.size(), 2U);
    EXPECT_EQ(roots[0].compare_with(Dyadic(1.0)), 0);
    EXPECT_EQ(roots[1].compare_with(Dyadic(2.0)), 0);
  }
  // One root of 2^-900 and one of 2^900.
  auto roots = isolate_roots(polynomial(std::vector<double>{1, -0x1p900 - 0, 1}));
  ASSERT_EQ(roots.size(), 2U);
  EXPECT_EQ(roots[0].to_double(), 0x1p-900);
  EXPECT_EQ(roots[1].to_double(), 0x1p900);
}

TEST(RealRoots, ScalingBothPolynomialAndUnknownScalesTheRootsExactly) {
  Rng rng = seeded(9);
  for (int i = 0; i < 100; ++i) {
    std::vector<double> c;
    for (int k = 0; k <= 6; ++k) c.push_back(rng.uniform(-1, 1));
    const int shift = static_cast<int>(rng.next() % 60) - 30;
    std::vector<double> scaled = c;
    for (std::size_t k = 0; k < c.size(); ++k) scaled[k] = std::ldexp(c[k], 11 - shift * static_cast<int>(k));
    auto roots = isolate_roots(polynomial(c)), moved = isolate_roots(polynomial(scaled));
    ASSERT_EQ(roots.size(), moved.size());
    for (std::size_t k = 0; k < roots.size(); ++k) {
      ASSERT_EQ(scale_by_power(roots[k].lo(), shift), moved[k].lo());
      ASSERT_EQ(std::ldexp(roots[k].to_double(), shift), moved[k].to_double());
    }
  }
}

TEST(RealRoots, AnyNumberOfDigitsOfARootCanBeHad) {
  for (const long bits : {1L, 53L, 1000L, 20000L}) {
    auto roots = isolate_roots(polynomial({-2, 0, 1}), dyadic_interval(0, kInfinity));
    ASSERT_EQ(roots.size(), 1U);
    roots[0].refine(-bits);
    ASSERT_FALSE(roots[0].is_exact());
    EXPECT_LE(exact(roots[0].hi()) - exact(roots[0].lo()), exact(Dyadic::power_of_two(-bits)));
    EXPECT_LT(exact(sqr(roots[0].lo())), 2);
    EXPECT_GT(exact(sqr(roots[0].hi())), 2);
  }
}

TEST(RealRoots, EveryRefinementKeepsTheRootAndTheChangeOfSign) {
  Rng rng = seeded(12);
  for (int i = 0; i < 200; ++i) {
    const Gmp denominator = i % 2 == 0 ? Gmp(Gmp(1) << static_cast<unsigned>(rng.next() % 50)) : Gmp(11);
    const Exact x(Gmp(static_cast<std::int64_t>(rng.next() % 20001) - 10000), denominator);
    const ExactPolynomial p = factor_with_root(x) * polynomial({3, 0, 1, 0, 2});
    auto roots = isolate_roots(p);
    ASSERT_EQ(roots.size(), 1U);
    RealRoot& root = roots[0];
    for (long width = 12; width > -60; width -= 1 + static_cast<long>(rng.next() % 7)) {
      root.refine(width);
      expect_well_formed(p, roots);
      ASSERT_TRUE(encloses(root, x)) << x;
      ASSERT_LE(exact(root.hi()) - exact(root.lo()), exact(Dyadic::power_of_two(width)));
    }
  }
}

TEST(RealRoots, RoundingGivesTheNearestDoubleAndDoubleDouble) {
  Rng rng = seeded(10);
  for (int i = 0; i < 500; ++i) {
    // x^2 = c: the nearest root is the one that IEEE's square root gives.
    const double c = std::fabs(log_uniform(rng, -1000, 1000));
    auto roots = isolate_roots(polynomial(std::vector<double>{-c, 0, 1}));
    ASSERT_EQ(roots.size(), 2U);
    const DoubleDouble pair = roots[1].to_double_double();
    ASSERT_EQ(roots[1].to_double(), std::sqrt(c));
    ASSERT_EQ(roots[0].to_double(), -std::sqrt(c));
    ASSERT_EQ(pair.hi, std::sqrt(c));
    const Exact error = abs(test::exact(pair) * test::exact(pair) - test::exact(c)) / test::exact(c);
    ASSERT_LE(to_double(error), 0x1p-105);
  }
  // A root halfway between two doubles goes to the even one; next to it, to its own side.
  const Dyadic half = Dyadic(1.0) + Dyadic::power_of_two(-53), little = Dyadic::power_of_two(-300);
  for (const int side : {-1, 0, 1}) {
    const Dyadic x = half + Dyadic(static_cast<double>(side)) * little;
    const std::vector<Dyadic> c{-x, Dyadic(1.0)};
    auto roots = isolate_roots(ExactPolynomial(std::span<const Dyadic>(c)));
    EXPECT_EQ(roots[0].to_double(), side == 1 ? next_above(1.0) : 1.0);
  }
  // Below half the least subnormal a root rounds to zero, above it to that subnormal.
  for (const long top : {-1076L, -1075L, -1074L}) {
    const std::vector<Dyadic> c{-Dyadic(BigInteger(4), top), Dyadic(BigInteger(3))};  // 4/3 2^top
    auto roots = isolate_roots(ExactPolynomial(std::span<const Dyadic>(c)));
    EXPECT_EQ(roots[0].to_double(), top == -1076 ? 0 : kTiny);
  }
}

TEST(RealRoots, RootsOfTwoPolynomialsAreOrdered) {
  const auto root_of = [](const ExactPolynomial& p) {
    return isolate_roots(p, dyadic_interval(0, kInfinity)).at(0);
  };
  const RealRoot root_2 = root_of(polynomial({-2, 0, 1}));
  const RealRoot same = root_of(polynomial({-2, 0, 1}) * polynomial({7, 0, 0, 1}));
  const RealRoot near = root_of(polynomial(std::vector<double>{-std::sqrt(2.0), 1}));
  const RealRoot third = root_of(polynomial({-1, 3})), two_thirds = root_of(polynomial({-4, 0, 9}));
  EXPECT_TRUE(compare(root_2, same) == 0);
  EXPECT_TRUE(compare(root_2, root_2) == 0);
  // fl(sqrt 2) lies above sqrt 2.
  EXPECT_TRUE(compare(root_2, near) < 0);
  EXPECT_TRUE(compare(near, root_2) > 0);
  EXPECT_TRUE(compare(third, two_thirds) < 0);
  EXPECT_TRUE(compare(root_of(polynomial({-6, 9})), two_thirds) == 0);
  // A common factor whose root is another one, in intervals that overlap.
  const ExactPolynomial common = polynomial({-4, 3});
  const RealRoot second = isolate_roots(common * polynomial({-2, 0, 1}), dyadic_interval(1, 2)).at(1);
  const RealRoot wide = root_of(common * polynomial({1, 0, 1}));
  ASSERT_TRUE(second.lo() < wide.hi());
  EXPECT_TRUE(compare(wide, second) < 0);
  EXPECT_TRUE(compare(second, wide) > 0);
  EXPECT_TRUE(compare(second, root_2) == 0);
  // Two algebraic numbers that agree to 60 digits.
  const BigInteger big = BigInteger::power_of_two(400);
  const RealRoot above = root_of(ExactPolynomial(Integers{-(big * 2) - 1, 0, big}));
  EXPECT_TRUE(compare(root_2, above) < 0);
  EXPECT_TRUE(compare(above, same) > 0);
}

TEST(RealRoots, TheSignOfAnotherPolynomialAtARootIsKnown) {
  const RealRoot root_2 = isolate_roots(polynomial({-2, 0, 1}), dyadic_interval(0, 4)).at(0);
  const BigInteger big = BigInteger::power_of_two(400);
  EXPECT_EQ(sign_at(polynomial({-2, 0, 1}) * polynomial({5, -7, 3}), root_2), 0);
  EXPECT_EQ(sign_at(ExactPolynomial(Integers{-(big * 2) - 1, 0, big}), root_2), -1);
  EXPECT_EQ(sign_at(ExactPolynomial(Integers{-(big * 2) + 1, 0, big}), root_2), 1);
  EXPECT_EQ(sign_at(power_of(polynomial({-4, 3}), 2), root_2), 1);
  EXPECT_EQ(sign_at(polynomial({-3}), root_2), -1);
  // A common factor that vanishes elsewhere is no zero here.
  const ExactPolynomial common = polynomial({-4, 3});
  const RealRoot second = isolate_roots(common * polynomial({-2, 0, 1}), dyadic_interval(1, 2)).at(1);
  EXPECT_EQ(sign_at(common * polynomial({5, 1}), second), 1);
  EXPECT_EQ(sign_at(common * polynomial({-5, 1}), second), -1);
  EXPECT_EQ(sign_at(polynomial({}), root_2), 0);
  Rng rng = seeded(13);
  for (int i = 0; i < 300; ++i) {
    const Exact x(Gmp(static_cast<std::int64_t>(rng.next() % 201) - 100), Gmp(1 + rng.next() % 20));
    const auto roots = isolate_roots(factor_with_root(x) * polynomial({1, 0, 1}));
    ExactPolynomial q = random_polynomial(rng, 5, 1000);
    if (i % 3 == 0) q = q * factor_with_root(x);
    const Exact value = power_value(exact(q), x);
    ASSERT_EQ(sign_at(q, roots.at(0)), value < 0 ? -1 : value > 0 ? 1 : 0);
  }
}

struct Hard {
  std::string origin;
  std::vector<double> c;
  std::vector<std::string> roots;
};

std::vector<Hard> hard_polynomials() {
  std::ifstream file(GRAZE_TEST_DATA "/polynomials_hard.jsonl");
  std::vector<Hard> all;
  for (std::string line; std::getline(file, line);) {
    std::istringstream text(line);
    boost::property_tree::ptree tree;
    boost::property_tree::read_json(text, tree);
    Hard hard{tree.get<std::string>("origin"), {}, {}};
    for (const auto& [name, c] : tree.get_child("c"))
      hard.c.push_back(std::strtod(c.data().c_str(), nullptr));
    for (const auto& [name, x] : tree.get_child("roots")) hard.roots.push_back(x.data());
    all.push_back(std::move(hard));
  }
  return all;
}

/// A decimal number, and one unit of the last of its 40 digits.
struct Decimal {
  Exact value, unit;
};
Decimal decimal(const std::string& text) {
  Gmp digits = 0, power = 1;
  bool fraction = false;
  for (const char character : text) {
    if (character == '.') fraction = true;
    if (character < '0' || character > '9') continue;
    digits = 10 * digits + (character - '0');
    if (fraction) power *= 10;
  }
  const Exact value(text.front() == '-' ? Gmp(-digits) : digits, power);
  Exact unit = abs(value);
  for (int i = 0; i < 39; ++i) unit /= 10;
  return {value, unit};
}

TEST(RealRoots, PublishedHardPolynomialsHaveTheirFortyDigits) {
  const auto all = hard_polynomials();
  ASSERT_GE(all.size(), 15U);
  for (const Hard& hard : all) {
    const ExactPolynomial p = polynomial(hard.c);
    auto roots = isolate_roots(p);
    expect_well_formed(p, roots);
    ASSERT_EQ(roots.size(), hard.roots.size()) << hard.origin;
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const Decimal expected = decimal(hard.roots[i]);
      roots[i].refine(static_cast<long>(std::ilogb(to_double(expected.value))) - 150);
      EXPECT_LE(abs(exact(roots[i].lo()) - expected.value), expected.unit) << hard.origin;
      EXPECT_TRUE(is_nearest(roots[i].to_double(), expected.value)) << hard.origin;
    }
  }
}

/// Microseconds for one isolation and rounding of all roots in [0, 1]; printed, never judged.
double microseconds(const std::vector<ExactPolynomial>& all) {
  const auto start = std::chrono::steady_clock::now();
  double sum = 0;
  for (const ExactPolynomial& p : all) {
    for (RealRoot& root : isolate_roots(p, dyadic_interval(0, 1))) sum += root.to_double();
  }
  const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
  EXPECT_GE(sum, 0);
  return time.count() / static_cast<double>(all.size());
}

TEST(RealRoots, TimesAreOnRecord) {
  Rng rng = seeded(11);
  for (const int degree : {4, 6, 8, 16}) {
    for (const int limbs : {1, 4, 7}) {
      std::vector<ExactPolynomial> all;
      for (int i = 0; i < 300; ++i) {
        Integers c;
        for (int k = 0; k <= degree; ++k) {
          std::vector<std::uint64_t> digits;
          for (int j = 0; j < limbs; ++j) digits.push_back(j == 0 ? rng.next() >> 11 << 11 : rng.next());
          c.push_back(BigInteger::from_limbs(digits, rng.next() % 2 == 0));
        }
        all.emplace_back(std::move(c));
      }
      std::printf("    degree %2d, %3d bits: %.1f us\n", degree, 64 * limbs - (limbs == 1 ? 11 : 0),
                  microseconds(all));
    }
  }
}

}  // namespace
}  // namespace graze
