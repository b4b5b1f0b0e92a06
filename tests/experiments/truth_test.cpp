// Certified truth on answers worked out by hand, and on properties that hold exactly.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <graze/experiments/truth.hpp>
#include <graze/surfaces/registry.hpp>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "questions.hpp"

namespace graze {
namespace {

using test::ask;
using test::expect_hits;
using test::Table;
using truth::Answer;
using truth::Hit;
using truth::make_surface;

SurfaceSpec teardrop_spec(double s) { return test::spec_of("teardrop", {{"s", s}}); }

SurfaceSpec profile_spec(const Table& points) {
  return test::spec_of("bezier_revolution", {{"control_points", points}});
}

void expect_near(Vec3 a, Vec3 b) { test::expect_near(a, b, 1e-15); }

TEST(Truth, AxisRayEntersTheTeardropThroughTheApexAndLeavesThroughTheBottom) {
  const Answer answer = ask(teardrop_spec(1), {{0, 10, 0}, {0, -1, 0}});
  expect_hits(answer, {{"4"}, {"10"}});
  EXPECT_EQ(answer.hits[0].normal, (Vec3{0, 1, 0}));
  EXPECT_EQ(answer.hits[1].normal, (Vec3{0, -1, 0}));
  EXPECT_EQ(answer.hits[0].params, (std::array<double, 2>{1, 0}));
  EXPECT_EQ(answer.hits[1].params, (std::array<double, 2>{0, 0}));
  EXPECT_EQ(answer.hits[0].cosine, 1);
  EXPECT_EQ(answer.hits[0].point, (Vec3{0, 6, 0}));
  EXPECT_EQ(answer.hits[1].point, (Vec3{0, 0, 0}));
}

TEST(Truth, HorizontalRayAtTheWorkedHeightHitsTwiceAndScalesWithItsDirection) {
  const Answer answer = ask(teardrop_spec(1), {{-5, 1.5, 0}, {1, 0, 0}});
  expect_hits(answer, {{"3.125"}, {"6.875"}});
  EXPECT_EQ(answer.hits[0].params[1], std::acos(-1.0));
  EXPECT_EQ(answer.hits[1].params, (std::array<double, 2>{0.5, 0}));
  // At t = 1/2: Y' = 6, R' = 6 - 3 - 9/4 = 3/4, so the normal is (8, -1) / sqrt(65).
  expect_near(answer.hits[1].normal, (1 / std::sqrt(65.0)) * Vec3{8, -1, 0});
  EXPECT_NEAR(answer.hits[1].cosine, 8 / std::sqrt(65.0), 1e-15);
  expect_hits(ask(teardrop_spec(1), {{-5, 1.5, 0}, {2, 0, 0}}), {{"1.5625"}, {"3.4375"}});
  expect_hits(ask(teardrop_spec(2), {{-10, 3, 0}, {1, 0, 0}}), {{"6.25"}, {"13.75"}});
}

TEST(Truth, RayThatTouchesACircleHasOneHitOfMultiplicityTwo) {
  const Answer answer = ask(teardrop_spec(1), {{1.875, 1.5, -5}, {0, 0, 1}});
  expect_hits(answer, {{"5", 2}});
  EXPECT_EQ(answer.hits[0].cosine, 0);
}

TEST(Truth, RayThatStartsOnTheSurfaceDoesNotHitItsOrigin) {
  expect_hits(ask(teardrop_spec(1), {{0, 1.5, 1.875}, {0, 0, 1}}), {});
  expect_hits(ask(teardrop_spec(1), {{0, 1.5, 1.875}, {0, 0, -1}}), {{"3.75"}});
  expect_hits(ask(teardrop_spec(1), {{0, 6, 0}, {0, -1, 0}}), {{"6"}});
  expect_hits(ask(teardrop_spec(1), {{0, 6, 0}, {0, 1, 0}}), {});
}

TEST(Truth, RayThroughAPoleFromOutsideTouches) {
  expect_hits(ask(teardrop_spec(1), {{-5, 0, 0}, {1, 0, 0}}), {{"5", 2}});
  expect_hits(ask(teardrop_spec(1), {{-5, 6, 0}, {1, 0, 0}}), {{"5", 2}});
  expect_hits(ask(teardrop_spec(1), {{-1, 5, 0}, {1, 1, 0}}), {{"1", 2}});
  EXPECT_NEAR(ask(teardrop_spec(1), {{-1, 5, 0}, {1, 1, 0}}).hits[0].cosine, std::sqrt(0.5), 1e-15);
}

TEST(Truth, RayThroughAPoleIntoTheBodyCrosses) {
  // Down from the apex at slope 8, steeper than the cone of slope 2/3 there.
  const Answer answer = ask(teardrop_spec(1), {{-1, 14, 0}, {1, -8, 0}});
  ASSERT_EQ(answer.hits.size(), 2U);
  EXPECT_EQ(answer.hits[0].l.decimal, "1");
  EXPECT_EQ(answer.hits[0].multiplicity, 1U);
  EXPECT_FALSE(answer.hits[1].tangent);
}

TEST(Truth, PlacementsAreExact) {
  SurfaceSpec twice = teardrop_spec(1);
  twice.placement.matrix = {Vec3{2, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, 2}};
  twice.placement.translate = {1, 2, 3};
  expect_hits(ask(twice, {{-9, 5, 3}, {1, 0, 0}}), {{"6.25"}, {"13.75"}});
  SurfaceSpec reflected = teardrop_spec(1);
  reflected.placement.matrix = {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}};
  const Answer up = ask(reflected, {{0, -10, 0}, {0, 1, 0}});
  expect_hits(up, {{"4"}, {"10"}});
  EXPECT_EQ(up.hits[0].normal, (Vec3{0, -1, 0}));
  // World x = X + 3 Y: the horizontal chord at Y = 3/2 moves by 9/2 along x.
  SurfaceSpec sheared = teardrop_spec(1);
  sheared.placement.matrix = {Vec3{1, 3, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const Answer shear = ask(sheared, {{-5, 1.5, 0}, {1, 0, 0}});
  expect_hits(shear, {{"7.625"}, {"11.375"}});
  // (8, -1) by the inverse transpose: (8, -1 - 24).
  expect_near(shear.hits[1].normal, (1 / std::sqrt(64.0 + 625.0)) * Vec3{8, -25, 0});
}

TEST(Truth, AThirdHasAllDigitsAndProof) {
  const Answer answer = ask(teardrop_spec(1), {{-5, 1.5, 0}, {3, 0, 0}});
  ASSERT_EQ(answer.hits.size(), 2U);
  const truth::Real& l = answer.hits[0].l;
  EXPECT_EQ(l.decimal, "1.041666666666666666666666666666666666667");
  EXPECT_EQ(l.lo, "1.041666666666666666666666666666666666666");
  EXPECT_EQ(l.hi, l.decimal);
  EXPECT_EQ(l.head, 25.0 / 24);
  EXPECT_EQ(l.tail, std::fma(-24, l.head, 25) / 24);
}

TEST(Truth, DigitsAreThoseOfLongerAnswersRounded) {
  const Ray ray{{-5, 1.5, 0.25}, {1, 0.125, 0.0625}};
  const std::string full = ask(teardrop_spec(1), ray, 300).hits[0].l.decimal;
  for (int digits = 17; digits < 120; ++digits) {
    const truth::Real l = ask(teardrop_spec(1), ray, digits).hits[0].l;
    ASSERT_EQ(l.lo, full.substr(0, static_cast<std::size_t>(digits) + 1));
    ASSERT_EQ(l.decimal, full[static_cast<std::size_t>(digits) + 1] < '5' ? l.lo : l.hi);
  }
}

TEST(Truth, ExactTieOfDecimalsRoundsToEven) {
  // l = 2^-17 + 1 has 18 significant digits and ends in 5.
  const SurfaceSpec cylinder = profile_spec({{1, 0}, {1, 4}});
  const truth::Real l = ask(cylinder, {{-2 - 0x1p-17, 1, 0}, {1, 0, 0}}, 17).hits[0].l;
  EXPECT_EQ(l.lo, "1.0000076293945312");
  EXPECT_EQ(l.hi, "1.0000076293945313");
  EXPECT_EQ(l.decimal, "1.0000076293945312");
  EXPECT_EQ(ask(cylinder, {{-2 - 0x1p-17, 1, 0}, {1, 0, 0}}, 18).hits[0].l.decimal, "1.00000762939453125");
}

TEST(Truth, RationalLengthAtAnIrrationalParameterIsRecognised) {
  // A cylinder with Y = 6 t^2: height 2 is at t = sqrt(1/3).
  const SurfaceSpec cup = profile_spec({{1, 0}, {1, 0}, {1, 6}});
  const Answer answer = ask(cup, {{0, 2, 0}, {1, 0, 0}});
  expect_hits(answer, {{"1"}});
  const Answer slanted = ask(cup, {{0, 1, 0}, {1, 1, 0}});
  expect_hits(slanted, {{"1"}});
  EXPECT_EQ(slanted.hits[0].params[0], std::sqrt(1.0 / 3));
}

TEST(Truth, RayInsideAConeOrCylinderIsCoincident) {
  const SurfaceSpec cone = profile_spec({{0, 0}, {1, 1}});
  EXPECT_EQ(ask(cone, {{0, 0, 0}, {1, 1, 0}}).status, Status::coincident);
  EXPECT_EQ(ask(cone, {{0.6, 1, 0.8}, {0.25, 0.5, 0}}).status, Status::ok);
  EXPECT_EQ(ask(cone, {{-4, -4, 0}, {1, 1, 0}}).status, Status::coincident);
  expect_hits(ask(cone, {{0, 0, 0}, {-1, -1, 0}}), {});
  expect_hits(ask(cone, {{1, 1, 0}, {1, 1, 0}}), {});
  const SurfaceSpec cylinder = profile_spec({{1, 0}, {1, 1}});
  EXPECT_EQ(ask(cylinder, {{0, -1, 1}, {0, 1, 0}}).status, Status::coincident);
  EXPECT_FALSE(ask(cylinder, {{0, -1, 1}, {0, 1, 0}}).why.empty());
  expect_hits(ask(cylinder, {{0, -1, 1}, {0, -1, 0}}), {});
  expect_hits(ask(cylinder, {{0, -1, 0.5}, {0, 1, 0}}), {});
}

TEST(Truth, DoubleConeIsPassedInItsCommonApex) {
  const SurfaceSpec cones = profile_spec({{1, 0}, {-1, 2}});
  expect_hits(ask(cones, {{-3, 1, 0}, {1, 0, 0}}), {{"3", 2}});
  expect_hits(ask(cones, {{-1, 0.5, 0}, {2, 1, 0}}), {{"0.5", 2}});
}

TEST(Truth, CurveTracedTwiceCountsEveryHitTwice) {
  const SurfaceSpec there_and_back = profile_spec({{1, 0}, {2, 4}, {1, 0}});
  const Answer answer = ask(there_and_back, {{-5, 1, 0.25}, {1, 0.0625, 0}});
  ASSERT_EQ(answer.hits.size(), 2U);
  EXPECT_EQ(answer.hits[0].multiplicity, 2U);
  EXPECT_LT(answer.hits[0].params[0], 0.5);
  EXPECT_EQ(ask(there_and_back, {{-5, 1, 0.25}, {1, 0, 0}}).hits.size(), 2U);
}

TEST(Truth, ClosedProfileCountsItsSeamTwice) {
  const SurfaceSpec ring = profile_spec({{1, 0}, {2, 1}, {1, 2}, {1, 0}});
  expect_hits(ask(ring, {{-3, 0, 0}, {1, 0, 0}}), {{"2", 2}, {"4", 2}});
}

TEST(Truth, FlatProfileIsADiskOrAnAnnulus) {
  const SurfaceSpec annulus = profile_spec({{1, 2}, {3, 2}});
  expect_hits(ask(annulus, {{2, 0, 0}, {0, 1, 0}}), {{"2"}});
  expect_hits(ask(annulus, {{0.5, 0, 0}, {0, 1, 0}}), {});
  expect_hits(ask(annulus, {{3, 0, 0}, {0, 0.5, 0}}), {{"4"}});
  expect_hits(ask(annulus, {{2, 2, 0}, {0, 1, 0}}), {});
  EXPECT_EQ(ask(annulus, {{0, 2, 0}, {1, 0, 0}}).status, Status::coincident);
  EXPECT_EQ(ask(annulus, {{-5, 2, 2}, {1, 0, 0}}).status, Status::coincident);
  expect_hits(ask(annulus, {{-5, 2, 3}, {1, 0, 0}}), {{"5", 2}});
  expect_hits(ask(annulus, {{-5, 2, 3}, {-1, 0, 0}}), {});
  expect_hits(ask(annulus, {{-5, 1, 2}, {1, 0, 0}}), {});
  const SurfaceSpec disk = profile_spec({{-1, 0}, {2, 0}});
  expect_hits(ask(disk, {{0, 1, 0}, {0, -1, 0}}), {{"1"}});
}

TEST(Truth, CuspHasANormal) {
  // R = 1 + (t - 1/2)^2, Y = (t - 1/2)^3 in Bezier points; the cusp is at t = 1/2, pointing inward.
  const Table points{{1.25, -0.125}, {1.25 - 1.0 / 3, 0.125}, {1.25 - 1.0 / 3, -0.125}, {1.25, 0.125}};
  const Answer answer = ask(profile_spec(points), {{3, 0, 0}, {-1, 0, 0}});
  ASSERT_FALSE(answer.hits.empty());
  for (const Hit& hit : answer.hits) EXPECT_NEAR(norm(hit.normal), 1, 1e-15);
}

TEST(Truth, ExtremeMagnitudesAreNoSpecialCase) {
  const SurfaceSpec drop = teardrop_spec(1);
  // From 1e300 straight at the axis: the length is the distance but for the radius.
  const Answer far = ask(drop, {{0, 0x1p996, 0}, {0, -0x1p990, 0}});
  ASSERT_EQ(far.hits.size(), 2U);
  EXPECT_EQ(far.hits[0].l.head, 64);
  EXPECT_EQ(far.hits[0].l.tail, -6 * 0x1p-990);
  EXPECT_EQ(far.hits[1].l.decimal, "64");
  EXPECT_EQ(far.hits[0].point, (Vec3{0, 6, 0}));
  const double tiny = std::numeric_limits<double>::denorm_min();
  const Answer flat = ask(drop, {{-5, 1.5, 0}, {1, tiny, 0}});
  ASSERT_EQ(flat.hits.size(), 2U);
  EXPECT_EQ(flat.hits[0].l.head, 3.125);
  EXPECT_LE(std::fabs(flat.hits[0].l.tail), 8 * tiny);
  const Answer slow = ask(drop, {{-5, 1.5, 0}, {tiny, 0, 0}});
  ASSERT_EQ(slow.hits.size(), 2U);
  EXPECT_EQ(slow.hits[0].l.head, std::numeric_limits<double>::infinity());
  EXPECT_EQ(slow.hits[0].l.tail, 0);
  EXPECT_EQ(slow.hits[0].l.decimal.substr(slow.hits[0].l.decimal.size() - 5), "e+323");
  EXPECT_EQ(slow.hits[0].point.x, -1.875);
  // A drop of 6e-300 seen from the side.
  const Answer small =
      ask(teardrop_spec(0x1p-1000), {{-5 * 0x1p-1000, 1.5 * 0x1p-1000, 0}, {0x1p-1000, 0, 0}});
  expect_hits(small, {{"3.125"}, {"6.875"}});
}

TEST(Truth, FlatterThanAnyDoubleStillIsNotHorizontal) {
  // Turned by 1e-300 a touch becomes two crossings, about 1e-150 apart.
  const Answer answer = ask(teardrop_spec(1), {{1.875, 1.5, -5}, {0, 1e-300, 1}}, 200);
  ASSERT_EQ(answer.hits.size(), 2U);
  EXPECT_EQ(answer.hits[0].multiplicity, 1U);
  EXPECT_NE(answer.hits[0].l.decimal, answer.hits[1].l.decimal);
  EXPECT_GT(answer.hits[0].cosine, 0);
  EXPECT_LT(answer.hits[0].cosine, 1e-140);
}

TEST(Truth, InvalidRaysAreAnswersAndInvalidSurfacesThrow) {
  const double nan = std::nan("");
  EXPECT_EQ(ask(teardrop_spec(1), {{0, 0, 0}, {0, 0, 0}}).status, Status::invalid);
  EXPECT_EQ(ask(teardrop_spec(1), {{0, nan, 0}, {0, 0, 1}}).status, Status::invalid);
  EXPECT_FALSE(ask(teardrop_spec(1), {{0, 0, 0}, {0, 0, 0}}).why.empty());
  EXPECT_THROW(make_surface(teardrop_spec(0)), std::invalid_argument);
  EXPECT_THROW(make_surface(teardrop_spec(-1)), std::invalid_argument);
  EXPECT_THROW(make_surface(teardrop_spec(nan)), std::invalid_argument);
  EXPECT_THROW(make_surface(profile_spec({{1, 1}})), std::invalid_argument);
  EXPECT_THROW(make_surface(profile_spec({{1, 1}, {1, 1}, {1, 1}})), std::invalid_argument);
  EXPECT_THROW(make_surface(profile_spec({{0, 1}, {0, 3}})), std::invalid_argument);
  EXPECT_THROW(make_surface(profile_spec({{0, 1}, {1, nan}})), std::invalid_argument);
  SurfaceSpec singular = teardrop_spec(1);
  singular.placement.matrix = {Vec3{1, 2, 3}, Vec3{2, 4, 6}, Vec3{0, 0, 1}};
  EXPECT_THROW(make_surface(singular), std::invalid_argument);
  SurfaceSpec unknown = teardrop_spec(1);
  unknown.type = "teacup";
  EXPECT_THROW(make_surface(unknown), std::invalid_argument);
  const std::vector<std::string> types = truth::types();
  for (const SurfaceEntry& surface : surface_registry()) {
    EXPECT_NE(std::find(types.begin(), types.end(), surface.name), types.end()) << surface.name;
  }
}

TEST(Truth, SceneMergesHitsAndBreaksTiesBySurface) {
  std::vector<std::unique_ptr<truth::Surface>> scene;
  scene.push_back(make_surface(teardrop_spec(1)));
  scene.push_back(make_surface(profile_spec({{0, 0}, {2, 0}, {3, 2}, {0, 6}})));
  scene.push_back(make_surface(teardrop_spec(2)));
  const Answer answer = truth::all_hits(scene, {{-10, 1.25, 0.125}, {1, 0.015625, 0}});
  ASSERT_EQ(answer.hits.size(), 6U);
  const std::vector<std::size_t> order{2, 0, 1, 0, 1, 2};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(answer.hits[i].surface, order[i]);
  EXPECT_EQ(answer.hits[1].l.decimal, answer.hits[2].l.decimal);
}

/// Log-uniform and mixed rays around a teardrop of unit size, in short numbers so that sums stay exact.
class ShortRays {
 public:
  explicit ShortRays(std::uint64_t seed) : random_(seed) {}
  double grid(int bits_behind_point, double range) {
    const double unit = std::ldexp(1, -bits_behind_point);
    return unit * std::floor(std::uniform_real_distribution<double>(-range, range)(random_) / unit);
  }
  Ray next() {
    const double range = random_() % 4 == 0 ? 2 : 8;
    const Vec3 o{grid(20, range), 2 + grid(20, range), grid(20, range)};
    const Vec3 target{grid(20, 1.5), 3 + grid(20, 3), grid(20, 1.5)};
    Ray ray{o, target - o};
    if (random_() % 8 == 0) ray.d.y = 0;
    if (random_() % 8 == 0) ray.d.y = std::ldexp(grid(4, 4), -40);
    return ray;
  }

 private:
  std::mt19937_64 random_;
};

bool is_inside_teardrop(Vec3 p) {
  const double v = p.y / 6;
  if (v <= 0 || v >= 1) return false;
  const double r = 3 * std::sqrt(v) * (1 - std::sqrt(v)) * (2 + std::sqrt(v));
  return p.x * p.x + p.z * p.z < r * r;
}

TEST(Truth, ConvexTeardropIsHitOnceFromInsideAndTwiceOrNeverFromOutside) {
  const auto surface = make_surface(teardrop_spec(1));
  ShortRays rays(3);
  std::size_t inside = 0;
  std::size_t crossing = 0;
  for (int i = 0; i < 4000; ++i) {
    const Ray ray = rays.next();
    const Answer answer = surface->all(ray, {17});
    std::uint32_t count = 0;
    for (const Hit& hit : answer.hits) count += hit.multiplicity;
    if (is_inside_teardrop(ray.o)) {
      ++inside;
      ASSERT_EQ(count, 1U) << "ray " << i << " of seed 3";
    } else {
      ASSERT_TRUE(count == 0 || count == 2) << "ray " << i << " of seed 3";
      crossing += count / 2;
    }
  }
  std::printf("%zu rays from inside, %zu crossing from outside\n", inside, crossing);
  EXPECT_GT(inside, 40U);
  EXPECT_GT(crossing, 500U);
}

TEST(Truth, ScalingByAPowerOfTwoChangesNothing) {
  ShortRays rays(4);
  for (const int k : {-300, -41, 7, 300}) {
    const double f = std::ldexp(1, k);
    const auto unit = make_surface(teardrop_spec(1));
    const auto other = make_surface(teardrop_spec(f));
    for (int i = 0; i < 200; ++i) {
      const Ray ray = rays.next();
      const Answer a = unit->all(ray, {});
      const Answer b = other->all({f * ray.o, f * ray.d}, {});
      ASSERT_EQ(a.hits.size(), b.hits.size());
      for (std::size_t j = 0; j < a.hits.size(); ++j) {
        ASSERT_EQ(a.hits[j].l.decimal, b.hits[j].l.decimal);
        ASSERT_EQ(a.hits[j].multiplicity, b.hits[j].multiplicity);
        ASSERT_EQ(f * a.hits[j].point, b.hits[j].point);
        ASSERT_EQ(a.hits[j].normal, b.hits[j].normal);
        ASSERT_EQ(a.hits[j].cosine, b.hits[j].cosine);
      }
    }
  }
}

TEST(Truth, ShiftedAndReversedRaysGiveTheSameHits) {
  ShortRays rays(5);
  const auto surface = make_surface(teardrop_spec(1));
  for (int i = 0; i < 500; ++i) {
    const Ray ray = rays.next();
    const Answer ahead = surface->all(ray, {});
    // 16 steps back and 16 steps ahead of the body are exact in these short numbers.
    const Answer back = surface->all({ray.o - 16.0 * ray.d, ray.d}, {});
    const Answer reverse = surface->all({ray.o + 16.0 * ray.d, -ray.d}, {});
    ASSERT_EQ(back.hits.size(), reverse.hits.size());
    ASSERT_GE(back.hits.size(), ahead.hits.size());
    const std::size_t n = back.hits.size();
    const std::size_t skipped = n - ahead.hits.size();
    for (std::size_t j = 0; j < n; ++j) {
      ASSERT_EQ(back.hits[j].multiplicity, reverse.hits[n - 1 - j].multiplicity);
      ASSERT_EQ(back.hits[j].point, reverse.hits[n - 1 - j].point);
      ASSERT_EQ(back.hits[j].normal, reverse.hits[n - 1 - j].normal);
      ASSERT_NEAR(back.hits[j].l.head + reverse.hits[n - 1 - j].l.head, 32, 1e-14);
      if (j >= skipped) {
        ASSERT_EQ(back.hits[j].point, ahead.hits[j - skipped].point);
      }
    }
  }
}

TEST(Truth, TeardropIsTheBezierRevolutionOfItsPoints) {
  ShortRays rays(6);
  for (const double s : {1.0, 0.5, 3.0}) {
    const auto drop = make_surface(teardrop_spec(s));
    const auto bezier = make_surface(profile_spec({{0, 0}, {2 * s, 0}, {3 * s, 2 * s}, {0, 6 * s}}));
    for (int i = 0; i < 200; ++i) {
      const Ray ray = rays.next();
      const Answer a = drop->all(ray, {});
      const Answer b = bezier->all(ray, {});
      ASSERT_EQ(a.hits.size(), b.hits.size());
      for (std::size_t j = 0; j < a.hits.size(); ++j) {
        ASSERT_EQ(a.hits[j].l.decimal, b.hits[j].l.decimal);
        ASSERT_EQ(a.hits[j].normal, b.hits[j].normal);
        ASSERT_EQ(a.hits[j].params, b.hits[j].params);
      }
    }
  }
}

TEST(TruthRoots, MultiplicitiesEndsAndZeroAreExact) {
  // x^2 (x - 1)^3 (x + 2)
  const std::vector<double> c{0, 0, -2, 5, -3, -1, 1};
  const auto all = truth::real_roots(c, std::nullopt);
  ASSERT_EQ(all.roots.size(), 3U);
  EXPECT_EQ(all.roots[0].x.decimal, "-2");
  EXPECT_EQ(all.roots[1].x.decimal, "0");
  EXPECT_EQ(all.roots[1].multiplicity, 2U);
  EXPECT_EQ(all.roots[2].x.decimal, "1");
  EXPECT_EQ(all.roots[2].multiplicity, 3U);
  EXPECT_EQ(truth::real_roots(c, std::pair{0.0, 1.0}).roots.size(), 2U);
  EXPECT_EQ(truth::real_roots(c, std::pair{1.0, 1.0}).roots.size(), 1U);
  EXPECT_EQ(truth::real_roots(c, std::pair{0x1p-1074, 0x1.fffffffffffffp-1}).roots.size(), 0U);
}

TEST(TruthRoots, IntervalEndsBetweenNeighbouringDoublesSelectTheRoot) {
  // sqrt(2) lies between two doubles; a closed interval of either one does not hold it.
  const std::vector<double> c{-2, 0, 1};
  const double below = 0x1.6a09e667f3bccp+0;
  const double above = 0x1.6a09e667f3bcdp+0;
  EXPECT_EQ(truth::real_roots(c, std::pair{below, above}).roots.size(), 1U);
  EXPECT_EQ(truth::real_roots(c, std::pair{below, below}).roots.size(), 0U);
  EXPECT_EQ(truth::real_roots(c, std::pair{above, 2.0}).roots.size(), 0U);
  // A rational root at an end that is no binary fraction of its cell: 3 x - 0.75.
  EXPECT_EQ(truth::real_roots(std::vector<double>{-0.75, 3}, std::pair{0.25, 1.0}).roots.size(), 1U);
}

TEST(TruthRoots, DegenerateInputIsAnswered) {
  EXPECT_EQ(truth::real_roots({}, std::nullopt).status, Status::coincident);
  EXPECT_EQ(truth::real_roots(std::vector<double>{0, 0}, std::nullopt).status, Status::coincident);
  EXPECT_TRUE(truth::real_roots(std::vector<double>{3, 0, 0}, std::nullopt).roots.empty());
  EXPECT_EQ(truth::real_roots(std::vector<double>{1, std::nan("")}, std::nullopt).status, Status::invalid);
  EXPECT_EQ(truth::real_roots(std::vector<double>{1, 1}, std::pair{1.0, 0.0}).status, Status::invalid);
}

TEST(TruthRoots, ExtremeCoefficientsHaveTheirRoots) {
  const auto tiny = truth::real_roots(std::vector<double>{-0x1p-1000, 0x1p1000}, std::nullopt);
  ASSERT_EQ(tiny.roots.size(), 1U);
  EXPECT_EQ(tiny.roots[0].x.head, 0);
  EXPECT_EQ(tiny.roots[0].x.decimal.substr(0, 6), "8.7098");
  const auto apart = truth::real_roots(std::vector<double>{1, -0x1p1000, 1}, std::nullopt);
  ASSERT_EQ(apart.roots.size(), 2U);
  EXPECT_EQ(apart.roots[0].x.head, 0x1p-1000);
  EXPECT_EQ(apart.roots[0].x.tail, 0);
  EXPECT_EQ(apart.roots[1].x.head, 0x1p1000);
  EXPECT_EQ(apart.roots[1].x.tail, -0x1p-1000);
}

TEST(TruthRoots, MignotteNeighboursArePartedAndWilkinsonCounted) {
  std::vector<double> mignotte(31, 0);
  mignotte[30] = 1;
  mignotte[2] = -2e6;
  mignotte[1] = 4e3;
  mignotte[0] = -2;
  const auto close = truth::real_roots(mignotte, std::nullopt);
  ASSERT_EQ(close.roots.size(), 4U);
  EXPECT_EQ(close.roots[1].x.head, close.roots[2].x.head);
  EXPECT_LT(truth::real_roots(mignotte, std::nullopt, {80}).roots[1].x.decimal,
            truth::real_roots(mignotte, std::nullopt, {80}).roots[2].x.decimal);
  // (x - 1) ... (x - 14) has coefficients below 2^53 and so exactly the roots 1 ... 14.
  std::vector<double> wilkinson{1};
  for (int k = 1; k <= 14; ++k) {
    wilkinson.insert(wilkinson.begin(), 0);
    for (std::size_t i = 0; i + 1 < wilkinson.size(); ++i) wilkinson[i] -= k * wilkinson[i + 1];
  }
  const auto whole = truth::real_roots(wilkinson, std::nullopt);
  ASSERT_EQ(whole.roots.size(), 14U);
  for (std::size_t i = 0; i < 14; ++i) EXPECT_EQ(whole.roots[i].x.decimal, std::to_string(i + 1));
}

TEST(TruthRoots, DegreeOneHundredIsCounted) {
  std::vector<double> c(101, 0);
  c[100] = 1;
  c[0] = -0x1p100;
  const auto answer = truth::real_roots(c, std::nullopt);
  ASSERT_EQ(answer.roots.size(), 2U);
  EXPECT_EQ(answer.roots[0].x.decimal, "-2");
  EXPECT_EQ(answer.roots[1].x.decimal, "2");
}

}  // namespace
}  // namespace graze
