// Kernels of surfaces: never wrong, the same on every instruction set, and no part of one in another's code.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdio>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/solvers/math/instruction_set.hpp>
#include <graze/solvers/math/rng.hpp>
#include <surfaces/cells.hpp>

#include "family_rays.hpp"

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

/// More surfaces than the contract's examples: profiles that fold back in height, one of a degree that only
/// the later tiers of `certified` take, and a cone.
std::vector<SurfaceSpec> specs_of(std::string_view type) {
  std::vector<SurfaceSpec> specs = examples(type);
  if (type == "bezier_revolution") {
    specs.push_back(bezier({{0, 0}, {4, 3}, {3, -2}, {0, 6}}));
    specs.push_back(bezier({{1, 0}, {-2, 3}, {3, -3}, {4, 4}, {0.5, 1}}));
    specs.push_back(bezier({{2, 0}, {3, 1}, {1, 1}, {2, 2}, {4, 3}, {1, 3}, {2, 4}, {1, 5}, {3, 5}, {0, 6}}));
    specs.push_back(bezier({{3, -1}, {1, 2}}));
  }
  return specs;
}

struct KernelCell {
  const SurfaceEntry* surface;
  const KernelEntry* kernel;
};

std::vector<KernelCell> kernels() {
  std::vector<KernelCell> cells;
  for (const SurfaceEntry& surface : surface_registry()) {
    for (const KernelEntry& kernel : surface.kernels) cells.push_back({&surface, &kernel});
  }
  return cells;
}

void PrintTo(const KernelCell& cell, std::ostream* out) {
  *out << cell.surface->name << " " << cell.kernel->solver;
}

class Kernel : public testing::TestWithParam<KernelCell> {
 protected:
  static KernelAnswers run(const SurfaceSpec& spec, std::span<const Ray> rays, bool all,
                           InstructionSet set = best_instruction_set()) {
    Parameters options;
    options.set("instruction_set", std::string(to_string(set)));
    const auto kernel = GetParam().kernel->make(options);
    kernel->add(spec);
    KernelAnswers answers;
    kernel->intersect(rays, all, answers);
    return answers;
  }
};

/// What the kernel leaves open is not wrong; what it answers must be the truth, l as near as promised.
TEST_P(Kernel, AnswersEveryFamilyRightOrLeavesItOpen) {
  const Promise& promised = promise_of(GetParam().kernel->solver);
  const std::size_t count = rays_a_family(1000, 200);
  // It takes more digits of the truth to see ulps.
  const int digits = promised.in_ulps ? 34 : 17;
  for (const SurfaceSpec& spec : specs_of(GetParam().surface->name)) {
    const auto surface = GetParam().surface->make(spec);
    const auto truth = truth::make_surface(spec);
    for (const CaseFamily& family : case_families()) {
      if (family.name == "scale" || !family.suits(surface->landmarks())) continue;
      const std::vector<Ray> rays = rays_of(family, *surface, kSeed, count);
      const KernelAnswers all = run(spec, rays, true), first = run(spec, rays, false);
      std::size_t open = 0, wrong = 0;
      double worst = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const truth::Answer answer = truth->all(rays[i], {.digits = digits});
        const auto expect = [&](const KernelAnswers& got, std::size_t wanted) {
          if (got.hits[i] == KernelAnswers::kOpen) {
            ++open;
            return;
          }
          if (got.hits[i] == KernelAnswers::kCoincident) {
            EXPECT_EQ(answer.status, Status::coincident) << family.name << " " << i;
            return;
          }
          if (static_cast<std::size_t>(got.hits[i]) != wanted || answer.status != Status::ok) {
            ++wrong;
            ADD_FAILURE() << family.name << std::hexfloat << " o " << rays[i].o.x << " " << rays[i].o.y << " "
                          << rays[i].o.z << " d " << rays[i].d.x << " " << rays[i].d.y << " " << rays[i].d.z
                          << std::defaultfloat << ": " << int{got.hits[i]} << " hits, truth " << wanted;
            return;
          }
          for (std::size_t k = 0; k < wanted; ++k) {
            const truth::Hit& hit = answer.hits[k];
            EXPECT_EQ(got.multiplicity(i, static_cast<int>(k)), hit.multiplicity) << family.name << " " << i;
            worst = std::max(worst, promised.share(got.l[k][i], hit, rays[i], surface->size()));
          }
        };
        expect(all, answer.hits.size());
        expect(first, std::min<std::size_t>(1, answer.hits.size()));
      }
      std::printf("%s %-10s %zu rays: %zu wrong, %zu open, worst %.2f %s\n",
                  std::string(GetParam().surface->name).c_str(), std::string(family.name).c_str(),
                  rays.size(), wrong, open, worst * promised.bound, promised.unit());
      EXPECT_LE(worst, 1) << family.name;
    }
  }
}

