// Every surface of the build against truth, on every family of rays that suits it. The first formulation of a
// surface is never wrong on a ray whose true verdict stands under one-ulp moves; the last one is the
// textbook's, and what it loses is printed. GRAZE_RAYS=20000 asks for that many rays a family (default 200).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/judge.hpp>
#include <graze/experiments/specs.hpp>
#include <graze/experiments/truth.hpp>
#include <surfaces/cells.hpp>

#include "family_rays.hpp"
#include "truth_blocks.hpp"

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;
/// Rays that are shown of each cell that is wrong: enough to see a pattern.
constexpr std::size_t kShown = 2;

struct Tally {
  std::size_t right = 0, uncertain = 0, failed = 0;
  std::size_t wrong = 0;      ///< on rays that are not ambiguous
  std::size_t ambiguous = 0;  ///< wrong, where one ulp of an input, or of l, decides
};

/// A formulation with a solver.
struct Contestant {
  const SurfaceEntry* surface;
  const SolverEntry* solver;
  std::string formulation;

  [[nodiscard]] std::string name() const { return formulation + " / " + std::string(solver->name); }
};

/// A line to paste: rays, then `graze solve` and `graze truth` say the rest.
void show(const Block& block, const Contestant& contestant, std::size_t i, const Answer& answer) {
  const Ray& ray = block.rays[i];
  std::printf(
      "  WRONG %s %s: %s with %zu hits, truth %s with %zu: "
      "{\"o\":[\"%a\",\"%a\",\"%a\"],\"d\":[\"%a\",\"%a\",\"%a\"]}\n",
      surface_label(block.spec).c_str(), contestant.name().c_str(),
      std::string(to_string(answer.status)).c_str(), answer.l.size(),
      std::string(to_string(block.truths[i].status)).c_str(), block.truths[i].hits.size(), ray.o.x, ray.o.y,
      ray.o.z, ray.d.x, ray.d.y, ray.d.z);
}

/// Whether neighbouring true hits are different doubles: an answer in doubles cannot list them otherwise.
bool doubles_tell_apart(const truth::Answer& truth) {
  const auto same = [](const truth::Hit& a, const truth::Hit& b) { return a.l.head == b.l.head; };
  return std::adjacent_find(truth.hits.begin(), truth.hits.end(), same) == truth.hits.end();
}

void judge_block(const Block& block, const Contestant& contestant, bool shown, Tally& tally) {
  Scene scene;
  scene.add(*contestant.surface, block.spec, *contestant.solver, {{}, contestant.formulation, {}});
  const std::vector<Answer> answers = ask(scene, block.rays);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Claim claim{answers[i].status, answers[i].l, {}, {}, answers[i].multiplicity};
    const Verdict verdict =
        judge(block.rays[i], block.truths[i], claim, {.size = block.size}, nullptr).verdict;
    tally.right += verdict == Verdict::right ? 1U : 0U;
    tally.uncertain += verdict == Verdict::uncertain ? 1U : 0U;
    tally.failed += verdict == Verdict::failed ? 1U : 0U;
    if (verdict != Verdict::wrong) continue;
    const bool ambiguous =
        !doubles_tell_apart(block.truths[i]) || is_ambiguous(*block.surface, block.rays[i], block.truths[i]);
    (ambiguous ? tally.ambiguous : tally.wrong) += 1;
    if (!ambiguous && shown && tally.wrong <= kShown) show(block, contestant, i, answers[i]);
  }
}

/// The formulation number `index` with the solver, if this build has the solver and it takes the formulation.
std::optional<Contestant> contestant(const SurfaceEntry& surface, std::size_t index, std::string_view name) {
  for (const SolverEntry& solver : solver_registry()) {
    if (solver.name != name) continue;
    const auto pairings = all_pairings(solver, surface);
    const bool takes = std::any_of(pairings.begin(), pairings.end(),
                                   [&](const Pairing& pairing) { return pairing.formulation == index; });
    if (takes) return Contestant{&surface, &solver, std::string(surface.formulations[index].name)};
  }
  return std::nullopt;
}

