// The convex polyhedron against the box it can be, its plane tests against N, and what it refuses.
#include <surfaces/convex.hpp>

namespace graze::test {
namespace {

class ConvexPolyhedronTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_convex("convex_polyhedron")) GTEST_SKIP() << "this build lacks convex_polyhedron or closed_form";
  }
  /// Planes that touch the unit ball: at random points, and last the six of the cube, which bound them.
  static Table random_planes(std::size_t count, std::uint64_t seed) {
    Rng rng(seed);
    const Table cube = box_halfspaces({-1, -1, -1}, {1, 1, 1});
    Table rows;
    while (rows.size() + cube.size() < count) {
      const Vec3 n = random_direction(rng);
      rows.push_back({n.x, n.y, n.z, 1});
    }
    rows.insert(rows.end(), cube.begin(), cube.end());
    return rows;
  }
  /// Rays between random points of the cube's circumscribed sphere.
  static std::vector<Ray> chords(std::size_t count, std::uint64_t seed) {
    Rng rng(seed);
    std::vector<Ray> rays;
    while (rays.size() < count) {
      const Vec3 o = std::sqrt(3.0) * random_direction(rng);
      rays.push_back({o, std::sqrt(3.0) * random_direction(rng) - o});
    }
    return rays;
  }
};

/// Rays at a box that meet its corners, edges, sides and insides, most of them exactly.
std::vector<Ray> lattice_rays(std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  const auto pick = [&] { return std::floor(rng.uniform(-3, 5)) / 2; };
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Ray ray{{pick(), pick(), pick()}, {pick(), pick(), pick()}};
    if (is_valid(ray)) rays.push_back(ray);
  }
  return rays;
}

TEST_F(ConvexPolyhedronTest, SixHalfSpacesAreTheBox) {
  if (!has_convex("box")) GTEST_SKIP() << "this build lacks box";
  const Vec3 lo{-0.5, 0, 0.5}, hi{1, 1.5, 2};
  const SurfaceSpec boxed = box({lo.x, lo.y, lo.z}, {hi.x, hi.y, hi.z});
  const SurfaceSpec planes = convex_polyhedron(box_halfspaces(lo, hi));
  std::vector<Ray> rays = lattice_rays(20000, 20261122);
  const auto general = mixed_rays(*find_surface("box").make(boxed), 2000, 20261122);
  rays.insert(rays.end(), general.begin(), general.end());
  const std::vector<Answer> a = ask(convex_scene(boxed), rays);
  const std::vector<Answer> b = ask(convex_scene(planes), rays);
  std::size_t touching = 0, coincident = 0, hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(a[i], b[i]) << "ray " << i;
    hits += a[i].l.size();
    if (a[i].status == Status::coincident) ++coincident;
    for (const std::uint32_t m : a[i].multiplicity) touching += m == 2 ? 1U : 0U;
  }
  std::printf("%zu rays, %zu hits, %zu touching, %zu coincident\n", rays.size(), hits, touching, coincident);
  EXPECT_GT(touching, 100U);
  EXPECT_GT(coincident, 100U);
}

TEST_F(ConvexPolyhedronTest, RedundantPlanesAndScaledRowsChangeNothingButTheNumbersOfFaces) {
  Table rows = octahedron();
  const std::vector<Ray> rays = lattice_rays(2000, 1);
  const std::vector<Answer> expected = ask(convex_scene(convex_polyhedron(rows)), rays);
  for (auto& row : rows) {
    for (double& entry : row) entry *= 0x1p-200;
  }
  rows.push_back({1, 0, 0, 5});
  rows.push_back({0.3, 0.1, 0.7, 50});
  rows.push_back(rows[3]);
  EXPECT_EQ(ask(convex_scene(convex_polyhedron(rows)), rays), expected);
}

TEST_F(ConvexPolyhedronTest, APlaneThatTouchesTheSolidInAnEdgeMakesRaysAlongItCoincident) {
  Table rows = box_halfspaces({0, 0, 0}, {1, 1, 1});
  const Ray ray{{-1, 1, 1}, {1, 0, 0}};
  EXPECT_EQ(convex_answer(convex_polyhedron(rows), ray).status, Status::coincident);
  rows.insert(rows.begin(), {0, 1, 1, 2});
  EXPECT_EQ(convex_answer(convex_polyhedron(rows), ray).status, Status::coincident);
}

