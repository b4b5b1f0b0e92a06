// Surfaces from callables: as scenes' surfaces, and by themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include <graze/surfaces/implicit.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

struct UnitSphere {
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    return x * x + y * y + z * z - 1.0;
  }
};

/// R = 1, r = 1/4.
struct Ring {
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    using std::sqrt;
    const T out = sqrt(x * x + z * z) - 1.0;
    return out * out + y * y - 0.0625;
  }
};

struct Gyroid {
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    using std::cos;
    using std::sin;
    return sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
  }
};

/// A sphere of radius 1 with waves of the given height: state from a parameter.
struct WavySphere {
  static std::vector<std::string_view> parameters() { return {"height"}; }
  explicit WavySphere(const Parameters& given) : height(given.number("height")) {}
  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    using std::sin;
    return x * x + y * y + z * z - 1.0 + height * (sin(6.0 * x) * (sin(6.0 * y) * sin(6.0 * z)));
  }
  double height;
};

const Bounds kBox{{-2, -2, -2}, {2, 2, 2}};

const SolverEntry* certified_solver() {
  for (const SolverEntry& solver : solver_registry()) {
    if (solver.info.claims.certified && solver.takes(Form::interval, Precision::binary64)) return &solver;
  }
  return nullptr;
}

Scene scene_of(const SurfaceEntry& entry, const SurfaceSpec& spec, const SolverEntry& solver) {
  Scene scene;
  scene.add(entry, spec, solver);
  return scene;
}

TEST(Implicit, ASphereAsACallableIsHitWhereItIs) {
  const SolverEntry* const solver = certified_solver();
  if (solver == nullptr) GTEST_SKIP() << "this build has no certified solver";
  const SurfaceEntry entry = implicit_entry("ball", UnitSphere{});
  const std::vector<Ray> rays{{{0, 0, -3}, {0, 0, 1}}, {{0.5, 0, 0}, {2, 0, 0}}, {{1.5, 0, -3}, {0, 0, 1}}};
  const std::vector<Answer> answers = ask(scene_of(entry, implicit_spec("ball", kBox), *solver), rays);
  ASSERT_EQ(answers[0].l.size(), 2U);
  EXPECT_NEAR(answers[0].l[0], 2, 1e-11);
  EXPECT_NEAR(answers[0].l[1], 4, 1e-11);
  EXPECT_NEAR(answers[0].normal[0].z, -1, 1e-11);
  ASSERT_EQ(answers[1].l.size(), 1U);
  EXPECT_NEAR(answers[1].l[0], 0.25, 1e-11);
  EXPECT_TRUE(answers[2].l.empty());
  EXPECT_EQ(answers[2].status, Status::ok);
}

TEST(Implicit, ALambdaIsASurfaceForEverySolverThatTakesItsForms) {
  const auto f = [](auto x, auto y, auto z) { return x * x + y * y + z * z - 1.0; };
  const SurfaceEntry entry = implicit_entry("ball", f);
  std::size_t solvers = 0;
  for (const SolverEntry& solver : solver_registry()) {
    if (all_pairings(solver, entry).empty()) continue;
    ++solvers;
    const std::vector<Ray> rays{{{0, 0, -3}, {0, 0, 1}}};
    const Answer answer = ask(scene_of(entry, implicit_spec("ball", kBox), solver), rays)[0];
    ASSERT_EQ(answer.l.size(), 2U) << solver.name;
    EXPECT_NEAR(answer.l[0], 2, 1e-10) << solver.name;
  }
  if (solvers == 0) GTEST_SKIP() << "no solver of this build takes scalar or interval equations";
}

TEST(Implicit, ATorusAsACallableAnswersAsTheTorus) {
  const SolverEntry* const solver = certified_solver();
  if (solver == nullptr || !has_surface("torus")) GTEST_SKIP() << "this build lacks one of them";
  const SurfaceEntry entry = implicit_entry("ring", Ring{});
  const SurfaceSpec spec = implicit_spec("ring", {{-1.5, -0.5, -1.5}, {1.5, 0.5, 1.5}});
  const SurfaceEntry& torus_entry = find_surface("torus");
  const auto rays = camera_rays(*torus_entry.make(torus(1, 0.25)), 400, kSeed);
  const auto a = ask(scene_of(entry, spec, *solver), rays);
  const auto b = ask(scene_of(torus_entry, torus(1, 0.25), *solver), rays);
  double worst = 0, worst_normal = 0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (a[i].status != Status::ok || b[i].status != Status::ok) continue;
    ASSERT_EQ(a[i].l.size(), b[i].l.size()) << i;
    for (std::size_t k = 0; k < a[i].l.size(); ++k, ++compared) {
      worst = std::max(worst, std::fabs(a[i].l[k] - b[i].l[k]) / a[i].l[k]);
      worst_normal = std::max(worst_normal, norm(a[i].normal[k] - b[i].normal[k]));
    }
  }
  std::printf("%zu hits, worst relative difference %.2g, of normals %.2g\n", compared, worst, worst_normal);
  EXPECT_GT(compared, 200U);
  EXPECT_LE(worst, 1e-9);
  EXPECT_LE(worst_normal, 1e-8);
}

