// The torus: worked rays, its three kinds, its formulations against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

class TorusTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("torus")) GTEST_SKIP() << "this build has no torus";
    companion_ = solver_named("companion");
    certified_ = solver_named("interval_bisection");
    if (companion_ == nullptr || certified_ == nullptr) GTEST_SKIP() << "this build lacks a solver";
  }
  const SolverEntry* companion_ = nullptr;
  const SolverEntry* certified_ = nullptr;
};

TEST_F(TorusTest, ARayThroughBothTubesHasFourHits) {
  const std::vector<Ray> rays{{{-3, 0, 0}, {1, 0, 0}}};
  for (const char* formulation : {"quartic_recentred", "quartic"}) {
    const Answer answer = ask(scene_of(torus(1, 0.25), *companion_, formulation), rays)[0];
    ASSERT_EQ(answer.l.size(), 4U) << formulation;
    const std::array<double, 4> expected{1.75, 2.25, 3.75, 4.25};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(answer.l[i], expected[i], 1e-12);
      EXPECT_NEAR(std::fabs(answer.normal[i].x), 1, 1e-13);
    }
    EXPECT_NEAR(answer.params[0][1], 0, 1e-12) << "v on the outer equator";
    EXPECT_NEAR(std::fabs(answer.params[1][1]), std::numbers::pi, 1e-12) << "v on the inner equator";
  }
  for (const char* formulation : {"quartic_recentred", "along_ray"}) {
    const Answer answer = ask(scene_of(torus(1, 0.25), *certified_, formulation), rays)[0];
    EXPECT_EQ(answer.l.size(), 4U) << formulation;
    EXPECT_EQ(answer.status, Status::ok) << formulation;
  }
}

TEST_F(TorusTest, ARayOnTheTopTouchesTwice) {
  const std::vector<Ray> rays{{{-3, 0.25, 0}, {1, 0, 0}}};
  const Answer answer = ask(scene_of(torus(1, 0.25), *companion_), rays)[0];
  ASSERT_EQ(answer.l.size(), 2U);
  EXPECT_NEAR(answer.l[0], 2, 1e-7);
  EXPECT_NEAR(answer.l[1], 4, 1e-7);
  EXPECT_EQ(answer.multiplicity, (std::vector<std::uint32_t>{2, 2}));
  EXPECT_EQ(ask(scene_of(torus(1, 0.25), *certified_), rays)[0].status, Status::uncertain);
}

TEST_F(TorusTest, ARayAlongTheInnerEquatorCrossesTouchesAndCrosses) {
  // x^2 + z^2 with z = 3/4 and y = 0: outer equator at x = +-1, inner equator touched at x = 0.
  const std::vector<Ray> rays{{{-3, 0, 0.75}, {1, 0, 0}}};
  const Answer answer = ask(scene_of(torus(1, 0.25), *companion_), rays)[0];
  ASSERT_EQ(answer.l.size(), 3U);
  EXPECT_NEAR(answer.l[0], 2, 1e-12);
  EXPECT_NEAR(answer.l[1], 3, 1e-7);
  EXPECT_NEAR(answer.l[2], 4, 1e-12);
  EXPECT_EQ(answer.multiplicity, (std::vector<std::uint32_t>{1, 2, 1}));
}

TEST_F(TorusTest, ARayThatStartsOnTheSurfaceDoesNotHitThere) {
  const std::vector<Ray> rays{{{1.25, 0, 0}, {-1, 0, 0}}, {{1.25, 0, 0}, {1, 0, 0}}};
  const std::vector<Answer> answers = ask(scene_of(torus(1, 0.25), *certified_), rays);
  EXPECT_EQ(answers[0].l.size(), 3U);
  EXPECT_EQ(answers[0].status, Status::ok);
  EXPECT_TRUE(answers[1].l.empty());
  EXPECT_EQ(answers[1].status, Status::ok);
}

TEST_F(TorusTest, ASpindleHasAnInnerSheetWithInwardNormals) {
  // R = 1, r = 2, along x through the centre: rho = 3 outside, rho = 1 inside.
  const std::vector<Ray> rays{{{-4, 0, 0}, {1, 0, 0}}};
  for (const char* formulation : {"quartic_recentred", "along_ray"}) {
    const Answer answer = ask(scene_of(torus(1, 2), *certified_, formulation), rays)[0];
    ASSERT_EQ(answer.l.size(), 4U) << formulation;
    const std::array<double, 4> expected{1, 3, 5, 7};
    const std::array<double, 4> normal_x{-1, 1, -1, 1};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(answer.l[i], expected[i], 1e-10);
      EXPECT_NEAR(answer.normal[i].x, normal_x[i], 1e-10)
          << "along the gradient of the product of both sheets";
    }
  }
}

