// The ladder by itself: what each tier answers, on equations whose roots are known exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <graze/solvers/certified.hpp>
#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/rng.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

PolynomialEquation equation_of(std::span<const double> c, double lo = -kInfinity, double hi = kInfinity) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  return equation;
}

Roots solve(const PolynomialEquation& equation) {
  Roots roots;
  Certified(Parameters{}).solve(equation, roots);
  return roots;
}

TEST(Certified, AQuadraticIsAnsweredByTheFirstTier) {
  const std::vector<double> c{2, -3, 1};
  const Roots roots = solve(equation_of(c));
  EXPECT_EQ(roots.counters.tier, 1U);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].x, 1);
  EXPECT_EQ(roots.list[1].x, 2);
}

// b^2 - ac differs from zero in the last of 106 bits only: b^2 = ac + 2^-104.
TEST(Certified, TheSmallestDiscriminantDecides) {
  const double b = 1 + 0x1p-52;
  const std::vector<double> touches{b * b, -2 * b, 1};  // b^2 is rounded: not a square
  const Roots rounded = solve(equation_of(touches));
  EXPECT_EQ(rounded.status, Status::ok);
  EXPECT_EQ(rounded.list.size(), 2U) << "fl(b^2) < b^2";
  const std::vector<double> exact{1, -2, 1};
  const Roots twice = solve(equation_of(exact));
  ASSERT_EQ(twice.list.size(), 1U);
  EXPECT_EQ(twice.list[0].multiplicity, 2U);
  EXPECT_EQ(twice.list[0].x, 1);
}

TEST(Certified, ATouchingQuarticTakesExactArithmetic) {
  const std::vector<double> c{4, -12, 13, -6, 1};  // (x - 1)^2 (x - 2)^2
  const Roots roots = solve(equation_of(c));
  EXPECT_EQ(roots.status, Status::ok);
  EXPECT_EQ(roots.counters.tier, 3U);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_EQ(roots.list[1].multiplicity, 2U);
  EXPECT_EQ(roots.list[0].x, 1);
  EXPECT_EQ(roots.list[1].x, 2);
}

TEST(Certified, ErrorsOfCoefficientsWithoutExactOnesLeaveATouchUncertain) {
  const std::vector<double> c{4, -12, 13, -6, 1}, error{1e-14, 0, 0, 0, 0};
  PolynomialEquation equation = equation_of(c, 0, 3);
  equation.c_error = error;
  EXPECT_EQ(solve(equation).status, Status::uncertain);
}

// The same coefficients, rounded, with their exact values at hand: 1/16 more than the touch, then less.
TEST(Certified, ExactCoefficientsDecideWhatRoundedOnesCannot) {
  const std::vector<double> c{4, -12, 13, -6, 1}, error{1e-14, 0, 0, 0, 0};
  for (const double moved : {0x1p-60, -0x1p-60, 0.0}) {
    struct Exact {
      double moved;
      void operator()(std::span<Dyadic> to) const {
        const double values[] = {4, -12, 13, -6, 1};
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = Dyadic(values[i]);
        to[0] = to[0] + Dyadic(moved);
      }
    } const exact{moved};
    PolynomialEquation equation = equation_of(c, 0, 3);
    equation.c_error = error;
    equation.exact = {&exact,
                      [](const void* self, std::span<Dyadic> to) { (*static_cast<const Exact*>(self))(to); }};
    const Roots roots = solve(equation);
    EXPECT_EQ(roots.status, Status::ok);
    EXPECT_EQ(roots.counters.tier, 3U);
    EXPECT_EQ(roots.list.size(), moved > 0 ? 0U : moved < 0 ? 4U : 2U) << moved;
  }
}