TEST_P(Kernel, EveryInstructionSetGivesTheSameBits) {
  for (const SurfaceSpec& spec : specs_of(GetParam().surface->name)) {
    const auto surface = GetParam().surface->make(spec);
    for (const CaseFamily& family : case_families()) {
      if (family.name == "scale" || !family.suits(surface->landmarks())) continue;
      const std::vector<Ray> rays = rays_of(family, *surface, kSeed, 500);
      for (const bool all : {false, true}) {
        const KernelAnswers best = run(spec, rays, all);
        for (const auto set : {InstructionSet::baseline, InstructionSet::avx2}) {
          if (set > best_instruction_set()) continue;
          const KernelAnswers other = run(spec, rays, all, set);
          ASSERT_EQ(other.hits, best.hits) << family.name << " " << to_string(set);
          for (std::size_t i = 0; i < rays.size(); ++i) {
            for (int k = 0; k < best.hits[i]; ++k) {
              const auto at = static_cast<std::size_t>(k);
              EXPECT_EQ(std::bit_cast<std::uint64_t>(other.l[at][i]),
                        std::bit_cast<std::uint64_t>(best.l[at][i]));
            }
          }
        }
      }
    }
  }
}

TEST_P(Kernel, ARaysAnswerDoesNotDependOnItsNeighbours) {
  const SurfaceSpec spec = examples(GetParam().surface->name).front();
  const auto surface = GetParam().surface->make(spec);
  const std::vector<Ray> rays = mixed_rays(*surface, 100, kSeed);
  const KernelAnswers together = run(spec, rays, true);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const KernelAnswers alone = run(spec, std::span(rays).subspan(i, 1), true);
    ASSERT_EQ(alone.hits[0], together.hits[i]) << i;
    for (int k = 0; k < alone.hits[0]; ++k)
      EXPECT_EQ(alone.l[static_cast<std::size_t>(k)][0], together.l[static_cast<std::size_t>(k)][i]);
  }
}

TEST_P(Kernel, RaysThatAreNoQuestionAreLeftOpen) {
  const SurfaceSpec spec = examples(GetParam().surface->name).front();
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<Ray> rays{{{0, 1, 5}, {0, 0, 0}},
                              {{kNaN, 1, 5}, {0, 0, -1}},
                              {{0, 1, 5}, {0, kNaN, -1}},
                              {{kInfinity, 1, 5}, {0, 0, -1}},
                              {{0, 1, 5}, {0, -kInfinity, 0}}};
  for (const bool all : {false, true}) {
    const KernelAnswers answers = run(spec, rays, all);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(answers.hits[i], KernelAnswers::kOpen) << i;
  }
}

/// A scene of one surface and nothing asked but l takes a shorter way.
TEST_P(Kernel, TheShortWayAnswersAsTheLongOne) {
  for (const SurfaceSpec& spec : examples(GetParam().surface->name)) {
    const auto surface = GetParam().surface->make(spec);
    Scene scene;
    scene.add(*GetParam().surface, spec, find_solver(GetParam().kernel->solver));
    const std::vector<Ray> rays = mixed_rays(*surface, 300, kSeed);
    for (const Query query : {Query::all, Query::first, Query::any}) {
      Scene::Workspace work;
      HitBuffer short_way, long_way;
      scene.intersect(rays, query, {}, work, short_way);
      scene.intersect(rays, query, {.points = true}, work, long_way);
      EXPECT_EQ(short_way.l, long_way.l);
      EXPECT_EQ(short_way.status, long_way.status);
      EXPECT_EQ(short_way.multiplicity, long_way.multiplicity);
      EXPECT_GT(short_way.l.size(), rays.size() / 8);
    }
  }
}

