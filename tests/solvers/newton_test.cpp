// Newton from outside and from equidistant starts: order, suppression, safeguards, and what it may miss.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/solvers/newton.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Newton newton(double starts = 32) {
  Parameters options;
  options.set("starts", starts);
  return Newton(options);
}

Roots solve(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  newton().solve(equation, roots);
  return roots;
}

Roots solve(Jet (*eval)(const void*, double), double lo, double hi, double starts, int max_roots = 0) {
  Roots roots;
  newton(starts).solve(ScalarEquation{nullptr, eval, lo, hi, max_roots, 0}, roots);
  return roots;
}

Jet sine(const void* /*self*/, double x) { return {std::sin(x), std::cos(x), -std::sin(x), 0x1p-52}; }
/// Newton's own steps from |x| > 1.3917 run away from the root.
Jet arc_tangent(const void* /*self*/, double x) {
  const double d = 1 / (1 + x * x);
  return {std::atan(x), d, -2 * x * d * d, 0x1p-52};
}
Jet parabola_above(const void* /*self*/, double x) { return {x * x + 1, 2 * x, 2, 0x1p-51}; }
/// Two roots 2^-8 apart about 0.3, far narrower than 32 starts are apart, between two other slopes.
Jet narrow_dip(const void* /*self*/, double x) {
  const double t = (x - 0.3) * 0x1p10, bell = std::exp(-t * t);
  return {1 - 2 * bell, 0x1p12 * t * bell, 0x1p22 * bell * (1 - 2 * t * t), 0x1p-51};
}

TEST(Newton, MaehlysSuppressionFindsAllRealRootsFromOutside) {
  const Roots roots = solve({-5040, 13068, -13132, 6769, -1960, 322, -28, 1});  // 1 ... 7
  ASSERT_EQ(roots.list.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_LE(std::fabs(roots.list[i].x - static_cast<double>(i + 1)), roots.list[i].radius + 0x1p-52);
  }
  EXPECT_EQ(roots.counters.starts, 7U) << "one start a root and none in vain: no step passes a root";
}

// The classic case: from 2 on plain Newton for the arc tangent diverges.
TEST(Newton, HalvedStepsReachTheRootOfTheArcTangentFromAfar) {
  const Roots roots = solve(&arc_tangent, -50, 70, 2);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_NEAR(roots.list[0].x, 0, 1e-15);
}

TEST(Newton, FindsTheRootsOfTheSineInOrder) {
  const Roots roots = solve(&sine, 1, 20, 32);
  ASSERT_EQ(roots.list.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(roots.list[i].x, static_cast<double>(i + 1) * std::acos(-1.0), 1e-14);
}

TEST(Newton, EndsEarlyOnceThereCanBeNoFurtherRoot) {
  EXPECT_LT(solve(&sine, 1, 20, 64, 2).counters.starts, 64U);
  EXPECT_EQ(solve(&sine, 1, 20, 64, 0).counters.starts, 64U);
}

TEST(Newton, NoRootIsOkAndEmpty) {
  const Roots roots = solve(&parabola_above, -3, 4, 16);
  EXPECT_EQ(roots.status, Status::ok);
  EXPECT_TRUE(roots.list.empty());
}

// What the page says of misses: a dip narrower than the starts are apart is seen by chance only.
TEST(Newton, MissesADipThatNoStartLeadsInto) {
  EXPECT_TRUE(solve(&narrow_dip, -1, 1, 8).list.empty());
  EXPECT_EQ(solve(&narrow_dip, -1, 1, 4000).list.size(), 2U);
}

TEST(Newton, ScalingTheUnknownByPowersOfTwoScalesTheRootsExactly) {
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

TEST(Newton, HardPublishedPolynomialsAreRightButForThoseNamed) {
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

TEST(Newton, OptionsAreChecked) { EXPECT_THROW(newton(0), std::invalid_argument); }

}  // namespace
}  // namespace graze
