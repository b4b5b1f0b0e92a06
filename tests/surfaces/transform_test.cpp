// A placed surface answers as the surface itself does for the ray moved the other way.
#include <gtest/gtest.h>

#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

TEST(Transform, TranslateAndMatrixAnswerAsTheMovedRay) {
  // Exact in doubles: a shear with a power of two, a swap, and a short shift.
  const Placement placement{{1, -2, 4}, {Vec3{0, 0.5, 2}, Vec3{0, 1, 0}, Vec3{-2, 0, 0}}};
  for (const Cell& cell : double_cells()) {
    if (!cell.solver->info.claims.deterministic) continue;
    const SurfaceSpec plain = examples(cell.surface->name).front();
    SurfaceSpec placed = plain;
    placed.placement = placement;
    const auto rays = camera_rays(*cell.surface->make(plain), 100, 20261122);
    std::vector<Ray> moved;
    for (const Ray& ray : rays) {
      moved.push_back({placement.matrix * ray.o + placement.translate, placement.matrix * ray.d});
    }
    const auto a = ask(cell.scene(plain), rays);
    const auto b = ask(cell.scene(placed), moved);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (a[i].status != Status::ok || b[i].status != Status::ok) continue;
      ASSERT_EQ(a[i].l.size(), b[i].l.size()) << cell.name() << " " << i;
      for (std::size_t k = 0; k < a[i].l.size(); ++k) {
        EXPECT_NEAR(b[i].l[k], a[i].l[k], 1e-7 * a[i].l[k]) << cell.name();
        // The normal goes by the inverse transpose: orthogonal to moved tangents.
        const Vec3 tangent = cross(a[i].normal[k], Vec3{0.6, 0.48, 0.64});
        EXPECT_NEAR(dot(b[i].normal[k], normalized(placement.matrix * tangent)), 0, 1e-6) << cell.name();
      }
    }
  }
}

TEST(Transform, ASingularMatrixIsRefused) {
  for (const SurfaceEntry& surface : surface_registry()) {
    SurfaceSpec spec = examples(surface.name).front();
    spec.placement.matrix[2] = spec.placement.matrix[1];
    EXPECT_THROW(surface.make(spec), std::invalid_argument) << surface.name;
  }
}

}  // namespace
}  // namespace graze::test
