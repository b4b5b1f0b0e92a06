// Certified truth of flat figures and convex solids on answers worked out by hand, on exact laws, and on rays
// aimed at edges and vertices, where neighbours must neither both miss nor both be hit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <graze/experiments/truth.hpp>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "questions.hpp"

namespace graze {
namespace {

using test::ask;
using test::expect_hits;
using test::list;
using test::spec_of;
using test::Table;
using test::table;
using truth::Answer;
using truth::Hit;
using truth::make_surface;

SurfaceSpec plane(Vec3 a, double b, bool one_sided = false) {
  return spec_of("plane", {{"a", list(a)}, {"b", b}, {"one_sided", one_sided}});
}
SurfaceSpec triangle(const std::vector<Vec3>& v) { return spec_of("triangle", {{"vertices", table(v)}}); }
SurfaceSpec polygon(const std::vector<Vec3>& v) { return spec_of("polygon", {{"vertices", table(v)}}); }
SurfaceSpec disk(Vec3 center, Vec3 normal, double radius) {
  return spec_of("disk", {{"center", list(center)}, {"normal", list(normal)}, {"radius", radius}});
}
SurfaceSpec box(Vec3 min, Vec3 max) { return spec_of("box", {{"min", list(min)}, {"max", list(max)}}); }
SurfaceSpec tetrahedron(const std::vector<Vec3>& v) {
  return spec_of("tetrahedron", {{"vertices", table(v)}});
}
SurfaceSpec polyhedron(const Table& halfspaces) {
  return spec_of("convex_polyhedron", {{"halfspaces", halfspaces}});
}

void expect_coincident(const SurfaceSpec& spec, const Ray& ray) {
  const Answer answer = ask(spec, ray);
  EXPECT_EQ(answer.status, Status::coincident);
  EXPECT_TRUE(answer.hits.empty());
  EXPECT_FALSE(answer.why.empty());
}

void expect_refused(const SurfaceSpec& spec, const std::string& word) {
  try {
    static_cast<void>(make_surface(spec));
    ADD_FAILURE() << "accepted, but is " << word;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

void expect_near(Vec3 a, Vec3 b) { test::expect_near(a, b, 1e-15); }

std::size_t count(const truth::Surface& surface, const Ray& ray) {
  return surface.all(ray, {17}).hits.size();
}

const std::vector<Vec3> kSquare{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
const std::vector<Vec3> kCorner{{1, 0, 0}, {-1, 0, -1}, {-1, 0, 1}, {0, 1, 0}};

// ---- Plane ----

TEST(TruthPlane, IsHitFromBothSidesUnlessItIsOneSided) {
  const Answer answer = ask(plane({0, 2, 0}, 6), {{1, 5, 1}, {3, -4, 0}});
  expect_hits(answer, {{"0.5"}});
  EXPECT_EQ(answer.hits[0].normal, (Vec3{0, 1, 0}));
  EXPECT_EQ(answer.hits[0].point, (Vec3{2.5, 3, 1}));
  EXPECT_EQ(answer.hits[0].cosine, 0.8);
  expect_hits(ask(plane({0, 2, 0}, 6), {{1, 1, 1}, {3, 4, 0}}), {{"0.5"}});
  expect_hits(ask(plane({0, 2, 0}, 6), {{1, 1, 1}, {3, -4, 0}}), {});
  expect_hits(ask(plane({0, 2, 0}, 6, true), {{1, 5, 1}, {3, -4, 0}}), {{"0.5"}});
  expect_hits(ask(plane({0, 2, 0}, 6, true), {{1, 1, 1}, {3, 4, 0}}), {});
}

TEST(TruthPlane, RayThatStartsOnItOrRunsBesideItMisses) {
  expect_hits(ask(plane({1, 1, 1}, 3), {{1, 1, 1}, {1, 2, 3}}), {});
  expect_hits(ask(plane({1, 1, 1}, 3), {{1, 1, 0}, {1, -1, 0}}), {});
  expect_coincident(plane({1, 1, 1}, 3), {{1, 1, 1}, {1, -1, 0}});
  expect_hits(ask(plane({1, 1, 1}, 3, true), {{1, 1, 1}, {1, -1, 0}}), {});
  // One ulp from parallel it is met far away.
  expect_hits(ask(plane({0, 1, 0}, 0), {{0, 1, 0}, {1, -0x1p-1022, 0}}, 17), {{"4.4942328371557898e+307"}});
}

TEST(TruthPlane, AThirdHasAllDigitsAndDistanceIsExact) {
  const Answer answer = ask(plane({0, 3, 0}, 1), {{0, 0, 0}, {0, 1, 0}});
  expect_hits(answer, {{"0.3333333333333333333333333333333333333333"}});
  EXPECT_EQ(answer.hits[0].l.head, 1.0 / 3);
  EXPECT_EQ(make_surface(plane({0, 3, 4}, 10))->distance({7, 3, 4}), 3);
  EXPECT_EQ(make_surface(plane({0x1p900, 0, 0}, 0x1p901))->distance({7, 3, 4}), 5);
}

// ---- Triangle ----

TEST(TruthTriangle, IsClosedAndItsParametersAreBarycentric) {
  const SurfaceSpec spec = triangle({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  const Answer answer = ask(spec, {{1, 2, 3}, {0, 0, -2}});
  expect_hits(answer, {{"1.5"}});
  EXPECT_EQ(answer.hits[0].params, (std::array<double, 2>{0.25, 0.5}));
  EXPECT_EQ(answer.hits[0].normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(answer.hits[0].point, (Vec3{1, 2, 0}));
  // Edges and vertices belong to it, from either side.
  for (const Vec3 at : {Vec3{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {2, 2, 0}, {0, 1, 0}, {3, 0, 0}})
    for (const Vec3 d : {Vec3{0, 0, -1}, {0, 0, 1}, {1, 2, -3}, {-5, 0.5, 1}})
      expect_hits(ask(spec, {at - 2 * d, d}), {{"2"}});
  expect_hits(ask(spec, {{2 + 0x1p-51, 2, 1}, {0, 0, -1}}), {});
  expect_hits(ask(spec, {{-0x1p-1074, 2, 1}, {0, 0, -1}}), {});
  expect_hits(ask(spec, {{1, 1, -1}, {0, 0, -1}}), {});
}

TEST(TruthTriangle, RayInItsPlaneIsCoincidentOrTouchesAVertex) {
  const SurfaceSpec spec = triangle({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  expect_coincident(spec, {{-1, 1, 0}, {1, 0, 0}});
  expect_coincident(spec, {{1, 1, 0}, {1, 0, 0}});
  expect_coincident(spec, {{-1, 0, 0}, {1, 0, 0}});
  expect_coincident(spec, {{0, 0, 0}, {1, 1, 0}});
  expect_hits(ask(spec, {{5, -1, 0}, {1, 0, 0}}), {});
  expect_hits(ask(spec, {{3, 1, 0}, {1, 0, 0}}), {});
  expect_hits(ask(spec, {{-1, 5, 0}, {1, 0, 0}}), {});
  const Answer touch = ask(spec, {{-2, 4, 0}, {1, 0, 0}});
  expect_hits(touch, {{"2", 2}});
  EXPECT_EQ(touch.hits[0].params, (std::array<double, 2>{0, 1}));
  EXPECT_EQ(touch.hits[0].cosine, 0);
  EXPECT_EQ(ask(spec, {{3, -1, 0}, {1, 1, 0}}).hits.at(0).params, (std::array<double, 2>{1, 0}));
  expect_hits(ask(spec, {{2, 4, 0}, {1, 0, 0}}), {});
}

TEST(TruthTriangle, NeedlesAndTinyOnesAreExact) {
  // A sliver whose area would vanish in doubles.
  const double h = 0x1p-1000;
  const SurfaceSpec sliver = triangle({{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}});
  expect_hits(ask(sliver, {{0.5, h, 1}, {0, 0, -1}}), {{"1"}});
  expect_hits(ask(sliver, {{0.5, h * (1 + 0x1p-52), 1}, {0, 0, -1}}), {});
  expect_hits(ask(sliver, {{0.5, h / 2, 1}, {0, 0, -1}}), {{"1"}});
  expect_refused(triangle({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}), "degenerate");
  expect_refused(triangle({{1, 2, 3}, {1, 2, 3}, {3, 3, 3}}), "degenerate");
  expect_refused(triangle({{1, 2, 3}, {1, 2, 4}}), "3 points");
  EXPECT_NO_THROW(make_surface(triangle({{0, 0, 0}, {1, 1, 1}, {3, 3, 3 + 0x1p-51}})));
}

// ---- Polygon ----

const std::vector<Vec3> kExercise{{-3, -3, 7}, {3, -4, 3}, {4, -5, 4}};

TEST(TruthPolygon, ExerciseOfTheSourceIsOutside) {
  const auto exercise = make_surface(polygon(kExercise));
  const Vec3 p{-2, -2, 4};
  for (const Vec3 d : {Vec3{1, 2, 1}, {-1, -2, -1}, {0, 0, 1}, {1, 0, 0}, {0, -3, 1}, {0.1, 0.7, 0.3}})
    EXPECT_EQ(count(*exercise, {p - d, d}), 0U);
  // Its plane is x + 2y + z + 2 = 0 and its middle is inside.
  const Vec3 middle{2, -4.25, 4.5};
  const Answer inside = exercise->all({middle + 3 * Vec3{1, 2, 1}, {-1, -2, -1}}, {});
  expect_hits(inside, {{"3"}});
  expect_near(inside.hits[0].normal, (1 / std::sqrt(6.0)) * Vec3{-1, -2, -1});
}

TEST(TruthPolygon, ConcaveOneHasItsNotchLeftOut) {
  const std::vector<Vec3> arrow{{0, 0, 1}, {4, 0, 1}, {4, 4, 1}, {2, 1, 1}, {0, 4, 1}};
  const auto surface = make_surface(polygon(arrow));
  EXPECT_EQ(count(*surface, {{2, 2, 0}, {0, 0, 1}}), 0U);
  EXPECT_EQ(count(*surface, {{2, 0.5, 0}, {0, 0, 1}}), 1U);
  EXPECT_EQ(count(*surface, {{0.5, 2, 0}, {0, 0, 1}}), 1U);
  EXPECT_EQ(count(*surface, {{3.5, 2, 3}, {0, 0, -1}}), 1U);
  EXPECT_EQ(count(*surface, {{3.5, 2, 3}, {0, 0, 1}}), 0U);
  EXPECT_EQ(surface->distance({2, 2, 1}), std::sqrt(1.0 / 3.25));
  EXPECT_EQ(surface->distance({2, 0.5, 3}), 2);
  EXPECT_EQ(surface->distance({2, -3, 5}), 5);
}

TEST(TruthPolygon, RayInItsPlaneIsCoincidentIffItCoversALength) {
  const std::vector<Vec3> arrow{{0, 0, 1}, {4, 0, 1}, {4, 4, 1}, {2, 1, 1}, {0, 4, 1}};
  const SurfaceSpec spec = polygon(arrow);
  expect_coincident(spec, {{-1, 0.5, 1}, {1, 0, 0}});
  expect_coincident(spec, {{-1, 0, 1}, {1, 0, 0}});  // along an edge
  expect_coincident(spec, {{4, 9, 1}, {0, -1, 0}});  // along an edge
  expect_coincident(spec, {{2, 2, 1}, {1, 0, 0}});   // from the notch
  expect_coincident(spec, {{2, 9, 1}, {0, -1, 0}});  // through the notch's vertex
  expect_coincident(spec, {{2, 1, 1}, {0, -1, 0}});
  expect_hits(ask(spec, {{2, 1, 1}, {0, 1, 0}}), {});
  expect_hits(ask(spec, {{-1, 4, 1}, {1, 0, 0}}), {});  // over two tips, and no hit either
  expect_hits(ask(spec, {{0, 8, 1}, {1, -1, 0}}), {});  // over one
  expect_coincident(spec, {{-1, 6, 1}, {1, -2, 0}});
  expect_hits(ask(spec, {{5, 0.5, 1}, {1, 0, 0}}), {});
  expect_hits(ask(spec, {{-1, 0.5, 0.5}, {1, 0, 0}}), {});
}

TEST(TruthPolygon, RefusalsNameTheirReason) {
  expect_refused(polygon({{0, 0, 0}, {1, 0, 0}}), "at least 3");
  expect_refused(polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), "degenerate");
  expect_refused(polygon({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "edge 1 has no length");
  expect_refused(polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}), "edge 3 has no length");
  expect_refused(polygon({{0, 0, 0}, {4, 0, 0}, {4, 4, 0.001}, {0, 4, 0}}), "plane");
  expect_refused(polygon({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {5, 6, 0}}), "edges 1 and 3 meet");
  expect_refused(polygon({{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {2, 4, 0}}), "edges 0 and 1 meet");
  // A vertex on another edge, a vertex used twice.
  expect_refused(polygon({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}), "intersects itself");
  expect_refused(polygon({{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}}),
                 "intersects itself");
  EXPECT_NO_THROW(make_surface(polygon({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {4, 4, 0}})));
  // Rounded vertices of a plane in general position are planar enough.
  EXPECT_NO_THROW(
      make_surface(polygon({{0.1, 0.2, 0.3}, {1.1, 0.2, 0.6}, {1.1, 1.2, 1.3}, {0.1, 1.2, 1.0}})));
}

TEST(TruthPolygon, LargeOnesAreAccepted) {
  std::vector<Vec3> star;
  for (int i = 0; i < 2000; ++i) {
    const double angle = i * std::acos(-1.0) / 1000;
    const double r = i % 2 == 0 ? 1 : 0.75;
    star.push_back({r * std::cos(angle), r * std::sin(angle), 0});
  }
  const auto surface = make_surface(polygon(star));
  EXPECT_EQ(count(*surface, {{0, 0, 1}, {0, 0, -1}}), 1U);
  EXPECT_EQ(count(*surface, {{0.7, 0.1, 1}, {0, 0, -1}}), 1U);
  EXPECT_EQ(count(*surface, {{0.9, 0.8, 1}, {0, 0, -1}}), 0U);
}

/// A grid of points in the plane z = a x + b y with dyadic coordinates, moved about within their cells.
class Grid {
 public:
  Grid(int n, double a, double b, std::mt19937_64& random) : n_(n) {
    std::uniform_int_distribution<int> step(-64, 64);
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const bool inner = i > 0 && j > 0 && i < n && j < n;
        const double x = i + (inner ? step(random) / 256.0 : 0);
        const double y = j + (inner ? step(random) / 256.0 : 0);
        points_.push_back({x, y, a * x + b * y});
      }
    }
  }
  [[nodiscard]] Vec3 at(int i, int j) const {
    return points_[static_cast<std::size_t>(j) * static_cast<std::size_t>(n_ + 1) +
                   static_cast<std::size_t>(i)];
  }
  /// Quadrilaterals and, in every third cell, a pair of triangles or an L and its complement.
  [[nodiscard]] std::vector<std::unique_ptr<truth::Surface>> tiles(std::mt19937_64& random) const {
    std::vector<std::unique_ptr<truth::Surface>> tiles;
    const auto add = [&](std::vector<Vec3> v) {
      if (random() % 2 == 0) std::reverse(v.begin(), v.end());
      std::rotate(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(random() % v.size()), v.end());
      tiles.push_back(make_surface(polygon(v)));
    };
    for (int j = 0; j + 1 < n_; j += 2) {
      for (int i = 0; i + 1 < n_; i += 2) {
        const Vec3 a = at(i, j);
        const Vec3 b = at(i + 1, j);
        const Vec3 c = at(i + 2, j);
        const Vec3 d = at(i + 2, j + 1);
        const Vec3 e = at(i + 2, j + 2);
        const Vec3 f = at(i + 1, j + 2);
        const Vec3 g = at(i, j + 2);
        const Vec3 h = at(i, j + 1);
        const Vec3 m = at(i + 1, j + 1);
        switch (random() % 3) {
          case 0:  // concave beside a quadrilateral
            add({a, b, m, d, e, f, g, h});
            add({b, c, d, m});
            break;
          case 1:
            add({a, b, m, h});
            add({b, c, m});
            add({c, d, m});
            add({m, d, e, f});
            add({h, m, f, g});
            break;
          default:
            add({a, b, c, d, m, h});
            add({h, m, d, e, f, g});
        }
      }
    }
    return tiles;
  }

 private:
  int n_;
  std::vector<Vec3> points_;
};

std::size_t count_of_all(const std::vector<std::unique_ptr<truth::Surface>>& tiles, const Ray& ray) {
  std::size_t sum = 0;
  for (const auto& tile : tiles) sum += count(*tile, ray);
  return sum;
}

TEST(TruthPolygon, NeighboursShareEveryRayThroughTheirEdgesAndVertices) {
  constexpr std::uint64_t kSeed = 20261122;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  std::mt19937_64 random(kSeed);
  std::uniform_int_distribution<int> whole(-512, 512);
  for (const auto& [a, b] : {std::array{0.0, 0.0}, {0.5, -0.25}, {3.0, 8.0}}) {
    const int n = 6;
    const Grid grid(n, a, b, random);
    const auto tiles = grid.tiles(random);
    for (int trial = 0; trial < 150; ++trial) {
      const int i = 1 + static_cast<int>(random() % (n - 1));
      const int j = 1 + static_cast<int>(random() % (n - 1));
      const std::array<Vec3, 2> next{grid.at(i, j == n - 1 ? j - 1 : j + 1),
                                     grid.at(i == n - 1 ? i - 1 : i + 1, j)};
      const Vec3 at = grid.at(i, j);
      const Vec3 target = trial % 3 == 0 ? at : 0.5 * (at + next[random() % 2]);
      // Eight bits of fraction stay exact through the sum; axis-parallel ones are the hard kind.
      Vec3 d{whole(random) / 256.0, whole(random) / 256.0, whole(random) / 256.0};
      if (trial % 5 == 0) d = {0, 0, trial % 2 == 0 ? 1.0 : -1.0};
      if (trial % 7 == 0) d.x = 0;
      if (dot(d, {a, b, -1}) == 0) continue;
      EXPECT_EQ(count_of_all(tiles, {target - 4 * d, d}), 1U) << trial;
    }
  }
}

TEST(TruthPolygon, TwoPlanesThatMeetInAnEdgeShareItsRays) {
  const auto floor = make_surface(polygon({{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}}));
  const auto wall = make_surface(polygon({{0, 0, 0}, {0, 8, 0}, {-3, 8, 5}, {-3, 0, 5}}));
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> whole(1, 256);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 at{0, whole(random) / 64.0, 0};
    if (at.y >= 8) continue;
    // From above: the edge is no silhouette.
    const Vec3 d{whole(random) / 512.0 - 0.25, whole(random) / 64.0 - 2, -whole(random) / 32.0 - 1};
    EXPECT_EQ(count(*floor, {at - 2 * d, d}) + count(*wall, {at - 2 * d, d}), 1U);
    const Vec3 slanted{4, d.y, 1};
    EXPECT_EQ(count(*floor, {at - 2 * slanted, slanted}) + count(*wall, {at - 2 * slanted, slanted}), 1U);
    // From the side it is one: both or none.
    const Vec3 beside{4, d.y, -1};
    EXPECT_EQ((count(*floor, {at - 2 * beside, beside}) + count(*wall, {at - 2 * beside, beside})) % 2, 0U);
  }
}

TEST(TruthPolygon, ClosedBoxOfPolygonsIsHitAnEvenNumberOfTimes) {
  const auto corner = [](unsigned i) {
    return Vec3{(i & 1U) != 0 ? 3.0 : -1.0, (i & 2U) != 0 ? 2.0 : 0.0, (i & 4U) != 0 ? 5.0 : 1.0};
  };
  std::vector<std::unique_ptr<truth::Surface>> six;
  std::vector<std::unique_ptr<truth::Surface>> twelve;
  const std::array<std::array<unsigned, 4>, 6> faces{
      {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}}};
  for (const auto& f : faces) {
    const std::array<Vec3, 4> v{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])};
    six.push_back(make_surface(polygon({v[0], v[1], v[2], v[3]})));
    twelve.push_back(make_surface(polygon({v[0], v[1], v[2]})));
    twelve.push_back(make_surface(polygon({v[3], v[2], v[0]})));
  }
  std::mt19937_64 random(6);
  std::uniform_int_distribution<int> whole(-16, 16);
  std::size_t hits = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const Vec3 at = trial % 2 == 0 ? corner(static_cast<unsigned>(random() % 8))
                                   : 0.5 * (corner(static_cast<unsigned>(random() % 8)) +
                                            corner(static_cast<unsigned>(random() % 8)));
    const Vec3 d{whole(random) / 4.0, whole(random) / 4.0, whole(random) / 4.0};
    if (max_abs(d) == 0) continue;
    const Ray ray{at - 64 * d, d};
    bool coincident = false;
    for (const auto& face : six) coincident = coincident || face->all(ray, {17}).status != Status::ok;
    if (coincident) continue;
    EXPECT_EQ(count_of_all(six, ray) % 2, 0U);
    EXPECT_EQ(count_of_all(twelve, ray) % 2, 0U);
    hits += count_of_all(six, ray);
  }
  EXPECT_GT(hits, 500U);
}

// ---- Disk ----

TEST(TruthDisk, IsClosedAndFlat) {
  const SurfaceSpec spec = disk({1, 2, 3}, {0, 0, -2}, 5);
  const Answer answer = ask(spec, {{4, 6, 10}, {0, 0, -1}});
  expect_hits(answer, {{"7"}});
  EXPECT_EQ(answer.hits[0].normal, (Vec3{0, 0, -1}));
  EXPECT_EQ(answer.hits[0].params, (std::array<double, 2>{0, 0}));
  EXPECT_EQ(answer.hits[0].cosine, 1);
  expect_hits(ask(spec, {{4, 6 + 0x1p-50, 10}, {0, 0, -1}}), {});
  expect_hits(ask(spec, {{1, 2, 10}, {0, 0, 1}}), {});
  expect_hits(ask(spec, {{1, 2, 3}, {0, 0, 1}}), {});
  EXPECT_EQ(make_surface(spec)->distance({1, 4, 10}), 7);
  EXPECT_EQ(make_surface(spec)->distance({1, 10, 7}), 5);
}

TEST(TruthDisk, RayInItsPlaneIsCoincidentOrTouches) {
  const SurfaceSpec spec = disk({0, 0, 0}, {0, 0, 1}, 5);
  expect_coincident(spec, {{-9, 4, 0}, {1, 0, 0}});
  expect_coincident(spec, {{0, 4, 0}, {1, 0, 0}});
  expect_coincident(spec, {{-3, 4, 0}, {1, 0, 0}});
  expect_hits(ask(spec, {{3, 4, 0}, {1, 0, 0}}), {});
  expect_hits(ask(spec, {{9, 4, 0}, {1, 0, 0}}), {});
  const Answer touch = ask(spec, {{-9, 5, 0}, {2, 0, 0}});
  expect_hits(touch, {{"4.5", 2}});
  EXPECT_EQ(touch.hits[0].cosine, 0);
  expect_hits(ask(spec, {{9, 5, 0}, {2, 0, 0}}), {});
  expect_hits(ask(spec, {{-9, 5 + 0x1p-50, 0}, {2, 0, 0}}), {});
  expect_hits(ask(spec, {{-9, 0, 1}, {2, 0, 0}}), {});
}

TEST(TruthDisk, RefusalsNameTheParameter) {
  expect_refused(disk({0, 0, 0}, {0, 0, 0}, 1), "normal");
  expect_refused(disk({0, 0, 0}, {0, 0, 1}, 0), "radius");
  expect_refused(disk({0, 0, 0}, {0, 0, 1}, -1), "radius");
  expect_refused(spec_of("disk", {{"normal", std::vector<double>{0, 0, 1}}}), "radius");
  expect_refused(plane({0, 0, 0}, 1), "a must not be zero");
}

// ---- Convex solids ----

TEST(TruthBox, ExampleOfTheSourceMisses) {
  expect_hits(ask(box({-1, 2, 1}, {3, 3, 3}), {{0, 4, 2}, {0.213, -0.436, 0.873}}), {});
}

TEST(TruthBox, FacesAreNumberedAndNormalsPointOutward) {
  const SurfaceSpec spec = box({-1, 2, 1}, {3, 3, 3});
  const std::array<Vec3, 6> normals{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};
  const Vec3 middle{1, 2.5, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    const Answer answer = ask(spec, {middle + 8 * normals[i], -normals[i]});
    ASSERT_EQ(answer.hits.size(), 2U);
    EXPECT_EQ(answer.hits[0].params, (std::array<double, 2>{static_cast<double>(i), 0}));
    EXPECT_EQ(answer.hits[1].params[0], static_cast<double>(i ^ 1U));
    EXPECT_EQ(answer.hits[0].normal, normals[i]);
    EXPECT_EQ(answer.hits[1].normal, -normals[i]);
    ASSERT_EQ(ask(spec, {middle, normals[i]}).hits.size(), 1U);
    EXPECT_EQ(ask(spec, {middle, normals[i]}).hits[0].params[0], static_cast<double>(i));
  }
  // Through an edge into the box the smaller face counts.
  EXPECT_EQ(ask(spec, {{-2, 1.5, 2}, {1, 0.5, 0}}).hits.at(0).params[0], 0);
}

TEST(TruthBox, EdgesAndVerticesTouchFacesCoincide) {
  const SurfaceSpec spec = box({0, 0, 0}, {4, 4, 4});
  expect_hits(ask(spec, {{-1, 1, 2}, {1, -1, 0}}), {{"1", 2}});
  expect_hits(ask(spec, {{-2, 1, 1}, {2, -1, -1}}), {{"1", 2}});
  expect_hits(ask(spec, {{-1, 1, 0}, {1, -1, 0}}), {{"1", 2}});
  EXPECT_NEAR(ask(spec, {{-1, 1, 2}, {1, -1, 0}}).hits[0].cosine, std::sqrt(0.5), 1e-15);
  expect_hits(ask(spec, {{1, -1, 2}, {1, -1, 0}}), {});
  expect_hits(ask(spec, {{-1, -1, -1}, {1, 1, 1}}), {{"1"}, {"5"}});
  expect_hits(ask(spec, {{0, 0, 0}, {1, 1, 1}}), {{"4"}});
  expect_hits(ask(spec, {{0, 0, 0}, {-1, 1, 1}}), {});
  expect_coincident(spec, {{-1, 1, 0}, {1, 0, 0}});
  expect_coincident(spec, {{-1, 0, 0}, {1, 0, 0}});
  expect_coincident(spec, {{1, 1, 4}, {1, 1, 0}});
  expect_hits(ask(spec, {{5, 1, 0}, {1, 0, 0}}), {});
  expect_hits(ask(spec, {{4, 1, 0}, {1, 0, 0}}), {});
  expect_hits(ask(spec, {{-1, 5, 0}, {1, 0, 0}}), {});
}

TEST(TruthBox, FlatAndEmptyOnesAreRefused) {
  expect_refused(box({0, 0, 0}, {1, 0, 1}), "flat");
  expect_refused(box({0, 0, 0}, {1, -1, 1}), "empty");
  EXPECT_NO_THROW(make_surface(box({0, 0, 0}, {1, 0x1p-1074, 0x1p1023})));
}

TEST(TruthBox, DistanceIsFromTheBoundary) {
  const auto surface = make_surface(box({0, 0, 0}, {4, 4, 4}));
  EXPECT_EQ(surface->distance({2, 1, 2}), 1);
  EXPECT_EQ(surface->distance({2, -3, 2}), 3);
  EXPECT_EQ(surface->distance({7, 8, 2}), 5);
  EXPECT_EQ(surface->distance({6, 7, 10}), 7);
  EXPECT_EQ(surface->distance({4, 4, 4}), 0);
}

TEST(TruthTetrahedron, ExerciseOfTheSource) {
  const SurfaceSpec spec = tetrahedron(kCorner);
  const Answer answer = ask(spec, {{0, 0, 0}, {1, 2, 3}});
  expect_hits(answer, {{"0.1111111111111111111111111111111111111111"}});
  // x + y + 2z = 1 is opposite to (-1, 0, -1).
  EXPECT_EQ(answer.hits[0].params[0], 1);
  expect_near(answer.hits[0].normal, (1 / std::sqrt(6.0)) * Vec3{1, 1, 2});
  const Answer through = ask(spec, {{-1, -2, -3}, {1, 2, 3}});
  expect_hits(through, {{"1"}, {"1.111111111111111111111111111111111111111"}});
  EXPECT_EQ(through.hits[0].params[0], 3);
  EXPECT_EQ(through.hits[0].normal, (Vec3{0, -1, 0}));
}

TEST(TruthTetrahedron, OrientationDoesNotMatterAndFlatOnesAreRefused) {
  std::vector<Vec3> turned = kCorner;
  std::swap(turned[0], turned[1]);
  const Answer answer = ask(tetrahedron(turned), {{-1, -2, -3}, {1, 2, 3}});
  expect_hits(answer, {{"1"}, {"1.111111111111111111111111111111111111111"}});
  EXPECT_EQ(answer.hits[1].params[0], 0);
  EXPECT_EQ(answer.hits[0].normal, (Vec3{0, -1, 0}));
  expect_refused(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 7, 0}}), "flat");
  expect_refused(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), "4 points");
  EXPECT_NO_THROW(make_surface(tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 7, 0x1p-1074}})));
}

