// labels: peers
// The peers of graze bench: asked as they should be, and never more than their own answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/peers.hpp>
#include <graze/surfaces/intersector.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

Roots solve(const SolverEntry& entry, std::vector<double> c, double lo, double hi,
            const Parameters& options = {}) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  entry.make(options)->solve(std::span<const PolynomialEquation>(&equation, 1), {&roots, 1});
  return roots;
}

bool is_root_finder(const Peer& peer) { return peer.seen == nullptr; }

bool has_peer(std::string_view name) {
  return std::any_of(peer_registry().begin(), peer_registry().end(),
                     [&](const Peer& peer) { return peer.solver.name == name; });
}

SurfaceSpec spec_of(std::string type, std::map<std::string, ParameterValue> parameters) {
  SurfaceSpec spec;
  spec.type = std::move(type);
  spec.parameters = Parameters(std::move(parameters));
  return spec;
}

SurfaceSpec teardrop() { return spec_of("teardrop", {{"s", 1.0}}); }

HitBuffer ask(const SurfaceSpec& spec, std::string_view solver, std::span<const Ray> rays, Query query,
              const Method& method = {}) {
  const SolverEntry& entry = find_solver_or_peer(solver);
  Scene scene;
  scene.add(seen_by(entry, find_surface(spec.type), query), spec, entry, method);
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, query, {}, work, hits);
  return hits;
}

std::vector<Ray> camera_rays(const SurfaceSpec& spec, std::size_t count) {
  const auto surface = find_surface(spec.type).make(spec);
  std::vector<Ray> rays;
  for (std::size_t block = 0; rays.size() < count; ++block) {
    for (const CaseRay& ray : make_block(find_family("camera"), *surface, kSeed, block, kCaseBlock))
      rays.push_back(ray.ray);
  }
  return rays;
}

// ---------------------------------------------------------------------------------------------- root finders

TEST(Peers, ThoseOfThisBuildAreListed) {
  ASSERT_FALSE(peer_registry().empty());
  for (const Peer& peer : peer_registry()) {
    std::printf("%s\n", std::string(peer.solver.name).c_str());
    EXPECT_EQ(peer.solver.name.substr(0, 5), "peer:");
    EXPECT_FALSE(peer.solver.info.claims.certified) << peer.solver.name;
  }
  EXPECT_EQ(solvers_and_peers().size(), solver_registry().size() + peer_registry().size());
}

TEST(Peers, AnUnknownPeerIsRefusedWithTheNearestNames) {
  try {
    find_solver_or_peer("peer:boost_tom748");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("peer:boost_toms748"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("GRAZE_PEERS"), std::string::npos) << error.what();
  }
}

TEST(Peers, FindTheRootsOfAKnownProductInsideTheInterval) {
  // (x + 2) (x - 1/2) (x - 1) (x - 3) = x^4 - 5/2 x^3 - 4 x^2 + 17/2 x - 3.
  const std::vector<double> c{-3, 8.5, -4, -2.5, 1};
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Peer& peer : peer_registry()) {
    if (!is_root_finder(peer)) continue;
    SCOPED_TRACE(peer.solver.name);
    const Roots all = solve(peer.solver, c, -infinity, infinity);
    ASSERT_EQ(all.list.size(), 4U);
    EXPECT_EQ(all.status, Status::ok);
    const double expected[] = {-2, 0.5, 1, 3};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(all.list[i].x, expected[i], 1e-13);
    const Roots inside = solve(peer.solver, c, 0.25, 2);
    ASSERT_EQ(inside.list.size(), 2U);
    EXPECT_NEAR(inside.list[0].x, 0.5, 1e-13);
    EXPECT_NEAR(inside.list[1].x, 1, 1e-13);
    EXPECT_EQ(solve(peer.solver, {1, 0, 1}, -infinity, infinity).list.size(), 0U);
    EXPECT_EQ(solve(peer.solver, {1, std::nan(""), 1}, 0, 1).status, Status::invalid);
  }
}

TEST(Peers, SeeADoubleRootWhereTheyClaimTo) {
  for (const Peer& peer : peer_registry()) {
    if (!is_root_finder(peer)) continue;
    SCOPED_TRACE(peer.solver.name);
    // (x - 1)^2 (x + 3) = x^3 + x^2 - 5 x + 3.
    const Roots roots = solve(peer.solver, {3, -5, 1, 1}, 0.1, 2.2);
    if (peer.solver.info.claims.finds_touching_roots) {
      ASSERT_EQ(roots.list.size(), 1U);
      EXPECT_NEAR(roots.list[0].x, 1, 1e-7);
      EXPECT_EQ(roots.list[0].multiplicity, 2U);
    } else {
      EXPECT_EQ(roots.list.size(), 0U);
    }
  }
}

