// Several surfaces in one scene: hits are merged in order and name their surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

TEST(Scene, HitsOfTwoTeardropsAreMergedInOrderWithTheirSurface) {
  if (!has_surface("teardrop")) GTEST_SKIP() << "this build has no teardrop";
  SurfaceSpec behind = teardrop(1);
  behind.placement.translate = {10, 0, 0};
  const SurfaceEntry& entry = find_surface("teardrop");
  const auto solver = std::find_if(solver_registry().begin(), solver_registry().end(),
                                   [&](const SolverEntry& s) { return !all_pairings(s, entry).empty(); });
  ASSERT_NE(solver, solver_registry().end());
  Scene scene;
  for (const SurfaceSpec& spec : {behind, teardrop(1)}) scene.add(entry, spec, *solver);
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

/// Many surfaces of every type of the build, each moved, turned and stretched: a few to a type and solver.
Scene crowd(std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  Scene scene;
  std::vector<const SolverEntry*> solvers;
  for (const SolverEntry& solver : solver_registry()) {
    if (solver.info.claims.deterministic) solvers.push_back(&solver);
  }
  const auto random = [&] { return rng.uniform(-1, 1); };
  while (scene.size() < count) {
    const auto& surface = surface_registry()[scene.size() % surface_registry().size()];
    const auto& solver =
        *solvers[static_cast<std::size_t>(rng.uniform() * static_cast<double>(solvers.size()))];
    SurfaceSpec spec = examples(surface.name).front();
    const double scale = std::exp2(rng.uniform(-3, 0));
    spec.placement.translate = {8 * random(), 8 * random(), 8 * random()};
    for (Vec3& row : spec.placement.matrix)
      row = scale * (row + Vec3{0.3 * random(), 0.3 * random(), 0.3 * random()});
    if (all_pairings(solver, surface).empty()) {
      scene.add(surface, spec, find_solver("interval_bisection"));
    } else {
      scene.add(surface, spec, solver);
    }
  }
  return scene;
}

std::vector<Ray> rays_through_the_crowd(std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 o{rng.uniform(-12, 12), rng.uniform(-12, 12), rng.uniform(-12, 12)};
    rays.push_back({o, random_direction(rng)});
  }
  // Rays that are no question do not disturb the others.
  rays[count / 2].d = {};
  return rays;
}

TEST(Scene, CullingChangesNoHit) {
  Scene scene = crowd(150, 1);
  const auto rays = rays_through_the_crowd(700, 2);
  const std::vector<Answer> culled = ask(scene, rays);
  scene.set_culling(false);
  const std::vector<Answer> all = ask(scene, rays);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(culled[i].l, all[i].l) << i;
    EXPECT_EQ(culled[i].normal, all[i].normal) << i;
    EXPECT_EQ(culled[i].params, all[i].params) << i;
    hits += all[i].l.size();
  }
  EXPECT_EQ(culled[350].status, Status::invalid);
  EXPECT_GT(hits, 300U);
}

TEST(Scene, FirstIsTheNearestOfAllAndAnySaysWhetherThereIsOne) {
  const Scene scene = crowd(150, 3);
  const auto rays = rays_through_the_crowd(700, 4);
  Scene::Workspace work;
  HitBuffer all, first, any;
  scene.intersect(rays, Query::all, kEverything, work, all);
  scene.intersect(rays, Query::first, kEverything, work, first);
  scene.intersect(rays, Query::any, kEverything, work, any);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(first.count(i), std::min<std::size_t>(1, all.count(i))) << i;
    ASSERT_EQ(any.count(i), first.count(i)) << i;
    if (first.count(i) == 0) continue;
    EXPECT_EQ(first.l[first.begin(i)], all.l[all.begin(i)]);
    EXPECT_EQ(first.surface[first.begin(i)], all.surface[all.begin(i)]);
    EXPECT_EQ(first.normal[first.begin(i)], all.normal[all.begin(i)]);
    EXPECT_EQ(first.params[first.begin(i)], all.params[all.begin(i)]);
  }
}

TEST(Scene, AnswersDoNotDependOnTheBlockInWhichARayComes) {
  const Scene scene = crowd(60, 5);
  const auto rays = rays_through_the_crowd(600, 6);
  for (const Query query : {Query::all, Query::first, Query::any}) {
    const std::vector<Answer> together = ask(scene, rays, query);
    std::vector<Ray> reversed(rays.rbegin(), rays.rend());
    std::vector<Answer> backwards = ask(scene, reversed, query);
    std::reverse(backwards.begin(), backwards.end());
    EXPECT_EQ(backwards, together);
    for (std::size_t i = 0; i < rays.size(); i += 41)
      EXPECT_EQ(ask(scene, {&rays[i], 1}, query)[0], together[i]);
  }
}

TEST(Scene, CullingAsksOnlyTheSurfacesThatARayMayMeet) {
  if (!has_surface("teardrop")) GTEST_SKIP() << "this build has no teardrop";
  Scene scene;
  for (int i = 0; i < 1000; ++i) {
    SurfaceSpec spec = teardrop(1);
    spec.placement.translate = {10.0 * i, 0, 0};
    scene.add(find_surface("teardrop"), spec, find_solver("interval_bisection"));
  }
  // Across the row: one teardrop. Along it: the first is enough for `first` and `any`.
  const std::vector<Ray> across{{{5000, 1.5, -9}, {0, 0, 1}}};
  const std::vector<Ray> along{{{-9, 1.5, 0}, {1, 0, 0}}};
  const auto evaluations = [&](const std::vector<Ray>& rays, Query query) {
    Scene::Workspace work;
    HitBuffer hits;
    scene.intersect(rays, query, {}, work, hits);
    EXPECT_GE(hits.count(0), 1U);
    return hits.counters[0].evaluations;
  };
  const auto one = evaluations(across, Query::all);
  EXPECT_GT(one, 0U);
  EXPECT_LE(evaluations(along, Query::first), 4 * one);
  EXPECT_LE(evaluations(along, Query::any), 4 * one);
  EXPECT_GE(evaluations(along, Query::all), 500 * one);
  scene.set_culling(false);
  EXPECT_GE(evaluations(along, Query::first), 500 * one);
}

TEST(Scene, AnEmptySceneHitsNothing) {
  const std::vector<Ray> rays{{{0, 0, 0}, {1, 0, 0}}};
  const Answer answer = ask(Scene(), rays)[0];
  EXPECT_EQ(answer.status, Status::ok);
  EXPECT_TRUE(answer.l.empty());
}

}  // namespace
}  // namespace graze::test
