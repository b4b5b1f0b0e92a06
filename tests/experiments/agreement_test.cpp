// Solvers against truth: how often they are right where they must be, and that a certified one is never
// wrong. Worst errors and counts are printed on success too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <boost/multiprecision/gmp.hpp>
#include <nlohmann/json.hpp>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/judge.hpp>
#include <graze/experiments/numbers.hpp>
#include <graze/experiments/specs.hpp>
#include <graze/experiments/truth.hpp>
#include <surfaces/cells.hpp>

#include "truth_blocks.hpp"

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;

struct Tally {
  std::size_t rays = 0, right = 0, wrong = 0, uncertain = 0, failed = 0, ambiguous = 0;
  double ulps = 0, condition_units = 0;  ///< worst of the right answers

  [[nodiscard]] double share_right() const { return static_cast<double>(right) / static_cast<double>(rays); }
};

void count(const Judgement& judgement, Tally& tally) {
  ++tally.rays;
  switch (judgement.verdict) {
    case Verdict::right:
      ++tally.right;
      break;
    case Verdict::wrong:
      ++tally.wrong;
      break;
    case Verdict::uncertain:
      ++tally.uncertain;
      break;
    case Verdict::failed:
      ++tally.failed;
      break;
  }
  if (judgement.verdict != Verdict::right) return;
  tally.ulps = std::max(tally.ulps, judgement.ulps.value_or(0));
  tally.condition_units = std::max(tally.condition_units, judgement.condition_units.value_or(0));
}

void print(const std::string& what, const Tally& t) {
  std::printf(
      "%-62s seed %llu: %zu rays, %zu right, %zu wrong (%zu of them ambiguous), %zu uncertain, %zu failed; "
      "worst %.3g ulps, %.3g condition units\n",
      what.c_str(), static_cast<unsigned long long>(kSeed), t.rays, t.right, t.wrong, t.ambiguous,
      t.uncertain, t.failed, t.ulps, t.condition_units);
}

std::vector<Block> blocks_of(const CaseFamily& family, const SurfaceSpec& spec, std::size_t rays) {
  std::vector<Block> blocks;
  if (!family.suits(find_surface(spec.type).make(spec)->landmarks())) return blocks;
  for (std::size_t b = 0; b * kCaseBlock < rays; ++b) {
    const std::size_t count = std::min(kCaseBlock, rays - b * kCaseBlock);
    blocks.push_back(make_truths(family, spec, kSeed, b, count));
  }
  return blocks;
}

void judge_block(const Block& block, const Scene& scene, Tally& tally) {
  const std::vector<Answer> answers = ask(scene, block.rays);
  for (std::size_t i = 0; i < block.rays.size(); ++i) {
    const Claim claim{answers[i].status, answers[i].l, {}, {}, answers[i].multiplicity};
    const Judgement judgement = judge(block.rays[i], block.truths[i], claim, {.size = block.size}, nullptr);
    count(judgement, tally);
    if (judgement.verdict == Verdict::wrong) {
      tally.ambiguous += is_ambiguous(*block.surface, block.rays[i], block.truths[i]) ? 1U : 0U;
    }
  }
}

Tally run(const std::vector<Block>& blocks, const SolverEntry& solver, const std::string& formulation) {
  Tally tally;
  const Scene* scene = nullptr;
  Scene built;
  double size = 0;
  for (const Block& block : blocks) {
    if (scene == nullptr || block.size != size) {
      built = Scene();
      built.add(find_surface(block.spec.type), block.spec, solver, {{}, std::string(formulation), {}});
      size = block.size;
      scene = &built;
    }
    judge_block(block, *scene, tally);
  }
  return tally;
}

/// The share of right answers that the project asks of a solver, and the rays its cost allows here.
struct Bar {
  std::string_view solver;
  double right;
  std::size_t rays;
};

constexpr std::array<Bar, 4> kBars{{{"companion", 0.999, 10000},
                                    {"interval_bisection", 0.999, 10000},
                                    {"newton_slices", 0.99, 10000},
                                    {"ceres_slices", 0.99, 300}}};

const SolverEntry* solver_of(const Bar& bar) {
  for (const SolverEntry& solver : solver_registry()) {
    if (solver.name == bar.solver) return &solver;
  }
  return nullptr;
}