const Table kOctahedron{{1, 1, 1, 1},  {1, 1, -1, 1},  {1, -1, 1, 1},  {1, -1, -1, 1},
                        {-1, 1, 1, 1}, {-1, 1, -1, 1}, {-1, -1, 1, 1}, {-1, -1, -1, 1}};

TEST(TruthPolyhedron, OctahedronIsHitThroughFacesEdgesAndVertices) {
  const SurfaceSpec spec = polyhedron(kOctahedron);
  expect_hits(ask(spec, {{-2, 0, 0}, {1, 0, 0}}), {{"1"}, {"3"}});
  expect_hits(ask(spec, {{1, 0, -2}, {0, 0, 1}}), {{"2", 2}});
  expect_hits(ask(spec, {{0.5, 0.5, -2}, {0, 0, 1}}), {{"2", 2}});
  expect_hits(ask(spec, {{0.5, 0.25, -2}, {0, 0, 1}}), {{"1.75"}, {"2.25"}});
  // Along an edge and inside a face.
  expect_coincident(spec, {{2, -1, 0}, {-1, 1, 0}});
  expect_coincident(spec, {{1, 0, 0}, {-2, 1, 1}});
  EXPECT_EQ(ask(spec, {{-2, 0, 0}, {1, 0, 0}}).hits[0].params[0], 4);
  EXPECT_EQ(ask(spec, {{-2, 0, 0}, {1, 0, 0}}).hits[1].params[0], 0);
  EXPECT_EQ(make_surface(spec)->distance({0, 0, 0}), std::sqrt(1.0 / 3));
  EXPECT_EQ(make_surface(spec)->distance({0, 3, 0}), 2);
}

