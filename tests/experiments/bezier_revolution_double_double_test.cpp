// The middle tier of Bezier profiles: what it proves is what exact integers say, and that is most of the
// rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include <graze/experiments/cases.hpp>
#include <graze/surfaces/bezier_revolution_double_double.hpp>
#include <graze/surfaces/bezier_revolution_exact.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261124;

struct Profile {
  std::string name;
  Table points;
};

void PrintTo(const Profile& profile, std::ostream* out) { *out << profile.name; }

std::vector<Profile> profiles() {
  Table sixteen;
  for (int i = 0; i <= 16; ++i) sixteen.push_back({i % 3 == 0 ? 0.5 : 2.0, static_cast<double>(i)});
  return {{"cone", {{1, 0}, {0, 2}}},
          {"cylinder", {{1, 0}, {1, 2}}},
          {"teardrop", teardrop_points(1)},
          {"vase", vase_points()},
          {"crossing", crossing_points()},
          {"seven", degree_seven_points()},
          {"fold", {{0, 0}, {3, 4}, {3, -2}, {0, 3}}},
          {"sixteen", sixteen}};
}

class BezierDoubleDoubles : public testing::TestWithParam<Profile> {
 protected:
  BezierDoubleDoubles()
      : surface_(bezier(GetParam().points)), lines_(surface_.profile), exact_(surface_.control_points) {}

  /// Whether anything is proved of the ray; if so it is checked.
  bool proves(const Ray& ray) {
    const LocalRay local = to_unit(ray, surface_.unit());
    BezierDoubleDouble::Hits hits;
    if (!lines_.find(local.o, local.d, hits)) return false;
    // The same line in the same units: what to_unit rounds is no question here.
    ExactBezierRevolution::Hits right = exact_.hits({scale_by_power(local.o, surface_.unit()), local.d});
    EXPECT_TRUE(right.has_value());
    if (!right) return true;
    EXPECT_EQ(hits.count, right->size());
    for (std::size_t i = 0; i < std::min(hits.count, right->size()); ++i) check(hits.list[i], (*right)[i]);
    return true;
  }

  void check(const BezierDoubleDouble::Hit& hit, ExactBezierHit right) const {
    constexpr long kDigits = 160;
    right.l.refine(kDigits);
    const auto in_object = [this](const Dyadic& x) { return scale_by_power(x, surface_.unit()); };
    const Dyadic l(hit.l), error(hit.error);
    EXPECT_LE(in_object(l - error), right.l.hi());
    EXPECT_GE(in_object(l + error), right.l.lo());
    EXPECT_EQ(hit.multiplicity, right.multiplicity);
    EXPECT_LE(hit.error, 0x1p-54 * (hit.l.hi + 0.25));
  }

  BezierRevolution surface_;
  BezierDoubleDouble lines_;
  ExactBezierRevolution exact_;
};

TEST_P(BezierDoubleDoubles, WhatIsProvedIsTrueAndMostOfAllRays) {
  const SurfaceModel<BezierRevolution> model(bezier(GetParam().points));
  const std::size_t count = kSanitized ? 10 : 50;
  std::size_t rays = 0, proved = 0;
  for (const CaseFamily& family : case_families()) {
    // Poles within the profile and the ends of the range are for the last tier.
    if (!family.suits(model.landmarks()) || family.name == "scale" || family.name == "extreme") continue;
    std::size_t here = 0;
    for (const CaseRay& ray : make_block(family, model, kSeed, 0, count)) here += proves(ray.ray) ? 1U : 0U;
    rays += count;
    proved += here;
    if (family.name != "axis") {
      EXPECT_GE(here * 10, 9 * count)
          << family.name;  // on the axis a profile that crosses it has double roots
    }
  }
  std::printf("%s: %zu of %zu rays proved\n", GetParam().name.c_str(), proved, rays);
  EXPECT_GE(proved * 10, 9 * rays);
}

