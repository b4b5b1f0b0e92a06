// The kernel of Bezier profiles on what one profile cannot show: every degree, profiles that cross the axis
// or fold back, ends that are caps, tips and rims; and the normals of its hits.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/specs.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/surfaces/bezier_revolution_certified.hpp>
#include <surfaces/cells.hpp>

#include "family_rays.hpp"

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261123;

struct Profile {
  std::string name;
  Table points;
  bool is_kind = true;  ///< doubles answer most ordinary rays
};

void PrintTo(const Profile& profile, std::ostream* out) { *out << profile.name; }

std::vector<Profile> profiles() {
  return {{"cone", {{1, 0}, {0, 2}}},
          {"cylinder", {{1, 0}, {1, 2}}},
          {"cap", {{0, 0}, {2, 0}, {2, 3}}},
          {"lens", {{0, 1}, {2, 1}, {0, 0.5}}},
          {"teardrop", teardrop_points(1)},
          {"waist", {{0, 0}, {4, 1}, {-2, 3}, {5, 2}, {0.5, 6}}},
          {"vase", vase_points()},
          {"raised", {{0, 1}, {2, 1}, {3, 2}, {2, 3}, {0, 3}}},
          {"crossing", crossing_points()},
          {"seven", degree_seven_points()},
          {"eight", {{0, 0}, {1, 0}, {3, 1}, {1, 2}, {2, 3}, {3, 4}, {2, 5}, {1, 6}, {0, 6}}},
          {"fold", {{0, 0}, {3, 4}, {3, -2}, {0, 3}}, false}};
}

KernelAnswers answer(const SurfaceSpec& spec, std::span<const Ray> rays, bool all) {
  KernelModel<BezierRevolutionCertified> kernel({});
  kernel.add(spec);
  KernelAnswers answers;
  kernel.intersect(rays, all, answers);
  return answers;
}

class BezierKernel : public testing::TestWithParam<Profile> {};

TEST_P(BezierKernel, NeverWrongNorOpen) {
  constexpr double kMostHard =
      0.03;  // of ordinary rays, for the tiers behind the first: measured, at most 0.01
  const Promise& promise = promise_of("certified");
  const std::size_t count = rays_a_family(400, 100);
  const SurfaceSpec spec = bezier(GetParam().points);
  const SurfaceModel<BezierRevolution> surface(spec);
  const auto truth = truth::make_surface(spec);
  for (const CaseFamily& family : case_families()) {
    if (family.name == "scale" || !family.suits(surface.landmarks())) continue;
    const std::vector<Ray> rays = rays_of(family, surface, kSeed, count);
    std::array<std::size_t, 4> by_tier{};
    double worst = 0;
    for (const bool all : {false, true}) {
      const KernelAnswers got = answer(spec, rays, all);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const truth::Answer right = truth->all(rays[i], {.digits = 17});
        ASSERT_NE(got.hits[i], KernelAnswers::kOpen) << family.name << " " << i;
        ASSERT_EQ(got.hits[i] == KernelAnswers::kCoincident, right.status == Status::coincident)
            << family.name << " " << i;
        if (right.status != Status::ok) continue;
        ++by_tier[got.tier[i]];
        const std::size_t hits = all ? right.hits.size() : std::min<std::size_t>(1, right.hits.size());
        ASSERT_EQ(static_cast<std::size_t>(got.hits[i]), hits) << family.name << " " << i << " all " << all;
        for (std::size_t k = 0; k < hits; ++k) {
          const truth::Hit& hit = right.hits[k];
          EXPECT_EQ(got.multiplicity(i, static_cast<int>(k)), hit.multiplicity) << family.name << " " << i;
          worst = std::max(worst, promise.share(got.l[k][i], hit, rays[i], surface.size()));
        }
      }
    }
    std::printf("%s %s: %zu in double, %zu in double-double, %zu exact, worst %.2f condition units\n",
                GetParam().name.c_str(), std::string(family.name).c_str(), by_tier[1], by_tier[2], by_tier[3],
                worst * promise.bound);
    EXPECT_LE(worst, 1) << family.name;
    const bool is_ordinary = family.name == "camera" || family.name == "flat" || family.name == "far";
    if (is_ordinary && GetParam().is_kind) {
      const auto hard = static_cast<double>(by_tier[2] + by_tier[3]);
      EXPECT_LE(hard, kMostHard * 2 * static_cast<double>(count)) << family.name;
    }
  }
}