TEST(Implicit, HitsOfAGyroidAreSignChangesAndNoneIsLeftOut) {
  const SolverEntry* const solver = certified_solver();
  if (solver == nullptr) GTEST_SKIP() << "this build has no certified solver";
  const Bounds box{{-4, -4, -4}, {4, 4, 4}};
  const Implicit<Gyroid> gyroid(Gyroid{}, box);
  const Scene scene = scene_of(implicit_entry("gyroid", Gyroid{}), implicit_spec("gyroid", box), *solver);
  const auto rays =
      camera_rays(*implicit_entry("gyroid", Gyroid{}).make(implicit_spec("gyroid", box)), 200, kSeed);
  std::size_t hits = 0, undecided = 0;
  for (const Ray& ray : rays) {
    const Answer answer = ask(scene, {&ray, 1})[0];
    undecided += answer.status != Status::ok ? 1U : 0U;
    if (answer.status != Status::ok) continue;
    // Every sign change between close nodes inside the box is one of the hits.
    const auto f = gyroid.on(ray);
    std::size_t found = 0;
    double last = 0;
    for (double l = 0; l < 60; l += 1.0 / 512) {
      const Vec3 x = ray.o + l * ray.d;
      const bool inside = max_abs(x) < 3.99;
      const double value = inside ? f.jet(l).f : 0;
      if (value * last < 0) {
        ++found;
        bool matched = false;
        for (const double hit : answer.l) matched = matched || (hit > l - 1.0 / 256 && hit < l + 1.0 / 256);
        EXPECT_TRUE(matched) << l;
      }
      last = value;
    }
    hits += answer.l.size();
    EXPECT_GE(answer.l.size(), found);
    for (const double l : answer.l) EXPECT_LE(std::fabs(f.jet(l).f), 1e-10);
  }
  std::printf("%zu hits, %zu of %zu rays undecided\n", hits, undecided, rays.size());
  EXPECT_GT(hits, 200U);
  EXPECT_LE(undecided, 4U);
}

TEST(Implicit, ACallableTakesItsStateFromParameters) {
  const SolverEntry* const solver = certified_solver();
  if (solver == nullptr) GTEST_SKIP() << "this build has no certified solver";
  const SurfaceEntry entry = surface_entry<Implicit<WavySphere>>("wavy_sphere");
  SurfaceSpec spec = implicit_spec("wavy_sphere", kBox);
  EXPECT_THROW(entry.make(spec), std::invalid_argument) << "height is missing";
  spec.parameters.set("height", 0.25);
  const Scene scene = scene_of(entry, spec, *solver);
  const std::vector<Ray> rays = camera_rays(*entry.make(spec), 200, kSeed);
  const WavySphere f(spec.parameters);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Answer answer = ask(scene, {&rays[i], 1})[0];
    if (answer.status != Status::ok) continue;
    EXPECT_EQ(answer.l.size() % 2, 0U) << "a closed surface seen from outside";
    hits += answer.l.size();
    for (std::size_t k = 0; k < answer.l.size(); ++k) {
      const Vec3 x = answer.point[k];
      EXPECT_LE(std::fabs(f(x.x, x.y, x.z)), 1e-10);
    }
  }
  EXPECT_GT(hits, 50U);
}