class NamedSolver : public testing::TestWithParam<Bar> {
 protected:
  void SetUp() override {
    if (solver_of(GetParam()) == nullptr) GTEST_SKIP() << "this build has no " << GetParam().solver;
  }
  static void expect_bar(std::string_view family, const std::string& formulation) {
    const Bar& bar = GetParam();
    const std::size_t rays = kSanitized ? bar.rays / 5 : bar.rays;
    const Tally tally = run(blocks_of(find_family(family), teardrop(1), rays), *solver_of(bar), formulation);
    print(std::string(bar.solver) + " " + (formulation.empty() ? "default" : formulation) + " on " +
              std::string(family),
          tally);
    EXPECT_GE(tally.share_right(), bar.right);
  }
};

TEST_P(NamedSolver, IsRightOnCameraRaysInItsDefaultFormulation) { expect_bar("camera", ""); }

TEST_P(NamedSolver, AlongTheRayIsAsGoodOnFlatAndHorizontalRaysAsOnCameraRays) {
  const SurfaceEntry& surface = find_surface("teardrop");
  bool takes = false;
  for (const Pairing& pairing : all_pairings(*solver_of(GetParam()), surface)) {
    takes = takes || surface.formulations[pairing.formulation].name == "along_ray";
  }
  if (!takes) GTEST_SKIP() << "does not take along_ray";
  for (const std::string_view family : {"camera", "flat", "horizontal"}) expect_bar(family, "along_ray");
}

INSTANTIATE_TEST_SUITE_P(Solvers, NamedSolver, testing::ValuesIn(kBars),
                         [](const auto& bar) { return std::string(bar.param.solver); });

// --------------------------------------------------------------------------------------------- never wrong

struct CertifiedCase {
  std::string surface;
  SurfaceSpec spec;
};

std::vector<CertifiedCase> certified_cases() {
  return {{"teardrop", teardrop(1)},
          {"vase", bezier(vase_points())},
          {"crossing", bezier(crossing_points())},
          {"degree_seven", bezier(degree_seven_points())}};
}

class CertifiedSolvers : public testing::TestWithParam<CertifiedCase> {};

void expect_never_wrong(const CertifiedCase& which, const CaseFamily& family) {
  constexpr std::size_t kRays = kSanitized ? 100 : 500;
  const std::vector<Block> blocks = blocks_of(family, which.spec, kRays);
  if (blocks.empty()) return;
  const SurfaceEntry& surface = find_surface(which.spec.type);
  for (const SolverEntry& solver : solver_registry()) {
    if (!solver.info.claims.certified) continue;
    for (const Pairing& pairing : all_pairings(solver, surface)) {
      const std::string formulation(surface.formulations[pairing.formulation].name);
      const Tally tally = run(blocks, solver, formulation);
      const std::string what = which.surface + " " + formulation + " " + std::string(solver.name) + " on " +
                               std::string(family.name);
      print(what, tally);
      EXPECT_EQ(tally.wrong, 0U) << what;
    }
  }
}

TEST_P(CertifiedSolvers, AreNeverWrongOnAnyFamilyInAnyFormulation) {
  for (const CaseFamily& family : case_families()) expect_never_wrong(GetParam(), family);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, CertifiedSolvers, testing::ValuesIn(certified_cases()),
                         [](const auto& which) { return which.param.surface; });

// -------------------------------------------------------------------------------------------- worked by hand

struct Worked {
  Ray ray;
  std::vector<double> l;
  std::uint32_t multiplicity = 1;
};

