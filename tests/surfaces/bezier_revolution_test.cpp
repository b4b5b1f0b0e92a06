// Bezier surfaces of revolution whose answers are known by hand.
#include <gtest/gtest.h>

#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

TEST(BezierRevolution, AConeIsHitWhereSchoolGeometrySays) {
  if (!has_surface("bezier_revolution")) GTEST_SKIP() << "this build has no bezier_revolution";
  // r = 2 - y from y = 0 to 2; the ray at y = 1/2 meets the circle of radius 3/2.
  const SurfaceSpec cone = bezier({{2, 0}, {0, 2}});
  const std::vector<Ray> rays{{{-5, 0.5, 0}, {1, 0, 0}}, {{-5, 3, 0}, {1, 0, 0}}};
  for (const Cell& cell : double_cells()) {
    if (cell.surface->name != "bezier_revolution") continue;
    const auto answers = ask(cell.scene(cone, 30), rays);
    ASSERT_EQ(answers[0].l.size(), 2U) << cell.name();
    EXPECT_NEAR(answers[0].l[0], 3.5, 1e-9) << cell.name();
    EXPECT_NEAR(answers[0].l[1], 6.5, 1e-9) << cell.name();
    EXPECT_NEAR(answers[0].normal[1].x, std::sqrt(0.5), 1e-9) << cell.name();
    EXPECT_TRUE(answers[1].l.empty()) << cell.name();
  }
}

TEST(BezierRevolution, ControlPointsThatAreNoSurfaceAreRefused) {
  if (!has_surface("bezier_revolution")) GTEST_SKIP() << "this build has no bezier_revolution";
  const Table bad[] = {
      {}, {{1, 1}}, {{1, 1}, {1, 1}}, {{0, 0}, {0, 3}}, {{0, 0}, {HUGE_VAL, 1}}, {{0, 0, 0}, {1, 1, 1}}};
  for (const Table& points : bad) {
    EXPECT_THROW(find_surface("bezier_revolution").make(bezier(points)), std::invalid_argument)
        << points.size();
  }
  EXPECT_THROW(find_surface("bezier_revolution").make(bezier(Table(34, {1, 2}))), std::invalid_argument);
}

}  // namespace
}  // namespace graze::test
