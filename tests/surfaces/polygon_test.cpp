// The polygon: the document's exercise, meshes that are hit exactly once, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

Scene scene_of(const std::vector<SurfaceSpec>& specs, std::string_view formulation = {}) {
  Scene scene;
  for (const SurfaceSpec& spec : specs) {
    scene.add(find_surface(spec.type), spec, find_solver("closed_form"),
              {{}, std::string(formulation), Precision::binary64});
  }
  return scene;
}

class PolygonTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("polygon") || solver_named("closed_form") == nullptr)
      GTEST_SKIP() << "not in this build";
  }
};

TEST_F(PolygonTest, ThePointOfTheDocumentsExerciseIsOutside) {
  // Document 001: plane x + 2y + z + 2 = 0 (errata 4), point (-2, -2, 4).
  const Table vertices{{-3, -3, 7}, {3, -4, 3}, {4, -5, 4}};
  for (const char* const formulation : {"exact", "even_odd"}) {
    const Scene scene = scene_of({figure("polygon", vertices)}, formulation);
    // Beside it, for contrast, (v0 + v1 + 2 v2) / 4 = (2, -4.25, 4.5) is inside.
    const Vec3 d{1, 1, 1};
    const std::vector<Ray> rays{{Vec3{-2, -2, 4} - 3 * d, d}, {Vec3{2, -4.25, 4.5} - 3 * d, d}};
    const auto answers = ask(scene, rays);
    EXPECT_TRUE(answers[0].l.empty()) << formulation;
    EXPECT_EQ(answers[1].l, std::vector<double>{3}) << formulation;
  }
}

TEST_F(PolygonTest, AnArrowIsHitInItsWingsAndNotInItsNotch) {
  // U shape in z = 0.
  const SurfaceSpec spec = figure(
      "polygon", {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 4, 0}, {3, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}});
  for (const char* const formulation : {"exact", "even_odd"}) {
    const std::vector<Ray> rays{{{0.5, 3, 1}, {0, 0, -1}},
                                {{2, 3, 1}, {0, 0, -1}},
                                {{3.5, 3, 1}, {0, 0, -1}},
                                {{2, 0.5, 1}, {0, 0, -1}},
                                {{5, 0.5, 1}, {0, 0, -1}}};
    const auto answers = ask(scene_of({spec}, formulation), rays);
    for (const std::size_t i : {0U, 2U, 3U}) EXPECT_EQ(answers[i].l, std::vector<double>{1}) << i;
    for (const std::size_t i : {1U, 4U}) EXPECT_TRUE(answers[i].l.empty()) << i;
  }
}

/// A terrain of triangles and quadrangles over [0,4]^2: neighbours share edges and vertices, windings vary.
std::vector<SurfaceSpec> terrain() {
  constexpr int kSide = 4;
  const auto vertex = [](int i, int j) {
    return std::vector<double>{static_cast<double>(i), static_cast<double>(j), 0.25 * ((3 * i + 5 * j) % 4)};
  };
  std::vector<SurfaceSpec> parts;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const auto a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      if ((i + j) % 2 == 0) {
        parts.push_back(figure("polygon", {a, b, c}));
        parts.push_back(figure("polygon", {a, d, c}));
      } else {
        parts.push_back(figure("polygon", {b, a, d}));
        parts.push_back(figure("polygon", {b, c, d}));
      }
    }
  }
  return parts;
}

TEST_F(PolygonTest, ARayThroughASharedEdgeOrVertexHitsExactlyOneNeighbour) {
  const Scene scene = scene_of(terrain());
  Rng rng(20261122);
  for (int n = 0; n < 3000; ++n) {
    // Steep enough to see every part from above; dyadic, so that edges and vertices are met exactly.
    const double x = std::floor(rng.uniform(1, 31)) / 8, y = std::floor(rng.uniform(1, 31)) / 8;
    const Vec3 lean{std::floor(rng.uniform(-3, 4)) / 32, std::floor(rng.uniform(-3, 4)) / 32, -1};
    const double z = 0.25 * std::floor(rng.uniform(0, 4));
    const double far = n % 2 == 0 ? 8 : 0x1p20;
    const Vec3 target{x, y, z};
    if (x < 1 || x > 3 || y < 1 || y > 3) continue;
    const Ray ray{target - far * lean, lean};
    EXPECT_EQ(ask(scene, {&ray, 1})[0].l.size(), 1U) << x << " " << y << " " << z << " far " << far;
  }
}

