// shards: 8
// What every (surface, formulation, solver) cell of the build must do, one named case a cell; and that a
// surface defined here, outside the library, is as good as a built-in one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <graze/surfaces/coefficients.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class SurfaceCell : public testing::TestWithParam<Cell> {
 protected:
  /// Solvers from random starts cost the most.
  static std::size_t each() {
    if (!GetParam().solver->info.claims.deterministic) return 6;
    return kSanitized ? 8 : 40;
  }
  static std::vector<SurfaceSpec> specs() { return examples(GetParam().surface->name); }
  static std::vector<Ray> rays(const SurfaceSpec& spec) {
    return mixed_rays(*GetParam().surface->make(spec), each(), kSeed);
  }
};

Vec3 times_power(Vec3 v, int k) { return {std::ldexp(v.x, k), std::ldexp(v.y, k), std::ldexp(v.z, k)}; }

/// Every length of the surface times 2^k.
SurfaceSpec scaled(const SurfaceEntry& entry, SurfaceSpec spec, int k) {
  spec.parameters = entry.scaled(spec.parameters, std::ldexp(1.0, k));
  return spec;
}

/// Scales lengths by 2^length and directions by 2^direction, and what the answers must then be.
void expect_scaling(const Cell& cell, const SurfaceSpec& spec, const std::vector<Ray>& rays, int length,
                    int direction) {
  const std::vector<Answer> original = ask(cell.scene(spec), rays);
  std::vector<Ray> moved = rays;
  for (Ray& ray : moved) ray = {times_power(ray.o, length), times_power(ray.d, direction)};
  const std::vector<Answer> answers = ask(cell.scene(scaled(*cell.surface, spec, length)), moved);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Answer expected = original[i];
    for (double& l : expected.l) l = std::ldexp(l, length - direction);
    for (Vec3& point : expected.point) point = times_power(point, length);
    ASSERT_EQ(answers[i], expected) << "ray " << i << ", lengths by 2^" << length << ", d by 2^" << direction;
  }
}

TEST_P(SurfaceCell, ScalingSceneAndRayByPowersOfTwoChangesNothingButTheScale) {
  for (const SurfaceSpec& spec : specs()) {
    const std::vector<Ray> all = rays(spec);
    for (const int k : {-300, -40, -1, 1, 40, 300}) {
      expect_scaling(GetParam(), spec, all, k, k);
      expect_scaling(GetParam(), spec, all, k, 0);
      expect_scaling(GetParam(), spec, all, 0, k);
    }
  }
}

TEST_P(SurfaceCell, AnswersDependNeitherOnOrderNorOnBatchSizeNorOnTheWorkspace) {
  for (const SurfaceSpec& spec : specs()) {
    const Scene scene = GetParam().scene(spec);
    std::vector<Ray> all = rays(spec);
    // More than two blocks of rays, so that block borders are crossed.
    const std::size_t distinct = all.size();
    if (GetParam().solver->info.claims.deterministic) {
      while (all.size() < 2 * Scene::kBlock + 7) all.push_back(all[all.size() - distinct]);
    }
    const std::vector<Answer> together = ask(scene, all);
    ASSERT_EQ(together.size(), all.size());
    std::vector<Ray> reversed(all.rbegin(), all.rend());
    std::vector<Answer> backwards = ask(scene, reversed);
    std::reverse(backwards.begin(), backwards.end());
    EXPECT_EQ(backwards, together);
    Scene::Workspace used;
    HitBuffer one_by_one;
    for (const Ray& ray : all) scene.intersect({&ray, 1}, Query::all, kEverything, used, one_by_one);
    EXPECT_EQ(answers_of(one_by_one), together);
    for (std::size_t i = 0; i < distinct; i += 5) EXPECT_EQ(ask(scene, {&all[i], 1})[0], together[i]);
  }
}

