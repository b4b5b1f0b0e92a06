// Exact integers and dyadics against GMP's integers and rationals: random and structured operands.
#include <gtest/gtest.h>

#include <bit>
#include <cinttypes>
#include <cstdio>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/coefficients.hpp>

#include "exact.hpp"
#include "gmp_integers.hpp"

namespace graze {
namespace {

using namespace test;
using Limb = BigInteger::Limb;

constexpr int kCases = 20'000;

Exact exact(const BigInteger& x) { return Exact(gmp(x)); }
Exact exact(const Dyadic& x) {
  const Gmp power = Gmp(1) << static_cast<unsigned>(std::labs(x.exponent()));
  return x.exponent() < 0 ? Exact(gmp(x.mantissa()), power) : Exact(Gmp(gmp(x.mantissa()) * power));
}

/// Equal value and canonical form: no leading zero limb, no negative zero.
::testing::AssertionResult is_value(const BigInteger& x, const Gmp& expected) {
  if (!x.limbs().empty() && x.limbs().back() == 0) return ::testing::AssertionFailure() << "leading zero";
  if (x.limbs().empty() && x != BigInteger()) return ::testing::AssertionFailure() << "negative zero";
  if (gmp(x) == expected) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << gmp(x) << " is not " << expected;
}
::testing::AssertionResult is_value(const Dyadic& x, const Exact& expected) {
  if (x.is_zero() ? x.exponent() != 0 : !x.mantissa().is_odd())
    return ::testing::AssertionFailure() << "not normalised";
  if (exact(x) == expected) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << exact(x) << " is not " << expected;
}

/// Limbs at the ends of their range as often as random ones: carries and division's rare steps live there.
BigInteger structured(Rng& rng, std::size_t most_limbs) {
  const std::array<Limb, 6> ends{0, 1, ~Limb{0}, ~Limb{0} - 1, Limb{1} << 63, (Limb{1} << 63) - 1};
  std::vector<Limb> limbs(rng.next() % (most_limbs + 1));
  for (Limb& limb : limbs) {
    const std::uint64_t kind = rng.next() % 12;
    limb = kind < ends.size() ? ends[kind] : rng.next() >> rng.next() % 64;
  }
  return BigInteger::from_limbs(limbs, rng.next() % 2 == 0);
}

Dyadic random_dyadic(Rng& rng) {
  return Dyadic(structured(rng, 4), static_cast<long>(rng.next() % 400) - 200);
}

int sign_of(const Gmp& x) { return x.sign(); }

/// The double nearest to q, ties to even, found from below by directed comparison only.
double nearest(const Exact& q, double guess) {
  if (abs(q) >= Exact(kMax) + Exact(0x1p970)) return q < 0 ? -kInfinity : kInfinity;
  double best = std::isfinite(guess) ? guess : std::copysign(kMax, guess);
  for (const double x : {next_below(best), next_above(best)}) {
    if (!std::isfinite(x)) continue;
    const Exact error = abs(test::exact(x) - q), least = abs(test::exact(best) - q);
    const bool even = (std::bit_cast<std::uint64_t>(x) & 1U) == 0;
    if (error < least || (error == least && even)) best = x;
  }
  return best;
}

TEST(BigInteger, SumsDifferencesAndProductsAreThoseOfGmp) {
  Rng rng = seeded(1);
  for (int i = 0; i < kCases; ++i) {
    const BigInteger x = structured(rng, 12), y = structured(rng, i % 3 == 0 ? 1 : 12);
    const Gmp a = gmp(x), b = gmp(y);
    ASSERT_TRUE(is_value(x + y, a + b));
    ASSERT_TRUE(is_value(x - y, a - b));
    ASSERT_TRUE(is_value(x * y, a * b));
    ASSERT_TRUE(is_value(-x, -a));
    ASSERT_TRUE(is_value(abs(x), abs(a)));
    ASSERT_EQ((x <=> y) < 0, a < b);
    ASSERT_EQ(x == y, a == b);
    ASSERT_EQ(x.sign(), sign_of(a));
  }
}

TEST(BigInteger, AnOperandMayBeTheResult) {
  Rng rng = seeded(2);
  for (int i = 0; i < kCases / 10; ++i) {
    const BigInteger x = structured(rng, 12);
    const Gmp a = gmp(x);
    BigInteger sum = x, difference = x, product = x, same = x;
    const BigInteger& alias = same;
    ASSERT_TRUE(is_value(sum += sum, 2 * a));
    ASSERT_TRUE(is_value(difference -= difference, 0));
    ASSERT_TRUE(is_value(product *= product, a * a));
    same = alias;
    ASSERT_TRUE(is_value(same, a));
  }
}

TEST(BigInteger, QuotientsAndRemaindersAreThoseOfGmp) {
  Rng rng = seeded(3);
  for (int i = 0; i < 5 * kCases; ++i) {
    const BigInteger x = structured(rng, 10), y = structured(rng, 1 + static_cast<std::size_t>(i) % 6);
    if (y.is_zero()) continue;
    const auto [quotient, remainder] = BigInteger::divide(x, y);
    ASSERT_TRUE(is_value(quotient, gmp(x) / gmp(y)));
    ASSERT_TRUE(is_value(remainder, gmp(x) % gmp(y)));
    ASSERT_EQ(exact_quotient(x * y, y), x);
  }
}

TEST(BigInteger, ATrialDigitThatIsOneTooLargeIsTakenBack) {
  // Two limbs leave no doubt about a trial digit, so it takes a third: B^3 (B/2) over (B/2) B^2 + B - 1
  // guesses B - 1, and the low limb says B - 2. All ones below the top make the guess fail the most.
  constexpr Limb kOnes = ~Limb{0}, kTop = Limb{1} << 63;
  const std::array<std::array<Limb, 4>, 4> dividends{
      {{0, 0, 0, kTop}, {0, 0, kTop - 1, kTop - 1}, {3, 0, kTop, kTop - 1}, {0, kOnes - 1, kOnes, kTop}}};
  const std::array<std::array<Limb, 3>, 4> divisors{
      {{kOnes, 0, kTop}, {1, 0, kTop}, {kOnes, kOnes, kTop}, {kOnes, kOnes, kOnes}}};
  for (const auto& u : dividends) {
    for (const auto& v : divisors) {
      const BigInteger x = BigInteger::from_limbs(u), y = BigInteger::from_limbs(v);
      const auto [quotient, remainder] = BigInteger::divide(x, y);
      EXPECT_TRUE(is_value(quotient, gmp(x) / gmp(y)));
      EXPECT_TRUE(is_value(remainder, gmp(x) % gmp(y)));
    }
  }
}

TEST(BigInteger, DivisionByZeroGivesTheDividendBack) {
  const auto [quotient, remainder] = BigInteger::divide(7, 0);
  EXPECT_TRUE(quotient.is_zero());
  EXPECT_EQ(remainder, BigInteger(7));
}

TEST(BigInteger, ShiftsMultiplyAndDivideByPowersOfTwoRoundingDown) {
  Rng rng = seeded(4);
  for (int i = 0; i < kCases; ++i) {
    const BigInteger x = structured(rng, 10);
    const std::size_t k = rng.next() % 3 == 0 ? 64 * (rng.next() % 12) : rng.next() % 700;
    const Gmp power = Gmp(1) << static_cast<unsigned>(k), a = gmp(x);
    ASSERT_TRUE(is_value(x << k, a * power));
    const Gmp cut = a / power;
    ASSERT_TRUE(is_value(x >> k, a < 0 && cut * power != a ? Gmp(cut - 1) : cut));
  }
}

TEST(BigInteger, DigitsAreCountedFromBothEnds) {
  Rng rng = seeded(5);
  EXPECT_EQ(BigInteger().bit_length(), 0U);
  EXPECT_EQ(BigInteger().trailing_zeros(), 0U);
  for (int i = 0; i < kCases / 10; ++i) {
    const BigInteger x = structured(rng, 10);
    if (x.is_zero()) continue;
    const Gmp a = abs(gmp(x));
    ASSERT_EQ(x.bit_length(), msb(a) + 1);
    ASSERT_EQ(x.trailing_zeros(), lsb(a));
    ASSERT_EQ(x.is_odd(), lsb(a) == 0);
  }
  EXPECT_EQ(BigInteger::power_of_two(200).bit_length(), 201U);
}

TEST(BigInteger, GreatestCommonDivisorsAreThoseOfGmp) {
  Rng rng = seeded(6);
  for (int i = 0; i < kCases / 10; ++i) {
    const BigInteger g = structured(rng, 4), x = g * structured(rng, 4), y = g * structured(rng, 4);
    ASSERT_TRUE(is_value(gcd(x, y), Gmp(gcd(gmp(x), gmp(y)))));
  }
  EXPECT_TRUE(gcd(BigInteger(), BigInteger()).is_zero());
}

TEST(BigInteger, BuiltInIntegersAndDoublesEnterExactly) {
  for (const std::int64_t x : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0},
                               std::int64_t{5}, std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_TRUE(is_value(BigInteger(x), Gmp(x)));
  }
  EXPECT_TRUE(is_value(BigInteger(std::numeric_limits<std::uint64_t>::max()), (Gmp(1) << 64) - 1));
  Rng rng = seeded(7);
  for (int i = 0; i < kCases; ++i) {
    const double x = std::trunc(log_uniform(rng, -3, 1023));
    ASSERT_TRUE(is_value(BigInteger(x), Gmp(test::exact(x))));
    ASSERT_EQ(BigInteger(x).to_double(), x);
  }
  EXPECT_TRUE(is_value(BigInteger(-2.75), -2));
  EXPECT_TRUE(is_value(BigInteger(-0.75), 0));
}

TEST(BigInteger, TheNearestDoubleIsTheNearestOne) {
  Rng rng = seeded(8);
  for (int i = 0; i < kCases; ++i) {
    const BigInteger x = structured(rng, 18);
    const double rounded = x.to_double();
    ASSERT_EQ(rounded, nearest(exact(x), rounded)) << gmp(x);
  }
  const BigInteger largest(kMax), half_step = BigInteger::power_of_two(969 + 1);
  EXPECT_EQ((largest + half_step - 1).to_double(), kMax);
  EXPECT_EQ((largest + half_step).to_double(), kInfinity);
  EXPECT_EQ((-largest - half_step).to_double(), -kInfinity);
}

TEST(BigInteger, ANumberMovedFromCanBeAssignedTo) {
  Rng rng = seeded(9);
  for (int i = 0; i < 100; ++i) {
    BigInteger x = structured(rng, 20);
    const BigInteger copy = x;
    BigInteger y = std::move(x);
    x = copy;
    ASSERT_EQ(x, y);
    x = std::move(y);
    ASSERT_EQ(x, copy);
  }
}

TEST(Dyadic, EveryFiniteDoubleEntersAndLeavesUnchanged) {
  for (const double x : special_values()) {
    EXPECT_TRUE(is_value(Dyadic(x), test::exact(x)));
    EXPECT_EQ(Dyadic(x).to_double(), x);
    EXPECT_EQ(Dyadic(x).round_down(), x);
    EXPECT_EQ(Dyadic(x).round_up(), x);
  }
  Rng rng = seeded(10);
  for (int i = 0; i < kCases; ++i) {
    const double x = log_uniform(rng, -1074, 1023);
    ASSERT_TRUE(is_value(Dyadic(x), test::exact(x)));
    ASSERT_EQ(Dyadic(x).to_double(), x);
  }
}

TEST(Dyadic, SumsDifferencesProductsAndOrderAreThoseOfRationals) {
  Rng rng = seeded(11);
  for (int i = 0; i < kCases; ++i) {
    const Dyadic x = random_dyadic(rng);
    // Every fourth pair is nearly equal, so that sums cancel.
    const Dyadic y = i % 4 == 0 ? x + Dyadic(structured(rng, 1), x.exponent()) : random_dyadic(rng);
    const Exact a = exact(x), b = exact(y);
    ASSERT_TRUE(is_value(x + y, a + b));
    ASSERT_TRUE(is_value(x - y, a - b));
    ASSERT_TRUE(is_value(x * y, a * b));
    ASSERT_TRUE(is_value(sqr(x), a * a));
    ASSERT_TRUE(is_value(-x, -a));
    ASSERT_TRUE(is_value(abs(x), abs(a)));
    ASSERT_EQ((x <=> y) < 0, a < b);
    ASSERT_EQ((x <=> y) > 0, a > b);
    ASSERT_EQ(x == y, a == b);
    ASSERT_TRUE(is_value(scale_by_power(x, -37), a / (Gmp(1) << 37)));
  }
  EXPECT_TRUE(is_value(scale_by_power(Dyadic(), 5), 0));
}

TEST(Dyadic, AssigningOperatorsTakeTheirOwnOperand) {
  Dyadic x(0.75), y(0.75), z(0.75);
  EXPECT_TRUE(is_value(x += x, Exact(3, 2)));
  EXPECT_TRUE(is_value(y -= y, 0));
  EXPECT_TRUE(is_value(z *= z, Exact(9, 16)));
}

TEST(Dyadic, RoundingIsCorrectInTheSubnormalRangeToo) {
  Rng rng = seeded(12);
  for (int i = 0; i < kCases; ++i) {
    const BigInteger m = structured(rng, 3);
    if (m.is_zero()) continue;
    // Places the leading bit about the subnormal range, or anywhere, or about the overflow.
    const long low = i % 3 == 0 ? -1080 : i % 3 == 1 ? -200 : 1015;
    const long top = low + static_cast<long>(rng.next() % (i % 3 == 1 ? 400 : 60));
    const Dyadic x(m, top - static_cast<long>(m.bit_length()));
    const Exact q = exact(x);
    const double rounded = x.to_double();
    ASSERT_EQ(rounded, nearest(q, rounded)) << q;
    ASSERT_TRUE(is_rounded_down(x.round_down(), q)) << q;
    ASSERT_TRUE(is_rounded_up(x.round_up(), q)) << q;
  }
}

TEST(Dyadic, HalfOfTheLeastSubnormalIsATieAndGoesToZero) {
  EXPECT_EQ(Dyadic::power_of_two(-1075).to_double(), 0);
  EXPECT_EQ(Dyadic(BigInteger(3), -1076).to_double(), kTiny);
  EXPECT_EQ(Dyadic(BigInteger(3), -1075).to_double(), 2 * kTiny);
  EXPECT_EQ(Dyadic(BigInteger(-3), -1076).to_double(), -kTiny);
  EXPECT_EQ(Dyadic::power_of_two(-5000).to_double(), 0);
  EXPECT_EQ(Dyadic::power_of_two(-5000).round_up(), kTiny);
  EXPECT_EQ(Dyadic::power_of_two(5000).to_double(), kInfinity);
  EXPECT_EQ(Dyadic::power_of_two(5000).round_down(), kMax);
}

TEST(Dyadic, ADoubleDoubleHoldsAHundredAndSixBits) {
  Rng rng = seeded(13);
  Worst worst("error of a double-double / 2^-106");
  for (int i = 0; i < kCases; ++i) {
    const Dyadic x = random_dyadic(rng);
    const DoubleDouble rounded = x.to_double_double();
    ASSERT_EQ(rounded.hi, rounded.hi + rounded.lo);
    ASSERT_TRUE(worst.within(test::exact(rounded) - exact(x), 0x1p-106 * std::fabs(x.to_double())));
    ASSERT_EQ(Dyadic(rounded).to_double_double(), rounded);
  }
  const DoubleDouble infinite = Dyadic::power_of_two(2000).to_double_double();
  EXPECT_EQ(infinite.hi, kInfinity);
  EXPECT_EQ(infinite.lo, 0);
}

TEST(Dyadic, WholeUnitsAreCountedDownwards) {
  EXPECT_EQ(Dyadic(5.75).floor_in_units_of(-1), BigInteger(11));
  EXPECT_EQ(Dyadic(-5.75).floor_in_units_of(0), BigInteger(-6));
  EXPECT_EQ(Dyadic(96).floor_in_units_of(4), BigInteger(6));
  EXPECT_TRUE(Dyadic().floor_in_units_of(3).is_zero());
}

/// The quartic's cubic coefficient of a torus, as surfaces write formulas for any number type.
template <class T>
T some_formula(const std::array<double, 4>& x) {
  T sum = exactly<T>(0);
  const T two = exactly<T>(2);
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    sum += two * (exactly<T>(x[i]) - exactly<T>(x[i + 1])) * sqr(exactly<T>(x[i])) - -exactly<T>(x[0]);
  }
  return sum;
}

TEST(Dyadic, RunsTheFormulasThatSurfacesWriteForAnyNumberType) {
  Rng rng = seeded(14);
  for (int i = 0; i < kCases / 10; ++i) {
    std::array<double, 4> x{};
    for (double& v : x) v = log_uniform(rng, -300, 300);
    const Dyadic value = some_formula<Dyadic>(x);
    const Interval enclosure = some_formula<Interval>(x);
    ASSERT_TRUE(Dyadic(enclosure.lo) <= value && value <= Dyadic(enclosure.hi));
    Exact sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Exact a = test::exact(x[k]);
      sum += 2 * (a - test::exact(x[k + 1])) * a * a + test::exact(x[0]);
    }
    ASSERT_TRUE(is_value(value, sum));
  }
}

}  // namespace
}  // namespace graze
