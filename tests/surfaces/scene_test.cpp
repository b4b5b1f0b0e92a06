// Several surfaces in one scene: hits are merged in order and name their surface.
#include <gtest/gtest.h>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

TEST(Scene, HitsOfTwoTeardropsAreMergedInOrderWithTheirSurface) {
  if (!has_surface("teardrop")) GTEST_SKIP() << "this build has no teardrop";
  SurfaceSpec behind = teardrop(1);
  behind.placement.translate = {10, 0, 0};
  Scene scene;
  for (const SurfaceSpec& spec : {behind, teardrop(1)}) {
    scene.add(Intersector(find_surface("teardrop"), spec, solver_registry().front()));
  }
  // An origin and slope off the symmetric ones: every formulation takes it.
  const std::vector<Ray> rays{{{-5, 1.5, 0}, {1, 0, 0}}, {{-5, 9, 0}, {1, 0, 0}}};
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, Query::all, kEverything, work, hits);
  ASSERT_EQ(hits.count(0), 4U);
  const double expected[] = {3.125, 6.875, 13.125, 16.875};
  const std::uint32_t surface[] = {1, 1, 0, 0};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(hits.l[k], expected[k], 1e-10);
    EXPECT_EQ(hits.surface[k], surface[k]);
  }
  EXPECT_EQ(hits.count(1), 0U);
  EXPECT_EQ(ask(scene, rays, Query::first)[0].l.size(), 1U);
}

TEST(Scene, AnEmptySceneHitsNothing) {
  const std::vector<Ray> rays{{{0, 0, 0}, {1, 0, 0}}};
  const Answer answer = ask(Scene(), rays)[0];
  EXPECT_EQ(answer.status, Status::ok);
  EXPECT_TRUE(answer.l.empty());
}

}  // namespace
}  // namespace graze::test