TEST_P(SurfaceCell, HitsAreSortedPositiveFiniteAndCarryUnitNormalsAndTheirPoints) {
  std::size_t hits = 0;
  for (const SurfaceSpec& spec : specs()) {
    const std::vector<Ray> all = rays(spec);
    const std::vector<Answer> answers = ask(GetParam().scene(spec), all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Answer& answer = answers[i];
      EXPECT_TRUE(std::is_sorted(answer.l.begin(), answer.l.end()));
      EXPECT_EQ(std::adjacent_find(answer.l.begin(), answer.l.end()), answer.l.end()) << "hits are distinct";
      for (std::size_t k = 0; k < answer.l.size(); ++k) {
        ++hits;
        EXPECT_GT(answer.l[k], 0);
        EXPECT_TRUE(std::isfinite(answer.l[k]));
        EXPECT_GE(answer.multiplicity[k], 1U);
        EXPECT_NEAR(norm(answer.normal[k]), 1, 4 * std::numeric_limits<double>::epsilon());
        EXPECT_EQ(answer.point[k].x, std::fma(answer.l[k], all[i].d.x, all[i].o.x));
      }
    }
  }
  EXPECT_GT(hits, each()) << "the rays must hit for this test to say anything";
}

TEST_P(SurfaceCell, QueriesFirstAndAnyAgreeWithAll) {
  for (const SurfaceSpec& spec : specs()) {
    const std::vector<Ray> all_rays = rays(spec);
    const Scene scene = GetParam().scene(spec);
    const std::vector<Answer> all = ask(scene, all_rays);
    const std::vector<Answer> first = ask(scene, all_rays, Query::first);
    const std::vector<Answer> any = ask(scene, all_rays, Query::any);
    for (std::size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(first[i].l.size(), std::min<std::size_t>(1, all[i].l.size()));
      ASSERT_EQ(any[i].l.size(), first[i].l.size());
      EXPECT_EQ(first[i].status, all[i].status);
      if (first[i].l.empty()) continue;
      if (GetParam().has_kernel()) {
        // A kernel may prove the first hit by another tier when it need not look for the others: both are
        // within 4 condition units of the truth.
        const double d = norm(all_rays[i].d);
        const double cosine = std::fabs(dot(all[i].normal[0], all_rays[i].d)) / d;
        const double unit = std::numeric_limits<double>::epsilon() *
                            (all[i].l[0] + GetParam().surface->make(spec)->size() / d / cosine);
        EXPECT_NEAR(first[i].l[0], all[i].l[0], 8 * unit);
        EXPECT_EQ(any[i].l[0], first[i].l[0]);
        continue;
      }
      EXPECT_EQ(first[i].l[0], all[i].l[0]);
      EXPECT_EQ(first[i].normal[0], all[i].normal[0]);
      EXPECT_EQ(first[i].params[0], all[i].params[0]);
      EXPECT_NE(std::find(all[i].l.begin(), all[i].l.end(), any[i].l[0]), all[i].l.end());
    }
  }
}

TEST_P(SurfaceCell, RaysThatAreNoQuestionAreInvalidAndLeaveTheirNeighboursAlone) {
  const SurfaceSpec spec = specs().front();
  const Scene scene = GetParam().scene(spec);
  const std::vector<Ray> good = rays(spec);
  const std::vector<Answer> alone = ask(scene, good);
  const std::array<Ray, 8> bad{Ray{{kNaN, 0, 0}, {1, 0, 0}}, Ray{{0, kInfinity, 0}, {0, 1, 0}},
                               Ray{{0, 0, 5}, {0, 0, kNaN}}, Ray{{0, 0, 5}, {0, -kInfinity, 1}},
                               Ray{{0, 0, 5}, {0, 0, 0}},    Ray{{1, 1, -kInfinity}, {0, 0, 1}},
                               Ray{{0, 1, 5}, {-0.0, 0, 0}}, Ray{{kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}}};
  std::vector<Ray> mixed;
  for (std::size_t i = 0; i < good.size(); ++i) {
    mixed.push_back(bad[i % bad.size()]);
    mixed.push_back(good[i]);
  }
  const std::vector<Answer> answers = ask(scene, mixed);
  for (std::size_t i = 0; i < good.size(); ++i) {
    EXPECT_EQ(answers[2 * i].status, Status::invalid) << "bad ray " << i % bad.size();
    EXPECT_TRUE(answers[2 * i].l.empty());
    EXPECT_EQ(answers[2 * i + 1], alone[i]);
  }
}

