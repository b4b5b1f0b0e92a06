// The last tier of Bezier profiles: what no rounded arithmetic can tell apart.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/surfaces/bezier_revolution_exact.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

using Points = std::vector<std::array<double, 2>>;

Points points_of(const Table& table) {
  Points points;
  for (const auto& row : table) points.push_back({row[0], row[1]});
  return points;
}

struct Expected {
  double l;
  std::uint32_t multiplicity;
};

void expect(const Points& points, const Ray& ray, const std::vector<Expected>& expected) {
  ExactBezierRevolution::Hits hits = ExactBezierRevolution(points).hits(ray);
  ASSERT_TRUE(hits.has_value());
  ASSERT_EQ(hits->size(), expected.size()) << ray.o.x << " " << ray.o.y << " " << ray.d.x << " " << ray.d.y;
  for (std::size_t i = 0; i < hits->size(); ++i) {
    EXPECT_EQ((*hits)[i].l.to_double(), expected[i].l) << i;
    EXPECT_EQ((*hits)[i].multiplicity, expected[i].multiplicity) << i;
  }
}

/// R = 2t, Y = t.
const Points& cone() {
  static const Points points{{0, 0}, {2, 1}};
  return points;
}
/// R = 1 - 2t, Y = t: crosses the axis at (0, 1/2).
const Points& double_cone() {
  static const Points points{{1, 0}, {-1, 1}};
  return points;
}
/// Y = 4t(1 - t), R = 1 + t: rises to 1 and falls; horizontal rays meet two circles.
const Points& arch() {
  static const Points points{{1, 0}, {1.5, 2}, {2, 0}};
  return points;
}
/// R = 1, Y = 4t(1 - t): up to 1 and back on itself.
const Points& there_and_back() {
  static const Points points{{1, 0}, {1, 2}, {1, 0}};
  return points;
}
/// A loop: R = 9 + 24 u^2, Y = 48 u^3 - 3 u, u = t - 1/2. It crosses itself at u = +-1/4 in (10.5, 0).
const Points& loop() {
  static const Points points{{15, -4.5}, {7, 6.5}, {7, -6.5}, {15, 4.5}};
  return points;
}

TEST(BezierExact, WorkedRays) {
  expect(cone(), {{-5, 0.5, 0}, {1, 0, 0}}, {{4, 1}, {6, 1}});
  expect(cone(), {{-5, 0.5, 0}, {2, 0, 0}}, {{2, 1}, {3, 1}});
  expect(cone(), {{1, 0.5, -3}, {0, 0, 1}}, {{3, 2}});
  expect(cone(), {{std::nextafter(1, 2), 0.5, -3}, {0, 0, 1}}, {});
  EXPECT_EQ(ExactBezierRevolution(cone()).hits({{std::nextafter(1, 0), 0.5, -3}, {0, 0, 1}})->size(), 2U);
  expect(cone(), {{1, -1, 0}, {0, 1, 0}}, {{1.5, 1}});
}

TEST(BezierExact, AHitAtTheOriginOfTheRayIsNone) {
  expect(cone(), {{-1, 0.5, 0}, {1, 0, 0}}, {{2, 1}});
  expect(cone(), {{1, 0.5, 0}, {1, 0, 0}}, {});
  expect(cone(), {{1, 0.5, 0}, {0, 0, 1}}, {});
  expect(cone(), {{1, 0.5, 0}, {0, 1, 0}}, {});
}

TEST(BezierExact, PolesCountOnceWhereTheLinePassesInsideAndAsATouchElsewhere) {
  // The cone's slope is 2: steeper lines pass inside.
  expect(cone(), {{0, -1, 0}, {0, 1, 0}}, {{1, 1}});
  expect(cone(), {{-1, -1, 0}, {1, 1, 0}}, {{1, 1}});
  expect(cone(), {{-3, -1, 0}, {3, 1, 0}}, {{1, 2}});
  expect(cone(), {{-3, 0, 0}, {1, 0, 0}}, {{3, 2}});
  // Where the profile crosses the axis both cones meet there.
  expect(double_cone(), {{0, -1, 0}, {0, 1, 0}}, {{1.5, 2}});
  expect(double_cone(), {{-8, 0.5, 0}, {1, 0, 0}}, {{8, 2}});
}

TEST(BezierExact, ARayInsideTheSurfaceHasNoHits) {
  EXPECT_FALSE(ExactBezierRevolution(cone()).hits({{-4, -2, 0}, {2, 1, 0}}).has_value());
  // It leaves the cone's mantle behind.
  expect(cone(), {{4, 2, 0}, {2, 1, 0}}, {});
  const Points disk{{0, 1}, {2, 1}}, annulus{{1, 1}, {2, 1}};
  for (const Points& points : {disk, annulus}) {
    EXPECT_FALSE(ExactBezierRevolution(points).hits({{-4, 1, 0.5}, {1, 0, 0}}).has_value());
    expect(points, {{-4, 1, 2}, {1, 0, 0}}, {{4, 2}});
    expect(points, {{-4, 1, 3}, {1, 0, 0}}, {});
    expect(points, {{1.5, 0, 0}, {0, 0.5, 0}}, {{2, 1}});
    expect(points, {{1.5, 2, 0}, {0, 0.5, 0}}, {});
  }
  expect(annulus, {{0.5, 0, 0}, {0, 1, 0}}, {});
}

