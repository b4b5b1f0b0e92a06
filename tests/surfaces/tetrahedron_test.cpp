// The tetrahedron: document 004's exercise, edges, corners and faces, any orientation.
#include <surfaces/convex.hpp>

#include <algorithm>

namespace graze::test {
namespace {

class TetrahedronTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_convex("tetrahedron")) GTEST_SKIP() << "this build lacks tetrahedron or closed_form";
  }
  static Table documents() { return {{1, 0, 0}, {-1, 0, -1}, {-1, 0, 1}, {0, 1, 0}}; }
};

TEST_F(TetrahedronTest, DocumentsExerciseIsInsideFromZeroToANinth) {
  for (const auto formulation : {"exact", "cyrus_beck"}) {
    const Answer inside = convex_answer(tetrahedron(documents()), {{0, 0, 0}, {1, 2, 3}}, formulation);
    ASSERT_EQ(inside.l.size(), 1U) << "the ray starts on the surface, and that is no hit";
    expect_ulps(inside.l[0], 1.0 / 9, 2);
    const Answer outside = convex_answer(tetrahedron(documents()), {{-1, -2, -3}, {1, 2, 3}}, formulation);
    ASSERT_EQ(outside.l.size(), 2U);
    expect_ulps(outside.l[0], 1, 2);
    expect_ulps(outside.l[1], 1 + 1.0 / 9, 2);
    EXPECT_EQ(outside.params[0][0], 3) << "y = 0 is opposite to the top";
    EXPECT_EQ(outside.normal[0], (Vec3{0, -1, 0}));
  }
}

TEST_F(TetrahedronTest, TheOrderOfTheVerticesOnlyNamesTheFaces) {
  Table vertices = documents();
  std::sort(vertices.begin(), vertices.end());
  const std::vector<Ray> rays =
      mixed_rays(*find_surface("tetrahedron").make(tetrahedron(vertices)), 100, 20261122);
  const std::vector<Answer> expected = ask(convex_scene(tetrahedron(vertices)), rays);
  do {
    const std::vector<Answer> answers = ask(convex_scene(tetrahedron(vertices)), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(answers[i].l.size(), expected[i].l.size());
      for (std::size_t k = 0; k < answers[i].l.size(); ++k) {
        expect_ulps(answers[i].l[k], expected[i].l[k], 4);
        EXPECT_LE(norm(answers[i].normal[k] - expected[i].normal[k]), 1e-15);
      }
    }
  } while (std::next_permutation(vertices.begin(), vertices.end()));
}

TEST_F(TetrahedronTest, RaysThroughCornersAndEdgesFromOutsideTouch) {
  const SurfaceSpec spec = tetrahedron(documents());
  const Answer corner = convex_answer(spec, {{-1, 1, 0}, {1, 0, 0}});  // over the top
  ASSERT_EQ(corner.l, (std::vector<double>{1}));
  EXPECT_EQ(corner.multiplicity[0], 2U);
  const Answer edge = convex_answer(spec, {{-1, -1, 0}, {0, 1, 0}});  // the middle of the edge 1-2
  ASSERT_EQ(edge.l.size(), 1U);
  EXPECT_EQ(edge.l[0], 1);
  EXPECT_EQ(edge.multiplicity[0], 2U);
}

TEST_F(TetrahedronTest, RaysInFacesAndAlongEdgesAreCoincident) {
  const SurfaceSpec spec = tetrahedron(documents());
  EXPECT_EQ(convex_answer(spec, {{-2, 0, 0.125}, {1, 0, 0}}).status, Status::coincident);
  EXPECT_EQ(convex_answer(spec, {{2, -1, 0}, {-1, 1, 0}}).status, Status::coincident) << "the edge 0-3";
  EXPECT_EQ(convex_answer(spec, {{-2, 0, 3}, {1, 0, 0}}).status, Status::ok) << "beside the face";
}

TEST_F(TetrahedronTest, NormalsOfASliverAreAccurate) {
  // The apex is 2^-40 above the base: its planes' normals cancel to a trillionth of their terms.
  const double h = 0x1p-40;
  const auto surface =
      find_surface("tetrahedron").make(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.25, h, 0.25}}));
  for (double u = 0.05; u < 1; u += 0.1) {
    const SurfaceSample sample = surface->sample(u, 0.25);
    EXPECT_NEAR(norm(sample.normal), 1, 1e-15);
    EXPECT_GT(std::fabs(sample.normal.y), 0.99);
  }
}

TEST_F(TetrahedronTest, CoplanarVerticesAreRefusedExactly) {
  EXPECT_EQ(refusal(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.25, 0, 0.25}})),
            "vertices lie in one plane: the tetrahedron is flat");
  EXPECT_NE(refusal(tetrahedron({{0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}, {0.4, 0.4, 0.4}, {1, 0, 0}})), "");
  EXPECT_EQ(refusal(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0.25, 1e-300, 0.25}})), "");
  EXPECT_NE(refusal(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}})), "");
}

}  // namespace
}  // namespace graze::test