/// The first formulation by closed form where its degree is one of a proved error, and certified.
std::vector<Contestant> best_of(const SurfaceEntry& surface) {
  constexpr int kProved = 2;
  std::vector<Contestant> all;
  for (const char* solver : {"closed_form", "interval_bisection"}) {
    const auto found = contestant(surface, 0, solver);
    const bool is_proved =
        found && (found->solver->info.claims.certified || surface.formulations[0].degree <= kProved);
    if (is_proved) all.push_back(*found);
  }
  return all;
}

/// The textbook's formulation, the last one with polynomials, with the first of these solvers that takes it.
std::optional<Contestant> textbook_of(const SurfaceEntry& surface) {
  const auto has_polynomials = [](const FormulationInfo& formulation) {
    return std::find(formulation.forms.begin(), formulation.forms.end(), Form::polynomial) !=
           formulation.forms.end();
  };
  std::size_t last = surface.formulations.size() - 1;
  while (last > 0 && !has_polynomials(surface.formulations[last])) --last;
  if (last == 0) return std::nullopt;
  for (const char* solver : {"closed_form", "companion", "interval_bisection"}) {
    if (const auto found = contestant(surface, last, solver)) return found;
  }
  return std::nullopt;
}

void print(const std::string& label, std::string_view family, const Contestant& contestant, const Tally& t) {
  std::printf("%-34.34s %-11s %-40.40s %7zu %7zu %7zu %7zu %7zu\n", label.c_str(),
              std::string(family).c_str(), contestant.name().c_str(), t.right, t.wrong, t.ambiguous,
              t.uncertain, t.failed);
}

class EverySurface : public testing::TestWithParam<const SurfaceEntry*> {
 protected:
  static void judge_family(const SurfaceSpec& spec, const CaseFamily& family) {
    const SurfaceEntry& surface = *GetParam();
    const std::vector<Contestant> best = best_of(surface);
    const std::optional<Contestant> textbook = textbook_of(surface);
    std::vector<Tally> tallies(best.size());
    Tally lost;
    // Block by block, so that memory does not grow with the rays.
    for (std::size_t number = 0; number * kCaseBlock < rays_a_family(200, 100); ++number) {
      const std::size_t count = std::min(kCaseBlock, rays_a_family(200, 100) - number * kCaseBlock);
      const Block block = make_truths(family, spec, kSeed, number, count);
      for (std::size_t i = 0; i < best.size(); ++i) judge_block(block, best[i], true, tallies[i]);
      if (textbook) judge_block(block, *textbook, false, lost);
    }
    const std::string label = spec.name.empty() ? surface_label(spec) : spec.name;
    for (std::size_t i = 0; i < best.size(); ++i) {
      print(label, family.name, best[i], tallies[i]);
      EXPECT_EQ(tallies[i].wrong, 0U) << label << ", " << family.name << ", " << best[i].name();
    }
    if (textbook) print(label, family.name, *textbook, lost);
  }
};

std::vector<const SurfaceEntry*> surfaces_with_truth() {
  const auto known = truth::types();
  std::vector<const SurfaceEntry*> all;
  for (const SurfaceEntry& entry : surface_registry()) {
    if (std::find(known.begin(), known.end(), entry.name) != known.end()) all.push_back(&entry);
  }
  return all;
}

TEST_P(EverySurface, IsNeverWrongInItsFirstFormulationOnRaysThatAreNotAmbiguous) {
  std::printf("%-34s %-11s %-40s %7s %7s %7s %7s %7s\n", "surface", "family", "formulation / solver", "right",
              "wrong", "ambig.", "uncert.", "failed");
  for (const SurfaceSpec& spec : examples(GetParam()->name)) {
    const Landmarks marks = GetParam()->make(spec)->landmarks();
    for (const CaseFamily& family : case_families()) {
      if (family.suits(marks)) judge_family(spec, family);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, EverySurface, testing::ValuesIn(surfaces_with_truth()),
                         [](const auto& surface) { return std::string(surface.param->name); });

TEST(Surfaces, OfTheBuildAllHaveTruth) {
  const auto known = truth::types();
  for (const SurfaceEntry& entry : surface_registry()) {
    EXPECT_NE(std::find(known.begin(), known.end(), entry.name), known.end()) << entry.name;
  }
}

}  // namespace
}  // namespace graze::test
