// Boxes and the hierarchy over them: culling may keep too much, and never loses a box that the ray meets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <vector>

#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/bvh.hpp>

namespace graze {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double log_uniform(Rng& rng, double lo, double hi) { return std::pow(10.0, rng.uniform(lo, hi)); }

Vec3 random_vector(Rng& rng) { return {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)}; }

Bounds random_box(Rng& rng) {
  const Vec3 c = 10 * random_vector(rng);
  const Vec3 h{log_uniform(rng, -3, 0), log_uniform(rng, -3, 0), log_uniform(rng, -3, 0)};
  return {c - h, c + h};
}

/// Whether o + l d, l >= 0, meets the closed box: exactly, by comparing the slabs' fractions.
bool truly_meets(const Ray& ray, const Bounds& box) {
  struct Fraction {
    Expansion top, bottom;  // bottom > 0
  };
  const auto less = [](const Fraction& a, const Fraction& b) {
    return (a.top * b.bottom - b.top * a.bottom).sign() < 0;
  };
  Fraction near{Expansion(0), Expansion(1)};
  Fraction far{Expansion(1), Expansion(0)};  // infinity
  const auto cut = [&](double o, double d, double lo, double hi) {
    if (d == 0) return lo <= o && o <= hi;
    const Expansion a = d > 0 ? Expansion(lo) - Expansion(o) : Expansion(o) - Expansion(hi);
    const Expansion b = d > 0 ? Expansion(hi) - Expansion(o) : Expansion(o) - Expansion(lo);
    const Fraction entry{a, Expansion(std::fabs(d))}, exit{b, Expansion(std::fabs(d))};
    if (less(near, entry)) near = entry;
    if (less(exit, far)) far = exit;
    return !less(far, near);
  };
  return cut(ray.o.x, ray.d.x, box.lo.x, box.hi.x) && cut(ray.o.y, ray.d.y, box.lo.y, box.hi.y) &&
         cut(ray.o.z, ray.d.z, box.lo.z, box.hi.z);
}

/// Rays at a box, many of them at its edges, corners and faces to within an ulp, or along its sides.
Ray ray_at(const Bounds& box, Rng& rng) {
  const auto pick = [&](double lo, double hi) {
    const double which = rng.uniform();
    return which < 0.3 ? lo : which < 0.6 ? hi : rng.uniform(lo, hi);
  };
  const Vec3 target{pick(box.lo.x, box.hi.x), pick(box.lo.y, box.hi.y), pick(box.lo.z, box.hi.z)};
  Vec3 d = random_vector(rng);
  if (rng.uniform() < 0.3) d.x = 0;
  if (rng.uniform() < 0.3) d.y = rng.uniform() < 0.5 ? -0.0 : log_uniform(rng, -300, -10);
  if (d == Vec3{}) d.z = 1;
  if (rng.uniform() < 0.3) return {10 * random_vector(rng), d};  // aims nowhere
  const double distance = rng.uniform() < 0.1 ? 0.0 : log_uniform(rng, -2, 6);
  return {target - distance * d, log_uniform(rng, -3, 3) * d};
}

TEST(Bounds, TheSlabTestNeverLosesABoxThatTheRayMeets) {
  Rng rng(kSeed);
  std::size_t met = 0, kept = 0;
  constexpr std::size_t kCount = 100000;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Bounds box = random_box(rng);
    const Ray ray = ray_at(box, rng);
    double near = 0;
    const bool may = SlabRay(ray).meets(box, kInfinity, near);
    const bool does = truly_meets(ray, box);
    EXPECT_TRUE(may || !does) << std::hexfloat << ray.o.x << " " << ray.o.y << " " << ray.o.z;
    met += does ? 1 : 0;
    kept += may ? 1 : 0;
  }
  std::printf("seed %llu: %zu of %zu rays meet their box, %zu are kept\n",
              static_cast<unsigned long long>(kSeed), met, kCount, kept);
  EXPECT_GT(met, kCount / 10);
  EXPECT_LT(kept, kCount * 9 / 10) << "the test must cull, too";
}