/// Both hits of a kernel and of the ladder are placed on the profile by where they are, not by an equation.
TEST_P(BezierKernel, HitsHaveTheNormalsOfTruth) {
  const SurfaceSpec spec = bezier(GetParam().points);
  const auto truth = truth::make_surface(spec);
  const SurfaceEntry entry =
      surface_entry<BezierRevolution>("bezier_revolution", {kernel_entry<BezierRevolutionCertified>()});
  Scene scene;
  scene.add(entry, spec, find_solver("certified"));
  const std::vector<Ray> rays = rays_of(find_family("camera"), *entry.make(spec), kSeed, 200);
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, Query::all, {.points = false, .normals = true, .params = true}, work, hits);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const truth::Answer right = truth->all(rays[i], {.digits = 17});
    if (right.hits.size() != hits.end(i) - hits.begin(i)) continue;  // the ladder may be uncertain
    for (std::size_t k = 0; k < right.hits.size(); ++k) {
      const truth::Hit& hit = right.hits[k];
      const std::size_t at = hits.begin(i) + k;
      if (hit.cosine < 1e-3) continue;
      // 1e-9: t of a hit is as good as the square root of the rounding where the profile turns.
      EXPECT_LT(max_abs(hits.normal[at] - hit.normal), 1e-9) << i;
      ++compared;
    }
  }
  EXPECT_GT(compared, 100U);
}

INSTANTIATE_TEST_SUITE_P(Profiles, BezierKernel, testing::ValuesIn(profiles()),
                         [](const auto& profile) { return profile.param.name; });

/// Ten control points or more, a disk, a body far from y = 0 and one at the end of the range are not for the
/// lanes.
TEST(BezierKernelLimits, WhatLanesCannotHandleOthersDecide) {
  const auto arc = [](int points) {
    Table table;
    for (int i = 0; i < points; ++i)
      table.push_back({1.0 + 0.1 * i * (points - 1 - i), static_cast<double>(i)});
    return table;
  };
  const Table disk{{0, 1}, {2, 1}}, high{{1, 100}, {1, 102}}, tiny{{0x1p-1040, 0}, {0, 0x1p-1040}};
  for (const Table& points : {arc(10), arc(17), disk, high, tiny}) {
    const SurfaceSpec spec = bezier(points);
    const auto truth = truth::make_surface(spec);
    const double height = points[0][1] + 0.4 * (points.back()[1] - points[0][1]);
    const std::vector<Ray> rays{{{-9, height, 0}, {1, 0.01, 0}},
                                {{-9, height, 0}, {1, 0x1p-1060, 0}},
                                {{0, -1, 0}, {0x1p-1050, 0x1p-1000, 0}},
                                {{-9, height + 0.5, 0x1p-1041}, {1, 0, 0}}};
    for (const bool all : {false, true}) {
      const KernelAnswers got = answer(spec, rays, all);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const truth::Answer right = truth->all(rays[i], {.digits = 17});
        ASSERT_NE(got.hits[i], KernelAnswers::kOpen) << points.size() << " " << i;
        ASSERT_EQ(got.hits[i] == KernelAnswers::kCoincident, right.status == Status::coincident)
            << points.size() << " " << i;
        if (right.status != Status::ok) continue;
        const std::size_t hits = all ? right.hits.size() : std::min<std::size_t>(1, right.hits.size());
        ASSERT_EQ(static_cast<std::size_t>(got.hits[i]), hits) << points.size() << " " << i;
        for (std::size_t k = 0; k < hits; ++k)
          EXPECT_NEAR(got.l[k][i], right.hits[k].l.head, 0x1p-50 * right.hits[k].l.head);
      }
    }
  }
  EXPECT_EQ(answer(bezier(arc(18)), std::vector<Ray>{{{-9, 1, 0.1}, {1, 0.01, 0}}}, true).hits[0],
            KernelAnswers::kOpen);
}