TEST(Peers, MpsolveTellsANearMissFromATouch) {
  if (!has_peer("peer:mpsolve")) GTEST_SKIP() << "not in this build";
  const SolverEntry& mpsolve = find_solver_or_peer("peer:mpsolve");
  // x^2 - 2 x + 1 +- 2^-50: off the axis by 2^-25, or two roots 2^-24 apart that double arithmetic joins.
  EXPECT_EQ(solve(mpsolve, {1 + 0x1p-50, -2, 1}, -9, 9).list.size(), 0U);
  if (!has_peer("peer:gsl")) return;
  EXPECT_EQ(solve(find_solver_or_peer("peer:gsl"), {1 + 0x1p-50, -2, 1}, -9, 9).list.size(), 1U);
}

TEST(Peers, EigensOwnRuleCallsAWideSplitComplex) {
  if (!has_peer("peer:eigen_polynomialsolver")) GTEST_SKIP() << "not in this build";
  const SolverEntry& eigen = find_solver_or_peer("peer:eigen_polynomialsolver");
  // Roots 1 +- 1e-8 i: a touch within the rounding of the coefficients, beyond Eigen's |Im| < 1e-12.
  const std::vector<double> c{1 + 0x1p-53 * 2, -2, 1};
  EXPECT_EQ(solve(eigen, c, -9, 9).list.size(), 1U);
  EXPECT_EQ(solve(eigen, c, -9, 9, Parameters({{"own_rule", true}})).list.size(), 0U);
}

TEST(Peers, AnswerARayInEveryFormulationThatTheyTake) {
  // By hand (document 000, s = 1): the ray along x at y = 1.5 meets the circle of radius 15/8.
  const Ray ray{{-5, 1.5, 0.0}, {1, 0.25, 0.125}};
  const HitBuffer expected = ask(teardrop(), "certified", {&ray, 1}, Query::all);
  ASSERT_EQ(expected.l.size(), 2U);
  int cells = 0;
  for (const Peer& peer : peer_registry()) {
    if (!is_root_finder(peer)) continue;
    for (const Pairing& pairing : all_pairings(peer.solver, find_surface("teardrop"))) {
      const std::string name(find_surface("teardrop").formulations[pairing.formulation].name);
      SCOPED_TRACE(std::string(peer.solver.name) + " " + name);
      const HitBuffer hits = ask(teardrop(), peer.solver.name, {&ray, 1}, Query::all, {{}, name});
      ASSERT_EQ(hits.l.size(), 2U);
      for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(hits.l[i], expected.l[i], 1e-10);
      ++cells;
    }
  }
  EXPECT_GT(cells, 0);
}

// ---------------------------------------------------------------------------------------------------- Embree

class EmbreePeer : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_peer("peer:embree")) GTEST_SKIP() << "not in this build";
  }
  static HitBuffer mesh(const SurfaceSpec& spec, std::span<const Ray> rays, Query query,
                        std::map<std::string, ParameterValue> options) {
    return ask(spec, "peer:embree", rays, query, {Parameters(std::move(options)), ""});
  }
  static std::vector<SurfaceSpec> surfaces() {
    return {teardrop(),
            spec_of("bezier_revolution",
                    {{"control_points", std::vector<std::vector<double>>{{0, 0}, {2, 0}, {3, 2}, {0, 6}}}}),
            spec_of("sphere", {{"center", std::vector<double>{1, -2, 3}}, {"radius", 2.0}}),
            spec_of("ellipsoid",
                    {{"center", std::vector<double>{0, 0, 1}}, {"semi_axes", std::vector<double>{3, 1, 2}}}),
            spec_of("torus", {{"R", 2.0}, {"r", 0.5}})};
  }
};

/// Rays whose number of hits (all) or whose first hit differ, and the largest relative difference of those
/// that do not.
struct Difference {
  std::size_t counts = 0;
  double worst = 0;
};

Difference difference(const HitBuffer& a, const HitBuffer& b, double size) {
  Difference result;
  for (std::size_t i = 0; i < a.rays(); ++i) {
    result.counts += a.count(i) != b.count(i) ? 1U : 0U;
    if (a.count(i) != b.count(i)) continue;
    for (std::size_t k = 0; k < a.count(i); ++k)
      result.worst = std::max(result.worst, std::fabs(a.l[a.begin(i) + k] - b.l[b.begin(i) + k]) / size);
  }
  return result;
}

TEST_F(EmbreePeer, SeesTheSurfacesThatTheirParametersCover) {
  constexpr std::size_t kRays = 2000;
  for (const SurfaceSpec& spec : surfaces()) {
    SCOPED_TRACE(spec.type);
    const std::vector<Ray> rays = camera_rays(spec, kRays);
    const double size = find_surface(spec.type).make(spec)->size();
    const HitBuffer truth = ask(spec, "certified", rays, Query::all);
    EXPECT_GT(truth.l.size(), kRays / 5);
    const Difference fine = difference(truth, mesh(spec, rays, Query::all, {{"triangles", 200000.0}}), size);
    std::printf("%-18s counts differ on %zu of %zu rays, worst |l - l*| / L %.1e\n", spec.type.c_str(),
                fine.counts, rays.size(), fine.worst);
    // Near the outline a mesh is wrong about presence, and l off by the root of its distance to the surface.
    EXPECT_LE(fine.counts, kRays / 100);
    EXPECT_LE(fine.worst, 0.1);
  }
}

