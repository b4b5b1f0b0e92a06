// The plane: values by hand, one side or both, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

class PlaneTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("plane")) GTEST_SKIP() << "this build has no plane";
  }
};

TEST_F(PlaneTest, TheWorkedCrossingHasItsValueInBothFormulations) {
  // x + 2y + z = -2 from (1, 1, 1) along (-1, 0, 0): x = -5, so l = 6.
  for (const char* const formulation : {"exact", "plain"}) {
    const Ray ray{{1, 1, 1}, {-1, 0, 0}};
    const Answer answer = ask(closed_form_scene(plane({1, 2, 1}, -2), formulation), {&ray, 1})[0];
    ASSERT_EQ(answer.l, std::vector<double>{6}) << formulation;
    EXPECT_NEAR(answer.normal[0].y, 2 / std::sqrt(6.0), 1e-15);
  }
}

TEST_F(PlaneTest, AOneSidedPlaneIsHitFromItsFrontOnly) {
  const std::vector<Ray> rays{{{0, 0, 5}, {0, 0, -1}}, {{0, 0, -5}, {0, 0, 1}}, {{0, 0, 1}, {1, 0, 0}}};
  for (const char* const formulation : {"exact", "plain"}) {
    const auto one = ask(closed_form_scene(plane({0, 0, 1}, 1, true), formulation), rays);
    EXPECT_EQ(one[0].l, std::vector<double>{4}) << formulation;
    EXPECT_TRUE(one[1].l.empty()) << formulation;
    EXPECT_EQ(one[2].status, Status::ok) << formulation;
    EXPECT_TRUE(one[2].l.empty()) << formulation;
  }
  const auto both = ask(closed_form_scene(plane({0, 0, 1}, 1)), rays);
  EXPECT_EQ(both[1].l, std::vector<double>{6});
  EXPECT_EQ(both[2].status, Status::coincident);
}

TEST_F(PlaneTest, ARayThatStartsOnThePlaneDoesNotHitAndOneThatStartsJustBesideItDoes) {
  const double above = std::nextafter(1.0, 2.0);
  const std::vector<Ray> rays{{{0, 0, 1}, {0, 0, 1}}, {{0, 0, 1}, {0, 0, -1}}, {{0, 0, above}, {0, 0, -1}}};
  const auto answers = ask(closed_form_scene(plane({0, 0, 3}, 3)), rays);
  EXPECT_TRUE(answers[0].l.empty());
  EXPECT_TRUE(answers[1].l.empty());
  EXPECT_EQ(answers[2].l, std::vector<double>{above - 1});
}

TEST_F(PlaneTest, TheSignOfAProductSumThatRoundsToZeroIsDecidedExactly) {
  // a.d = (1 + e)(1 - e) - 1 = -e^2: plain arithmetic sees a parallel ray.
  const double e = 0x1p-30;
  const Ray ray{{0, 0, 0}, {1 - e, 0, -1}};
  const SurfaceSpec spec = plane({1 + e, 0, 1}, -0x1p-60);
  const Answer exact = ask(closed_form_scene(spec), {&ray, 1})[0];
  ASSERT_EQ(exact.l, std::vector<double>{1});
  EXPECT_TRUE(ask(closed_form_scene(spec, "plain"), {&ray, 1})[0].l.empty());
}

TEST_F(PlaneTest, ANormalThatIsZeroIsRefusedByName) {
  EXPECT_EQ(refusal(plane({0, 0, 0}, 1)), "parameter 'a' must not be zero: it is the plane's normal");
  EXPECT_NE(refusal(plane({1, 0, 0}, std::nan(""))), "");
  EXPECT_EQ(refusal(plane({0, 1e-320, 0}, 1)), "");
}

}  // namespace
}  // namespace graze::test