TEST(TruthPolyhedron, RedundantHalfSpacesChangeNoHit) {
  Table more = kOctahedron;
  more.push_back({1, 0, 0, 1});  // touches a vertex
  more.push_back({1, 1, 0, 1});  // touches an edge
  more.push_back({2, 2, 2, 2});  // twice the same
  more.push_back({0, 1, 0, 5});  // far away
  const SurfaceSpec spec = polyhedron(more);
  expect_hits(ask(spec, {{-2, 0, 0}, {1, 0, 0}}), {{"1"}, {"3"}});
  EXPECT_EQ(ask(spec, {{-2, 0, 0}, {1, 0, 0}}).hits[1].params[0], 0);
  expect_hits(ask(spec, {{1, 0, -2}, {0, 0, 1}}), {{"2", 2}});
  expect_coincident(spec, {{2, -1, 0}, {-1, 1, 0}});
  EXPECT_EQ(make_surface(spec)->distance({0, 0, 0}), std::sqrt(1.0 / 3));
}

TEST(TruthPolyhedron, RefusalsSayEmptyFlatOrUnbounded) {
  const auto with = [](Table rows, const Table& more) {
    rows.insert(rows.end(), more.begin(), more.end());
    return polyhedron(rows);
  };
  expect_refused(with(kOctahedron, {{1, 1, 1, -2}}), "empty");
  expect_refused(with(kOctahedron, {{1, 1, 1, -1}}), "flat");
  expect_refused(with(kOctahedron, {{1, 0, 0, -1}}), "flat");
  expect_refused(with(kOctahedron, {{1, 1, 0, -1}}), "flat");
  // Flat first, then empty.
  expect_refused(with(kOctahedron, {{1, 1, 1, -1}, {-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, -1}}), "empty");
  expect_refused(with(kOctahedron, {{1, 0, 0, 0}, {-1, 0, 0, 0}, {0, 1, 0, -1}}), "flat");
  expect_refused(polyhedron({}), "unbounded");
  expect_refused(polyhedron({{1, 0, 0, 1}, {-1, 0, 0, 1}, {0, 1, 0, 1}, {0, -1, 0, 1}}), "unbounded");
  expect_refused(polyhedron({{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}}), "unbounded");
  expect_refused(polyhedron({{1, 0, 0, -1}, {-1, 0, 0, -1}}), "empty");
  expect_refused(polyhedron({{1, 0, 0, 1}, {-1, 0, 0, -1}}), "flat");
  expect_refused(polyhedron({{1, 0, 0, 1}, {0, 0, 0, 1}}), "halfspaces[1]");
  // Three planes closed by a fourth that is nearly parallel to their recession cone's edge.
  const double tiny = 0x1p-1000;
  expect_refused(polyhedron({{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {1, 1, 0, 1}}), "unbounded");
  EXPECT_NO_THROW(make_surface(polyhedron({{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, -1, 0}, {1, 1, tiny, 1}})));
  EXPECT_NO_THROW(make_surface(with(kOctahedron, {{1, 1, 1, -1 + 0x1p-52}})));
  expect_refused(polyhedron(Table(257, std::vector<double>{1, 0, 0, 1})), "256");
}

TEST(TruthPolyhedron, ManyHalfSpacesAroundASphere) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Table rows;
  for (int i = 0; i < 256; ++i) rows.push_back({normal(random), normal(random), normal(random), 1});
  const auto surface = make_surface(polyhedron(rows));
  for (int i = 0; i < 100; ++i) {
    const Vec3 d{normal(random), normal(random), normal(random)};
    const Answer answer = surface->all({{0, 0, 0}, d}, {});
    ASSERT_EQ(answer.hits.size(), 1U);
    double nearest = 1e300;
    for (const auto& row : rows) {
      const double speed = dot({row[0], row[1], row[2]}, d);
      if (speed > 0) nearest = std::min(nearest, 1 / speed);
    }
    EXPECT_NEAR(answer.hits[0].l.head / nearest, 1, 1e-12);
    EXPECT_LT(surface->distance(answer.hits[0].point), 1e-15);
  }
}

