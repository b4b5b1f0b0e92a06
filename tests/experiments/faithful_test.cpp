// shards: 2
// Solvers faithful and certified on every surface whose equation is a polynomial, over every family of rays:
// the count, the multiplicities and l against exact truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/solvers/math/scaling.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

/// Rays a family; a long run takes them from the environment.
std::size_t rays_a_family() {
  const char* const wanted = std::getenv("GRAZE_RAYS");
  return wanted != nullptr ? std::strtoul(wanted, nullptr, 10) : kSanitized ? 20 : 100;
}

/// Rays of the surface's own scale.
std::vector<Ray> rays_of(const CaseFamily& family, const AnySurface& surface, std::size_t count) {
  std::vector<Ray> rays;
  for (std::size_t block = 0; rays.size() < count; ++block) {
    if (block_scale(family, kSeed, block) != 1) continue;
    const std::size_t wanted = std::min(kCaseBlock, count - rays.size());
    for (const CaseRay& ray : make_block(family, surface, kSeed, block, wanted)) rays.push_back(ray.ray);
  }
  return rays;
}

/// More surfaces than the contract's examples: leading coefficients that vanish, singular points, odd
/// degrees.
std::vector<SurfaceSpec> specs_of(std::string_view type) {
  std::vector<SurfaceSpec> specs = examples(type);
  if (type == "quadric") {
    specs.push_back(with_numbers("quadric", {{"A", 1.0}, {"G", -0.5}}));
    specs.push_back(with_numbers("quadric", {{"A", 1.0}, {"G", -0.5}, {"H", -1.0}}));
  }
  if (type == "implicit_polynomial") {
    const Table cayley{{4, 2, 0, 0}, {4, 0, 2, 0}, {4, 0, 0, 2}, {16, 1, 1, 1}, {-1, 0, 0, 0}};
    specs.push_back(implicit_polynomial(cayley));
  }
  return specs;
}

bool prefers_a_polynomial(const SurfaceEntry& surface) {
  const std::vector<Form>& forms = surface.formulations.front().forms;
  return std::find(forms.begin(), forms.end(), Form::polynomial) != forms.end();
}

struct Question {
  const SurfaceEntry* surface;
  std::string solver;
  double ulps;   ///< that l may be off the truth
  double units;  ///< or condition units, eps (|l| + L/|n.d|)
};

std::vector<Question> questions() {
  std::vector<Question> all;
  for (const SurfaceEntry& surface : surface_registry()) {
    if (!prefers_a_polynomial(surface)) continue;
    if (solver_named("faithful") != nullptr) all.push_back({&surface, "faithful", 1, 0});
    if (solver_named("certified") != nullptr) all.push_back({&surface, "certified", 0, 4});
  }
  return all;
}

void PrintTo(const Question& question, std::ostream* out) {
  *out << question.surface->name << " " << question.solver;
}

std::string as_text(const Ray& ray) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "o %a %a %a d %a %a %a", ray.o.x, ray.o.y, ray.o.z, ray.d.x,
                ray.d.y, ray.d.z);
  return text.data();
}

class EveryFamily : public testing::TestWithParam<Question> {
 protected:
  /// The error of l as a share of what is allowed.
  static double share(double l, const truth::Hit& hit, const Ray& ray, double size) {
    const double error = std::fabs((l - hit.l.head) - hit.l.tail);
    const double unit = 0x1p-52 * (std::fabs(hit.l.head) + size / norm(ray.d) / hit.cosine);
    const Question& question = GetParam();
    return error / (question.units == 0 ? question.ulps * ulp(hit.l.head) : question.units * unit);
  }
};

TEST_P(EveryFamily, GivesEveryHitWithItsMultiplicityAndPlace) {
  const SurfaceEntry& entry = *GetParam().surface;
  for (const SurfaceSpec& spec : specs_of(entry.name)) {
    const auto surface = entry.make(spec);
    const auto truth = truth::make_surface(spec);
    const Scene scene = scene_of(spec, find_solver(GetParam().solver));
    for (const CaseFamily& family : case_families()) {
      if (family.name == "scale" || !family.suits(surface->landmarks())) continue;
      const std::vector<Ray> rays = rays_of(family, *surface, rays_a_family());
      const std::vector<Answer> answers = ask(scene, rays);
      double worst = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const truth::Answer expected = truth->all(rays[i], {.digits = 34});
        const std::string where = std::string(family.name) + " " + as_text(rays[i]);
        EXPECT_EQ(answers[i].status, expected.status) << where;
        ASSERT_EQ(answers[i].l.size(), expected.hits.size()) << where;
        for (std::size_t k = 0; k < expected.hits.size(); ++k) {
          const truth::Hit& hit = expected.hits[k];
          EXPECT_EQ(answers[i].multiplicity[k], hit.multiplicity) << where;
          const double part = share(answers[i].l[k], hit, rays[i], surface->size());
          EXPECT_LE(part, 1) << where;
          worst = std::max(worst, part);
        }
      }
      std::printf("%s %s %-10s %zu rays: worst %.3f of what is allowed\n", std::string(entry.name).c_str(),
                  GetParam().solver.c_str(), std::string(family.name).c_str(), rays.size(), worst);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryFamily, testing::ValuesIn(questions()), [](const auto& question) {
  return std::string(question.param.surface->name) + "_" + question.param.solver;
});

}  // namespace
}  // namespace graze::test