TEST(WorkedHits, EveryCellGivesTheCrossingHitsWorkedByHand) {
  const std::vector<Worked> all{{{{0, 10, 0}, {0, -1, 0}}, {4, 10}},
                                {{{-5, 1.5, 0}, {1, 0, 0}}, {3.125, 6.875}},
                                {{{-5, 1.5, 0}, {2, 0, 0}}, {1.5625, 3.4375}},
                                {{{0, 1.5, 8}, {0, 0, 1}}, {}},
                                {{{0, 1.5, 0}, {0, 0, -1}}, {1.875}}};
  std::vector<Ray> rays;
  for (const Worked& worked : all) rays.push_back(worked.ray);
  for (const Cell& cell : double_cells()) {
    if (cell.surface->name != "teardrop") continue;
    const std::vector<Answer> answers = ask(cell.scene(teardrop(1), 30), rays);
    for (std::size_t i = 0; i < all.size(); ++i) {
      // The poles are singular in every formulation but one: uncertain is an honest answer there.
      if (answers[i].status == Status::uncertain && cell.solver->info.claims.certified) continue;
      // Random starts along the axis may not find the apex, a double zero of the squared form.
      if (i == 0 && !cell.solver->info.claims.deterministic && answers[i].l.size() < 2) continue;
      // Newton's and Halley's steps end on both sides of that double zero (solvers/newton.md).
      const bool from_starts = cell.solver->name == "newton" || cell.solver->name == "halley";
      if (i == 0 && from_starts && cell.formulation() == "along_ray") continue;
      // Poles are double roots of the implicit sextic, squared as it is: rounding may lift them off zero.
      const bool is_implicit = cell.formulation().starts_with("implicit_sextic");
      if (i == 0 && is_implicit && answers[i].l.size() < 2) continue;
      ASSERT_EQ(answers[i].l.size(), all[i].l.size()) << cell.name() << ", ray " << i;
      for (std::size_t k = 0; k < all[i].l.size(); ++k) {
        EXPECT_NEAR(answers[i].l[k], all[i].l[k], 1e-7) << cell.name() << ", ray " << i;
      }
    }
  }
}

TEST(WorkedHits, TheTouchingRayIsHitTwiceInOnePlaceOrUncertain) {
  const std::vector<Ray> rays{{{1.875, 1.5, -5}, {0, 0, 1}}};
  for (const Cell& cell : double_cells()) {
    if (cell.surface->name != "teardrop") continue;
    const Answer answer = ask(cell.scene(teardrop(1), 30), rays)[0];
    if (answer.status != Status::ok) {
      EXPECT_EQ(answer.status, Status::uncertain) << cell.name();
      continue;
    }
    // A certificate of a touch takes exact arithmetic.
    EXPECT_TRUE(!cell.solver->info.claims.certified || cell.solver->info.claims.finds_touching_roots)
        << cell.name();
    // Random starts promise no hit: Ceres' full solver slows down at a double root.
    if (!cell.solver->info.claims.deterministic && answer.l.empty()) continue;
    std::uint32_t multiplicity = 0;
    for (std::size_t k = 0; k < answer.l.size(); ++k) {
      EXPECT_NEAR(answer.l[k], 5, 1e-6) << cell.name();
      multiplicity += answer.multiplicity[k];
    }
    // Rounding may part the double hit into two simple ones.
    EXPECT_EQ(multiplicity, 2U) << cell.name();
  }
}

// ------------------------------------------------------------------------------------------------ tests/data

using Decimal = boost::multiprecision::cpp_dec_float_100;
using Rational = boost::multiprecision::mpq_rational;

std::vector<nlohmann::json> lines_of(const char* file) {
  std::ifstream in(std::string(GRAZE_TEST_DATA) + "/" + file);
  EXPECT_TRUE(in.is_open()) << file;
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

std::vector<double> doubles(const nlohmann::json& list) {
  std::vector<double> values;
  for (const auto& item : list) values.push_back(parse_hex_float(item.get<std::string>()).value());
  return values;
}

Ray ray_of(const nlohmann::json& line) {
  const std::vector<double> o = doubles(line["o"]);
  const std::vector<double> d = doubles(line["d"]);
  return {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}};
}

/// Two 40-digit decimals of one number: at most one unit of the last digit apart.
void expect_same(const std::string& ours, const std::string& stored, const std::string& where) {
  const Decimal a(ours), b(stored);
  EXPECT_LE(abs(a - b), abs(b) * Decimal("1e-39")) << where << ": " << ours << " and " << stored;
}

/// "1.25", "3e-5" as a fraction.
Rational fraction(const std::string& text) {
  const std::size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  long exponent = e == std::string::npos ? 0 : std::stol(text.substr(e + 1));
  const std::size_t dot = digits.find('.');
  if (dot != std::string::npos) {
    exponent -= static_cast<long>(digits.size() - dot - 1);
    digits.erase(dot, 1);
  }
  // A leading zero would mean octal.
  const bool negative = digits[0] == '-';
  const std::size_t first = digits.find_first_not_of("-0");
  Rational value = first == std::string::npos ? Rational(0) : Rational(digits.substr(first));
  const Rational ten = exponent > 0 ? Rational(10) : Rational(1, 10);
  for (long k = 0; k < std::labs(exponent); ++k) value *= ten;
  if (negative) value = -value;
  return value;
}