/// From level to steep, past the places where one way of asking gives way to the other.
TEST_P(BezierDoubleDoubles, LinesOfEverySlope) {
  const SurfaceModel<BezierRevolution> model(bezier(GetParam().points));
  Rng rng(kSeed);
  std::size_t proved = 0, rays = 0;
  for (int exponent = -200; exponent <= 0; exponent += exponent < -60 ? 20 : 1) {
    for (int k = 0; k < 4; ++k, ++rays) {
      const SurfaceSample at = model.sample(rng.uniform(), rng.uniform());
      const Vec3 d{rng.uniform() - 0.5, std::ldexp(rng.uniform() - 0.5, exponent), rng.uniform() - 0.5};
      proved += proves({at.point - 3 * d + Vec3{0, 0, 1e-3}, d}) ? 1U : 0U;
    }
  }
  std::printf("%s: %zu of %zu slopes proved\n", GetParam().name.c_str(), proved, rays);
  EXPECT_GE(proved * 10, 9 * rays);
}

/// No bar: the page's figures.
TEST_P(BezierDoubleDoubles, TimesAreOnRecord) {
  const SurfaceModel<BezierRevolution> model(bezier(GetParam().points));
  std::vector<Ray> rays;
  for (const CaseRay& ray : make_block(find_family("tangent"), model, kSeed, 0, kCaseBlock)) {
    const LocalRay local = to_unit(ray.ray, surface_.unit());
    rays.push_back({local.o, local.d});
  }
  const auto seconds = [&](const auto& answer) {
    const auto start = std::chrono::steady_clock::now();
    for (const Ray& ray : rays) answer(ray);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const auto in_double_doubles = [&](const Ray& ray) {
    BezierDoubleDouble::Hits hits;
    static_cast<void>(lines_.find(ray.o, ray.d, hits));
  };
  const auto in_integers = [&](const Ray& ray) {
    ExactBezierRevolution::Hits hits = exact_.hits({scale_by_power(ray.o, surface_.unit()), ray.d});
    for (ExactBezierHit& hit : *hits) static_cast<void>(hit.l.to_double());
  };
  double fast = 1e9, slow = 1e9;
  for (int run = 0; run < 5; ++run) {
    fast = std::min(fast, seconds(in_double_doubles));
    slow = std::min(slow, seconds(in_integers));
  }
  std::printf("%s, tangent rays: double-doubles %.1f us a ray, exact integers %.1f times that\n",
              GetParam().name.c_str(), 1e6 * fast / static_cast<double>(rays.size()), slow / fast);
}

INSTANTIATE_TEST_SUITE_P(Profiles, BezierDoubleDoubles, testing::ValuesIn(profiles()),
                         [](const auto& profile) { return profile.param.name; });

TEST(BezierDoubleDouble, WhatOnlyExactArithmeticTellsIsNotProved) {
  const BezierRevolution cone(bezier({{0, 0}, {1, 1}}));
  const BezierDoubleDouble lines(cone.profile);
  BezierDoubleDouble::Hits hits;
  // Touches, a generator of the mantle, an origin on it, the rim, and the pole's own plane.
  const std::vector<Ray> open{{{0.5, 0.5, -1}, {0, 0, 1}},
                              {{-1, -1, 0}, {1, 1, 0}},
                              {{0.5, 0.5, 0}, {1, 0.25, 0}},
                              {{-1, 0.5, 0}, {1, 0.25, 0}},
                              {{-1, 0, 0}, {1, 0, 0}}};
  for (const Ray& ray : open) EXPECT_FALSE(lines.find(ray.o, ray.d, hits)) << ray.o.x << " " << ray.d.y;
  // Every point of a profile that runs back on itself is two.
  const BezierRevolution back(bezier({{1, 0}, {1, 1.5}, {1, 0}}));
  const BezierDoubleDouble doubled(back.profile);
  EXPECT_FALSE(doubled.find({-2, 0, 0}, {1, 0.25, 0}, hits));
  EXPECT_FALSE(doubled.find({-2, 0.375, 0}, {1, 0, 0}, hits));
  // Through the pole, inside and beside the cone.
  ASSERT_TRUE(lines.find({-0.5, -1, 0}, {0.5, 1, 0}, hits));
  ASSERT_EQ(hits.count, 1U);
  EXPECT_EQ(hits.list[0].multiplicity, 1U);
  ASSERT_TRUE(lines.find({-1, -0.5, 0}, {1, 0.5, 0}, hits));
  ASSERT_EQ(hits.count, 1U);
  EXPECT_EQ(hits.list[0].multiplicity, 2U);
}

}  // namespace
}  // namespace graze::test
