// The teardrop is the Bezier surface of its control points: both answer alike.
#include <gtest/gtest.h>

#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

Scene along_ray(const SurfaceSpec& spec) {
  for (const SolverEntry& solver : solver_registry()) {
    if (!solver.info.claims.certified) continue;
    Scene scene;
    scene.add(find_surface(spec.type), spec, solver);
    return scene;
  }
  return {};
}

TEST(Teardrop, AnswersAsTheBezierSurfaceOfItsControlPoints) {
  if (!has_surface("teardrop") || !has_surface("bezier_revolution"))
    GTEST_SKIP() << "this build lacks one of them";
  for (const double s : {1.0, 0.75, 3.0}) {
    const auto rays = camera_rays(*find_surface("teardrop").make(teardrop(s)), 400, 20261122);
    const auto a = ask(along_ray(teardrop(s)), rays);
    const auto b = ask(along_ray(bezier(teardrop_points(s))), rays);
    double worst = 0;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (a[i].status != Status::ok || b[i].status != Status::ok) continue;
      ASSERT_EQ(a[i].l.size(), b[i].l.size()) << i;
      for (std::size_t k = 0; k < a[i].l.size(); ++k, ++compared) {
        worst = std::max(worst, std::fabs(a[i].l[k] - b[i].l[k]) / a[i].l[k]);
        EXPECT_LE(norm(a[i].normal[k] - b[i].normal[k]), 1e-6);
      }
    }
    std::printf("s = %g: %zu hits, worst relative difference %.3g\n", s, compared, worst);
    EXPECT_LE(worst, 1e-9);
    EXPECT_GT(compared, 200U);
  }
}

TEST(Teardrop, SizesThatAreNoSizeAreRefused) {
  if (!has_surface("teardrop")) GTEST_SKIP() << "this build has no teardrop";
  for (const double s : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(find_surface("teardrop").make(teardrop(s)), std::invalid_argument) << s;
  }
}

}  // namespace
}  // namespace graze::test
