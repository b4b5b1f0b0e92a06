// graze bench: ns per ray of several solvers, interleaved in one process.
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <graze/experiments/truth.hpp>

#include "cases.hpp"
#include "commands.hpp"
#include "errors.hpp"
#include "json_lines.hpp"
#include "judge.hpp"
#include "operations.hpp"
#include "peers.hpp"
#include "timing.hpp"

namespace graze {
namespace {

struct BenchOptions {
  std::string surface;
  std::vector<std::string> cases;
  std::string solvers = std::string(kDefaultSolver);
  std::string formulation;
  std::string precision = "double";
  std::string query = "first";
  std::size_t rays = 8192;
  std::size_t judged = 1000;
  double match_radius = Measure{}.match_radius;
  std::optional<double> misses;
  int threads = 1;
  int repeats = 15;
  double budget_ms = 200;
  std::uint64_t seed = 1;
  bool json = false;
};

/// Rays whose operations are counted: enough for a steady mean, few enough for the slowest solver.
constexpr std::size_t kCountedRays = 1000;

/// The family's rays; those of the family `scale` at scale 1, since one surface is timed.
std::vector<Ray> family_rays(const CaseFamily& family, const AnySurface& surface,
                             const BenchOptions& options) {
  std::vector<Ray> rays;
  for (std::size_t block = 0; rays.size() < options.rays; ++block) {
    const std::size_t count = std::min(kCaseBlock, options.rays - rays.size());
    for (const CaseRay& ray : make_block(family, surface, options.seed, block, count))
      rays.push_back(ray.ray);
  }
  return rays;
}

/// Rays from the same origins past the centre `width` times as far from it: a wider lens.
std::vector<Ray> spread_about(Vec3 centre, std::span<const Ray> rays, double width) {
  std::vector<Ray> wide;
  for (const Ray& ray : rays) {
    const double foot = dot(centre - ray.o, ray.d) / dot(ray.d, ray.d);
    const Vec3 target = ray.o + foot * ray.d;
    wide.push_back({ray.o, normalized(centre + width * (target - centre) - ray.o)});
  }
  return wide;
}

double share_of_misses(const Scene& scene, std::span<const Ray> rays) {
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, Query::any, {}, work, hits);
  return 1 - static_cast<double>(hits.l.size()) / static_cast<double>(rays.size());
}

/// The family's rays, spread until the wanted share of them misses, as the default solver says.
std::vector<Ray> rays_with_misses(const CaseFamily& family, const AnySurface& surface,
                                  const SurfaceSpec& spec, const BenchOptions& options) {
  SceneMember member;
  member.surface = spec;
  const Scene scene = build_scene({&member, 1}, parse_solver(std::string(kDefaultSolver)), Query::any);
  const std::vector<Ray> rays = family_rays(family, surface, options);
  const Vec3 centre = surface.landmarks().centre;
  const auto misses = [&](double width) { return share_of_misses(scene, spread_about(centre, rays, width)); };
  double low = 1, high = 64;  // the share grows with the width, but for accidents of the draw
  if (misses(low) > *options.misses || misses(high) < *options.misses)
    throw UsageError(fmt::format("--misses: no width of case '{}' has this share of misses", family.name));
  constexpr int kHalvings = 20;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (misses(middle) < *options.misses ? low : high) = middle;
  }
  return spread_about(centre, rays, high);
}

/// Answers on the first rays, against truth: all hits, the first one, or (any) only whether there is one.
struct Score {
  std::size_t judged = 0, wrong = 0, uncertain = 0, failed = 0, hits = 0;
};

std::vector<truth::Answer> first_truths(const SurfaceSpec& spec, std::span<const Ray> rays, Query query) {
  const auto truth = truth::make_surface(spec);
  std::vector<truth::Answer> answers;
  for (const Ray& ray : rays) {
    answers.push_back(truth->all(ray, {.digits = 17}));
    if (query != Query::all && answers.back().hits.size() > 1) answers.back().hits.resize(1);
  }
  return answers;
}

/// Query any: any hit will do, and an answer need not say where it is. One that lists none under a status
/// other than ok claims nothing.
Verdict judge_presence(const truth::Answer& truth, const Claim& claim) {
  if (claim.l.empty() && claim.status == Status::uncertain) return Verdict::uncertain;
  if (claim.l.empty() && (claim.status == Status::failed || claim.status == Status::invalid))
    return Verdict::failed;
  const bool is_right = (claim.status == Status::coincident) == (truth.status == Status::coincident) &&
                        claim.l.empty() == truth.hits.empty();
  return is_right ? Verdict::right : Verdict::wrong;
}