TEST_F(PolygonTest, AClosedCubeGivesEvenCountsFromOutside) {
  const Table v{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2}, {2, 0, 2}, {2, 2, 2}, {0, 2, 2}};
  const auto face = [&](std::initializer_list<std::size_t> corners) {
    Table points;
    for (const std::size_t i : corners) points.push_back(v[i]);
    return figure("polygon", points);
  };
  const Scene scene = scene_of({face({0, 1, 2, 3}), face({4, 5, 6, 7}), face({0, 1, 5, 4}),
                                face({3, 2, 6, 7}), face({0, 3, 7, 4}), face({1, 2, 6, 5})});
  Rng rng(20261122);
  std::size_t hits = 0;
  for (int n = 0; n < 3000; ++n) {
    const auto draw = [&](double lo, double hi) { return std::floor(rng.uniform(lo, hi)) / 2; };
    const Vec3 target{draw(0, 5), draw(0, 5), draw(0, 5)};
    const Vec3 d{draw(-6, 7), draw(-6, 7), draw(-6, 7)};
    if (d == Vec3{}) continue;
    const Ray ray{target - 16 * d, d};
    const Answer answer = ask(scene, {&ray, 1})[0];
    if (answer.status == Status::coincident) continue;  // it runs along a face
    std::size_t count = 0;
    for (const std::uint32_t m : answer.multiplicity) count += m;
    EXPECT_EQ(count % 2, 0U) << n;
    hits += count;
  }
  EXPECT_GT(hits, 1000U);
}

TEST_F(PolygonTest, RaysInThePlaneRunInsideOrMiss) {
  const SurfaceSpec spec = figure(
      "polygon", {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 4, 0}, {3, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}});
  const std::vector<Ray> rays{{{-1, 3, 0}, {1, 0, 0}},    // crosses both arms
                              {{2, 3, 0}, {1, 0, 0}},     // from the notch into an arm
                              {{2, 3, 0}, {0, 1, 0}},     // out of the notch
                              {{-1, 0, 0}, {1, 0, 0}},    // along an edge
                              {{-1, 1, 0}, {1, -1, 0}},   // only the corner (0, 0)
                              {{-1, 5, 0}, {1, 0, 0}},    // passes
                              {{3.5, 3, 0}, {0, 1, 0}}};  // starts inside an arm
  const auto answers = ask(scene_of({spec}), rays);
  for (const std::size_t i : {0U, 1U, 3U, 6U}) EXPECT_EQ(answers[i].status, Status::coincident) << i;
  for (const std::size_t i : {2U, 4U, 5U}) {
    EXPECT_EQ(answers[i].status, Status::ok) << i;
    EXPECT_TRUE(answers[i].l.empty()) << i;
  }
}

TEST_F(PolygonTest, WhatIsNoPolygonIsRefusedWithTheReason) {
  const auto reason = [](const Table& vertices) { return refusal(figure("polygon", vertices)); };
  EXPECT_EQ(reason({{0, 0, 0}, {1, 0, 0}}), "vertices must be at least three points");
  EXPECT_EQ(reason({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "vertices: edge 1 has no length");
  EXPECT_EQ(reason({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}}), "vertices enclose no area: the polygon is degenerate");
  EXPECT_EQ(reason({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.125}, {0, 1, 0}}).find("vertices["), 0U);
  EXPECT_NE(reason({{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}}).find("intersects itself"),
            std::string::npos);
  // A spike and a vertex on another edge are meetings too; a straight angle is none.
  EXPECT_NE(reason({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {2, 2, 0}}).find("intersects itself"),
            std::string::npos);
  EXPECT_NE(reason({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}).find("intersects itself"),
            std::string::npos);
  EXPECT_EQ(reason({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {4, 4, 0}}), "");
}

TEST_F(PolygonTest, SamplesLieInside) {
  const auto surface = find_surface("polygon").make(figure("polygon", arrow_points()));
  const Scene scene = scene_of({figure("polygon", arrow_points())});
  Rng rng(20261122);
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const double u = rng.uniform();
    const SurfaceSample sample = surface->sample(u, rng.uniform());
    const Ray ray{sample.point + sample.normal, -sample.normal};
    inside += ask(scene, {&ray, 1})[0].l.size() == 1 ? 1 : 0;
  }
  EXPECT_GE(inside, 499);
}

}  // namespace
}  // namespace graze::test