TEST_P(SurfaceCell, ExtremeRaysEndWithoutNonsense) {
  const Scene scene = GetParam().scene(specs().front());
  std::vector<Ray> all;
  for (const double size : {5e-324, 1e-310, 1e-300, 1e-160, 1e160, 1e300, 1.7e308}) {
    all.push_back({{size, size, -size}, {1, 1, 1}});
    all.push_back({{0, 1, -5}, {size, 0, size}});
    all.push_back({{-5, 1, 0}, {1, size, 0}});
    all.push_back({{size, size, size}, {-size, -size, -size}});
    all.push_back({{0, size, 0}, {0, -1, 0}});
  }
  for (const Answer& answer : ask(scene, all)) {
    for (const double l : answer.l) EXPECT_TRUE(std::isfinite(l) && l > 0);
  }
}

/// Exact: a quarter turn about the y axis.
Vec3 quarter_turn(Vec3 v) { return {v.z, v.y, -v.x}; }

TEST_P(SurfaceCell, AQuarterTurnAboutTheAxisKeepsTheHits) {
  const SurfaceSpec spec = specs().front();
  const auto surface = GetParam().surface->make(spec);
  if (!surface->landmarks().has_axis) GTEST_SKIP() << "no axis";
  const std::size_t count = GetParam().solver->info.claims.deterministic ? 300 : 30;
  const std::vector<Ray> all = camera_rays(*surface, count, kSeed);
  std::vector<Ray> turned = all;
  for (Ray& ray : turned) ray = {quarter_turn(ray.o), quarter_turn(ray.d)};
  const Scene scene = GetParam().scene(spec, 30);
  const std::vector<Answer> a = ask(scene, all);
  const std::vector<Answer> b = ask(scene, turned);
  std::size_t different = 0;
  double worst = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (a[i].l.size() != b[i].l.size()) {
      ++different;
      continue;
    }
    for (std::size_t k = 0; k < a[i].l.size(); ++k) {
      worst = std::max(worst, std::fabs(a[i].l[k] - b[i].l[k]) / a[i].l[k]);
    }
  }
  std::printf("%s: %zu of %zu rays differ in count, worst relative difference %.2g\n",
              GetParam().name().c_str(), different, count, worst);
  // Random starts differ between the two, and may find a different number of roots on a few rays; in float
  // the rounding of coefficients in a bad basis may lose a pair on one side and not on the other.
  const std::size_t allowed = GetParam().in_float() ? count / 50 : 0;
  EXPECT_LE(different, GetParam().solver->info.claims.deterministic ? allowed : count / 5);
  // A grazing hit may lose half of a float's 24 bits, and the condition of the basis as much again.
  EXPECT_LE(worst, GetParam().in_float() ? 0.25 : 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Cells, SurfaceCell, testing::ValuesIn(all_cells()),
                         [](const auto& cell) { return cell.param.name(); });

// ------------------------------------------------------------------------------- a surface of the user's own

/// A ball about the origin, in the fewest lines the concept allows: one formulation, a quadratic in l.
struct Ball;

struct BallQuadratic {
  static FormulationInfo info() { return {"quadratic", "|o + l d|^2 = r^2", "school", {Form::polynomial}}; }
  explicit BallQuadratic(const Ball& ball);
  void pose(const LocalRay& ray, EquationBlock& block) const {
    pose_polynomial(block, 0, Basis::power, ray.lo, ray.hi, {}, [&](auto number) {
      using T = decltype(number);
      const auto [x, y, z] = recentred_point<T>(ray);
      const T dx = exactly<T>(ray.d.x), dy = exactly<T>(ray.d.y), dz = exactly<T>(ray.d.z);
      const T r = exactly<T>(radius);
      return std::array<T, 3>{x * x + y * y + z * z - r * r, exactly<T>(2) * (x * dx + y * dy + z * dz),
                              dx * dx + dy * dy + dz * dz};
    });
  }
  void lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
            std::vector<LocalHit>& hits) const {
    hits.push_back({.multiplicity = root.multiplicity, .delta = root.x});
  }
  double radius;
};