TEST_F(ConvexPolyhedronTest, CornersEdgesAndSamplesOfTheOctahedron) {
  const auto surface = find_surface("convex_polyhedron").make(convex_polyhedron(octahedron()));
  const Landmarks marks = surface->landmarks();
  EXPECT_EQ(marks.edges.size(), 12U);
  EXPECT_EQ(marks.parallels.size(), 6U);
  EXPECT_EQ(marks.half, (Vec3{1, 1, 1}));
  Rng rng(20261122);
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform();
    const Vec3 p = surface->sample(u, rng.uniform()).point;
    EXPECT_NEAR(std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z), 1, 4e-16);
  }
}

TEST_F(ConvexPolyhedronTest, WhatIsNoSolidIsRefusedWithTheReason) {
  const auto reason = [](const Table& rows) { return refusal(convex_polyhedron(rows)); };
  const auto says = [](const std::string& text, const char* word) {
    return text.find(word) != std::string::npos;
  };
  const Table cube = box_halfspaces({0, 0, 0}, {1, 1, 1});
  const auto with = [&](std::vector<double> row) {
    Table rows = cube;
    rows.push_back(std::move(row));
    return rows;
  };
  EXPECT_EQ(reason(cube), "");
  EXPECT_TRUE(says(reason(with({0, 0, 0, 1})), "halfspaces[6] has a normal of zero"));
  EXPECT_TRUE(says(reason(with({1, 1, 1, -0x1p-60})), "empty"));
  EXPECT_TRUE(says(reason(with({1, 1, 1, 0})), "flat")) << "a corner alone";
  EXPECT_TRUE(says(reason(with({1, 1, 0, 0})), "flat")) << "an edge alone";
  EXPECT_TRUE(says(reason(with({1, 0, 0, 0})), "flat")) << "a side alone";
  EXPECT_EQ(reason(with({1, 0, 0, 0x1p-60})), "") << "thin, but a solid";
  EXPECT_EQ(reason(with({1, 1, 1, 3})), "") << "a plane that touches a corner";
  EXPECT_TRUE(says(reason({cube.begin(), cube.end() - 1}), "unbounded"));
  EXPECT_TRUE(says(reason({{1, 0, 0, 1}, {-1, 0, 0, 1}}), "unbounded")) << "a slab";
  EXPECT_TRUE(says(reason({{1, 0, 0, -1}, {-1, 0, 0, -1}}), "empty")) << "no slab";
  EXPECT_TRUE(says(reason({{1, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}}), "unbounded"))
      << "a tube";
  EXPECT_TRUE(says(reason({{1, 0, 0, 1}, {-1, -1, 0, -3}, {0, 1, 0, 1}}), "empty")) << "no prism";
  EXPECT_TRUE(says(reason({{1, 1, 1, 1}}), "unbounded"));
  EXPECT_TRUE(says(reason({}), "unbounded"));
  EXPECT_TRUE(says(reason(Table(129, {1, 0, 0, 1})), "at most"));
}

// Document 004: how many planes does a random ray cost, out of N?
TEST_F(ConvexPolyhedronTest, PlaneTestsGrowWithNForRaysThatHitAndLessForRaysThatMiss) {
  std::printf("   N   hit   miss   all (plane tests a ray)\n");
  double last = 0;
  for (const std::size_t count : {6U, 12U, 24U, 48U, 96U}) {
    const SurfaceSpec spec = convex_polyhedron(random_planes(count, 20261122));
    const std::vector<Ray> rays = chords(2000, 7);
    Scene::Workspace work;
    HitBuffer hits;
    convex_scene(spec).intersect(rays, Query::all, {}, work, hits);
    double on_hit = 0, on_miss = 0, hit = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool is_hit = hits.count(i) > 0;
      if (is_hit) ++hit;
      (is_hit ? on_hit : on_miss) += hits.counters[i].tests;
    }
    const double all = (on_hit + on_miss) / 2000;
    std::printf("%4zu  %5.1f  %5.1f  %5.1f  (%.0f %% hit)\n", count, on_hit / hit, on_miss / (2000 - hit),
                all, hit / 20);
    EXPECT_LT(on_miss / (2000 - hit), 0.75 * static_cast<double>(count)) << "a miss ends early";
    EXPECT_EQ(on_hit / hit, static_cast<double>(count)) << "a hit has to pass every plane";
    EXPECT_GT(all, last);
    last = all;
  }
}

}  // namespace
}  // namespace graze::test
