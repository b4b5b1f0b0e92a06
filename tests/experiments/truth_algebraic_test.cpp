// Certified truth of sphere, ellipsoid, quadric, torus and implicit_polynomial: answers worked out by hand,
// and properties that hold exactly.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <graze/experiments/truth.hpp>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "questions.hpp"

namespace graze {
namespace {

using truth::Answer;
using truth::Hit;
using truth::make_surface;
using List = std::vector<double>;
using test::ask;
using test::expect_hits;
using test::spec_of;
using test::Table;
using Values = std::map<std::string, ParameterValue>;

SurfaceSpec sphere(double radius, const List& center = {0, 0, 0}) {
  return spec_of("sphere", {{"center", center}, {"radius", radius}});
}
SurfaceSpec torus(double major, double minor) { return spec_of("torus", {{"R", major}, {"r", minor}}); }
SurfaceSpec quadric(const Values& values) { return spec_of("quadric", values); }
SurfaceSpec implicit(const Table& terms) { return spec_of("implicit_polynomial", {{"terms", terms}}); }
/// x^2 + z^2 = y^2.
SurfaceSpec cone() { return quadric({{"A", 1.0}, {"E", -1.0}, {"H", 1.0}}); }

void expect_near(Vec3 a, Vec3 b) { test::expect_near(a, b, 0x1p-52); }

/// The same numbers digit for digit; normals and cosines to the last place, since both are rounded.
void expect_same(const Answer& a, const Answer& b) {
  ASSERT_EQ(a.status, b.status);
  ASSERT_EQ(a.hits.size(), b.hits.size());
  for (std::size_t i = 0; i < a.hits.size(); ++i) {
    const Hit& p = a.hits[i];
    const Hit& q = b.hits[i];
    ASSERT_EQ(p.l.decimal, q.l.decimal);
    ASSERT_EQ(p.l.lo, q.l.lo);
    ASSERT_EQ(p.l.hi, q.l.hi);
    ASSERT_EQ(p.l.head, q.l.head);
    ASSERT_EQ(p.l.tail, q.l.tail);
    ASSERT_EQ(p.multiplicity, q.multiplicity);
    expect_near(p.normal, q.normal);
    ASSERT_DOUBLE_EQ(p.cosine, q.cosine);
    ASSERT_DOUBLE_EQ(p.point.x, q.point.x);
    ASSERT_DOUBLE_EQ(p.point.y, q.point.y);
    ASSERT_DOUBLE_EQ(p.point.z, q.point.z);
  }
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  double u() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector(double size) { return {size * u(), size * u(), size * u()}; }
  /// A multiple of 1/8 in [-3, 3].
  double eighth() { return static_cast<double>(random_() % 49) / 8 - 3; }
  Ray towards_origin(double from, double spread) {
    const Vec3 o = vector(from);
    return {o, vector(spread) - o};
  }

 private:
  std::mt19937_64 random_;
};

const double kPi = std::acos(-1.0);

TEST(TruthAlgebraic, TorusInItsPlaneIsPassedFourTimes) {
  const Answer answer = ask(torus(1, 0.25), {{-3, 0, 0}, {1, 0, 0}});
  expect_hits(answer, {{"1.75"}, {"2.25"}, {"3.75"}, {"4.25"}});
  EXPECT_EQ(answer.hits[0].normal, (Vec3{-1, 0, 0}));
  EXPECT_EQ(answer.hits[1].normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(answer.hits[0].params, (std::array<double, 2>{kPi, 0}));
  EXPECT_EQ(answer.hits[1].params, (std::array<double, 2>{kPi, kPi}));
  EXPECT_EQ(answer.hits[2].params, (std::array<double, 2>{0, kPi}));
  EXPECT_EQ(answer.hits[3].params, (std::array<double, 2>{0, 0}));
  EXPECT_EQ(answer.hits[3].point, (Vec3{1.25, 0, 0}));
  EXPECT_EQ(answer.hits[3].cosine, 1);
}

TEST(TruthAlgebraic, TorusIsTouchedAlongItsTopCircleAndAtItsInnerEquator) {
  const Answer top = ask(torus(1, 0.25), {{-3, 0.25, 0}, {1, 0, 0}});
  expect_hits(top, {{"2", 2}, {"4", 2}});
  EXPECT_EQ(top.hits[0].cosine, 0);
  EXPECT_EQ(top.hits[0].normal, (Vec3{0, 1, 0}));
  EXPECT_EQ(top.hits[1].params, (std::array<double, 2>{0, kPi / 2}));
  const Answer inner = ask(torus(1, 0.25), {{-3, 0, 0.75}, {1, 0, 0}});
  expect_hits(inner, {{"2"}, {"3", 2}, {"4"}});
  EXPECT_EQ(inner.hits[1].normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(inner.hits[1].params, (std::array<double, 2>{kPi / 2, kPi}));
}

TEST(TruthAlgebraic, HornAndSpindleTorusMeetTheirAxisInSingularPoints) {
  const Answer horn = ask(torus(1, 1), {{-3, 0, 0}, {1, 0, 0}});
  expect_hits(horn, {{"1"}, {"3", 2}, {"5"}});
  EXPECT_EQ(horn.hits[1].normal, (Vec3{-1, 0, 0}));
  EXPECT_EQ(horn.hits[1].cosine, 1);
  // y^2 = 3 twice.
  const Answer spindle = ask(torus(1, 2), {{0, -5, 0}, {0, 1, 0}});
  ASSERT_EQ(spindle.hits.size(), 2U);
  for (const Hit& hit : spindle.hits) {
    EXPECT_EQ(hit.multiplicity, 2U);
    EXPECT_EQ(hit.normal, (Vec3{0, -1, 0}));
    EXPECT_EQ(hit.cosine, 1);
    EXPECT_EQ(hit.params[0], 0);
    EXPECT_EQ(std::fabs(hit.point.y), std::sqrt(3.0));
  }
  EXPECT_EQ(spindle.hits[0].l.decimal, "3.267949192431122706472553658494127633057");
  // Outer sheet at 3, inner sheet (hypot(x, z) + R = r) at 1.
  expect_hits(ask(torus(1, 2), {{-5, 0, 0}, {1, 0, 0}}), {{"2"}, {"4"}, {"6"}, {"8"}});
}

TEST(TruthAlgebraic, SphereIsTouchedByATangentAndMissedOneUlpOutside) {
  const Answer answer = ask(sphere(1), {{1, -5, 0}, {0, 1, 0}});
  expect_hits(answer, {{"5", 2}});
  EXPECT_EQ(answer.hits[0].normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(answer.hits[0].cosine, 0);
  expect_hits(ask(sphere(1), {{1 + 0x1p-52, -5, 0}, {0, 1, 0}}), {});
  const Answer inside = ask(sphere(1), {{1 - 0x1p-53, -5, 0}, {0, 1, 0}});
  ASSERT_EQ(inside.hits.size(), 2U);
  // n . d = -+ sqrt(1 - (1 - 2^-53)^2) = -+ sqrt(2^-52 - 2^-106).
  EXPECT_DOUBLE_EQ(inside.hits[0].cosine, 0x1p-26 * std::sqrt(1 - 0x1p-54));
}

TEST(TruthAlgebraic, SphereHasItsAngles) {
  const Answer poles = ask(sphere(2, {1, 2, 3}), {{1, -8, 3}, {0, 2, 0}});
  expect_hits(poles, {{"4"}, {"6"}});
  EXPECT_EQ(poles.hits[0].params, (std::array<double, 2>{0, -kPi / 2}));
  EXPECT_EQ(poles.hits[1].params, (std::array<double, 2>{0, kPi / 2}));
  const Answer back = ask(sphere(2, {1, 2, 3}), {{-5, 2, 3}, {1, 0, 0}});
  EXPECT_EQ(back.hits[0].params, (std::array<double, 2>{kPi, 0}));
  const Answer slanted = ask(sphere(5), {{3, 0, -4}, {0, 0, 1}});
  expect_hits(slanted, {{"8"}});
  EXPECT_DOUBLE_EQ(slanted.hits[0].params[0], std::atan2(4.0, 3.0));
  const Answer above = ask(sphere(5), {{3, 10, 0}, {0, -1, 0}});
  EXPECT_DOUBLE_EQ(above.hits[0].params[1], std::atan2(4.0, 3.0));
}

TEST(TruthAlgebraic, RayThatStartsOnTheSurfaceDoesNotHitItsOrigin) {
  expect_hits(ask(sphere(1), {{1, 0, 0}, {0, 1, 0}}), {});
  expect_hits(ask(sphere(1), {{1, 0, 0}, {1, 0, 0}}), {});
  expect_hits(ask(sphere(1), {{1, 0, 0}, {-1, 0, 0}}), {{"2"}});
  expect_hits(ask(torus(1, 0.25), {{0.75, 0, 0}, {1, 0, 0}}), {{"0.5"}});
  expect_hits(ask(cone(), {{0, 0, 0}, {1, 0, 0}}), {});
}

TEST(TruthAlgebraic, ConeApexIsSingularAndFacesTheRay) {
  const Answer answer = ask(cone(), {{-3, -1, 0}, {3, 1, 0}});
  expect_hits(answer, {{"1", 2}});
  expect_near(answer.hits[0].normal, (-1 / std::sqrt(10.0)) * Vec3{3, 1, 0});
  EXPECT_EQ(answer.hits[0].cosine, 1);
  EXPECT_EQ(answer.hits[0].point, Vec3{});
  // Beside the apex the cone is regular; its gradient is (x, -y, z).
  const Answer beside = ask(cone(), {{-3, 1, 0}, {1, 0, 0}});
  expect_hits(beside, {{"2"}, {"4"}});
  expect_near(beside.hits[0].normal, std::sqrt(0.5) * Vec3{-1, -1, 0});
}

TEST(TruthAlgebraic, GeneratorsAreCoincident) {
  const SurfaceSpec hyperboloid = quadric({{"A", 1.0}, {"E", -1.0}, {"H", 1.0}, {"J", -1.0}});
  const SurfaceSpec paraboloid = quadric({{"A", 1.0}, {"H", -1.0}, {"G", -0.5}});  // y = x^2 - z^2
  const SurfaceSpec cylinder = quadric({{"A", 1.0}, {"H", 1.0}, {"J", -25.0}});
  const std::vector<std::pair<SurfaceSpec, Ray>> cases{{cone(), {{3, 5, 4}, {3, 5, 4}}},
                                                       {cone(), {{0, 0, 0}, {-3, 5, 4}}},
                                                       {hyperboloid, {{1, 0, 0}, {0, 2, 2}}},
                                                       {hyperboloid, {{1, -2, -2}, {0, 1, 1}}},
                                                       {paraboloid, {{2, 4, 0}, {1, 4, -1}}},
                                                       {paraboloid, {{0, 0, 0}, {1, 0, 1}}},
                                                       {cylinder, {{3, -7, 4}, {0, -1, 0}}},
                                                       {implicit({{1, 1, 1, 1}}), {{2, 3, 0}, {1, 0, 0}}},
                                                       {quadric({{"D", 1.0}}), {{0, 1, 2}, {0, 1, 1}}}};
  for (const auto& [spec, ray] : cases) {
    const Answer answer = ask(spec, ray);
    EXPECT_EQ(answer.status, Status::coincident);
    EXPECT_TRUE(answer.hits.empty());
    Ray shifted = ray;
    shifted.o.x += 0x1p-40;
    shifted.d.x += 0x1p-45;
    shifted.d.z += 0x1p-46;
    EXPECT_EQ(ask(spec, shifted).status, Status::ok);
  }
}

TEST(TruthAlgebraic, RayParallelToAnAxisOfAQuadricHasItsOneRoot) {
  // y = x^2 + z^2 from below, the hyperbolic paraboloid, an asymptotic direction of the cone and a plane.
  expect_hits(ask(quadric({{"A", 1.0}, {"H", 1.0}, {"G", -0.5}}), {{1, -3, 2}, {0, 1, 0}}), {{"8"}});
  expect_hits(ask(quadric({{"A", 1.0}, {"H", -1.0}, {"G", -0.5}}), {{1, -3, 2}, {0, 1, 0}}), {});
  expect_hits(ask(quadric({{"A", 1.0}, {"H", -1.0}, {"G", -0.5}}), {{2, -3, 1}, {0, 1, 0}}), {{"6"}});
  expect_hits(ask(cone(), {{-4, 0, 0}, {1, 1, 0}}), {{"2"}});
  expect_hits(ask(quadric({{"D", 1.0}, {"J", -4.0}}), {{0, 1, 2}, {1, 0, 0}}), {{"2"}});
  expect_hits(ask(quadric({{"A", 1.0}, {"H", 1.0}, {"J", -1.0}}), {{2, 0, 0}, {0, 1, 0}}), {});
}

TEST(TruthAlgebraic, EmptyAndImaginaryQuadricsAreNotHit) {
  const Ray ray{{-3, 0.5, 0.25}, {1, 0, 0}};
  expect_hits(ask(quadric({{"J", 1.0}}), ray), {});
  expect_hits(ask(quadric({{"A", 1.0}, {"E", 1.0}, {"H", 1.0}, {"J", 1.0}}), ray), {});
  expect_hits(ask(quadric({{"A", 1.0}, {"J", 1.0}}), ray), {});
  expect_hits(ask(quadric({{"A", 1.0}, {"E", 1.0}, {"H", 1.0}}), ray), {});
  expect_hits(ask(quadric({{"A", 1.0}, {"E", 1.0}, {"H", 1.0}}), {{-3, -3, 0}, {1, 1, 0}}), {{"3", 2}});
}

TEST(TruthAlgebraic, DoublePlaneIsSingularEverywhereAndCrossedPlanesInTheirLine) {
  const Answer answer = ask(quadric({{"A", 1.0}}), {{-3, 1, 0}, {1, 1, 0}});
  expect_hits(answer, {{"3", 2}});
  EXPECT_EQ(answer.hits[0].cosine, 1);
  expect_near(answer.hits[0].normal, -std::sqrt(0.5) * Vec3{1, 1, 0});
  const SurfaceSpec crossed = quadric({{"B", 0.5}});  // x y = 0
  expect_hits(ask(crossed, {{-1, -2, 0}, {1, 1, 0}}), {{"1"}, {"2"}});
  expect_hits(ask(crossed, {{-2, -2, 0}, {1, 1, 0}}), {{"2", 2}});
}

TEST(TruthAlgebraic, NormalOfAQuadricPointsAwayFromItsBodyWhateverTheSignOfItsCoefficients) {
  const Ray ray{{-3, 0, 0}, {1, 0, 0}};
  for (const double side : {1.0, -1.0}) {
    const Answer ellipsoid = ask(quadric({{"A", side}, {"E", side}, {"H", side}, {"J", -side}}), ray);
    expect_hits(ellipsoid, {{"2"}, {"4"}});
    EXPECT_EQ(ellipsoid.hits[0].normal, (Vec3{-1, 0, 0}));
    const Answer cylinder = ask(quadric({{"A", side}, {"H", side}, {"J", -side}}), ray);
    EXPECT_EQ(cylinder.hits[1].normal, (Vec3{1, 0, 0}));
  }
  // One negative and one positive eigenvalue: the gradient as it is, in both cases.
  EXPECT_EQ(ask(quadric({{"A", 1.0}, {"E", -1.0}, {"J", -1.0}}), ray).hits[0].normal, (Vec3{-1, 0, 0}));
  EXPECT_EQ(ask(quadric({{"A", -1.0}, {"E", 1.0}, {"J", 1.0}}), ray).hits[0].normal, (Vec3{1, 0, 0}));
}

TEST(TruthAlgebraic, ImplicitPolynomialCountsItsRootsWithMultiplicity) {
  // y = x^3 and its inflection tangent.
  const SurfaceSpec cubic = implicit({{1, 3, 0, 0}, {-1, 0, 1, 0}});
  const Answer inflection = ask(cubic, {{-2, 0, 0}, {1, 0, 0}});
  expect_hits(inflection, {{"2", 3}});
  EXPECT_EQ(inflection.hits[0].normal, (Vec3{0, -1, 0}));
  EXPECT_EQ(inflection.hits[0].cosine, 0);
  // (x - 1)^5 (x - 2) z^2, expanded, with equal terms given twice.
  const SurfaceSpec high = implicit({{1, 6, 0, 2},
                                     {-7, 5, 0, 2},
                                     {10, 4, 0, 2},
                                     {10, 4, 0, 2},
                                     {-30, 3, 0, 2},
                                     {25, 2, 0, 2},
                                     {-11, 1, 0, 2},
                                     {2, 0, 0, 2}});
  const Answer powers = ask(high, {{0, 0, 1}, {1, 0, 0}});
  expect_hits(powers, {{"1", 5}, {"2"}});
  EXPECT_EQ(powers.hits[0].cosine, 1);
  EXPECT_EQ(powers.hits[1].normal, (Vec3{1, 0, 0}));
  EXPECT_EQ(ask(high, {{0, 0, 0}, {1, 0, 0}}).status, Status::coincident);
  // Degree 32: x^32 = 2^32 y^0.
  expect_hits(ask(implicit({{1, 32, 0, 0}, {-0x1p32, 0, 0, 0}}), {{-3, 1, 1}, {1, 0, 0}}), {{"1"}, {"5"}});
}

TEST(TruthAlgebraic, SphereIsQuadricIsEllipsoidIsImplicitPolynomial) {
  Random random(1);
  std::size_t hits = 0;
  for (int i = 0; i < 300; ++i) {
    const List c{random.eighth(), random.eighth(), random.eighth()};
    const double r = 0.125 + std::fabs(random.eighth());
    const double j = c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - r * r;
    const double k = 0.5;  // of the quadric's coefficients: any factor states the same surface
    const SurfaceSpec q = quadric(
        {{"A", k}, {"E", k}, {"H", k}, {"D", -k * c[0]}, {"G", -k * c[1]}, {"I", -k * c[2]}, {"J", k * j}});
    const SurfaceSpec e = spec_of("ellipsoid", {{"center", c}, {"semi_axes", List{r, r, r}}});
    const SurfaceSpec p =
        spec_of("ellipsoid", {{"center", c}, {"P", Table{{r * r, 0, 0}, {0, r * r, 0}, {0, 0, r * r}}}});
    const SurfaceSpec f = implicit({{1, 2, 0, 0},
                                    {1, 0, 2, 0},
                                    {1, 0, 0, 2},
                                    {-2 * c[0], 1, 0, 0},
                                    {-2 * c[1], 0, 1, 0},
                                    {-2 * c[2], 0, 0, 1},
                                    {j, 0, 0, 0}});
    // Every third ray is short, so that tangents and starts on the surface are among them.
    Ray ray = random.towards_origin(8, 4);
    if (i % 3 == 0) ray = {{random.eighth(), random.eighth(), random.eighth()}, {1, 0, 0}};
    if (i % 9 == 0) ray.o = {c[0] - 4, c[1] + r, c[2]};
    const Answer wanted = ask(sphere(r, c), ray);
    hits += wanted.hits.size();
    for (const SurfaceSpec& other : {q, e, p, f}) expect_same(wanted, ask(other, ray));
    const Answer angles = ask(e, ray);
    for (std::size_t h = 0; h < wanted.hits.size(); ++h)
      EXPECT_EQ(angles.hits[h].params, wanted.hits[h].params);
  }
  EXPECT_GT(hits, 100U);
}

TEST(TruthAlgebraic, TorusIsItsImplicitPolynomial) {
  Random random(2);
  // (q + 15/16)^2 - 4 (x^2 + z^2), q = x^2 + y^2 + z^2, for R = 1, r = 1/4.
  const double k = 15.0 / 16;
  const SurfaceSpec f = implicit({{1, 4, 0, 0},
                                  {1, 0, 4, 0},
                                  {1, 0, 0, 4},
                                  {2, 2, 2, 0},
                                  {2, 2, 0, 2},
                                  {2, 0, 2, 2},
                                  {2 * k - 4, 2, 0, 0},
                                  {2 * k, 0, 2, 0},
                                  {2 * k - 4, 0, 0, 2},
                                  {k * k, 0, 0, 0}});
  for (int i = 0; i < 200; ++i) {
    const Ray ray = random.towards_origin(4, 1);
    expect_same(ask(torus(1, 0.25), ray), ask(f, ray));
  }
}

TEST(TruthAlgebraic, EllipsoidIsAStretchedSphere) {
  Random random(3);
  SurfaceSpec stretched = sphere(1);
  stretched.placement.matrix = {Vec3{2, 0, 0}, Vec3{0, 0.5, 0}, Vec3{0, 0, 3}};
  stretched.placement.translate = {1, -2, 0.25};
  const SurfaceSpec ellipsoid =
      spec_of("ellipsoid", {{"center", List{1, -2, 0.25}}, {"semi_axes", List{2, 0.5, 3}}});
  // M = [[1,1,0],[0,1,0],[0,0,1]]: P = M M^T.
  SurfaceSpec sheared = sphere(1);
  sheared.placement.matrix = {Vec3{1, 1, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const SurfaceSpec slanted = spec_of("ellipsoid", {{"P", Table{{2, 1, 0}, {1, 1, 0}, {0, 0, 1}}}});
  for (int i = 0; i < 100; ++i) {
    const Ray ray = random.towards_origin(9, 3);
    expect_same(ask(stretched, ray), ask(ellipsoid, ray));
    expect_same(ask(sheared, ray), ask(slanted, ray));
  }
}

TEST(TruthAlgebraic, PlacedTorusIsHitWhereTheRayInItsOwnSpaceHits) {
  // A quarter turn about z, twice the size, moved: the axis is then -x.
  SurfaceSpec placed = torus(1, 0.25);
  placed.placement.matrix = {Vec3{0, -2, 0}, Vec3{2, 0, 0}, Vec3{0, 0, 2}};
  placed.placement.translate = {10, 20, 30};
  const Answer answer = ask(placed, {{10, 14, 30}, {0, 2, 0}});
  expect_hits(answer, {{"1.75"}, {"2.25"}, {"3.75"}, {"4.25"}});
  EXPECT_EQ(answer.hits[0].normal, (Vec3{0, -1, 0}));
  EXPECT_EQ(answer.hits[0].params, (std::array<double, 2>{kPi, 0}));
  EXPECT_EQ(answer.hits[3].point, (Vec3{10, 22.5, 30}));
  const Answer touched = ask(placed, {{9.5, 14, 30}, {0, 2, 0}});
  expect_hits(touched, {{"2", 2}, {"4", 2}});
  EXPECT_EQ(touched.hits[0].normal, (Vec3{-1, 0, 0}));
  // Mirrored: normals stay outward.
  SurfaceSpec mirrored = sphere(1, {2, 0, 0});
  mirrored.placement.matrix = {Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  const Answer image = ask(mirrored, {{-5, 0, 0}, {1, 0, 0}});
  expect_hits(image, {{"2"}, {"4"}});
  EXPECT_EQ(image.hits[0].normal, (Vec3{-1, 0, 0}));
}

TEST(TruthAlgebraic, ScalingByAPowerOfTwoChangesNothing) {
  Random random(4);
  for (const int k : {-900, -40, 3, 200, 900}) {
    const double s = std::ldexp(1.0, k);
    const SurfaceSpec ellipsoid = spec_of("ellipsoid", {{"semi_axes", List{1, 0.5, 2}}});
    const SurfaceSpec large = spec_of("ellipsoid", {{"semi_axes", List{s, 0.5 * s, 2 * s}}});
    for (int i = 0; i < 30; ++i) {
      const Ray ray = random.towards_origin(4, 1);
      const Ray big{s * ray.o, s * ray.d};
      const auto scaled_back = [&](Answer answer) {
        for (Hit& hit : answer.hits) hit.point = (1 / s) * hit.point;
        return answer;
      };
      expect_same(ask(torus(1, 0.25), ray), scaled_back(ask(torus(s, 0.25 * s), big)));
      expect_same(ask(ellipsoid, ray), scaled_back(ask(large, big)));
    }
  }
}

TEST(TruthAlgebraic, ExtremeMagnitudesAreNoSpecialCase) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  expect_hits(ask(sphere(tiny), {{-4 * tiny, 0, 0}, {tiny, 0, 0}}), {{"3"}, {"5"}});
  expect_hits(ask(sphere(0x1p1000), {{0, 0, 0}, {0x1p1000, 0, 0}}), {{"1"}});
  const Answer far = ask(sphere(1), {{-0x1p1023, 0, 0}, {0x1p1023, 0, 0}});
  ASSERT_EQ(far.hits.size(), 2U);
  EXPECT_EQ(far.hits[0].point, (Vec3{-1, 0, 0}));
  EXPECT_EQ(far.hits[1].point, (Vec3{1, 0, 0}));
  EXPECT_EQ(far.hits[0].l.head, 1);
  EXPECT_EQ(far.hits[0].l.tail, -0x1p-1023);
  const Answer mixed = ask(torus(1, 1e-300), {{-3, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(mixed.hits.size(), 4U);
  const Answer high = ask(implicit({{1e300, 32, 0, 0}, {-1e-300, 0, 0, 0}}), {{1e300, 1, 1}, {-1, 0, 0}});
  EXPECT_EQ(high.hits.size(), 2U);
}

TEST(TruthAlgebraic, ShiftedAndReversedRaysGiveTheSameHits) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Ray ray{{random.eighth(), random.eighth(), random.eighth() - 8},
                  {random.eighth() / 16, random.eighth() / 16, 1}};
    const Ray reversed{ray.o + 32.0 * ray.d, -ray.d};
    for (const SurfaceSpec& spec : {torus(2, 0.75), sphere(2, {0.5, 0, 0.25})}) {
      const Answer forth = ask(spec, ray);
      const Answer back = ask(spec, reversed);
      ASSERT_EQ(forth.hits.size(), back.hits.size());
      for (std::size_t h = 0; h < forth.hits.size(); ++h) {
        const Hit& a = forth.hits[h];
        const Hit& b = back.hits[back.hits.size() - 1 - h];
        EXPECT_EQ(a.multiplicity, b.multiplicity);
        EXPECT_DOUBLE_EQ(a.l.head, 32 - b.l.head);
        expect_near(a.normal, b.normal);
      }
    }
  }
}

TEST(TruthAlgebraic, InvalidRaysAreAnswers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const SurfaceSpec& spec : {sphere(1), torus(1, 0.25), cone()}) {
    EXPECT_EQ(ask(spec, {{nan, 0, 0}, {1, 0, 0}}).status, Status::invalid);
    EXPECT_EQ(ask(spec, {{0, 0, 0}, {0, 0, 0}}).status, Status::invalid);
  }
}

void expect_refused(const SurfaceSpec& spec, const std::string& part) {
  try {
    make_surface(spec);
    ADD_FAILURE() << spec.type << " was not refused: " << part;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(TruthAlgebraic, WhatIsNoSurfaceIsRefusedByName) {
  expect_refused(sphere(0), "radius");
  expect_refused(sphere(-1), "radius");
  expect_refused(spec_of("sphere", {}), "radius");
  expect_refused(spec_of("sphere", {{"radius", 1.0}, {"centre", List{0, 0, 0}}}), "center");
  expect_refused(torus(0, 1), "R");
  expect_refused(torus(1, 0), "r");
  expect_refused(spec_of("ellipsoid", {}), "P or semi_axes");
  const Table unit{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  expect_refused(spec_of("ellipsoid", {{"semi_axes", List{1, 1, 1}}, {"P", unit}}), "P or semi_axes");
  expect_refused(spec_of("ellipsoid", {{"semi_axes", List{1, 0, 1}}}), "semi_axes");
  expect_refused(spec_of("ellipsoid", {{"P", Table{{1, 0, 0}, {0, 1, 0}}}}), "P");
  expect_refused(spec_of("ellipsoid", {{"P", Table{{1, 0x1p-60, 0}, {0, 1, 0}, {0, 0, 1}}}}), "symmetric");
  // Singular by an exact cancellation, and regular by the last bit.
  expect_refused(spec_of("ellipsoid", {{"P", Table{{1, 1, 0}, {1, 1, 0}, {0, 0, 1}}}}), "positive definite");
  expect_refused(spec_of("ellipsoid", {{"P", Table{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}}),
                 "positive definite");
  EXPECT_NO_THROW(
      make_surface(spec_of("ellipsoid", {{"P", Table{{1, 1, 0}, {1, 1 + 0x1p-52, 0}, {0, 0, 1}}}})));
  expect_refused(quadric({}), "zero");
  expect_refused(quadric({{"K", 1.0}}), "K");
  expect_refused(implicit({{1, 0, 0, 0}}), "constant");
  expect_refused(implicit({{1, 1, 0, 0}, {-1, 1, 0, 0}, {3, 0, 0, 0}}), "constant");
  expect_refused(implicit({{1, 0.5, 0, 0}}), "exponent");
  expect_refused(implicit({{1, -1, 0, 0}}), "exponent");
  expect_refused(implicit({{1, 33, 0, 0}}), "degree 33");
  expect_refused(implicit({{1, 11, 11, 11}}), "degree 33");
  expect_refused(implicit({{1, 1, 0}}), "terms");
  EXPECT_NO_THROW(make_surface(implicit({{1, 40, 0, 0}, {-1, 40, 0, 0}, {1, 0, 1, 0}})));
  SurfaceSpec flat = sphere(1);
  flat.placement.matrix = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0}};
  expect_refused(flat, "singular");
}

double distance(const SurfaceSpec& spec, Vec3 p) { return make_surface(spec)->distance(p); }

TEST(TruthAlgebraic, DistanceFromASphereAndATorusIsThatOfTheFormula) {
  Random random(6);
  EXPECT_EQ(distance(sphere(1), {0, 0, 0}), 1);
  EXPECT_EQ(distance(sphere(1), {1, 0, 0}), 0);
  EXPECT_EQ(distance(sphere(1), {1 + 0x1p-52, 0, 0}), 0x1p-52);
  EXPECT_EQ(distance(sphere(1, {1e8, 0, 0}), {1e8 + 3, 4, 0}), 4);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 p = random.vector(i % 3 == 0 ? 10 : 1.5);
    const double size = norm(p);
    EXPECT_NEAR(distance(sphere(1), p), std::fabs(size - 1), 1e-15 * (1 + size));
    const double wanted = std::fabs(std::hypot(std::hypot(p.x, p.z) - 1, p.y) - 0.25);
    const double given = distance(torus(1, 0.25), p);
    EXPECT_NEAR(given, wanted, 1e-14 * (1 + size));
    worst = std::max(worst, std::fabs(given - wanted));
  }
  std::printf("torus distance: worst difference from the formula %.3g\n", worst);
}

TEST(TruthAlgebraic, DistanceFindsTheNearestPointAndNotJustAFootPoint) {
  // On the long axis inside the evolute the nearest points are beside: x = 4 p / 3, distance^2 = 11/12.
  const SurfaceSpec ellipsoid = spec_of("ellipsoid", {{"semi_axes", List{2, 1, 1}}});
  EXPECT_DOUBLE_EQ(distance(ellipsoid, {0.5, 0, 0}), std::sqrt(11.0 / 12));
  EXPECT_DOUBLE_EQ(distance(ellipsoid, {1.75, 0, 0}), 0.25);
  EXPECT_DOUBLE_EQ(distance(cone(), {0, 1, 0}), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(distance(cone(), {3, 0, 0}), 3 * std::sqrt(0.5));
  EXPECT_EQ(distance(cone(), {0, 0, 0}), 0);
  // Near the apex, and the placement's own lengths.
  EXPECT_DOUBLE_EQ(distance(cone(), {0x1p-60, 0, 0}), 0x1p-60 * std::sqrt(0.5));
  SurfaceSpec stretched = sphere(1);
  stretched.placement.matrix = {Vec3{2, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  EXPECT_DOUBLE_EQ(distance(stretched, {0.5, 0, 0}), std::sqrt(11.0 / 12));
}

TEST(TruthAlgebraic, DistanceIsFiniteWhereTheGradientVanishes) {
  EXPECT_DOUBLE_EQ(distance(quadric({{"A", 1.0}, {"E", 1.0}, {"H", 1.0}}), {3, 4, 12}), 13);
  EXPECT_DOUBLE_EQ(distance(quadric({{"A", 1.0}, {"H", 1.0}}), {3, 7, 4}), 5);
  EXPECT_DOUBLE_EQ(distance(quadric({{"A", 1.0}}), {0.25, 7, 4}), 0.25);
  EXPECT_DOUBLE_EQ(distance(torus(1, 1), {0, 0.5, 0}), std::hypot(1, 0.5) - 1);
  EXPECT_DOUBLE_EQ(distance(torus(1, 2), {0, 1.5, 0}), 2 - std::hypot(1, 1.5));
  // Nothing is as near as the empty set is far.
  EXPECT_TRUE(std::isinf(distance(quadric({{"A", 1.0}, {"J", 1.0}}), {1, 2, 3})));
}

}  // namespace
}  // namespace graze
