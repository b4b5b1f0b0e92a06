// The teardrop's last tier: what no rounded arithmetic can tell apart.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <graze/surfaces/teardrop_exact.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

struct Expected {
  double l;
  std::uint32_t multiplicity;
};

void expect(const Ray& ray, const std::vector<Expected>& expected) {
  std::vector<ExactHit> hits = exact_teardrop_hits(ray, 1);
  ASSERT_EQ(hits.size(), expected.size()) << ray.o.x << " " << ray.d.x;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_EQ(hits[i].l.to_double(), expected[i].l);
    EXPECT_EQ(hits[i].multiplicity, expected[i].multiplicity);
  }
}

TEST(TeardropExact, WorkedRays) {
  // y = 1.5 is t = 1/2, R = 15/8.
  expect({{-5, 1.5, 0}, {1, 0, 0}}, {{5 - 1.875, 1}, {5 + 1.875, 1}});
  expect({{1.875, 1.5, -5}, {0, 0, 1}}, {{5, 2}});
  expect({{std::nextafter(1.875, 2), 1.5, -5}, {0, 0, 1}}, {});
  EXPECT_EQ(exact_teardrop_hits({{std::nextafter(1.875, 0), 1.5, -5}, {0, 0, 1}}, 1).size(), 2U);
}

TEST(TeardropExact, AHitAtTheOriginOfTheRayIsNone) {
  expect({{-1.875, 1.5, 0}, {1, 0, 0}}, {{3.75, 1}});
  expect({{1.875, 1.5, 0}, {1, 0, 0}}, {});
  expect({{1.875, 1.5, 0}, {0, 0, 1}}, {});
}

TEST(TeardropExact, PolesCountOnceWhereTheLinePassesInsideAndAsATouchElsewhere) {
  expect({{0, -1, 0}, {0, 1, 0}}, {{1, 1}, {7, 1}});
  expect({{-3, 0, 0}, {1, 0, 0}}, {{3, 2}});
  expect({{-4, 6, 0}, {1, 0, 0}}, {{4, 2}});
  // Through the apex: steeper than the cone (slope 4/3) inside, along it or flatter a touch.
  EXPECT_EQ(exact_teardrop_hits({{-1, 8, 0}, {1, -2, 0}}, 1).size(), 2U);
  expect({{-3, 10, 0}, {3, -4, 0}}, {{1, 2}});
  expect({{-1, 7, 0}, {1, -1, 0}}, {{1, 2}});
}

TEST(TeardropExact, MirroredSheetsAreNoHits) {
  expect({{0, 7, 0}, {0, 1, 0}}, {});
  expect({{-5, 12, 0}, {1, 0, 0}}, {});
  expect({{-5, -1, 0}, {1, 0, 0}}, {});
}

TEST(TeardropExact, SidesOfPointsTurnAtTheHitsAndAtThePolesPlanes) {
  const auto side = [](const Ray& ray, double l) { return side_of_teardrop(ray, 1, l); };
  const Ray across{{-5, 1.5, 0}, {1, 0, 0}};
  EXPECT_EQ(side(across, 0), -1);
  EXPECT_EQ(side(across, std::nextafter(3.125, 0)), -1);
  EXPECT_EQ(side(across, 3.125), 0);
  EXPECT_EQ(side(across, std::nextafter(3.125, 4)), 1);
  EXPECT_EQ(side(across, std::nextafter(6.875, 0)), 1);
  EXPECT_EQ(side(across, std::nextafter(6.875, 7)), -1);
  // On the axis below, inside and above: beyond the poles the mirrored sheets are no inside.
  const Ray along{{0, -1, 0}, {0, 1, 0}};
  EXPECT_EQ(side(along, 0.5), -1);
  EXPECT_EQ(side(along, 1), 0);
  EXPECT_EQ(side(along, std::nextafter(1, 2)), 1);
  EXPECT_EQ(side(along, std::nextafter(7, 0)), 1);
  EXPECT_EQ(side(along, 7), 0);
  EXPECT_EQ(side(along, 8), -1);
}

// A chord shorter than an ulp of l: both hits have one nearest double, from which one of them must move.
TEST(TeardropExact, TwoHitsOfOneDoubleAreBothWithinAnUlp) {
  if (solver_named("faithful") == nullptr) GTEST_SKIP() << "faithful is not in this build";
  const SurfaceSpec spec = teardrop(1);
  const auto truth = truth::make_surface(spec);
  const Scene scene = scene_of(spec, find_solver("faithful"));
  bool moves_up = false, moves_down = false;
  for (const double beyond : {0.0, 4.0, 8.0, 12.0, 16.0, 20.0}) {
    const Ray ray{{-0x1p54 - beyond, 0.015, 0}, {1.5, 0, 0}};
    const truth::Answer expected = truth->all(ray, {.digits = 34});
    const std::vector<Answer> answers = ask(scene, {&ray, 1});
    ASSERT_EQ(expected.hits.size(), 2U);
    ASSERT_EQ(answers.front().l.size(), 2U);
    for (std::size_t k = 0; k < 2; ++k) {
      const truth::Real& l = expected.hits[k].l;
      EXPECT_LE(std::fabs((answers.front().l[k] - l.head) - l.tail), ulp(l.head)) << beyond;
    }
    EXPECT_LT(answers.front().l[0], answers.front().l[1]);
    if (expected.hits[0].l.head != expected.hits[1].l.head) continue;
    moves_up |= answers.front().l[0] == expected.hits[0].l.head;
    moves_down |= answers.front().l[1] == expected.hits[1].l.head;
  }
  EXPECT_TRUE(moves_up && moves_down);
}

// The truth engine has its own integers, its own polynomials and its own isolation.
TEST(TeardropExact, AgreesWithTheTruthOnEveryFamily) {
  const SurfaceSpec spec = teardrop(1.7);
  const auto surface = find_surface("teardrop").make(spec);
  const auto truth = truth::make_surface(spec);
  const std::size_t count = kSanitized ? 8 : 64;
  double rays = 0, seconds = 0;
  for (const CaseFamily& family : case_families()) {
    if (!family.suits(surface->landmarks()) || family.name == "scale") continue;
    for (const CaseRay& ray : make_block(family, *surface, 20261122, 0, count)) {
      const truth::Answer answer = truth->all(ray.ray, {.digits = 17});
      const auto start = std::chrono::steady_clock::now();
      std::vector<ExactHit> hits = exact_teardrop_hits(ray.ray, 1.7);
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      ++rays;
      ASSERT_EQ(hits.size(), answer.hits.size()) << family.name;
      for (std::size_t i = 0; i < hits.size(); ++i) {
        EXPECT_EQ(hits[i].l.to_double(), answer.hits[i].l.head) << family.name;
        EXPECT_EQ(hits[i].multiplicity, answer.hits[i].multiplicity) << family.name;
      }
    }
  }
  std::printf("%.0f rays of all families: %.0f us a ray without the digits of l\n", rays,
              1e6 * seconds / rays);
}

}  // namespace
}  // namespace graze::test