TEST(BezierExact, HorizontalRaysWhereYTurns) {
  // Y = 1 at t = 1/2 only, twice, with R = 3/2.
  expect(arch(), {{-2, 1, 0}, {1, 0, 0}}, {{0.5, 2}, {3.5, 2}});
  expect(arch(), {{-2, 1, 1.5}, {1, 0, 0}}, {{2, 4}});
  expect(arch(), {{-2, std::nextafter(1, 2), 0}, {1, 0, 0}}, {});
  // Y = 3/4 at t = 1/4 and 3/4: R = 5/4 and 7/4.
  expect(arch(), {{-2, 0.75, 0}, {1, 0, 0}}, {{0.25, 1}, {0.75, 1}, {3.25, 1}, {3.75, 1}});
}

TEST(BezierExact, HitsInOnePointAreOne) {
  expect(there_and_back(), {{-2, 0.25, 0}, {1, 0, 0}}, {{1, 2}, {3, 2}});
  expect(there_and_back(), {{-2, 0, 0}, {1, 0.25, 0}}, {{1, 2}, {3, 2}});
  // y = 1/4 at t = (1 -+ sqrt(3/4)) / 2, irrational.
  expect(there_and_back(), {{-2, 0.25, 1}, {1, 0, 0}}, {{2, 4}});
  expect(loop(), {{-12, 0, 0}, {1, 0, 0}}, {{1.5, 2}, {3, 1}, {21, 1}, {22.5, 2}});
  std::size_t twice = 0;
  ExactBezierRevolution::Hits hits = ExactBezierRevolution(loop()).hits({{-11.5, -1, 0}, {1, 1, 0}});
  for (ExactBezierHit& hit : *hits) twice += hit.l.to_double() == 1 && hit.multiplicity == 2 ? 1U : 0U;
  EXPECT_EQ(twice, 1U);
}

TEST(BezierExact, TheDoubleIsTheNearestAlsoAtATie) {
  constexpr double kU = 0x1p-53;
  const Points cylinder{{1 - kU, 0}, {1 - kU, 1}};
  // l = 1 + u lies between two doubles: the even one is 1. A little more, by 2^-200, is nearer to the other.
  expect(cylinder, {{-2, 0.5, 0}, {1, 0, 0}}, {{1, 1}, {3, 1}});
  expect(cylinder, {{-2, 0.5, 0x1p-100}, {1, 0, 0}}, {{1 + 2 * kU, 1}, {3, 1}});
  ExactBezierRevolution::Hits hits = ExactBezierRevolution(cylinder).hits({{-2, 0.5, 0.5}, {1, 0.25, 0}});
  BezierLength l = hits->front().l;
  constexpr long kDigits = 300;
  l.refine(kDigits);
  EXPECT_LE(l.hi() - l.lo(), scale_by_power(l.lo(), -kDigits));
  EXPECT_EQ(l.compare_with(l.lo()), 1);
  EXPECT_EQ(l.compare_with(l.hi()), -1);
}

struct Named {
  std::string name;
  Table points;
};

std::vector<Named> profiles() {
  return {{"cone", {{1, 0}, {0, 2}}},
          {"cylinder", {{1, 0}, {1, 2}}},
          {"disk", {{0, 1}, {2, 1}}},
          {"teardrop", teardrop_points(1)},
          {"vase", vase_points()},
          {"raised", {{0, 0}, {2, 1}, {3, 2}, {1, 4}, {0, 6}}},
          {"crossing", crossing_points()},
          {"fold", {{0, 0}, {3, 4}, {3, -2}, {0, 3}}},
          {"loop", {{1, 0}, {6, 3}, {-3, 3}, {2, 0}}},
          {"back", {{1, 0}, {1.25, 2}, {1, 0}}},
          {"ring", {{1, 0}, {3, -2}, {3, 2}, {1, 0}}},
          {"nine", {{0, 0}, {1, 0}, {3, 1}, {1, 2}, {2, 3}, {3, 4}, {2, 5}, {1, 6}, {2, 7}, {0, 6}}}};
}

// The truth engine has its own integers, its own polynomials and its own isolation.
TEST(BezierExact, AgreesWithTheTruthOnEveryFamily) {
  const std::size_t count = kSanitized ? 8 : 40;
  for (const Named& profile : profiles()) {
    const SurfaceSpec spec = bezier(profile.points);
    const auto surface = find_surface("bezier_revolution").make(spec);
    const auto truth = truth::make_surface(spec);
    const ExactBezierRevolution exact(points_of(profile.points));
    double rays = 0, seconds = 0;
    for (const CaseFamily& family : case_families()) {
      if (!family.suits(surface->landmarks()) || family.name == "scale") continue;
      for (const CaseRay& ray : make_block(family, *surface, 20261122, 0, count)) {
        const truth::Answer answer = truth->all(ray.ray, {.digits = 17});
        const auto start = std::chrono::steady_clock::now();
        ExactBezierRevolution::Hits hits = exact.hits(ray.ray);
        if (hits) {
          for (ExactBezierHit& hit : *hits) static_cast<void>(hit.l.to_double());
        }
        seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        ++rays;
        ASSERT_EQ(hits.has_value(), answer.status == Status::ok) << profile.name << " " << family.name;
        if (!hits) continue;
        ASSERT_EQ(hits->size(), answer.hits.size()) << profile.name << " " << family.name;
        for (std::size_t i = 0; i < hits->size(); ++i) {
          EXPECT_EQ((*hits)[i].l.to_double(), answer.hits[i].l.head) << profile.name << " " << family.name;
          EXPECT_EQ((*hits)[i].multiplicity, answer.hits[i].multiplicity) << family.name;
        }
      }
    }
    std::printf("%s: %.0f rays of all families, %.0f us a ray\n", profile.name.c_str(), rays,
                1e6 * seconds / rays);
  }
}

}  // namespace
}  // namespace graze::test