/// Is o + l d strictly inside the teardrop of size s? Exact, in units of s: with v = y/6 and w = 2 - v,
/// F = A - B sqrt(v) for A = 9 v (w^2 + v) - |xz|^2, B = 18 v w >= 0.
bool is_inside(const Ray& ray, const Rational& s, const Rational& l) {
  const Rational x = (Rational(ray.o.x) + l * Rational(ray.d.x)) / s;
  const Rational v = (Rational(ray.o.y) + l * Rational(ray.d.y)) / (6 * s);
  const Rational z = (Rational(ray.o.z) + l * Rational(ray.d.z)) / s;
  if (v <= 0 || v >= 1) return false;
  const Rational w = 2 - v;
  const Rational a = 9 * v * (w * w + v) - x * x - z * z;
  const Rational b = 18 * v * w;
  return a > 0 && a * a > b * b * v;
}

/// The hard rays of every surface.
auto hard_rays() {
  auto lines = lines_of("teardrop_hard.jsonl");
  const auto others = lines_of("surfaces_hard.jsonl");
  lines.insert(lines.end(), others.begin(), others.end());
  return lines;
}

TEST(HardRays, TruthGivesTheStoredDigitsOnEveryOne) {
  const auto lines = hard_rays();
  EXPECT_GE(lines.size(), 65U);
  for (const auto& line : lines) {
    const Ray ray = ray_of(line);
    const auto surface = truth::make_surface(parse_surface(line["surface"].get<std::string>()));
    const truth::Answer answer = surface->all(ray, {.digits = 40});
    const std::string where = line["origin"].get<std::string>();
    EXPECT_EQ(to_string(answer.status), line.value("status", "ok")) << where;
    ASSERT_EQ(answer.hits.size(), line["truth"].size()) << where;
    for (std::size_t k = 0; k < answer.hits.size(); ++k) {
      expect_same(answer.hits[k].l.decimal, line["truth"][k].get<std::string>(), where);
    }
  }
}

TEST(HardRays, TheStoredDigitsAreCrossingsInExactArithmetic) {
  std::size_t crossings = 0;
  for (const auto& line : lines_of("teardrop_hard.jsonl")) {
    const Ray ray = ray_of(line);
    const auto& digits = line["truth"];
    const Rational size(parse_surface(line["surface"].get<std::string>()).parameters.number("s"));
    // A single hit of a ray that starts outside touches: F keeps its sign there.
    if (digits.size() != 2) continue;
    for (const auto& l : digits) {
      const Rational middle = fraction(l.get<std::string>());
      const Rational step = middle / Rational("1000000000000000000000000000000");
      EXPECT_NE(is_inside(ray, size, middle - step), is_inside(ray, size, middle + step))
          << line["origin"] << " " << l;
      ++crossings;
    }
  }
  EXPECT_GT(crossings, 50U);
}

TEST(HardRays, CertifiedSolversAreNeverWrongOnThem) {
  Tally all;
  for (const auto& line : hard_rays()) {
    const Ray ray = ray_of(line);
    const SurfaceSpec spec = parse_surface(line["surface"].get<std::string>());
    const truth::Answer answer = truth::make_surface(spec)->all(ray, {});
    for (const Cell& cell : double_cells()) {
      if (cell.surface->name != spec.type || !cell.solver->info.claims.certified) continue;
      if (cell.surface->formulations[cell.pairing.formulation].is_plain) continue;
      const Answer claimed = ask(cell.scene(spec), {&ray, 1})[0];
      const Judgement judgement =
          judge(ray, answer, {claimed.status, claimed.l, {}, {}, claimed.multiplicity}, {}, nullptr);
      count(judgement, all);
      EXPECT_NE(judgement.verdict, Verdict::wrong) << cell.name() << ": " << line["origin"];
    }
  }
  print("certified cells on the hard rays", all);
}