TEST(TruthPolyhedron, BoxAndTetrahedronAreTheirHalfSpaces) {
  const auto a = make_surface(box({-1, 0, 2}, {3, 0.5, 7}));
  const auto b = make_surface(polyhedron(
      {{-1, 0, 0, 1}, {2, 0, 0, 6}, {0, -3, 0, 0}, {0, 1, 0, 0.5}, {0, 0, -0.25, -0.5}, {0, 0, 1, 7}}));
  const auto c = make_surface(tetrahedron(kCorner));
  const auto d = make_surface(polyhedron({{-1, 1, 0, 1}, {1, 1, 2, 1}, {1, 1, -2, 1}, {0, -1, 0, 0}}));
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> part(-1, 1);
  std::size_t hits = 0;
  const auto compare = [&](const truth::Surface& x, const truth::Surface& y, const Ray& ray) {
    const Answer p = x.all(ray, {});
    const Answer q = y.all(ray, {});
    ASSERT_EQ(p.hits.size(), q.hits.size());
    for (std::size_t i = 0; i < p.hits.size(); ++i) {
      EXPECT_EQ(p.hits[i].l.decimal, q.hits[i].l.decimal);
      EXPECT_EQ(p.hits[i].normal, q.hits[i].normal);
      EXPECT_EQ(p.hits[i].params, q.hits[i].params);
      EXPECT_EQ(p.hits[i].cosine, q.hits[i].cosine);
      ++hits;
    }
  };
  for (int i = 0; i < 300; ++i) {
    const Vec3 o{8 * part(random), 8 * part(random), 8 * part(random)};
    compare(*a, *b, {o, Vec3{1, 0.25, 4} - o + 2 * Vec3{part(random), part(random), part(random)}});
    compare(*c, *d, {o, Vec3{0, 0.25, 0} - o + Vec3{part(random), part(random), part(random)}});
  }
  EXPECT_GT(hits, 400U);
}