// 2 x - 1 + a x^2 with |a| <= 1: 1/2 moves, and a second root may come into the interval.
TEST(Certified, ALeadingZeroWithAnErrorLeavesTheDegreeOpen) {
  const std::vector<double> c{-1, 2, 0}, error{0, 0, 1};
  PolynomialEquation equation = equation_of(c, -8, 8);
  equation.c_error = error;
  EXPECT_EQ(solve(equation).status, Status::uncertain);
  const std::vector<double> exact{0, 0, 0};
  equation.c_error = exact;
  const Roots roots = solve(equation);
  EXPECT_EQ(roots.status, Status::ok);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.list[0].x, 0.5);
}

// The slope is 2 +- 1.5, so the root of 2 x - 1 lies between 2/7 and 2.
TEST(Certified, ASlopeThatMayShrinkByMoreThanHalfProvesNoRadius) {
  const std::vector<double> c{-1, 2}, error{0, 1.5};
  PolynomialEquation equation = equation_of(c, -8, 8);
  equation.c_error = error;
  for (const Root& root : solve(equation).list) EXPECT_LE(root.x - root.radius, 2.0 / 7);
  for (const Root& root : solve(equation).list) EXPECT_GE(root.x + root.radius, 2.0);
}

TEST(Certified, RootsOutsideTheClosedIntervalAreNoneAndThoseAtItsEndsAre) {
  const std::vector<double> c{2, -3, 1};
  EXPECT_EQ(solve(equation_of(c, 1, 2)).list.size(), 2U);
  EXPECT_EQ(solve(equation_of(c, std::nextafter(1.0, 2.0), std::nextafter(2.0, 1.0))).list.size(), 0U);
  EXPECT_EQ(solve(equation_of(c, 1, std::nextafter(2.0, 1.0))).list.size(), 1U);
}

TEST(Certified, BernsteinEquationsAreAnsweredExactlyToo) {
  const std::vector<double> square{1, -1, 1};  // (2 x - 1)^2 on [0, 1]
  PolynomialEquation equation = equation_of(square, 0, 1);
  equation.basis = Basis::bernstein;
  const Roots roots = solve(equation);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.list[0].x, 0.5);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
}

TEST(Certified, EveryPublishedHardPolynomialIsAnsweredRight) {
  double worst = 0;
  for (const HardPolynomial& hard : hard_polynomials()) {
    const Roots roots = solve(equation_of(hard.c));
    EXPECT_EQ(roots.status, Status::ok) << hard.origin;
    ASSERT_EQ(roots.list.size(), hard.roots.size()) << hard.origin;
    for (std::size_t i = 0; i < hard.roots.size(); ++i) {
      const double error = std::fabs(roots.list[i].x - hard.roots[i]);
      EXPECT_LE(error, roots.list[i].radius + std::fabs(hard.roots[i]) * 0x1p-52) << hard.origin;
      worst = std::max(worst, error / std::fabs(hard.roots[i]));
    }
  }
  std::printf("worst relative error on the hard polynomials: %.2g\n", worst);
}

TEST(Certified, RandomQuadraticsWithErrorsAreNeverWrong) {
  constexpr std::uint64_t kSeed = 7;
  Rng rng(kSeed);
  int proved = 0;
  for (int i = 0; i < 5000; ++i) {
    // The true polynomial has the double root 1 + k 2^-40 or a pair beside it; the given one is off by
    // `error`.
    const double gap = std::ldexp(rng.uniform(-1, 1), -static_cast<int>(rng.uniform(0, 60)));
    const double error = std::ldexp(1.0, -static_cast<int>(rng.uniform(20, 60)));
    const double constant = 1 - gap;  // x^2 - 2 x + 1 - gap: roots 1 +- sqrt(gap)
    const std::vector<double> c{constant + error * rng.uniform(-0.99, 0.99), -2, 1}, bounds{error, 0, 0};
    const double true_gap = 1 - constant;
    PolynomialEquation equation = equation_of(c, -1, 4);
    equation.c_error = bounds;
    const Roots roots = solve(equation);
    if (roots.status != Status::ok) continue;
    ++proved;
    ASSERT_EQ(roots.list.size(), true_gap > 0   ? 2U
                                 : true_gap < 0 ? 0U
                                                : 1U)
        << std::hexfloat << c[0] << " " << error;
    for (const Root& root : roots.list) {
      const double x = root.x > 1 ? 1 + std::sqrt(true_gap) : 1 - std::sqrt(true_gap);
      EXPECT_LE(std::fabs(root.x - x), root.radius + 0x1p-51) << std::hexfloat << c[0];
    }
  }
  std::printf("seed %d: %d of 5000 proved\n", static_cast<int>(kSeed), proved);
  EXPECT_GT(proved, 1250);
}