Score score(const Scene& scene, std::span<const Ray> rays, Query query, std::span<const truth::Answer> truths,
            const Measure& measure) {
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, query, {}, work, hits);
  Score result;
  result.hits = hits.l.size();
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const Claim claim{hits.status[i],
                      std::span(hits.l).subspan(hits.begin(i), hits.count(i)),
                      {},
                      {},
                      std::span(hits.multiplicity).subspan(hits.begin(i), hits.count(i))};
    const Verdict verdict = query == Query::any ? judge_presence(truths[i], claim)
                                                : judge(rays[i], truths[i], claim, measure, nullptr).verdict;
    ++result.judged;
    result.wrong += verdict == Verdict::wrong ? 1 : 0;
    result.uncertain += verdict == Verdict::uncertain ? 1 : 0;
    result.failed += verdict == Verdict::failed ? 1 : 0;
  }
  return result;
}

/// The rays that one tier of a ladder answered, and what they cost by themselves.
struct TierLine {
  std::uint32_t tier = 0;
  std::vector<Ray> rays;
  Spread ns;
};

struct Line {
  std::string solver, formulation;
  Spread ns;
  std::vector<TierLine> tiers;
  Score score;
  std::optional<OperationTotals> operations;
  std::size_t rays = 0;
  bool censored = false;
};

/// "412.5", or "81.0 + 9.2 f" where f is evaluated outside the solver; "-" where nothing was counted.
std::string operations_text(const std::optional<OperationTotals>& operations) {
  if (!operations) return "-";
  std::string text = fmt::format("{:.1f}", operations->per_ray(operations->count.flops()));
  if (operations->evaluations > 0)
    text += fmt::format(" + {:.1f} f", operations->per_ray(operations->evaluations));
  return text;
}

/// Means over the rays counted; null where nothing was.
nlohmann::ordered_json operations_json(const std::optional<OperationTotals>& operations) {
  if (!operations) return nullptr;
  const OperationCount& count = operations->count;
  const auto mean = [&](std::uint64_t total) { return operations->per_ray(total); };
  return {{"total", mean(count.flops())},
          {"additions", mean(count.additions)},
          {"multiplications", mean(count.multiplications)},
          {"divisions", mean(count.divisions)},
          {"square_roots", mean(count.square_roots)},
          {"fused", mean(count.fused)},
          {"functions", mean(count.functions)},
          {"comparisons", mean(count.comparisons)},
          {"evaluations_apart", mean(operations->evaluations)},
          {"rays", operations->rays}};
}

/// The rays by the highest tier that each needed.
std::vector<TierLine> rays_by_tier(const Scene& scene, std::span<const Ray> rays, Query query) {
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, query, {}, work, hits);
  std::vector<TierLine> tiers;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t tier = hits.counters[i].tier;
    if (tier >= tiers.size()) tiers.resize(tier + 1);
    tiers[tier].tier = tier;
    tiers[tier].rays.push_back(rays[i]);
  }
  // Tier 0 is none: rays that no solver was asked about, and solvers that have no tiers.
  tiers.erase(tiers.begin());
  std::erase_if(tiers, [](const TierLine& line) { return line.rays.empty(); });
  return tiers;
}

/// Each tier's rays alone, after the whole cells: their memory shall not disturb those.
void time_tiers(std::span<const Scene> scenes, const TimingOptions& options, Query query,
                std::vector<Line>& lines) {
  std::vector<Contestant> contestants;
  std::vector<TierLine*> timed;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (TierLine& tier : lines[i].tiers) {
      contestants.push_back({{{&scenes[i], tier.rays}}, query});
      timed.push_back(&tier);
    }
  }
  std::vector<std::vector<double>> samples(timed.size());
  time_contestants(contestants, options, [&](const TimingSample& sample) {
    samples[sample.contestant].push_back(sample.ns_per_ray);
    return true;
  });
  for (std::size_t i = 0; i < timed.size(); ++i) timed[i]->ns = spread(samples[i]);
}

/// "tier 1: 98.2 %, 11.5 ns; tier 3: 1.8 %, 251000 ns".
std::string tiers_text(const Line& line, std::size_t rays) {
  std::string text;
  for (const TierLine& tier : line.tiers) {
    text += fmt::format("{}tier {}: {:.4g} %, {:.4g} ns", text.empty() ? "" : "; ", tier.tier,
                        100.0 * static_cast<double>(tier.rays.size()) / static_cast<double>(rays),
                        tier.ns.median);
  }
  return text;
}

