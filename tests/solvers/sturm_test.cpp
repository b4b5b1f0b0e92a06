// Sturm's theorem in floating point: counts, touching roots, the published hard inputs.
#include <gtest/gtest.h>

#include <cstdio>

#include <graze/solvers/power_basis.hpp>
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
  // Roots nearer than the rounding of p lets the method see, beside those that are hidden from all.
  const std::vector<std::string> merged{"Orellana, De Michele 2020, Algorithm 1010, case 2,",
                                        "Orellana, De Michele 2020, Algorithm 1010, case 17",
                                        "Zeng 2004, TOMS 30(2), after Uhlig: (x+1)^6"};
  const auto all = hard_polynomials();
  ASSERT_GE(all.size(), 21U);
  for (const HardPolynomial& p : all) {
    const Roots roots = ask(p.c);
    const double error = worst_error(p, roots);
    std::printf("%-70.70s %zu roots, %.3g condition units, %u steps\n", p.origin.c_str(), roots.list.size(),
                error, roots.counters.iterations);
    // Signs that rounding hides in the remainders; case 22 leaves the doubles.
    const bool lost = is_one_of(
        p.origin,
        {"Boost.Math issue 747", "Flocke, Algorithm 954 (2015), cubic of roots -1, 1e14",
         "Jenkins, Traub 1975, TOMS 1(1), p4", "Orellana, De Michele 2020, Algorithm 1010, case 15",
         "Orellana, De Michele 2020, Algorithm 1010, case 16",
         "Orellana, De Michele 2020, Algorithm 1010, case 19",
         "Orellana, De Michele 2020, Algorithm 1010, case 22", "Zeng 2004, TOMS 30(2), after Goedecker"});
    if (lost) {
      EXPECT_TRUE(roots.status == Status::uncertain || roots.status == Status::failed) << p.origin;
      continue;
    }
    EXPECT_EQ(roots.status, Status::ok) << p.origin;
    if (is_hidden(p)) expect_nearby_roots(p, roots, power_basis::kBackward);
    if (is_hidden(p) || is_one_of(p.origin, merged)) continue;
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