TEST(Bounds, ExtremeRaysNeverLoseTheBoxEither) {
  const Bounds box{{-1, -1, -1}, {1, 1, 1}};
  double near = 0;
  for (const double size : {5e-324, 1e-310, 1e-160, 1e160, 1e300}) {
    EXPECT_TRUE(SlabRay({{0, 0, -2}, {0, 0, size}}).meets(box, kInfinity, near)) << size;
    EXPECT_TRUE(SlabRay({{0.5, 0.5, -2}, {0, size, 1}}).meets(box, kInfinity, near) || size > 1) << size;
    EXPECT_TRUE(SlabRay({{0, 0, 0}, {size, size, size}}).meets(box, kInfinity, near)) << size;
  }
  EXPECT_TRUE(SlabRay({{1, 1, -2}, {0, 0, 1}}).meets(box, kInfinity, near)) << "along an edge";
  EXPECT_FALSE(SlabRay({{1.5, 0, -2}, {0, 0, 1}}).meets(box, kInfinity, near));
  EXPECT_FALSE(SlabRay({{0, 0, 2}, {0, 0, 1}}).meets(box, kInfinity, near)) << "behind";
  EXPECT_TRUE(SlabRay({{0, 0, -2}, {0, 0, 1}}).meets(Bounds{}, kInfinity, near)) << "unbounded";
  EXPECT_FALSE(SlabRay({{0, 0, -4}, {0, 0, 1}}).meets(box, 2, near)) << "too far";
  EXPECT_TRUE(SlabRay({{0, 0, -4}, {0, 0, 1}}).meets(box, 3, near));
  EXPECT_LE(near, 3);
}

TEST(Bounds, APlacedBoxHoldsEveryPlacedPoint) {
  Rng rng(kSeed);
  for (int i = 0; i < 5000; ++i) {
    const Bounds box = random_box(rng);
    const Placement placement{log_uniform(rng, -6, 6) * random_vector(rng),
                              {random_vector(rng), random_vector(rng), random_vector(rng)}};
    const Bounds world = placed(box, placement);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p{(corner & 1) != 0 ? box.hi.x : box.lo.x, (corner & 2) != 0 ? box.hi.y : box.lo.y,
                   (corner & 4) != 0 ? box.hi.z : box.lo.z};
      const auto inside = [&](const Vec3& row, double t, double lo, double hi) {
        const Expansion x = Expansion(row.x) * Expansion(p.x) + Expansion(row.y) * Expansion(p.y) +
                            Expansion(row.z) * Expansion(p.z) + Expansion(t);
        return (x - Expansion(lo)).sign() >= 0 && (Expansion(hi) - x).sign() >= 0;
      };
      EXPECT_TRUE(inside(placement.matrix[0], placement.translate.x, world.lo.x, world.hi.x));
      EXPECT_TRUE(inside(placement.matrix[1], placement.translate.y, world.lo.y, world.hi.y));
      EXPECT_TRUE(inside(placement.matrix[2], placement.translate.z, world.lo.z, world.hi.z));
    }
  }
}

/// Every box that the walk offers with a far end, in the order in which they come.
std::vector<std::uint32_t> walk(const Bvh& tree, const Ray& ray, double far) {
  Bvh::Walk walk;
  walk.start(tree, ray);
  std::vector<std::uint32_t> all, leaf;
  while (walk.next(tree, far, leaf)) all.insert(all.end(), leaf.begin(), leaf.end());
  return all;
}

TEST(Bvh, OffersExactlyTheBoxesThatPassTheSlabTestEachOnce) {
  Rng rng(kSeed);
  for (const std::size_t count :
       {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{17}, std::size_t{1000}}) {
    std::vector<Bounds> boxes;
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(random_box(rng));
    // Equal boxes and centres, which no cut can part.
    for (std::size_t i = 0; i < count / 4; ++i) boxes.push_back(boxes[i % 3]);
    const Bvh tree(boxes);
    for (int k = 0; k < 300; ++k) {
      const Ray ray =
          ray_at(boxes[static_cast<std::size_t>(rng.uniform() * static_cast<double>(count))], rng);
      for (const double far : {kInfinity, 1.0}) {
        std::vector<std::uint32_t> offered = walk(tree, ray, far);
        std::sort(offered.begin(), offered.end());
        std::vector<std::uint32_t> expected;
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
          double near = 0;
          if (SlabRay(ray).meets(boxes[i], far, near)) expected.push_back(i);
        }
        ASSERT_EQ(offered, expected) << count << " boxes, ray " << k;
      }
    }
  }
  EXPECT_TRUE(walk(Bvh(std::span<const Bounds>()), {{0, 0, 0}, {1, 0, 0}}, kInfinity).empty());
}

TEST(Bvh, NearBoxesComeFirstWhereTheyDoNotOverlap) {
  std::vector<Bounds> row;
  for (int i = 0; i < 64; ++i) row.push_back({{3.0 * i, -1, -1}, {3.0 * i + 1, 1, 1}});
  const Bvh tree(row);
  const auto order = walk(tree, {{-5, 0, 0}, {1, 0, 0}}, kInfinity);
  const auto backwards = walk(tree, {{500, 0, 0}, {-1, 0, 0}}, kInfinity);
  ASSERT_EQ(order.size(), 64U);
  // A leaf holds two boxes, whose own order does not count.
  for (std::size_t i = 0; i + 2 < order.size(); ++i) {
    EXPECT_LT(order[i] / 2, order[i + 2] / 2 + 1);
    EXPECT_GT(backwards[i] / 2 + 1, backwards[i + 2] / 2);
  }
}

}  // namespace
}  // namespace graze