struct Ball {
  using Formulations = std::tuple<BallQuadratic>;
  static SurfaceInfo info() {
    SurfaceInfo info;
    info.summary = "a ball";
    info.parameters = {"radius"};
    info.params = {"a", "b"};
    return info;
  }
  static Parameters scaled(const Parameters& parameters, double factor) {
    constexpr std::array kLengths{Length{"radius"}};
    return scale_lengths(parameters, kLengths, factor);
  }
  explicit Ball(const SurfaceSpec& spec) : size_(spec.parameters.number("radius")) {
    if (size_ <= 0) throw std::invalid_argument("parameter 'radius' must be positive");
    radius = scale_by_power(size_, -unit());
  }
  [[nodiscard]] int unit() const { return exponent_of(size_); }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] Bounds bounds() const { return box_about({}, {size_, size_, size_}); }
  [[nodiscard]] bool clip(LocalRay& ray) const {
    recentre(ray, {}, 4 * radius);
    ray.lo = std::max(-ray.centre, -8 * radius);
    ray.hi = 8 * radius;
    return ray.lo <= ray.hi;
  }
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const {
    return {normalized(ray.at(hit.delta)), {}};
  }
  [[nodiscard]] SurfaceSample sample(double u, double /*v*/) const { return {{size_ * u, 0, 0}, {1, 0, 0}}; }
  [[nodiscard]] Landmarks landmarks() const {
    Landmarks marks;
    marks.half = {size_, size_, size_};
    return marks;
  }

  double radius = 1;

 private:
  double size_;
};

BallQuadratic::BallQuadratic(const Ball& ball) : radius(ball.radius) {}

static_assert(SurfaceType<Ball>);

SurfaceSpec ball(double radius) {
  SurfaceSpec spec;
  spec.type = "ball";
  spec.parameters.set("radius", radius);
  return spec;
}

TEST(OpenSurface, ASurfaceDefinedOutsideTheLibraryIsSolvedByEverySolverThatTakesItsForm) {
  const SurfaceEntry entry = surface_entry<Ball>("ball");
  std::size_t solvers = 0;
  for (const SolverEntry& solver : solver_registry()) {
    if (all_pairings(solver, entry).empty()) continue;
    ++solvers;
    Scene scene;
    scene.add(entry, ball(3), solver);
    const std::vector<Ray> rays{{{0, 0, -5}, {0, 0, 1}}, {{0, 0, 0}, {2, 0, 0}}, {{0, 4, -5}, {0, 0, 1}}};
    const std::vector<Answer> answers = ask(scene, rays);
    ASSERT_EQ(answers[0].l.size(), 2U) << solver.name;
    EXPECT_NEAR(answers[0].l[0], 2, 1e-10);
    EXPECT_NEAR(answers[0].l[1], 8, 1e-10);
    EXPECT_NEAR(answers[0].normal[0].z, -1, 1e-10);
    ASSERT_EQ(answers[1].l.size(), 1U) << solver.name;
    EXPECT_NEAR(answers[1].l[0], 1.5, 1e-10);
    EXPECT_TRUE(answers[2].l.empty()) << solver.name;
    EXPECT_EQ(answers[2].status, Status::ok);
  }
  EXPECT_GT(solvers, 0U);
}

TEST(OpenSurface, ItsEntryChecksParametersAndFormulationsAsTheBuiltInOnesDo) {
  const SurfaceEntry entry = surface_entry<Ball>("ball");
  EXPECT_THROW(entry.make(ball(-1)), std::invalid_argument);
  SurfaceSpec misspelt = ball(1);
  misspelt.parameters.set("radios", 1.0);
  EXPECT_THROW(entry.make(misspelt), std::invalid_argument);
  for (const SolverEntry& solver : solver_registry()) {
    EXPECT_THROW(pair_up(solver, entry, "quadratik"), std::invalid_argument) << solver.name;
  }
}

TEST(SurfaceRegistry, EverySurfaceSaysWhatItIs) {
  for (const SurfaceEntry& surface : surface_registry()) {
    EXPECT_FALSE(surface.info.summary.empty()) << surface.name;
    EXPECT_FALSE(surface.info.source.empty()) << surface.name;
    EXPECT_FALSE(surface.formulations.empty()) << surface.name;
    for (const FormulationInfo& formulation : surface.formulations) {
      EXPECT_FALSE(formulation.forms.empty()) << surface.name << " " << formulation.name;
      EXPECT_FALSE(formulation.source.empty()) << surface.name << " " << formulation.name;
    }
    for (const SurfaceSpec& spec : examples(surface.name)) EXPECT_GT(surface.make(spec)->size(), 0);
  }
}

TEST(SurfaceRegistry, UnknownNamesNameTheNearest) {
  if (!has_surface("teardrop")) GTEST_SKIP() << "this build has no teardrop";
  try {
    find_surface("teardrob");
    FAIL() << "must throw";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("teardrop"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace graze::test