nlohmann::ordered_json tiers_json(const Line& line) {
  nlohmann::ordered_json tiers = nlohmann::ordered_json::array();
  for (const TierLine& tier : line.tiers) {
    tiers.push_back(
        {{"tier", tier.tier},
         {"rays", tier.rays.size()},
         {"ns_per_ray", {{"min", tier.ns.min}, {"median", tier.ns.median}, {"p90", tier.ns.p90}}}});
  }
  return tiers;
}

void print(const BenchOptions& options, const CaseFamily& family, const std::vector<Line>& lines,
           Output& output) {
  fmt::memory_buffer& out = output.buffer();
  if (!options.json) {
    fmt::format_to(std::back_inserter(out),
                   "{} / {}, query {}, {} rays\n  {:<28} {:<20} {:>12} {:>12} {:>12} {:>20}  {}\n",
                   options.surface, family.name, options.query, options.rays, "solver", "formulation",
                   "median ns", "min ns", "p90 ns", "solver operations",
                   "wrong / uncertain / failed of judged");
  }
  for (const Line& line : lines) {
    if (options.json) {
      const nlohmann::ordered_json json{
          {"surface", options.surface},
          {"case", family.name},
          {"solver", line.solver},
          {"formulation", line.formulation},
          {"precision", options.precision},
          {"query", options.query},
          {"rays", line.rays},
          {"threads", options.threads},
          {"ns_per_ray", {{"min", line.ns.min}, {"median", line.ns.median}, {"p90", line.ns.p90}}},
          {"tiers", tiers_json(line)},
          {"solver_operations", operations_json(line.operations)},
          {"hits", line.score.hits},
          {"wrong", line.score.wrong},
          {"uncertain", line.score.uncertain},
          {"failed", line.score.failed},
          {"judged", line.score.judged},
          {"censored", line.censored}};
      fmt::format_to(std::back_inserter(out), "{}\n", json.dump());
    } else {
      fmt::format_to(std::back_inserter(out),
                     "  {:<28} {:<20} {:>12.1f} {:>12.1f} {:>12.1f} {:>20}  {} / {} / {} of {}{}\n",
                     line.solver, line.formulation, line.ns.median, line.ns.min, line.ns.p90,
                     operations_text(line.operations), line.score.wrong, line.score.uncertain,
                     line.score.failed, line.score.judged,
                     line.censored ? fmt::format("  (timed on {} rays)", line.rays) : "");
      if (!line.tiers.empty())
        fmt::format_to(std::back_inserter(out), "    {}\n", tiers_text(line, options.rays));
    }
  }
  output.flush();
}

void bench_family(const BenchOptions& options, const SurfaceSpec& spec, std::span<const SolverSpec> solvers,
                  const CaseFamily& family, Output& output) {
  const auto surface = find_surface(spec.type).make(spec);
  if (!family.suits(surface->landmarks())) {
    throw UsageError(fmt::format("case '{}' makes no sense for {}", family.name, options.surface));
  }
  const Query query = parse_query(options.query);
  const std::vector<Ray> rays = options.misses ? rays_with_misses(family, *surface, spec, options)
                                               : family_rays(family, *surface, options);
  const auto truths = first_truths(spec, std::span(rays).first(std::min(options.judged, rays.size())), query);

  std::vector<Scene> scenes;
  std::vector<Line> lines;
  for (const SolverSpec& solver : solvers) {
    SceneMember member;
    member.surface = spec;
    member.formulation = options.formulation;
    scenes.push_back(build_scene({&member, 1}, solver, query));
    Line line;
    line.solver = solver.options_text.empty() ? solver.name : solver.name + ":" + solver.options_text;
    const std::size_t formulation = scenes.back().pairing(0).formulation;
    const SolverEntry& entry = find_solver_or_peer(solver.name);
    const SurfaceEntry seen = seen_by(entry, find_surface(spec.type), query);
    line.formulation = std::string(seen.formulations[formulation].name);
    line.score = score(scenes.back(), std::span(rays).first(truths.size()), query, truths,
                       {options.match_radius, surface->size()});
    // Ladders are certified; other solvers have no tiers, and all rays are many for the slow ones.
    if (entry.info.claims.certified) line.tiers = rays_by_tier(scenes.back(), rays, query);
    line.operations = count_operations(spec, options.formulation, solver,
                                       std::span(rays).first(std::min(kCountedRays, rays.size())), query);
    lines.push_back(std::move(line));
  }
  std::vector<Contestant> contestants;
  for (const Scene& scene : scenes) contestants.push_back({{{&scene, rays}}, query});
  std::vector<std::vector<double>> samples(scenes.size());
  const TimingOptions timing{options.repeats, 1e-3 * options.budget_ms, options.seed, options.threads};
  time_contestants(contestants, timing, [&](const TimingSample& sample) {
    samples[sample.contestant].push_back(sample.ns_per_ray);
    lines[sample.contestant].rays = sample.rays;
    lines[sample.contestant].censored |= sample.censored;
    return true;
  });
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].ns = spread(samples[i]);
  time_tiers(scenes, timing, query, lines);
  print(options, family, lines, output);
}