TEST(Certified, AMultipleRootInAnIntervalOfOnePointKeepsItsMultiplicity) {
  const std::vector<double> c{0, 0, 0, 0, 0, 1};
  const Roots roots = solve(equation_of(c, 0, 0));
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.list[0].multiplicity, 5U);
}

/// Coefficients that are doubles, as a surface gives them beside their roundings.
std::vector<DoubleDoubleBall> near_of(const std::vector<double>& c) { return {c.begin(), c.end()}; }

double l_of(const Root& root, double origin) {
  const DoubleDouble sum = two_sum(origin, root.x);
  return sum.hi + (sum.lo + root.tail);
}

// x^4 = n 2^-100, as beside the cusp of a horn torus: what is left open of c0 moves x by up to 2^-45.
TEST(Certified, TwoRootsWhereTheSlopeAllButVanishesKeepTheirDigits) {
  constexpr double kOrigin = 4;
  double worst = 0;
  for (int n = 1; n <= 256; ++n) {
    const std::vector<double> exact{-n * 0x1p-100, 0, 0, 0, 1}, error{0x1p-118, 0, 0, 0, 0};
    std::vector<double> c = exact;
    c[0] += error[0];
    std::vector<DoubleDoubleBall> near = near_of(c);
    near[0] = DoubleDoubleBall(DoubleDouble(c[0]), error[0]);
    PolynomialEquation equation = equation_of(c, -4, 4);
    equation.c_error = error;
    equation.exact = {&exact,
                      [](const void* self, std::span<Dyadic> to) {
                        const auto& from = *static_cast<const std::vector<double>*>(self);
                        for (std::size_t i = 0; i < to.size(); ++i) to[i] = Dyadic(from[i]);
                      },
                      kOrigin, near};
    const Roots roots = solve(equation);
    EXPECT_EQ(roots.status, Status::ok);
    ASSERT_EQ(roots.list.size(), 2U) << n;
    for (const Root& root : roots.list) {
      const double way = std::fabs(l_of(root, kOrigin) - kOrigin);  // exact
      worst = std::max(worst, std::fabs(way - std::sqrt(std::sqrt(n)) * 0x1p-25) / (kOrigin * 0x1p-52));
    }
  }
  std::printf("worst error %.3g eps\n", worst);
  EXPECT_LE(worst, 4);
}

// x = -+2^-40 about an origin whose ulp is 2^-32.
TEST(Certified, TwoRootsWithOneNearestDoubleOfLGetNeighbours) {
  constexpr double kOrigin = 0x1.8p+20;
  const std::vector<double> c{-0x1p-80, 0, 1};
  const std::vector<DoubleDoubleBall> near = near_of(c);
  PolynomialEquation equation = equation_of(c, -kOrigin, kOrigin);
  equation.exact.near = near;
  equation.exact.origin = kOrigin;
  const Roots roots = solve(equation);
  EXPECT_EQ(roots.counters.tier, 3U);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(l_of(roots.list[1], kOrigin), std::nextafter(l_of(roots.list[0], kOrigin), kInfinity));
}

TEST(Certified, AnInstructionSetThatIsNoneIsRefused) {
  Parameters options;
  options.set("instruction_set", std::string("mmx"));
  EXPECT_THROW(Certified{options}, std::invalid_argument);
  options.set("instruction_set", std::string("baseline"));
  EXPECT_EQ(Certified::instruction_set(options), InstructionSet::baseline);
}

}  // namespace
}  // namespace graze