struct HardPolynomial {
  std::string origin;
  std::vector<double> c;
  std::vector<std::string> roots;
};

std::vector<HardPolynomial> hard_polynomials() {
  std::vector<HardPolynomial> all;
  for (const auto& line : lines_of("polynomials_hard.jsonl")) {
    all.push_back({line["origin"].get<std::string>(), doubles(line["c"]),
                   line["roots"].get<std::vector<std::string>>()});
  }
  return all;
}

TEST(HardPolynomials, TruthGivesTheStoredRoots) {
  const auto all = hard_polynomials();
  EXPECT_GE(all.size(), 80U);
  for (const HardPolynomial& p : all) {
    const truth::PolynomialAnswer answer = truth::real_roots(p.c, std::nullopt, {.digits = 40});
    EXPECT_EQ(answer.status, Status::ok) << p.origin;
    ASSERT_EQ(answer.roots.size(), p.roots.size()) << p.origin;
    for (std::size_t i = 0; i < p.roots.size(); ++i)
      expect_same(answer.roots[i].x.decimal, p.roots[i], p.origin);
  }
}

TEST(HardPolynomials, TruthSaysNoRootMoreAndNoneLessOnEitherSideOfARoot) {
  for (const HardPolynomial& p : hard_polynomials()) {
    if (p.roots.empty()) continue;
    const double first = Decimal(p.roots.front()).convert_to<double>();
    const double last = Decimal(p.roots.back()).convert_to<double>();
    const auto inside =
        truth::real_roots(p.c, std::pair{std::nextafter(first, -1e300), std::nextafter(last, 1e300)});
    EXPECT_EQ(inside.roots.size(), p.roots.size()) << p.origin;
  }
}

bool has_right_roots(const HardPolynomial& p, const Roots& roots) {
  if (roots.list.size() != p.roots.size()) return false;
  for (std::size_t i = 0; i < p.roots.size(); ++i) {
    const double x = Decimal(p.roots[i]).convert_to<double>();
    if (!(std::fabs(roots.list[i].x - x) <= 1e-6 * std::fabs(x))) return false;
  }
  return true;
}

/// Exactly one true root in every certified enclosure.
void expect_certificates_hold(const HardPolynomial& p, const Roots& roots, std::string_view solver) {
  for (const Root& root : roots.list) {
    if (!root.certified) continue;
    const auto inside = [&](const std::string& x) {
      return abs(Decimal(x) - Decimal(root.x)) <= Decimal(root.radius);
    };
    EXPECT_EQ(std::count_if(p.roots.begin(), p.roots.end(), inside), 1) << solver << ": " << p.origin;
  }
}

TEST(HardPolynomials, NoSolverIsWrongUnderACertifiedClaim) {
  const auto all = hard_polynomials();
  for (const SolverEntry& entry : solver_registry()) {
    const auto solver = entry.make({});
    if (!solver->takes(Form::polynomial)) continue;
    std::size_t right = 0, said_no = 0;
    std::size_t asked = 0;
    for (const HardPolynomial& p : all) {
      const auto degree = static_cast<int>(p.c.size()) - 1;
      if (entry.info.max_degree > 0 && degree > entry.info.max_degree) continue;
      ++asked;
      PolynomialEquation equation;
      equation.c = p.c;
      Roots roots;
      solver->solve({&equation, 1}, {&roots, 1});
      EXPECT_TRUE(std::is_sorted(roots.list.begin(), roots.list.end(),
                                 [](const Root& a, const Root& b) { return a.x < b.x; }));
      expect_certificates_hold(p, roots, entry.name);
      right += roots.status == Status::ok && has_right_roots(p, roots) ? 1U : 0U;
      said_no += roots.status != Status::ok ? 1U : 0U;
      if (entry.info.claims.certified && roots.status == Status::ok) {
        EXPECT_EQ(roots.list.size(), p.roots.size()) << entry.name << ": " << p.origin;
      }
    }
    std::printf("%s: %zu of %zu right, %zu uncertain or failed\n", std::string(entry.name).c_str(), right,
                asked, said_no);
    // A solver that proves its answers may leave roots of a multiplicity open.
    EXPECT_GE(2 * (right + (entry.info.claims.certified ? said_no : 0)), asked) << entry.name;
  }
}

}  // namespace
}  // namespace graze::test