/// The solvers named, or with "all" every one that takes an equation of the surface.
std::vector<SolverSpec> solvers_to_bench(const BenchOptions& options, const SurfaceSpec& spec) {
  const Precision precision = parse_precision(options.precision);
  std::vector<SolverSpec> solvers;
  if (options.solvers != "all") {
    solvers = parse_solver_list(options.solvers);
  } else {
    const Query query = parse_query(options.query);
    for (const SolverEntry* const entry : solvers_and_peers()) {
      if (all_pairings(*entry, seen_by(*entry, find_surface(spec.type), query), precision).empty()) continue;
      solvers.push_back(parse_solver_list(entry->name).front());
    }
  }
  for (SolverSpec& solver : solvers) solver.precision = precision;
  return solvers;
}

void bench(const BenchOptions& options) {
  const SurfaceSpec spec = parse_surface(options.surface);
  const std::vector<SolverSpec> solvers = solvers_to_bench(options, spec);
  std::optional<PinnedCore> pinned;
  if (options.threads == 1) pinned.emplace();
  if (pinned && !pinned->warning().empty())
    fmt::print(stderr, "graze bench: warning: {}\n", pinned->warning());
  Output output;
  for (const std::string& name : options.cases) {
    const CaseFamily* family = nullptr;
    try {
      family = &find_family(name);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
    bench_family(options, spec, solvers, *family, output);
  }
}

}  // namespace

Action add_bench_command(CLI::App& app) {
  CLI::App* const command =
      app.add_subcommand("bench", "ns per ray of several solvers, interleaved in one process");
  const auto options = std::make_shared<BenchOptions>();
  options->cases = {"camera"};
  command->add_option("--surface", options->surface, "surface, values in TOML syntax: teardrop:s=1")
      ->type_name("NAME:key=value,...")
      ->required();
  command
      ->add_option("--solver", options->solvers,
                   "solvers to compare: A,B:key=value,C; or all that take the surface (default certified)")
      ->type_name("A,B,...|all");
  command->add_option("--case", options->cases, "case families (default camera)")
      ->type_name("NAME,...")
      ->delimiter(',');
  command
      ->add_option("--formulation", options->formulation,
                   "equation to solve (default: each solver's preference)")
      ->type_name("NAME");
  add_precision_option(*command, options->precision);
  add_query_option(*command, options->query);
  command->get_option("--query")->description("all hits, the first hit, or any one hit (default first)");
  command->add_option("--rays", options->rays, "rays (default 8192: resident in the L2 cache)")
      ->check(CLI::Range(1, 100000000));
  command->add_option("--judge", options->judged, "rays judged against truth (default 1000)")
      ->check(CLI::Range(0, 100000000));
  command
      ->add_option("--match-radius", options->match_radius,
                   "how near a claimed hit is to be, relative to |l| + L/|d| (default 1e-6)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--misses", options->misses,
                   "spread the rays about the surface until this share misses (default: as the family is)")
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--threads", options->threads,
                   "threads that share the rays of a turn (default 1, pinned); for many rays")
      ->check(CLI::Range(1, 1024));
  command->add_option("--repeats", options->repeats, "counted turns of each solver (default 15)")
      ->check(CLI::Range(1, 100000));
  command->add_option("--budget-ms", options->budget_ms, "time after which a turn stops (default 200)")
      ->check(CLI::Range(1.0, 1e6));
  command->add_option("--seed", options->seed, "of rays and order (default 1)");
  command->add_flag("--json", options->json, "one JSON object a line");
  return [options] { bench(*options); };
}

}  // namespace graze
