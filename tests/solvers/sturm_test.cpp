// Sturm's theorem in floating point: counts, touching roots, the published hard inputs.
#include <gtest/gtest.h>

#include <cstdio>

#include <graze/solvers/sturm.hpp>

#include "solvers/realroots_testing.hpp"

namespace graze {
namespace {

using namespace realroots;

const Parameters kNone;

Roots ask(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
  return solve(Sturm(kNone), c, lo, hi);
}

// Sturm's own promise: the number of distinct roots between two points, multiplicities not counted.
TEST(Sturm, DistinctRootsOfAPolynomialWithRepeatedFactorsAreCountedOnce) {
  // (x - 1)^2 (x - 2)^2 (x + 3)
  const Roots roots = ask({12, -32, 27, -5, -3, 1});
  ASSERT_EQ(roots.list.size(), 3U);
  EXPECT_NEAR(roots.list[0].x, -3, 1e-14);
  EXPECT_NEAR(roots.list[1].x, 1, 1e-7);
  EXPECT_NEAR(roots.list[2].x, 2, 1e-7);
  EXPECT_EQ(roots.list[1].multiplicity, 2U);
  EXPECT_EQ(roots.list[2].multiplicity, 2U);
}

// The remainders of degree 20 lose all digits, and a leading coefficient of 1e-20 is below their rounding:
// the sequence ends too early, and the solver notices.
TEST(Sturm, PublishedHardInputsAreSolvedToTheirConditionOrUncertain) {
  const std::vector<std::string> merged{"Wilkinson 1963, degree 20", "cluster 1 +- 2^-26",
                                        "cluster 1, 1 +- 2^-16",
                                        "in the manner of Orellana, De Michele 2020: quartic of near roots",
                                        "Flocke, Algorithm 954 (2015), cubic of roots -1, 1e14"};
  const auto all = hard_polynomials();
  ASSERT_GE(all.size(), 21U);
  for (const HardPolynomial& p : all) {
    const Roots roots = ask(p.c);
    const double error = worst_error(p, roots);
    std::printf("%-70.70s %zu roots, %.3g condition units, %u steps\n", p.origin.c_str(), roots.list.size(),
                error, roots.counters.iterations);
    const bool lost = is_one_of(
        p.origin, {"Boost.Math issue 747", "Flocke, Algorithm 954 (2015), cubic of roots -1, 1e14"});
    EXPECT_EQ(roots.status, lost ? Status::uncertain : Status::ok) << p.origin;
    if (lost || is_one_of(p.origin, merged)) continue;
    EXPECT_LE(error, 1) << p.origin;
  }
}

TEST(Sturm, ABudgetThatIsTooSmallIsAFailureAndNoMiss) {
  Parameters options;
  options.set("budget", 10.0);
  EXPECT_EQ(solve(Sturm(options), hard_polynomials()[8].c).status, Status::failed);
}

TEST(Sturm, OptionsAreChecked) {
  Parameters options;
  options.set("budget", 1.0);
  EXPECT_THROW(Sturm{options}, std::invalid_argument);
}

}  // namespace
}  // namespace graze