// ---- All types ----

std::vector<SurfaceSpec> one_of_each() {
  return {plane({0.3, 1.1, -0.7}, 0.4),
          triangle({{-1.3, 0.2, 0.1}, {1.7, -0.3, 0.4}, {0.2, 1.9, -0.6}}),
          polygon({{-2, -1, 0}, {2, -1.5, 0}, {0.5, 0.25, 0}, {1.75, 2, 0}, {-1, 1.5, 0}}),
          disk({0.1, -0.2, 0.3}, {0.5, 1.5, -0.25}, 1.625),
          box({-1, -0.7, -0.3}, {1.1, 0.9, 0.8}),
          tetrahedron(kCorner),
          polyhedron(kOctahedron)};
}

std::vector<Ray> some_rays(std::uint64_t seed, int n) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(-1, 1);
  std::vector<Ray> rays;
  for (int i = 0; i < n; ++i) {
    const Vec3 o{4 * part(random), 4 * part(random), 4 * part(random)};
    rays.push_back({o, Vec3{part(random), part(random), part(random)} - o});
  }
  return rays;
}

SurfaceSpec scaled(SurfaceSpec spec, double k) {
  std::map<std::string, ParameterValue> values = spec.parameters.values();
  for (auto& [name, value] : values) {
    if (name == "a" || name == "normal" || name == "one_sided") continue;
    if (auto* number = std::get_if<double>(&value)) *number *= k;
    if (auto* numbers = std::get_if<std::vector<double>>(&value))
      for (double& x : *numbers) x *= k;
    if (auto* rows = std::get_if<Table>(&value))
      for (auto& row : *rows)
        for (std::size_t i = name == "halfspaces" ? 3 : 0; i < row.size(); ++i) row[i] *= k;
  }
  spec.parameters = Parameters(values);
  return spec;
}