TEST_F(TorusTest, CrossingPointsFaceTheRay) {
  // Along the axis of a spindle: both crossings are double roots, the gradient vanishes there.
  const std::vector<Ray> rays{{{0, -4, 0}, {0, 2, 0}}};
  const Answer answer = ask(scene_of(torus(3, 5), *companion_), rays)[0];
  ASSERT_EQ(answer.l.size(), 1U) << "starts on one of them: y = -4";
  EXPECT_NEAR(answer.l[0], 4, 1e-7);
  EXPECT_EQ(answer.multiplicity[0], 2U);
  EXPECT_EQ(answer.normal[0], (Vec3{0, -1, 0}));
}

TEST_F(TorusTest, KindsAndLandmarksFollowTheRadii) {
  const SurfaceEntry& entry = find_surface("torus");
  const auto ring = entry.make(torus(1, 0.25)), horn = entry.make(torus(0.5, 0.5)),
             spindle = entry.make(torus(3, 5));
  EXPECT_EQ(ring->variety(), "ring torus");
  EXPECT_EQ(horn->variety(), "horn torus");
  EXPECT_EQ(spindle->variety(), "spindle torus");
  EXPECT_TRUE(ring->landmarks().singular.empty());
  ASSERT_EQ(horn->landmarks().singular.size(), 1U);
  EXPECT_EQ(horn->landmarks().singular[0].first, (Vec3{}));
  ASSERT_EQ(spindle->landmarks().singular.size(), 2U);
  EXPECT_EQ(spindle->landmarks().singular[0].first, (Vec3{0, 4, 0}));
}

TEST_F(TorusTest, SamplesLieOnTheSurfaceWithItsNormal) {
  Rng rng(kSeed);
  for (const auto& [ring, tube] : {std::pair{1.0, 0.25}, {0.5, 0.5}, {0.75, 1.25}}) {
    const auto surface = find_surface("torus").make(torus(ring, tube));
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {
      const double u = rng.uniform();
      const SurfaceSample s = surface->sample(u, rng.uniform());
      const double rho = std::hypot(s.point.x, s.point.z);
      const double outer = std::fabs(std::hypot(rho - ring, s.point.y) - tube);
      const double inner = std::fabs(std::hypot(rho + ring, s.point.y) - tube);
      worst = std::max(worst, std::min(outer, inner));
      EXPECT_NEAR(norm(s.normal), 1, 4e-16);
    }
    EXPECT_LE(worst, 1e-15);
  }
}

TEST_F(TorusTest, SheetsAndQuarticAgreeOnEveryRayThatTheyDecide) {
  for (const auto& spec : {torus(1, 0.25), torus(0.5, 0.5), torus(0.75, 1.25), torus(1, 0x1p-10)}) {
    const auto rays = mixed_rays(*find_surface("torus").make(spec), 300, kSeed);
    const auto a = ask(scene_of(spec, *certified_, "quartic_recentred"), rays);
    const auto b = ask(scene_of(spec, *certified_, "along_ray"), rays);
    double worst = 0;
    std::size_t undecided = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (a[i].status != Status::ok || b[i].status != Status::ok) {
        ++undecided;
        continue;
      }
      ASSERT_EQ(a[i].l.size(), b[i].l.size()) << i;
      for (std::size_t k = 0; k < a[i].l.size(); ++k)
        worst = std::max(worst, std::fabs(a[i].l[k] - b[i].l[k]) / a[i].l[k]);
    }
    std::printf("%zu of %zu rays undecided, worst relative difference %.2g\n", undecided, rays.size(), worst);
    EXPECT_LE(undecided, rays.size() / 10);
    EXPECT_LE(worst, 1e-6);
  }
}

TEST_F(TorusTest, RadiiThatAreNoneAreRefused) {
  const SurfaceEntry& entry = find_surface("torus");
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(entry.make(torus(bad, 1)), std::invalid_argument) << bad;
    EXPECT_THROW(entry.make(torus(1, bad)), std::invalid_argument) << bad;
  }
  EXPECT_THROW(entry.make(torus(1e308, 1e308)), std::invalid_argument) << "R + r overflows";
  EXPECT_THROW(entry.make(torus(1e300, 1e-300)), std::invalid_argument) << "no common local frame";
}

}  // namespace
}  // namespace graze::test