TEST_F(EmbreePeer, AFinerMeshIsNearer) {
  // Rays at the axis, across: no outline near. Twice the cells a side are a quarter of the error.
  std::vector<Ray> rays;
  for (int i = 0; i < 500; ++i) rays.push_back({{-8, 0.5 + 0.005 * i, -0.3 + 0.001 * i}, {1, 0.01, 0.02}});
  const HitBuffer truth = ask(teardrop(), "certified", rays, Query::first);
  const Difference coarse =
      difference(truth, mesh(teardrop(), rays, Query::first, {{"triangles", 2000.0}}), 1);
  const Difference fine =
      difference(truth, mesh(teardrop(), rays, Query::first, {{"triangles", 32000.0}}), 1);
  EXPECT_EQ(coarse.counts + fine.counts, 0U);
  std::printf("worst |l - l*|: %.2e at 2 000 triangles, %.2e at 32 000\n", coarse.worst, fine.worst);
  EXPECT_GT(coarse.worst / fine.worst, 8);
  EXPECT_LT(coarse.worst / fine.worst, 32);
}

TEST_F(EmbreePeer, IsAsFineAtAPoleAsElsewhere) {
  // 100 cells from pole to pole: chords of pi/100 stay within (pi/100)^2 / 8 of the unit sphere.
  const SurfaceSpec sphere = spec_of("sphere", {{"center", std::vector<double>{0, 0, 0}}, {"radius", 1.0}});
  std::vector<Ray> rays;
  for (int i = 1; i < 100; ++i) rays.push_back({{0.002 * i, 5, 0.0007 * i}, {0, -1, 0}});
  const HitBuffer truth = ask(sphere, "certified", rays, Query::first);
  const Difference found = difference(truth, mesh(sphere, rays, Query::first, {{"triangles", 20000.0}}), 1);
  EXPECT_EQ(found.counts, 0U);
  std::printf("worst |l - l*| near the pole: %.2e\n", found.worst);
  EXPECT_LE(found.worst, 4e-4);
}

TEST_F(EmbreePeer, PacketsAnswerAsSingleRaysAndAnyAsFirst) {
  const std::vector<Ray> rays = camera_rays(teardrop(), 1003);  // no multiple of 16
  const HitBuffer one = mesh(teardrop(), rays, Query::first, {{"triangles", 20000.0}});
  const HitBuffer packets = mesh(teardrop(), rays, Query::first, {{"triangles", 20000.0}, {"packets", true}});
  const Difference same = difference(one, packets, 1);
  EXPECT_EQ(same.counts, 0U);
  EXPECT_LE(same.worst, 1e-5);  // the two paths of Embree round differently
  for (const bool by_packets : {false, true}) {
    const HitBuffer any =
        mesh(teardrop(), rays, Query::any, {{"triangles", 20000.0}, {"packets", by_packets}});
    EXPECT_EQ(difference(one, any, 1).counts, 0U);
    ASSERT_FALSE(any.l.empty());
    // Occlusion says nothing about where.
    EXPECT_EQ(any.l.front(), static_cast<double>(std::numeric_limits<float>::max()));
  }
}

TEST_F(EmbreePeer, RaysBeyondSinglePrecisionMeetNothingAndBadOnesAreInvalid) {
  const double nan = std::nan("");
  const std::vector<Ray> rays{{{-5, 1.5, 0}, {1, 0, 0}},
                              {{-5e60, 1.5, 0}, {1e60, 0, 0}},
                              {{-5, 1.5, 0}, {1e-60, 0, 0}},
                              {{-5, 1.5, 0}, {0, 0, 0}},
                              {{nan, 1.5, 0}, {1, 0, 0}}};
  for (const bool packets : {false, true}) {
    const HitBuffer hits =
        mesh(teardrop(), rays, Query::first, {{"triangles", 2000.0}, {"packets", packets}});
    ASSERT_EQ(hits.rays(), rays.size());
    EXPECT_EQ(hits.count(0), 1U);
    for (std::size_t i = 1; i < rays.size(); ++i) EXPECT_EQ(hits.count(i), 0U) << i;
    EXPECT_EQ(hits.status[1], Status::ok);
    EXPECT_EQ(hits.status[2], Status::ok);
    EXPECT_EQ(hits.status[3], Status::invalid);
    EXPECT_EQ(hits.status[4], Status::invalid);
  }
}

TEST_F(EmbreePeer, HasNoMeshOfOtherSurfaces) {
  const SolverEntry& embree = find_solver_or_peer("peer:embree");
  for (const SurfaceEntry& surface : surface_registry()) {
    const auto known = surfaces();
    const bool covered = std::any_of(known.begin(), known.end(),
                                     [&](const SurfaceSpec& spec) { return spec.type == surface.name; });
    const SurfaceEntry seen = seen_by(embree, surface, Query::first);
    EXPECT_EQ(all_pairings(embree, seen).size(), covered ? 1U : 0U) << surface.name;
  }
  EXPECT_THROW(embree.make(Parameters({{"triangles", 3.0}})), std::invalid_argument);
}

}  // namespace
}  // namespace graze::test