TEST(TruthFlat, ScalingByAPowerOfTwoScalesTheAnswer) {
  for (const SurfaceSpec& spec : one_of_each()) {
    for (const double k : {0x1p-900, 0x1p40, 0x1p1000}) {
      const auto plain = make_surface(spec);
      const auto large = make_surface(scaled(spec, k));
      std::size_t hits = 0;
      for (const Ray& ray : some_rays(21, 60)) {
        const Answer a = plain->all(ray, {});
        const Answer b = large->all({k * ray.o, ray.d}, {});
        ASSERT_EQ(a.hits.size(), b.hits.size()) << spec.type;
        for (std::size_t i = 0; i < a.hits.size(); ++i) {
          EXPECT_EQ(b.hits[i].l.head, k * a.hits[i].l.head);
          EXPECT_EQ(b.hits[i].l.tail, k * a.hits[i].l.tail);
          EXPECT_EQ(b.hits[i].point, k * a.hits[i].point);
          EXPECT_EQ(b.hits[i].normal, a.hits[i].normal);
          EXPECT_EQ(b.hits[i].params, a.hits[i].params);
          EXPECT_EQ(b.hits[i].cosine, a.hits[i].cosine);
          ++hits;
        }
      }
      EXPECT_GT(hits, 5U) << spec.type;
    }
  }
}

