// shards: 2
// Solvers faithful and certified on every surface whose equation is a polynomial, over every family of rays:
// the count, the multiplicities and l against exact truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/truth.hpp>
#include <surfaces/cells.hpp>

#include "family_rays.hpp"

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

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
  Promise promise;
};

std::vector<Question> questions() {
  std::vector<Question> all;
  for (const SurfaceEntry& surface : surface_registry()) {
    if (!prefers_a_polynomial(surface)) continue;
    for (const Promise& promise : kPromises) {
      if (solver_named(promise.solver) != nullptr) all.push_back({&surface, promise});
    }
  }
  return all;
}

void PrintTo(const Question& question, std::ostream* out) {
  *out << question.surface->name << " " << question.promise.solver;
}

std::string as_text(const Ray& ray) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "o %a %a %a d %a %a %a", ray.o.x, ray.o.y, ray.o.z, ray.d.x,
                ray.d.y, ray.d.z);
  return text.data();
}

class EveryFamily : public testing::TestWithParam<Question> {};

TEST_P(EveryFamily, GivesEveryHitWithItsMultiplicityAndPlace) {
  const SurfaceEntry& entry = *GetParam().surface;
  const Promise& promise = GetParam().promise;
  const std::size_t count = rays_a_family(100, 20);
  for (const SurfaceSpec& spec : specs_of(entry.name)) {
    const auto surface = entry.make(spec);
    const auto truth = truth::make_surface(spec);
    const Scene scene = scene_of(spec, find_solver(promise.solver));
    for (const CaseFamily& family : case_families()) {
      if (family.name == "scale" || !family.suits(surface->landmarks())) continue;
      const std::vector<Ray> rays = rays_of(family, *surface, kSeed, count);
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
          const double part = promise.share(answers[i].l[k], hit, rays[i], surface->size());
          EXPECT_LE(part, 1) << where;
          worst = std::max(worst, part);
        }
      }
      std::printf("%s %s %-10s %zu rays: worst %.3f of what is allowed\n", std::string(entry.name).c_str(),
                  std::string(promise.solver).c_str(), std::string(family.name).c_str(), rays.size(), worst);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryFamily, testing::ValuesIn(questions()), [](const auto& question) {
  return std::string(question.param.surface->name) + "_" + std::string(question.param.promise.solver);
});

}  // namespace
}  // namespace graze::test