/// The profile meets itself at r = 18, y = 0, t = 1/4 and 3/4: two pieces of it are hit a few ulps apart.
TEST(BezierRevolutionKernel, TheFirstOfTwoHitsBesideACrossingIsTheFirstWithinAnUlp) {
  if (solver_named("faithful") == nullptr) GTEST_SKIP() << "faithful is not in this build";
  const SurfaceSpec spec = bezier({{9, -9}, {25, 13}, {25, -13}, {9, 9}});
  const auto truth = truth::make_surface(spec);
  const Scene scene = scene_of(spec, find_solver("faithful"));
  Rng rng(kSeed);
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) {
    const double angle = rng.uniform(0, 6.28), off = std::exp2(rng.uniform(-52, -44));
    const auto near = [&](double x) { return x + off * rng.uniform(-18, 18); };
    const Vec3 from{rng.uniform(19, 20), rng.uniform(-0.1, 0.1), rng.uniform(-1, 1)};
    const Vec3 to{near(18 * std::cos(0.1 * angle)), near(0), near(18 * std::sin(0.1 * angle))};
    rays.push_back({from, {to.x - from.x, to.y - from.y, to.z - from.z}});
  }
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, Query::first, {}, work, hits);
  double worst = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const truth::Hit hit = truth->all(rays[i], {.digits = 34}).hits.at(0);
    ASSERT_EQ(hits.end(i) - hits.begin(i), 1U);
    const double error = std::fabs((hits.l[hits.begin(i)] - hit.l.head) - hit.l.tail) / ulp(hit.l.head);
    EXPECT_LE(error, 1) << i;
    worst = std::max(worst, error);
  }
  std::printf("worst %.2f ulps\n", worst);
}

/// Past the apex the equation goes on as the mirrored tip, which these rays meet 4e-14 above it.
TEST_P(Kernel, RaysPastTheApexMiss) {
  if (GetParam().surface->name != "teardrop") GTEST_SKIP() << "no apex";
  const std::vector<Ray> rays{{{0x1.f1a786be89b74p+2, 0x1.f65bd09f86bbp+3, 0x1.92515d76b141bp-4},
                               {-0x1.4041f946fb4a3p-1, -0x1.8f73f275994cp-1, -0x1.02e7c529cd012p-7}},
                              {{0x1.ac379bfc92561p+1, 0x1.25ec165043eb1p+4, 0x1.22e6b7ab6f0fcp+3},
                               {-0x1.b414446903c19p-3, -0x1.931cad641af4ap-1, -0x1.283dfa77d23c4p-1}},
                              {{0x1.38ed02c2e6cb7p-4, 0x1.36112d261d839p+3, -0x1.738c8e321515bp+1},
                               {-0x1.0a97c3e4beda9p-6, -0x1.9257af9fbb15ap-1, 0x1.3c893c4fa60b1p-1}},
                              {{0x1.f99244719008cp+0, 0x1.d8899e468f946p+3, 0x1.a13bd9d789c3dp+2},
                               {-0x1.6c4e0d6d4b174p-3, -0x1.944cc26a7551ap-1, -0x1.2ca68b270dfbp-1}}};
  SurfaceSpec spec;
  spec.type = "teardrop";
  spec.parameters.set("s", 1.0);
  for (const bool all : {false, true}) {
    const KernelAnswers answers = run(spec, rays, all);
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(answers.hits[i], 0) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Kernel, testing::ValuesIn(kernels()), [](const auto& cell) {
  return std::string(cell.param.surface->name) + "_" + std::string(cell.param.kernel->solver);
});

}  // namespace
}  // namespace graze::test