TEST(TruthFlat, PlacementMovesTheAnswerWithTheRay) {
  // Entries of few bits, so that the placed ray is exact.
  Placement placement;
  placement.translate = {3, -0.5, 0.25};
  placement.matrix = {Vec3{1, 2, 0}, Vec3{0, -1, 0.5}, Vec3{0.25, 0, 1}};
  for (SurfaceSpec spec : one_of_each()) {
    const auto plain = make_surface(spec);
    spec.placement = placement;
    const auto placed = make_surface(spec);
    std::size_t hits = 0;
    for (Ray ray : some_rays(22, 200)) {
      const auto rounded = [](Vec3 v) {
        return Vec3{std::round(v.x * 64) / 64, std::round(v.y * 64) / 64, std::round(v.z * 64) / 64};
      };
      ray = {rounded(ray.o), rounded(ray.d)};
      const Ray moved{placement.matrix * ray.o + placement.translate, placement.matrix * ray.d};
      const Answer a = plain->all(ray, {});
      const Answer b = placed->all(moved, {});
      ASSERT_EQ(a.hits.size(), b.hits.size()) << spec.type;
      ASSERT_EQ(a.status, b.status) << spec.type;
      for (std::size_t i = 0; i < a.hits.size(); ++i) {
        EXPECT_EQ(a.hits[i].l.decimal, b.hits[i].l.decimal) << spec.type;
        EXPECT_EQ(a.hits[i].params, b.hits[i].params) << spec.type;
        EXPECT_EQ(a.hits[i].multiplicity, b.hits[i].multiplicity) << spec.type;
        // M^T times the world's normal points along the object's: M^-T n.
        const Vec3 back = normalized(transpose(placement.matrix) * b.hits[i].normal);
        expect_near(back, a.hits[i].normal);
        EXPECT_LT(placed->distance(b.hits[i].point), 1e-14) << spec.type;
        EXPECT_LT(plain->distance(a.hits[i].point), 1e-14) << spec.type;
        ++hits;
      }
    }
    EXPECT_GT(hits, 20U) << spec.type;
  }
}

