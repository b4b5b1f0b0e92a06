// The disk: rim, rays in its plane, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

class DiskTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("disk")) GTEST_SKIP() << "this build has no disk";
  }
};

TEST_F(DiskTest, TheRimBelongsToTheDiskToTheLastBit) {
  // 3-4-5: the point (3, 4) lies exactly on the rim of radius 5.
  const double out = std::nextafter(4.0, 5.0), in = std::nextafter(4.0, 3.0);
  const std::vector<Ray> rays{{{3, 4, 2}, {0, 0, -1}}, {{3, out, 2}, {0, 0, -1}}, {{3, in, 2}, {0, 0, -1}}};
  const auto answers = ask(closed_form_scene(disk({0, 0, 0}, {0, 0, 1}, 5)), rays);
  EXPECT_EQ(answers[0].l, std::vector<double>{2});
  EXPECT_TRUE(answers[1].l.empty());
  EXPECT_EQ(answers[2].l, std::vector<double>{2});
}

TEST_F(DiskTest, ObliqueRaysThroughTheRimHitWhereverTheyComeFrom) {
  // Dyadic origins aimed at (3, 4, 0) exactly, from near and from 2^33 away.
  const Scene scene = closed_form_scene(disk({0, 0, 0}, {0, 0, 1}, 5));
  Rng rng(20261122);
  for (int i = 0; i < 200; ++i) {
    const double scale = i % 2 == 0 ? 1 : 0x1p30;
    const auto draw = [&] { return scale * std::floor(rng.uniform(-64, 64)) / 8; };
    const Vec3 d{draw(), draw(), scale * (1 + std::floor(rng.uniform(0, 7)))};
    const Ray ray{Vec3{3, 4, 0} - d, d};
    EXPECT_EQ(ask(scene, {&ray, 1})[0].l, std::vector<double>{1}) << i;
  }
}

TEST_F(DiskTest, RaysInThePlaneTouchRunInsideOrMiss) {
  const std::vector<Ray> rays{{{-4, 2, 0}, {2, 0, 0}},    // touches at (0, 2)
                              {{-4, 1, 0}, {1, 0, 0}},    // crosses the disk
                              {{4, 1, 0}, {1, 0, 0}},     // has left it behind
                              {{0, 0, 0}, {1, 0, 0}},     // starts inside
                              {{-4, 2.5, 0}, {1, 0, 0}},  // passes
                              {{4, 2, 0}, {1, 0, 0}},     // touched it at l < 0
                              {{-4, 1, 1}, {1, 0, 0}}};   // parallel beside it
  const auto answers = ask(closed_form_scene(disk({0, 0, 0}, {0, 0, 1}, 2)), rays);
  EXPECT_EQ(answers[0].l, std::vector<double>{2});
  EXPECT_EQ(answers[0].multiplicity, std::vector<std::uint32_t>{2});
  EXPECT_EQ(answers[1].status, Status::coincident);
  EXPECT_EQ(answers[2].status, Status::ok);
  EXPECT_EQ(answers[3].status, Status::coincident);
  for (const std::size_t i : {2U, 4U, 5U, 6U}) {
    EXPECT_EQ(answers[i].status, Status::ok) << i;
    EXPECT_TRUE(answers[i].l.empty()) << i;
  }
}

TEST_F(DiskTest, WhatIsNoDiskIsRefusedByName) {
  EXPECT_EQ(refusal(disk({0, 0, 0}, {0, 0, 0}, 1)), "parameter 'normal' must not be zero");
  EXPECT_EQ(refusal(disk({0, 0, 0}, {0, 0, 1}, 0)), "parameter 'radius' must be positive");
  EXPECT_EQ(refusal(disk({0, 0, 0}, {0, 0, 1}, -1)), "parameter 'radius' must be positive");
}

}  // namespace
}  // namespace graze::test