/// A profile that winds about a cylinder of radius 2: a ray along it has more hits than a batch has places
/// for.
TEST(BezierKernelLimits, ManyHitsAreAllThere) {
  const SurfaceSpec spec = bezier({{0, 0}, {20, 1}, {-40, 2}, {60, 3}, {-40, 4}, {20, 5}, {0, 6}});
  const auto truth = truth::make_surface(spec);
  std::size_t most = 0;
  Rng rng(kSeed);
  for (int i = 0; i < 200; ++i) {
    std::vector<Ray> rays(3, Ray{{3 * rng.uniform(), -1, 0}, {rng.uniform() - 0.5, 4, 0}});
    const truth::Answer right = truth->all(rays[0], {.digits = 17});
    const KernelAnswers got = answer(spec, rays, true);
    most = std::max(most, right.hits.size());
    for (std::size_t ray = 0; ray < rays.size(); ++ray) {
      ASSERT_EQ(static_cast<std::size_t>(got.hits[ray]), right.hits.size());
      for (std::size_t k = 0; k < right.hits.size(); ++k)
        EXPECT_NEAR(got.l[k][ray], right.hits[k].l.head, 0x1p-48 * right.hits[k].l.head);
    }
  }
  EXPECT_GT(most, KernelAnswers::kMost);
}

/// Y turns where R = 2 and Y = 1: a level ray there meets two sheets at once.
SurfaceSpec arch() { return bezier({{1, 0}, {2, 2}, {3, 0}}); }

/// The answers of a scene, through the kernel's own way (a lone surface) or with others beside it.
HitBuffer seen(const SurfaceSpec& spec, std::string_view solver, bool is_alone, std::span<const Ray> rays) {
  Scene scene;
  scene.add(find_surface(spec.type), spec, find_solver(solver));
  // Out of reach of the rays.
  if (!is_alone)
    scene.add(find_surface("sphere"), parse_surface("sphere:radius=1,center=[0,1000,0]"),
              find_solver(solver));
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, Query::all, {}, work, hits);
  return hits;
}

TEST(BezierKernelLimits, MultiplicitiesAboveTwoAreTold) {
  // A tangent of the circle, one through it, the first again, one past it, one that climbs.
  const std::vector<Ray> rays{{{-3, 1, 2}, {1, 0, 0}},
                              {{-3, 1, 0}, {1, 0, 0}},
                              {{-3, 1, 2}, {1, 0, 0}},
                              {{-3, 1, 2.5}, {1, 0, 0}},
                              {{-3, 0.5, 0}, {1, 0.125, 0}}};
  const auto truth = truth::make_surface(arch());
  std::uint32_t most = 0;
  for (const std::string_view solver : {"certified", "faithful"}) {
    for (const bool is_alone : {true, false}) {
      const HitBuffer got = seen(arch(), solver, is_alone, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const truth::Answer right = truth->all(rays[i], {});
        ASSERT_EQ(got.count(i), right.hits.size()) << solver << " " << i;
        for (std::size_t k = 0; k < right.hits.size(); ++k) {
          const std::uint32_t multiplicity = got.multiplicity[got.begin(i) + k];
          EXPECT_EQ(multiplicity, right.hits[k].multiplicity) << solver << " " << i << " alone " << is_alone;
          most = std::max(most, multiplicity);
        }
      }
    }
  }
  EXPECT_EQ(most, 4U);
}

TEST(BezierKernelLimits, RaysInsideTheSurfaceAreCoincident) {
  // Along a ruling of the cone, from outside and from the tip, in numbers whose products are no doubles; away
  // from it; past it.
  const SurfaceSpec cone = bezier({{1.25, 0}, {0, 2}});
  const double k = 0x1p27 + 1, m = 1 + 0x1p-27;
  const std::vector<Ray> rays{{{0.75 + 0.75 * m, -2 * m, 1 + m}, {-0.75 * k, 2 * k, -k}},
                              {{0, 2, 0}, {0.75 * k, -2 * k, k}},
                              {{0, 2, 0}, {-0.75 * k, 2 * k, -k}},
                              {{0.75 + 0.75 * m, -2 * m, 1.5 + m}, {-0.75 * k, 2 * k, -k}}};
  const std::array expected{Status::coincident, Status::coincident, Status::ok, Status::ok};
  const auto truth = truth::make_surface(cone);
  for (const std::string_view solver : {"certified", "faithful"}) {
    for (const bool is_alone : {true, false}) {
      const HitBuffer got = seen(cone, solver, is_alone, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(got.status[i], expected[i]) << solver << " " << i << " alone " << is_alone;
        EXPECT_EQ(got.count(i), truth->all(rays[i], {}).hits.size()) << solver << " " << i;
      }
    }
  }
}

}  // namespace
}  // namespace graze::test