TEST(Implicit, ScalingByPowersOfTwoChangesNothingButTheScale) {
  const SurfaceEntry entry = implicit_entry("ring", Ring{});
  const SurfaceSpec spec = implicit_spec("ring", {{-1.5, -0.5, -1.5}, {1.5, 0.5, 1.5}});
  const auto rays = mixed_rays(*entry.make(spec), 40, kSeed);
  for (const SolverEntry& solver : solver_registry()) {
    if (all_pairings(solver, entry).empty()) continue;
    const auto original = ask(scene_of(entry, spec, solver), rays);
    for (const int k : {-300, 7, 300}) {
      SurfaceSpec larger = spec;
      larger.parameters = entry.scaled(spec.parameters, std::ldexp(1.0, k));
      std::vector<Ray> moved = rays;
      for (Ray& ray : moved) ray.o = {std::ldexp(ray.o.x, k), std::ldexp(ray.o.y, k), std::ldexp(ray.o.z, k)};
      const auto answers = ask(scene_of(entry, larger, solver), moved);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(answers[i].status, original[i].status);
        ASSERT_EQ(answers[i].l.size(), original[i].l.size()) << solver.name << " ray " << i;
        for (std::size_t j = 0; j < answers[i].l.size(); ++j) {
          EXPECT_EQ(answers[i].l[j], std::ldexp(original[i].l[j], k));
          EXPECT_EQ(answers[i].normal[j], original[i].normal[j]);
        }
      }
    }
  }
}

TEST(Implicit, SphereTracingNeverOverstepsTheFirstHit) {
  // |grad| = 2 |x| <= 4 sqrt 3 in the box.
  const Implicit<UnitSphere> sphere(UnitSphere{}, kBox, 7.0);
  Rng rng(kSeed);
  int near = 0, passed = 0, most = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 o = 1.9 * random_direction(rng);
    const Vec3 d = 0.75 * normalized(1.5 * random_direction(rng) - o);
    const SphereTrace trace = sphere.sphere_trace({o, d}, 0, 5);
    most = std::max(most, trace.steps);
    // The nearer root of |o + l d|^2 = 1 in long double.
    const auto inner = [](Vec3 v, Vec3 w) {
      const auto wide = [](double x) { return static_cast<long double>(x); };
      return wide(v.x) * wide(w.x) + wide(v.y) * wide(w.y) + wide(v.z) * wide(w.z);
    };
    const long double a = inner(d, d), b = inner(d, o), c = inner(o, o) - 1;
    const long double discriminant = b * b - a * c;
    if (discriminant < 0 || b > 0) {
      if (trace.end == SphereTrace::End::passed) ++passed;
      continue;
    }
    const long double first = c / (-b + std::sqrt(discriminant));
    EXPECT_LE(static_cast<long double>(trace.l), first * (1 + 1e-17L)) << i;
    if (trace.end == SphereTrace::End::near) {
      ++near;
      if (discriminant > 0.01L) {
        EXPECT_NEAR(trace.l, static_cast<double>(first), 1e-9);
      }
    }
  }
  std::printf("%d near, %d passed, at most %d steps\n", near, passed, most);
  EXPECT_GT(near, 500);
  EXPECT_GT(passed, 100);
}

TEST(Implicit, DistanceBoundsAreBelowTheDistance) {
  const Implicit<UnitSphere> sphere(UnitSphere{}, kBox, 7.0);
  Rng rng(kSeed);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 x = rng.uniform(0, 2) * random_direction(rng);
    EXPECT_LE(sphere.distance_bound(x), std::fabs(norm(x) - 1) + 1e-15);
  }
  EXPECT_EQ(Implicit<UnitSphere>(UnitSphere{}, kBox).distance_bound({2, 0, 0}), 0) << "no Lipschitz bound";
}

TEST(Implicit, SamplesLieOnTheSurface) {
  const Implicit<Ring> ring(Ring{}, {{-1.5, -0.5, -1.5}, {1.5, 0.5, 1.5}});
  Rng rng(kSeed);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const double u = rng.uniform();
    const SurfaceSample sample = ring.sample(u, rng.uniform());
    const Vec3 x = sample.point;
    worst = std::max(worst, std::fabs(std::hypot(std::hypot(x.x, x.z) - 1, x.y) - 0.25));
    EXPECT_NEAR(norm(sample.normal), 1, 1e-15);
  }
  std::printf("worst distance %.2g\n", worst);
  EXPECT_LE(worst, 1e-14);
}

TEST(Implicit, BoxesAndNumbersThatAreNoneAreRefused) {
  EXPECT_THROW(Implicit<UnitSphere>(UnitSphere{}, Bounds{}), std::invalid_argument);
  EXPECT_THROW(Implicit<UnitSphere>(UnitSphere{}, Bounds{{0, 0, 0}, {1, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(Implicit<UnitSphere>(UnitSphere{}, kBox, -1), std::invalid_argument);
  EXPECT_THROW(Implicit<UnitSphere>(UnitSphere{}, kBox, 1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace graze::test
