// Bezier clipping: the paper's convergence, touching roots, the published hard inputs.
#include <gtest/gtest.h>

#include <cstdio>

#include <graze/solvers/bezier_clipping.hpp>
#include <graze/solvers/power_basis.hpp>

#include "solvers/realroots_testing.hpp"

namespace graze {
namespace {

using namespace realroots;

const Parameters kNone;

Roots ask(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
  return solve(BezierClipping(kNone), c, lo, hi);
}

// Sederberg and Nishita: clipping converges quadratically to a simple root. From width 1 to 2^-53 that is
// 1, 2, 4, ... 53 digits: 6 doublings, and the pieces that isolate.
TEST(BezierClipping, ClippingConvergesQuadraticallyToASimpleRoot) {
  const Roots roots = ask({-0.3, 0.9, 0.2, 0.1}, 0, 1);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_LE(roots.counters.iterations, 7U);
}

// Without clips that count every piece is halved: bisection needs a piece a bit and more.
TEST(BezierClipping, RefusingClipsLeavesBisection) {
  Parameters options;
  options.set("split", 0.999999);
  const Roots halved = solve(BezierClipping(options), std::vector<double>{-0.3, 0.9, 0.2, 0.1}, 0, 1);
  ASSERT_EQ(halved.list.size(), 1U);
  EXPECT_GT(halved.counters.iterations, 8U);
  EXPECT_NEAR(halved.list[0].x, ask({-0.3, 0.9, 0.2, 0.1}, 0, 1).list[0].x, 0x1p-52);
}

TEST(BezierClipping, PublishedHardInputsAreSolvedToTheirCondition) {
  // Roots nearer than the rounding of p lets the method see, beside those that are hidden from all.
  const std::vector<std::string> merged{"Orellana, De Michele 2020, Algorithm 1010, case 2,",
                                        "Orellana, De Michele 2020, Algorithm 1010, case 17",
                                        "Zeng 2004, TOMS 30(2), after Uhlig: (x+1)^6"};
  const auto all = hard_polynomials();
  ASSERT_GE(all.size(), 21U);
  for (const HardPolynomial& p : all) {
    const Roots roots = ask(p.c);
    const double error = worst_error(p, roots);
    std::printf("%-70.70s %zu roots, %.3g condition units, %u pieces\n", p.origin.c_str(), roots.list.size(),
                error, roots.counters.iterations);
    EXPECT_EQ(roots.status, Status::ok) << p.origin;
    if (is_hidden(p)) expect_nearby_roots(p, roots, power_basis::kBackward);
    if (is_hidden(p) || is_one_of(p.origin, merged)) continue;
    EXPECT_LE(error, 1) << p.origin;
  }
}

TEST(BezierClipping, ABudgetThatIsTooSmallIsAFailureAndNoMiss) {
  Parameters options;
  options.set("budget", 10.0);
  EXPECT_EQ(solve(BezierClipping(options), hard_polynomials()[8].c).status, Status::failed);
}

TEST(BezierClipping, OptionsAreChecked) {
  Parameters options;
  options.set("split", 1.0);
  EXPECT_THROW(BezierClipping{options}, std::invalid_argument);
}

}  // namespace
}  // namespace graze