TEST(TruthFlat, DistanceIsThatOfTheWorld) {
  const auto stretched = [](SurfaceSpec spec) {
    spec.placement.matrix = {Vec3{4, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    spec.placement.translate = {1, 0, 0};
    return make_surface(spec);
  };
  EXPECT_EQ(stretched(box({0, 0, 0}, {1, 1, 1}))->distance({7, 0.5, 0.5}), 2);
  EXPECT_EQ(stretched(disk({0, 0, 0}, {0, 1, 0}, 1))->distance({7, 0, 0}), 2);
  EXPECT_EQ(stretched(disk({0, 0, 0}, {0, 1, 0}, 1))->distance({4, 5, 0}), 5);
  EXPECT_EQ(stretched(triangle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}))->distance({-2, 0.5, 4}), 5);
  EXPECT_EQ(stretched(polygon(kSquare))->distance({20, 2, 4}), 5);
  EXPECT_EQ(stretched(plane({1, 0, 0}, 2))->distance({12, 3, 3}), 3);
  // The largest and the smallest doubles there are.
  const auto huge = make_surface(box({0x1p-1074, 0, 0}, {0x1p1023, 1, 1}));
  EXPECT_EQ(huge->distance({0x1p1022, 0.25, 0.5}), 0.25);
  EXPECT_EQ(huge->distance({0, 0.25, 0.5}), 0x1p-1074);
}

TEST(TruthFlat, HitsHaveProofPointAndCosine) {
  for (const SurfaceSpec& spec : one_of_each()) {
    const auto surface = make_surface(spec);
    for (const Ray& ray : some_rays(23, 100)) {
      double last = 0;
      for (const Hit& hit : surface->all(ray, {}).hits) {
        EXPECT_GT(hit.l.head, last);
        last = hit.l.head;
        EXPECT_NEAR(norm(hit.normal), 1, 4e-16);
        EXPECT_NEAR(hit.cosine, std::fabs(dot(hit.normal, ray.d)) / norm(ray.d), 1e-14);
        const Vec3 claimed = ray.o + hit.l.head * ray.d;
        EXPECT_LT(norm(hit.point - claimed), 1e-14);
        EXPECT_LE(std::stod(hit.l.lo), std::stod(hit.l.hi));
      }
    }
  }
}

TEST(TruthFlat, RaysThatAreNoQuestionAreInvalid) {
  for (const SurfaceSpec& spec : one_of_each()) {
    EXPECT_EQ(ask(spec, {{0, 0, 0}, {0, 0, 0}}).status, Status::invalid);
    EXPECT_EQ(ask(spec, {{0, std::nan(""), 0}, {1, 0, 0}}).status, Status::invalid);
    EXPECT_FALSE(ask(spec, {{0, 0, 0}, {0, HUGE_VAL, 0}}).why.empty());
  }
}

TEST(TruthFlat, UnknownParametersAndSingularPlacementsAreRefused) {
  for (SurfaceSpec spec : one_of_each()) {
    SurfaceSpec misspelt = spec;
    misspelt.parameters.set("radios", 1.0);
    expect_refused(misspelt, "radios");
    spec.placement.matrix = {Vec3{1, 2, 3}, Vec3{2, 4, 6}, Vec3{0, 0, 1}};
    expect_refused(spec, "singular");
  }
}

TEST(TruthFlat, ExtremeMagnitudesAreExact) {
  const auto far = make_surface(box({0x1p-1074, 0, 0}, {0x1p1023, 1, 1}));
  const Answer answer = far->all({{-0x1p1000, 0.5, 0.5}, {0x1p-1074, 0, 0}}, {});
  ASSERT_EQ(answer.hits.size(), 2U);
  EXPECT_EQ(answer.hits[0].point.x, 0x1p-1074);
  EXPECT_EQ(answer.hits[1].point.x, 0x1p1023);
  EXPECT_TRUE(std::isinf(answer.hits[0].l.head));
  const Answer tiny =
      ask(triangle({{0, 0, 0}, {0x1p-1074, 0, 0}, {0, 0x1p-1074, 0}}), {{0, 0, 1e300}, {0, 0, -1}});
  expect_hits(tiny, {{"1.000000000000000052504760255204420248704e+300"}});
}

}  // namespace
}  // namespace graze
