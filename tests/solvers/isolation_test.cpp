// What the methods that isolate real roots by changes of sign have in common (solvers/isolation.hpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <graze/solvers/bezier_clipping.hpp>
#include <graze/solvers/sturm.hpp>
#include <solvers/realroots_testing.hpp>

namespace graze {
namespace {

using namespace realroots;

template <class S>
class Isolation : public testing::Test {
 protected:
  static Roots ask(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
    return solve(S(Parameters{}), c, lo, hi);
  }
};
using Methods = testing::Types<BezierClipping, Sturm>;
TYPED_TEST_SUITE(Isolation, Methods);

TYPED_TEST(Isolation, RandomPolynomialsGetEveryRootToRounding) {
  constexpr std::uint64_t kSeed = 20261122;
  Rng rng(kSeed);
  double worst = 0;
  for (int degree = 2; degree <= 20; ++degree) {
    double pieces = 0, found = 0;
    constexpr int kCount = 200;
    for (int i = 0; i < kCount; ++i) {
      const std::vector<double> c = random_coefficients(rng, degree);
      const Roots roots = TestFixture::ask(c, -1, 1);
      EXPECT_EQ(roots.status, Status::ok);
      EXPECT_GE(static_cast<int>(roots.list.size()), sign_changes_on_a_grid(c, -1, 1, 256)) << degree;
      for (const Root& root : roots.list)
        if (root.multiplicity == 1) worst = std::max(worst, backward_error(c, root.x));
      pieces += roots.counters.iterations;
      found += static_cast<double>(roots.list.size());
    }
    std::printf("degree %2d: %.2f roots, %.1f iterations\n", degree, found / kCount, pieces / kCount);
  }
  std::printf("seed %llu: worst backward error %.3g n u\n", static_cast<unsigned long long>(kSeed), worst);
  EXPECT_LE(worst, TypeParam::kMeasuredBackward);
}

TYPED_TEST(Isolation, ATouchingRootHasMultiplicityTwo) {
  const double t = 1.0 / 3;
  const Roots roots = TestFixture::ask({-2 * t * t, t * t + 4 * t, -2 - 2 * t, 1}, -1, 4);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].multiplicity, 2U);
  EXPECT_NEAR(roots.list[0].x, t, 1e-8);
  EXPECT_LE(std::fabs(roots.list[0].x - t), roots.list[0].radius);
  EXPECT_EQ(roots.list[1].multiplicity, 1U);
}

TYPED_TEST(Isolation, APairOffTheAxisByMoreThanRoundingIsNoRoot) {
  EXPECT_TRUE(TestFixture::ask({1 + 0x1p-40, -2, 1}).list.empty());
}

TYPED_TEST(Isolation, ATripleRootCountsOnceAsAChangeOfSign) {
  const Roots roots = TestFixture::ask({-1, 3, -3, 1});
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.list[0].multiplicity, 1U);
  EXPECT_NEAR(roots.list[0].x, 1, 2e-5);
}

TYPED_TEST(Isolation, RootsAtClosedEndsCountWithinRounding) {
  EXPECT_EQ(TestFixture::ask({-1, 3}, 1.0 / 3, 1).list.size(), 1U);
  EXPECT_EQ(TestFixture::ask({-1, 3}, 0, 1.0 / 3).list.size(), 1U);
  EXPECT_TRUE(TestFixture::ask({-1, 3}, 0.3333334, 1).list.empty());
}

TYPED_TEST(Isolation, PowersOfTwoScaleTheRootsExactly) {
  Rng rng(7);
  for (int i = 0; i < 300; ++i) {
    const std::vector<double> c = random_coefficients(rng, 1 + i % 14);
    for (const auto& [k, m] : {std::pair{900, 0}, std::pair{-900, 0}, std::pair{3, 40}, std::pair{-5, -60}})
      EXPECT_TRUE(scales_exactly(TypeParam(Parameters{}), c, k, m)) << i << " " << k << " " << m;
  }
}

}  // namespace
}  // namespace graze
