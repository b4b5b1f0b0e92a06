// Halley from outside and from equidistant starts: order, suppression, safeguards, and what it may miss.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/solvers/from_starts.hpp>
#include <graze/solvers/halley.hpp>
#include <graze/solvers/newton.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Halley halley(double starts = 32) {
  Parameters options;
  options.set("starts", starts);
  return Halley(options);
}

Roots solve(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  halley().solve(equation, roots);
  return roots;
}

Roots solve(Jet (*eval)(const void*, double), double lo, double hi, double starts, int max_roots = 0) {
  Roots roots;
  halley(starts).solve(ScalarEquation{nullptr, eval, lo, hi, max_roots, 0}, roots);
  return roots;
}

Jet sine(const void* /*self*/, double x) { return {std::sin(x), std::cos(x), -std::sin(x), 0x1p-52}; }
Jet parabola_above(const void* /*self*/, double x) { return {x * x + 1, 2 * x, 2, 0x1p-51}; }
/// Two roots 2^-8 apart about 0.3, far narrower than 32 starts are apart, between two other slopes.
Jet narrow_dip(const void* /*self*/, double x) {
  const double t = (x - 0.3) * 0x1p10, bell = std::exp(-t * t);
  return {1 - 2 * bell, 0x1p12 * t * bell, 0x1p22 * bell * (1 - 2 * t * t), 0x1p-51};
}

TEST(Halley, MaehlysSuppressionFindsAllRealRootsFromOutside) {
  const Roots roots = solve({-5040, 13068, -13132, 6769, -1960, 322, -28, 1});  // 1 ... 7
  ASSERT_EQ(roots.list.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_LE(std::fabs(roots.list[i].x - static_cast<double>(i + 1)), roots.list[i].radius + 0x1p-52);
  }
  EXPECT_EQ(roots.counters.starts, 7U) << "one start a root and none in vain: no step passes a root";
}

/// The steps from 1.2 to the root of x^3 = 2, and whether each error is a fixed multiple of the last one's
/// cube.
TEST(Halley, ConvergesWithThirdOrderOnACubeRoot) {
  const double root = std::cbrt(2.0);
  double x = 1.2, error = std::fabs(x - root);
  for (int step = 0; step < 2; ++step) {
    const from_starts::Local<double> local{.ratio = (x * x * x - 2) / (3 * x * x), .curvature = 2 / x};
    x += from_starts::halley_step(local);
    const double next = std::fabs(x - root);
    // For x^n = a the constant is (n^2 - 1) / (12 a^(2/n)).
    EXPECT_NEAR(next / (error * error * error), 8 / (12 * root * root), 0.05);
    error = next;
  }
  EXPECT_LT(error, 1e-4);
}

TEST(Halley, NeedsFewerStepsThanNewton) {
  const std::vector<double> c{-5040, 13068, -13132, 6769, -1960, 322, -28, 1};
  Roots newton_roots;
  PolynomialEquation equation;
  equation.c = c;
  Newton(Parameters{}).solve(equation, newton_roots);
  const Roots roots = solve(c);
  std::printf("1 ... 7: %u steps, Newton %u\n", roots.counters.iterations, newton_roots.counters.iterations);
  EXPECT_LT(roots.counters.iterations, newton_roots.counters.iterations);
}

TEST(Halley, FindsTheRootsOfTheSineInOrder) {
  const Roots roots = solve(&sine, 1, 20, 32);
  ASSERT_EQ(roots.list.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(roots.list[i].x, static_cast<double>(i + 1) * std::acos(-1.0), 1e-14);
}

TEST(Halley, EndsEarlyOnceThereCanBeNoFurtherRoot) {
  EXPECT_LT(solve(&sine, 1, 20, 64, 2).counters.starts, 64U);
  EXPECT_EQ(solve(&sine, 1, 20, 64, 0).counters.starts, 64U);
}

TEST(Halley, NoRootIsOkAndEmpty) {
  const Roots roots = solve(&parabola_above, -3, 4, 16);
  EXPECT_EQ(roots.status, Status::ok);
  EXPECT_TRUE(roots.list.empty());
}

// What the page says of misses: a dip narrower than the starts are apart is seen by chance only.
TEST(Halley, MissesADipThatNoStartLeadsInto) {
  EXPECT_TRUE(solve(&narrow_dip, -1, 1, 8).list.empty());
  EXPECT_EQ(solve(&narrow_dip, -1, 1, 4000).list.size(), 2U);
}

TEST(Halley, ScalingTheUnknownByPowersOfTwoScalesTheRootsExactly) {
  const std::vector<double> c{3, -7, 1, 1.5};
  const Roots plain = solve(c);
  ASSERT_EQ(plain.list.size(), 3U);
  for (const int k : {-60, -7, 1, 33}) {
    std::vector<double> scaled;
    for (std::size_t i = 0; i < c.size(); ++i) scaled.push_back(std::ldexp(c[i], -k * static_cast<int>(i)));
    const Roots roots = solve(scaled);
    ASSERT_EQ(roots.list.size(), 3U) << k;
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(roots.list[i].x, std::ldexp(plain.list[i].x, k)) << k;
  }
}

TEST(Halley, HardPublishedPolynomialsAreRightButForThoseNamed) {
  for (const HardPolynomial& hard : hard_polynomials()) {
    const Roots roots = solve(hard.c);
    EXPECT_EQ(roots.status, Status::ok) << hard.origin;
    const std::size_t right = count_right(hard, roots, 8);
    // Roots that rounding hides: between them |p| is noise, and they come as one with the multiplicity of
    // all.
    const bool hidden = hard.origin.rfind("cluster 1 +- 2^-26", 0) == 0 ||
                        hard.origin.rfind("cluster 1, 1 +- 2^-16", 0) == 0 ||
                        hard.origin.rfind("Wilkinson 1963, degree 20", 0) == 0;
    if (!hidden) {
      EXPECT_EQ(right, hard.roots.size()) << hard.origin;
    }
    EXPECT_GE(roots.list.size(), 1U) << hard.origin;
  }
}

TEST(Halley, OptionsAreChecked) { EXPECT_THROW(halley(0), std::invalid_argument); }

}  // namespace
}  // namespace graze
