// The triangle: u and v by hand, its closed boundary, meshes without gaps, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

class TriangleTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("triangle")) GTEST_SKIP() << "this build has no triangle";
  }
};

TEST_F(TriangleTest, UAndVAreThoseOfThePoint) {
  const SurfaceSpec spec = figure("triangle", {{1, 0, 0}, {5, 0, 0}, {1, 8, 0}});
  for (const char* const formulation : {"exact", "barycentric"}) {
    const Ray ray{{2, 4, 3}, {0, 0, -2}};
    const Answer answer = ask(closed_form_scene(spec, formulation), {&ray, 1})[0];
    ASSERT_EQ(answer.l, std::vector<double>{1.5}) << formulation;
    EXPECT_EQ(answer.params[0], (std::array<double, 2>{0.25, 0.5})) << formulation;
    EXPECT_EQ(answer.normal[0], (Vec3{0, 0, 1})) << formulation;
  }
}

TEST_F(TriangleTest, EdgesAndVerticesBelongToItForRaysFromAnywhere) {
  const Vec3 a{0.5, 0, 1}, b{3, 1, 2}, c{1, 4, -1};
  const Scene scene = closed_form_scene(figure("triangle", {{0.5, 0, 1}, {3, 1, 2}, {1, 4, -1}}));
  Rng rng(20261122);
  for (int i = 0; i < 300; ++i) {
    const double k = std::floor(rng.uniform(0, 9)) / 8;
    const Vec3 target = i % 3 == 0 ? a + k * (b - a) : i % 3 == 1 ? b + k * (c - b) : c + k * (a - c);
    const double scale = i % 2 == 0 ? 1 : 0x1p24;
    const auto draw = [&] { return scale * std::floor(rng.uniform(-64, 64)) / 8; };
    const Vec3 d{draw(), draw(), draw()};
    if (dot(d, cross(b - a, c - a)) == 0) continue;
    const Ray ray{target - d, d};
    const Answer answer = ask(scene, {&ray, 1})[0];
    EXPECT_EQ(answer.l, std::vector<double>{1}) << i;
  }
}

TEST_F(TriangleTest, RaysInThePlaneTouchAVertexRunInsideOrMiss) {
  const SurfaceSpec spec = figure("triangle", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  const std::vector<Ray> rays{{{-2, 2, 0}, {1, -1, 0}},  // touches v0
                              {{-1, 1, 0}, {1, 0, 0}},   // crosses
                              {{-1, 0, 0}, {1, 0, 0}},   // along an edge
                              {{4, 0, 0}, {1, 0, 0}},    // starts at the end of that edge
                              {{1, -1, 0}, {1, -1, 0}},  // touched v0 at l < 0
                              {{-1, 6, 0}, {1, 0, 0}},   // passes
                              {{1, 1, 0}, {1, 1, 0}}};   // starts inside
  const auto answers = ask(closed_form_scene(spec), rays);
  EXPECT_EQ(answers[0].l, std::vector<double>{2});
  EXPECT_EQ(answers[0].multiplicity, std::vector<std::uint32_t>{2});
  EXPECT_EQ(answers[0].params[0], (std::array<double, 2>{0, 0}));
  for (const std::size_t i : {1U, 2U, 6U}) EXPECT_EQ(answers[i].status, Status::coincident) << i;
  for (const std::size_t i : {3U, 4U, 5U}) {
    EXPECT_EQ(answers[i].status, Status::ok) << i;
    EXPECT_TRUE(answers[i].l.empty()) << i;
  }
}

TEST_F(TriangleTest, ATriangulatedGridHasNoGapsAtItsEdgesAndVertices) {
  // Closed triangles: every ray into the grid hits at least one, through the inside of a shared edge two.
  Scene scene;
  Rng rng(20261122);
  constexpr int kSide = 4;
  const auto vertex = [](int i, int j) {
    return std::vector<double>{static_cast<double>(i), static_cast<double>(j), 0.25 * ((3 * i + 5 * j) % 4)};
  };
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const Table lower{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)};
      const Table upper{vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)};
      for (const Table& part : {lower, upper}) {
        for (const SolverEntry& solver : solver_registry()) {
          if (solver.name == "closed_form")
            scene.add(find_surface("triangle"), figure("triangle", part), solver);
        }
      }
    }
  }
  int seen = 0;
  for (int n = 0; n < 2000; ++n) {
    const double x = std::floor(rng.uniform(1, 31)) / 8, y = std::floor(rng.uniform(1, 31)) / 8;
    const Ray ray{{x, y, 8}, {0, 0, -1}};
    const std::size_t hits = ask(scene, {&ray, 1})[0].l.size();
    EXPECT_GE(hits, 1U) << x << " " << y;
    seen += hits > 1 ? 1 : 0;
  }
  EXPECT_GT(seen, 100);
}

TEST_F(TriangleTest, WhatIsNoTriangleIsRefusedWithTheReason) {
  const auto reason = [](const Table& vertices) { return refusal(figure("triangle", vertices)); };
  EXPECT_EQ(reason({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}),
            "vertices lie on one line: the triangle is degenerate");
  EXPECT_EQ(reason({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}), "vertices are one point: the triangle is degenerate");
  EXPECT_EQ(reason({{0, 0, 0}, {1, 1, 1}}), "vertices must be three points: this is a triangle");
  // One ulp beside the line is a triangle.
  EXPECT_EQ(reason({{0, 0, 0}, {1, 1, 1}, {3, 3, std::nextafter(3.0, 4.0)}}), "");
}

}  // namespace
}  // namespace graze::test
