// The box: document 001's example, edges, corners and sides, where the slab test in plain arithmetic loses.
#include <surfaces/convex.hpp>

namespace graze::test {
namespace {

class BoxTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_convex("box")) GTEST_SKIP() << "this build lacks box or closed_form";
  }
  static SurfaceSpec documents() { return box({-1, 2, 1}, {3, 3, 3}); }
  static SurfaceSpec unit() { return box({0, 0, 0}, {1, 1, 1}); }
};

TEST_F(BoxTest, DocumentsExampleHasNoIntersection) {
  for (const auto formulation : {"exact", "slabs"}) {
    const Answer answer = convex_answer(documents(), {{0, 4, 2}, {0.213, -0.436, 0.873}}, formulation);
    EXPECT_EQ(answer.status, Status::ok);
    EXPECT_TRUE(answer.l.empty());
  }
}

TEST_F(BoxTest, ARayThroughTwoSidesSaysWhichAndWithWhichNormal) {
  for (const auto formulation : {"exact", "slabs"}) {
    const Answer answer = convex_answer(documents(), {{-5, 2.5, 2}, {2, 0, 0}}, formulation);
    ASSERT_EQ(answer.l, (std::vector<double>{2, 4}));
    EXPECT_EQ(answer.normal[0], (Vec3{-1, 0, 0}));
    EXPECT_EQ(answer.normal[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(answer.params[0][0], 0);
    EXPECT_EQ(answer.params[1][0], 1);
  }
}

TEST_F(BoxTest, ARayFromInsideHitsOnceAndOneThatLeavesTheSurfaceDoesNotHitItAgain) {
  EXPECT_EQ(convex_answer(unit(), {{0.5, 0.5, 0.5}, {0, 0, -1}}).l, (std::vector<double>{0.5}));
  EXPECT_TRUE(convex_answer(unit(), {{1, 0.5, 0.5}, {1, 0.1, 0}}).l.empty());
  EXPECT_EQ(convex_answer(unit(), {{1, 0.5, 0.5}, {-1, 0, 0}}).l, (std::vector<double>{1}));
}

TEST_F(BoxTest, ARayThatTouchesAnEdgeOrACornerHasOneHitOfMultiplicityTwo) {
  EXPECT_EQ(convex_answer(unit(), {{-1, 2, 0.5}, {1, -1, 0}}).l.size(), 2U) << "from edge to edge";
  const Answer touch = convex_answer(unit(), {{-1, 0, 0.5}, {1, 1, 0}});
  ASSERT_EQ(touch.l, (std::vector<double>{1}));
  EXPECT_EQ(touch.multiplicity[0], 2U);
  EXPECT_EQ(touch.params[0][0], 0) << "the first of the sides that meet there";
  const Answer corner = convex_answer(unit(), {{2, 0, 2}, {-1, 1, -1}});
  ASSERT_EQ(corner.l, (std::vector<double>{1}));
  EXPECT_EQ(corner.multiplicity[0], 2U);
  EXPECT_EQ(corner.params[0][0], 1);
}

TEST_F(BoxTest, ARayThroughTwoOppositeCornersHitsBoth) {
  const Answer answer = convex_answer(unit(), {{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(answer.l, (std::vector<double>{1, 2}));
  EXPECT_EQ(answer.multiplicity, (std::vector<std::uint32_t>{1, 1}));
  EXPECT_EQ(answer.params[0][0], 0);
  EXPECT_EQ(answer.params[1][0], 1);
}

TEST_F(BoxTest, ARayInsideASideOrAlongAnEdgeIsCoincident) {
  EXPECT_EQ(convex_answer(unit(), {{-1, 0, 0.5}, {1, 0, 0}}).status, Status::coincident);
  EXPECT_EQ(convex_answer(unit(), {{-1, 0, 0}, {1, 0, 0}}).status, Status::coincident);
  EXPECT_EQ(convex_answer(unit(), {{0.5, 1, 0.5}, {1, 0, 0.25}}).status, Status::coincident);
}

TEST_F(BoxTest, ARayInAPlaneOfASideThatPassesTheSideOrLeavesItIsAMiss) {
  for (const Ray& ray :
       {Ray{{-1, 0, 2}, {1, 0, 0}}, Ray{{2, 0, 0.5}, {1, 0, 0}}, Ray{{1, 0, 0.5}, {1, 0, 0}}}) {
    const Answer answer = convex_answer(unit(), ray);
    EXPECT_EQ(answer.status, Status::ok);
    EXPECT_TRUE(answer.l.empty());
  }
  const Answer corner =
      convex_answer(unit(), {{2, 0, 0}, {-1, 0, 1}});  // touches the edge x = 1, z = 1 at a corner
  ASSERT_EQ(corner.l, (std::vector<double>{1}));
  EXPECT_EQ(corner.multiplicity[0], 2U);
}

TEST_F(BoxTest, ExactSlabsTellATouchFromAMissByOneUlpAndPlainOnesDoNot) {
  // The ray rises through the edge x = 0, y = 1; one ulp higher it misses, but both quotients round alike.
  Rng rng(20261122);
  std::size_t touches = 0, misses = 0, plain_misses = 0;
  constexpr std::size_t kRays = 1000;
  for (std::size_t i = 0; i < kRays; ++i) {
    const double x = std::floor(rng.uniform(1, 1 << 20)), y = std::floor(rng.uniform(2, 1 << 20));
    const double slant = std::floor(rng.uniform(1, 1 << 20)) / (1 << 20);
    const Ray touching{{-x, 1 - y, 0.5}, {x * slant, y * slant, 0}};
    const Ray missing{{-x, next_above(1 - y), 0.5}, touching.d};
    const Answer touch = convex_answer(unit(), touching);
    if (touch.l.size() == 1 && touch.multiplicity[0] == 2) ++touches;
    if (convex_answer(unit(), missing).l.empty()) ++misses;
    if (convex_answer(unit(), missing, "slabs").l.empty()) ++plain_misses;
  }
  std::printf("misses by one ulp answered as such: exact %zu, slabs %zu of %zu\n", misses, plain_misses,
              kRays);
  EXPECT_EQ(touches, kRays);
  EXPECT_EQ(misses, kRays);
}

TEST_F(BoxTest, TheTestEndsWithTheFirstSlabThatDecides) {
  EXPECT_EQ(tests_of(unit(), {{-1, 0.5, 0.5}, {1, 0, 0}}), 3U);
  EXPECT_EQ(tests_of(unit(), {{2, 0.5, 0.5}, {1, 0, 0}}), 1U) << "behind the ray";
  EXPECT_EQ(tests_of(unit(), {{2, 0.5, 0.5}, {0, 1, 0}}), 1U) << "beside the first slab";
  EXPECT_EQ(tests_of(unit(), {{-1, 3, 0.5}, {1, 1, 0}}), 2U) << "l_in > l_out in the second";
}

TEST_F(BoxTest, AFarOriginKeepsTheHitsFaithful) {
  double worst = 0;
  Rng rng(20261122);
  for (int i = 0; i < 2000; ++i) {
    const double far = std::pow(10.0, rng.uniform(1, 10));
    const Vec3 target{rng.uniform(0.1, 0.9), rng.uniform(0.1, 0.9), 1};
    const Ray ray{{target.x, target.y, far}, {0, 0, -1}};
    const Answer answer = convex_answer(unit(), ray);
    ASSERT_EQ(answer.l.size(), 2U);
    worst = std::max(worst, std::fabs(answer.l[0] - (far - 1)) / ulp(far));
  }
  std::printf("largest error of l from afar: %.3g ulps\n", worst);
  EXPECT_EQ(worst, 0);
}

TEST_F(BoxTest, FlatAndReversedBoxesAreRefusedWithTheAxis) {
  EXPECT_EQ(refusal(box({0, 0, 0}, {1, 0, 1})), "min must be below max in y: the box is flat");
  EXPECT_EQ(refusal(box({0, 0, 2}, {1, 1, 1})), "min must be below max in z: the box is reversed");
  EXPECT_EQ(refusal(box({0, 0, 0}, {std::nextafter(0.0, 1.0), 1, 1})), "");
}

TEST_F(BoxTest, SamplesLieOnTheSidesAndFaceOutward) {
  const auto surface = find_surface("box").make(documents());
  Rng rng(20261122);
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform();
    const SurfaceSample sample = surface->sample(u, rng.uniform());
    const Vec3 from_middle = sample.point - Vec3{1, 2.5, 2};
    EXPECT_EQ(
        std::max({std::fabs(from_middle.x) / 2, std::fabs(from_middle.y) / 0.5, std::fabs(from_middle.z)}),
        1.0);
    EXPECT_GT(dot(sample.normal, from_middle), 0);
  }
  EXPECT_EQ(surface->landmarks().edges.size(), 12U);
  EXPECT_EQ(surface->landmarks().parallels.size(), 3U);
}

}  // namespace
}  // namespace graze::test
