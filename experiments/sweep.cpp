#include "sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#include <fmt/format.h>

#include "errors.hpp"
#include "judge.hpp"
#include "progress.hpp"
#include "store.hpp"
#include "timing.hpp"
#include "toml_values.hpp"

namespace graze {
namespace {

// ------------------------------------------------------------------------------------------- configuration

/// Reads fields of one table and remembers them, to complain about the others.
class Fields {
 public:
  Fields(const toml::table& table, std::string file, std::string prefix)
      : table_(table), file_(std::move(file)), prefix_(std::move(prefix)) {}

  const toml::node* get(const std::string& field) {
    known_.push_back(field);
    return table_.get(field);
  }
  double number(const std::string& field, double fallback, double lo, double hi) {
    const toml::node* const node = get(field);
    if (node == nullptr) return fallback;
    const double value = toml_number(*node, file_, prefix_ + field);
    if (value >= lo && value <= hi) return value;
    throw UsageError(where(*node, file_, prefix_ + field) + fmt::format("must lie in [{}, {}]", lo, hi));
  }
  template <class Integer>
  Integer whole(const std::string& field, Integer fallback, double lo, double hi) {
    const double value = number(field, static_cast<double>(fallback), lo, hi);
    if (value == std::floor(value)) return static_cast<Integer>(value);
    throw UsageError(where(*table_.get(field), file_, prefix_ + field) + "must be a whole number");
  }
  std::string word(const std::string& field, const std::string& fallback) {
    const toml::node* const node = get(field);
    if (node == nullptr) return fallback;
    if (const auto text = node->value<std::string>()) return *text;
    throw UsageError(where(*node, file_, prefix_ + field) + "expected a string");
  }
  std::vector<std::pair<std::string, const toml::node*>> words(const std::string& field) {
    std::vector<std::pair<std::string, const toml::node*>> list;
    const toml::node* const node = get(field);
    if (node == nullptr) return list;
    const toml::array* const array = node->as_array();
    if (array == nullptr)
      throw UsageError(where(*node, file_, prefix_ + field) + "expected a list of strings");
    for (const toml::node& entry : *array) {
      const auto text = entry.value<std::string>();
      if (!text) throw UsageError(where(entry, file_, prefix_ + field) + "expected a string");
      list.emplace_back(*text, &entry);
    }
    return list;
  }
  void expect_no_others() const {
    std::vector<std::string_view> known(known_.begin(), known_.end());
    for (const auto& [key, node] : table_) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
      throw UsageError(where(node, file_, prefix_ + std::string(key.str())) +
                       unknown_name_message("field", key.str(), known));
    }
  }

 private:
  const toml::table& table_;
  std::string file_, prefix_;
  std::vector<std::string> known_;
};

/// Runs `parse` on a word of the file; its complaint is given the word's place.
template <class Parse>
auto at_its_place(const std::pair<std::string, const toml::node*>& word, const std::string& file,
                  const std::string& field, const Parse& parse) {
  try {
    return parse(word.first);
  } catch (const UsageError& error) {
    throw UsageError(where(*word.second, file, field) + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(where(*word.second, file, field) + error.what());
  }
}

void read_timing(const toml::table& root, SweepConfig& config) {
  const toml::node* const node = root.get("timing");
  if (node == nullptr) return;
  const toml::table* const table = node->as_table();
  if (table == nullptr) throw UsageError(where(*node, config.path, "timing") + "expected a table [timing]");
  Fields fields(*table, config.path, "timing.");
  config.timing_repeats = fields.whole("repeats", config.timing_repeats, 0, 1000);
  config.timing_rays = fields.whole("rays", config.timing_rays, 1, 1e7);
  config.timing_budget_ms = fields.number("budget_ms", config.timing_budget_ms, 1, 1e6);
  const std::string query = fields.word("query", "all");
  if (query != "all" && query != "first") {
    throw UsageError(where(*table->get("query"), config.path, "timing.query") +
                     "must be \"all\" or \"first\"");
  }
  config.timing_query = query == "all" ? Query::all : Query::first;
  fields.expect_no_others();
}

// ---------------------------------------------------------------------------------------------------- plan

/// A cell of the experiment with its row.
struct Cell {
  std::int64_t id = 0;
  SolverSpec solver;
};

/// One surface of the experiment.
struct Subject {
  SurfaceSpec spec;
  std::string label;
  std::int64_t id = 0;
  double size = 1;
  std::vector<Cell> cells;
  std::vector<const CaseFamily*> families;
};

/// One block of rays to judge, with the cells that have not been.
struct Work {
  const Subject* subject = nullptr;
  const CaseFamily* family = nullptr;
  std::int64_t family_id = 0;
  std::size_t block = 0;
  std::size_t count = 0;
  std::vector<const Cell*> cells;
};

std::size_t block_count(std::size_t rays) { return (rays + kCaseBlock - 1) / kCaseBlock; }
std::size_t rays_in_block(std::size_t rays, std::size_t block) {
  return std::min(kCaseBlock, rays - block * kCaseBlock);
}

/// The cells of a solver with a surface: one for each formulation that it takes, or for the one it prefers.
std::vector<Pairing> pairings_of(const SweepConfig& config, const SolverEntry& solver,
                                 const SurfaceEntry& surface, Precision precision) {
  const std::vector<Pairing> pairings = all_pairings(solver, surface, precision);
  if (config.all_formulations || pairings.empty()) return pairings;
  return {pair_up(solver, surface, {}, precision)};
}

std::vector<Cell> make_cells(const SweepConfig& config, Store& store, Subject& subject) {
  const SurfaceEntry& surface = find_surface(subject.spec.type);
  std::vector<Cell> cells;
  for (const SolverSpec& solver : config.solvers) {
    const SolverEntry& entry = find_solver(solver.name);
    for (const Precision precision : config.precisions) {
      const std::vector<Pairing> pairings = pairings_of(config, entry, surface, precision);
      for (const Pairing& pairing : pairings) {
        const FormulationInfo& formulation = surface.formulations[pairing.formulation];
        Cell cell;
        cell.solver = solver;
        cell.solver.formulation = std::string(formulation.name);
        cell.solver.precision = precision;
        cell.id = store.cell_id({subject.id, cell.solver.formulation, std::string(to_string(pairing.form)),
                                 solver.name, solver.options_text, std::string(to_string(precision)),
                                 entry.info.claims.certified && !formulation.is_plain});
        cells.push_back(cell);
      }
      for (std::size_t i = 0; i < surface.formulations.size(); ++i) {
        const bool taken = std::any_of(pairings.begin(), pairings.end(),
                                       [i](const Pairing& pairing) { return pairing.formulation == i; });
        if (taken) continue;
        store.skip(fmt::format("{} / {} / {} / {}", subject.label, surface.formulations[i].name, solver.name,
                               to_string(precision)),
                   config.all_formulations || pairings.empty()
                       ? "the solver takes no form that this formulation offers in this precision"
                       : "preferred formulations only");
      }
    }
  }
  return cells;
}

std::vector<Subject> make_subjects(const SweepConfig& config, Store& store) {
  std::vector<Subject> subjects;
  for (const SurfaceSpec& spec : config.surfaces) {
    Subject subject;
    subject.spec = spec;
    subject.label = surface_label(spec);
    const auto surface = find_surface(spec.type).make(spec);
    subject.size = surface->size();
    subject.id = store.surface_id(subject.label, spec.type, subject.size);
    subject.cells = make_cells(config, store, subject);
    for (const CaseFamily& family : case_families()) {
      const bool asked = config.cases.empty() || std::find(config.cases.begin(), config.cases.end(),
                                                           family.name) != config.cases.end();
      if (!asked) continue;
      if (family.suits(surface->landmarks())) {
        subject.families.push_back(&family);
      } else {
        store.skip(fmt::format("{} / case {}", subject.label, family.name),
                   "the family makes no sense for this surface");
      }
    }
    subjects.push_back(std::move(subject));
  }
  return subjects;
}

// -------------------------------------------------------------------------------------------- accuracy pass

/// Ids that do not depend on the order in which blocks finish.
std::int64_t ray_id(std::int64_t surface, std::int64_t family, std::size_t index) {
  return ((surface * 1000 + family) << 32) + static_cast<std::int64_t>(index);
}

SceneMember member_of(const Subject& subject, const SolverSpec& solver, double scale) {
  SceneMember member;
  member.surface = scale == 1 ? subject.spec : scaled(subject.spec, scale);
  member.formulation = solver.formulation;
  return member;
}

Scene scene_of(const Subject& subject, const SolverSpec& solver, double scale) {
  const SceneMember member = member_of(subject, solver, scale);
  return build_scene({&member, 1}, solver);
}

/// Decides which records stay: all of a small family; else the wrong and uncertain ones, the block's worst,
/// and a seeded sample.
void choose_kept(const SweepConfig& config, std::vector<RecordRow>& records) {
  const bool all = config.rays <= config.keep_all;
  RecordRow* worst = nullptr;
  for (RecordRow& record : records) {
    record.kept = all ? "all" : "";
    if (all) continue;
    if (record.judgement.verdict != Verdict::right) {
      record.kept = "wrong";
    } else if (mix64(hash_combine(config.seed, static_cast<std::uint64_t>(record.ray))) %
                   config.sample_every ==
               0) {
      record.kept = "sample";
    }
    const double error = record.judgement.condition_units.value_or(-1);
    if (worst == nullptr || error > worst->judgement.condition_units.value_or(-1)) worst = &record;
  }
  if (worst != nullptr && worst->kept.empty()) worst->kept = "worst";
}

std::vector<RayRow> make_rays(const SweepConfig& config, const Work& work, const AnySurface& surface,
                              double scale) {
  std::vector<RayRow> rows;
  const auto rays = make_block(*work.family, surface, config.seed, work.block, work.count);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RayRow row;
    row.index = work.block * kCaseBlock + i;
    row.id = ray_id(work.subject->id, work.family_id, row.index);
    row.surface = work.subject->id;
    row.family = work.family_id;
    row.ray = rays[i];
    row.scale = scale;
    rows.push_back(std::move(row));
  }
  return rows;
}

/// One cell's records over a block.
std::vector<RecordRow> run_cell(const Cell& cell, const Scene& scene, std::span<const RayRow> rows,
                                const Measure& measure, const truth::Surface& truth) {
  std::vector<Ray> rays;
  for (const RayRow& row : rows) rays.push_back(row.ray.ray);
  Scene::Workspace workspace;
  HitBuffer hits;
  scene.intersect(rays, Query::all, {.points = true, .normals = true, .params = false}, workspace, hits);

  std::vector<RecordRow> records;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t begin = hits.begin(i);
    const std::size_t count = hits.count(i);
    const Claim claim{
        hits.status[i], std::span(hits.l).subspan(begin, count), std::span(hits.point).subspan(begin, count),
        std::span(hits.normal).subspan(begin, count), std::span(hits.multiplicity).subspan(begin, count)};
    RecordRow record;
    record.cell = cell.id;
    record.ray = rows[i].id;
    record.status = claim.status;
    record.l.assign(claim.l.begin(), claim.l.end());
    record.counters = hits.counters[i];
    record.judgement = judge(rays[i], rows[i].truth, claim, measure, &truth);
    records.push_back(std::move(record));
  }
  return records;
}

BlockResult run_block(const SweepConfig& config, const Work& work) {
  const double scale = block_scale(*work.family, config.seed, work.block);
  const SurfaceSpec spec = scale == 1 ? work.subject->spec : scaled(work.subject->spec, scale);
  const auto surface = find_surface(spec.type).make(spec);
  const auto truth = truth::make_surface(spec);
  const Measure measure{config.match_radius, surface->size()};

  BlockResult result;
  result.family = work.family_id;
  result.block = work.block;
  result.rays = make_rays(config, work, *surface, scale);
  for (RayRow& row : result.rays) {
    row.truth = truth->all(row.ray.ray, {});
    row.condition = condition(row.truth, row.ray.ray, measure.size);
  }
  std::vector<bool> any_wrong(result.rays.size(), false);
  for (const Cell* cell : work.cells) {
    result.cells.push_back(cell->id);
    auto records =
        run_cell(*cell, scene_of(*work.subject, cell->solver, scale), result.rays, measure, *truth);
    choose_kept(config, records);
    for (std::size_t i = 0; i < records.size(); ++i) {
      any_wrong[i] = any_wrong[i] || records[i].judgement.verdict != Verdict::right;
    }
    std::move(records.begin(), records.end(), std::back_inserter(result.records));
  }
  // Ambiguity costs twelve truths: asked only where it excuses someone.
  for (std::size_t i = 0; i < result.rays.size(); ++i) {
    RayRow& row = result.rays[i];
    if (any_wrong[i]) row.ambiguous = is_ambiguous(*truth, row.ray.ray, row.truth);
  }
  return result;
}

/// Runs the work on `jobs` threads and hands every finished block to the store.
void run_accuracy(const SweepConfig& config, const std::vector<Work>& work, int jobs, Store& store,
                  std::int64_t build) {
  Progress progress("accuracy, blocks of rays", work.size());
  std::atomic<std::size_t> next{0};
  std::mutex store_mutex;
  std::exception_ptr failure;
  const auto worker = [&] {
    while (!interrupted()) {
      const std::size_t i = next++;
      if (i >= work.size()) return;
      try {
        const BlockResult result = run_block(config, work[i]);
        const std::lock_guard lock(store_mutex);
        store.write(build, result);
      } catch (...) {
        const std::lock_guard lock(store_mutex);
        if (!failure) failure = std::current_exception();
        next = work.size();
        return;
      }
      progress.advance();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < jobs; ++i) threads.emplace_back(worker);
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

std::vector<Work> plan_accuracy(const SweepConfig& config, const std::vector<Subject>& subjects, Store& store,
                                std::int64_t build) {
  const auto done = store.finished_blocks(build);
  std::vector<Work> plan;
  for (const Subject& subject : subjects) {
    for (const CaseFamily* family : subject.families) {
      const std::int64_t family_id = store.family_id(*family);
      for (std::size_t block = 0; block < block_count(config.rays); ++block) {
        Work work{&subject, family, family_id, block, rays_in_block(config.rays, block), {}};
        for (const Cell& cell : subject.cells) {
          if (done.count({cell.id, family_id, static_cast<std::int64_t>(block)}) == 0)
            work.cells.push_back(&cell);
        }
        if (!work.cells.empty()) plan.push_back(std::move(work));
      }
    }
  }
  return plan;
}

// ---------------------------------------------------------------------------------------------- timing pass

/// The scenes and rays of one family, kept alive while they are timed.
struct TimedFamily {
  std::vector<std::vector<Ray>> rays;      ///< by block group
  std::vector<double> scales;              ///< of each group
  std::vector<std::vector<Scene>> scenes;  ///< by cell, by group
};

TimedFamily prepare_timing(const SweepConfig& config, const Subject& subject, const CaseFamily& family) {
  TimedFamily timed;
  for (std::size_t block = 0; block < block_count(config.timing_rays); ++block) {
    const double scale = block_scale(family, config.seed, block);
    const SurfaceSpec spec = scale == 1 ? subject.spec : scaled(subject.spec, scale);
    const auto surface = find_surface(spec.type).make(spec);
    if (timed.scales.empty() || timed.scales.back() != scale) {
      timed.scales.push_back(scale);
      timed.rays.emplace_back();
    }
    const auto rays =
        make_block(family, *surface, config.seed, block, rays_in_block(config.timing_rays, block));
    for (const CaseRay& ray : rays) timed.rays.back().push_back(ray.ray);
  }
  for (const Cell& cell : subject.cells) {
    timed.scenes.emplace_back();
    for (const double scale : timed.scales)
      timed.scenes.back().push_back(scene_of(subject, cell.solver, scale));
  }
  return timed;
}

/// Notes a cell whose repeats scatter: its median says little.
void warn_of_noise(const std::vector<std::vector<double>>& samples, const Subject& subject,
                   const CaseFamily& family, Store& store, std::int64_t build) {
  std::size_t noisy = 0;
  constexpr double kNoisy = 1.5;  // p90 / median; an idle machine stays below 1.1
  for (const auto& times : samples) {
    const Spread s = spread(times);
    noisy += s.median > 0 && s.p90 / s.median > kNoisy ? 1 : 0;
  }
  if (noisy == 0) return;
  store.note(
      build, "timing",
      fmt::format(
          "{} / {}: {} of {} cells scatter (90th percentile over {} times the median): the machine was "
          "busy",
          subject.label, family.name, noisy, samples.size(), kNoisy));
}

void time_family(const SweepConfig& config, const Subject& subject, const CaseFamily& family, Store& store,
                 std::int64_t build, Progress& progress) {
  const std::int64_t family_id = store.family_id(family);
  const auto done = store.finished_timings(build);
  const TimedFamily timed = prepare_timing(config, subject, family);
  std::vector<Contestant> contestants;
  std::vector<std::int64_t> ids;
  for (std::size_t c = 0; c < subject.cells.size(); ++c) {
    if (done.count({subject.cells[c].id, family_id, config.timing_repeats - 1}) != 0) continue;
    Contestant contestant;
    contestant.query = config.timing_query;
    for (std::size_t g = 0; g < timed.rays.size(); ++g) {
      contestant.groups.push_back({&timed.scenes[c][g], timed.rays[g]});
    }
    contestants.push_back(std::move(contestant));
    ids.push_back(subject.cells[c].id);
  }
  std::vector<std::vector<double>> samples(contestants.size());
  std::vector<TimingRow> rows;
  const TimingOptions options{config.timing_repeats, 1e-3 * config.timing_budget_ms,
                              hash_combine(config.seed, static_cast<std::uint64_t>(family_id))};
  time_contestants(contestants, options, [&](const TimingSample& sample) {
    samples[sample.contestant].push_back(sample.ns_per_ray);
    rows.push_back({ids[sample.contestant], family_id, sample.repeat, sample.turn, sample.rays,
                    sample.ns_per_ray, config.timing_query == Query::all ? "all" : "first", sample.censored});
    progress.advance();
    return !interrupted();
  });
  // Interleaved turns belong together: a family counts as timed when all of them are done.
  if (interrupted()) return;
  for (const TimingRow& row : rows) store.write(build, row);
  warn_of_noise(samples, subject, family, store, build);
}

void run_timing(const SweepConfig& config, const std::vector<Subject>& subjects, Store& store,
                std::int64_t build) {
  if (config.timing_repeats == 0) return;
  const auto done = store.finished_timings(build);
  struct Item {
    const Subject* subject;
    const CaseFamily* family;
  };
  std::vector<Item> items;
  std::size_t turns = 0;
  for (const Subject& subject : subjects) {
    for (const CaseFamily* family : subject.families) {
      std::size_t missing = 0;
      for (const Cell& cell : subject.cells) {
        if (done.count({cell.id, store.family_id(*family), config.timing_repeats - 1}) == 0) ++missing;
      }
      if (missing > 0) items.push_back({&subject, family});
      turns += missing * static_cast<std::size_t>(config.timing_repeats);
    }
  }
  if (items.empty()) return;
  const PinnedCore pinned;
  if (!pinned.warning().empty()) store.note(build, "timing", pinned.warning());
  Progress progress("timing, turns", turns);
  for (const Item& item : items) {
    if (!interrupted()) time_family(config, *item.subject, *item.family, store, build, progress);
  }
}

// -------------------------------------------------------------------------------------------------- store

/// What decides the rays and the verdicts must not change under a store that has results.
void check_same_experiment(const SweepConfig& config, Store& store, const std::string& out) {
  const std::map<std::string, std::string> identity{{"format", "1"},
                                                    {"seed", fmt::format("{}", config.seed)},
                                                    {"match_radius", fmt::format("{}", config.match_radius)},
                                                    {"keep_all", fmt::format("{}", config.keep_all)}};
  for (const auto& [key, value] : identity) {
    const auto stored = store.meta(key);
    if (stored && *stored != value) {
      throw UsageError(
          fmt::format("{} holds a run with {} = {}, this configuration has {}: choose another --out", out,
                      key, *stored, value));
    }
    store.set_meta(key, value);
  }
}

/// Blocks are finished whole, so a run grows only from a whole number of them.
void check_growth(const SweepConfig& config, Store& store, const std::string& out) {
  const auto stored = store.meta("rays");
  const std::size_t before = stored ? std::stoul(*stored) : config.rays;
  if (config.rays > before && before % kCaseBlock != 0) {
    throw UsageError(fmt::format(
        "{} holds {} rays a family, which is no multiple of {}: it cannot grow to {}; choose another --out",
        out, before, kCaseBlock, config.rays));
  }
  store.set_meta("rays", fmt::format("{}", std::max(before, config.rays)));
}

}  // namespace

SweepConfig read_sweep_config(const std::string& path) {
  const toml::table root = parse_toml_file(path);
  SweepConfig config;
  config.path = path;
  config.text = [&] {
    std::ostringstream text;
    text << root;
    return text.str();
  }();
  Fields fields(root, path, "");
  config.name = fields.word("name", std::filesystem::path(path).stem().string());
  config.title = fields.word("title", config.name);
  config.seed = fields.whole("seed", config.seed, 0, 0x1p53);
  config.rays = fields.whole("rays", config.rays, 1, 1e9);
  config.match_radius = fields.number("match_radius", config.match_radius, 1e-15, 0.1);
  config.keep_all = fields.whole("keep_all", config.keep_all, 0, 1e12);
  config.sample_every = fields.whole("sample_every", config.sample_every, 1, 1e9);
  for (const auto& word : fields.words("surfaces")) {
    config.surfaces.push_back(at_its_place(word, path, "surfaces", parse_surface));
  }
  for (const auto& word : fields.words("solvers")) {
    config.solvers.push_back(at_its_place(word, path, "solvers", parse_solver));
  }
  const std::string formulations = fields.word("formulations", "all");
  if (formulations != "all" && formulations != "preferred") {
    throw UsageError(where(*root.get("formulations"), path, "formulations") +
                     "must be \"all\" or \"preferred\"");
  }
  config.all_formulations = formulations == "all";
  const auto precisions = fields.words("precision");
  if (!precisions.empty()) config.precisions.clear();
  for (const auto& [name, node] : precisions) {
    if (name != "double" && name != "float") {
      throw UsageError(where(*node, path, "precision") + "must be \"double\" or \"float\"");
    }
    config.precisions.push_back(name == "float" ? Precision::binary32 : Precision::binary64);
  }
  for (const auto& word : fields.words("cases")) {
    config.cases.push_back(at_its_place(
        word, path, "cases", [](const std::string& name) { return std::string(find_family(name).name); }));
  }
  fields.get("timing");
  fields.expect_no_others();
  read_timing(root, config);
  if (config.surfaces.empty()) throw UsageError(path + ": field 'surfaces': missing or empty");
  if (config.solvers.empty()) throw UsageError(path + ": field 'solvers': missing or empty");
  return config;
}

void run_sweep(const SweepConfig& config, const SweepOptions& options) {
  watch_for_interrupt();
  Store store(options.out);
  check_same_experiment(config, store, options.out);
  check_growth(config, store, options.out);
  for (const auto& [key, value] : std::map<std::string, std::string>{{"name", config.name},
                                                                     {"title", config.title},
                                                                     {"config", config.text},
                                                                     {"config_path", config.path},
                                                                     {"command", options.command}}) {
    store.set_meta(key, value);
  }
  const std::int64_t build = store.build_id();
  const std::vector<Subject> subjects = make_subjects(config, store);
  const std::vector<Work> plan = plan_accuracy(config, subjects, store, build);
  const std::string resume =
      fmt::format("interrupted; what is finished is kept in {}: run the same command to go on", options.out);
  if (!plan.empty()) run_accuracy(config, plan, options.jobs, store, build);
  if (interrupted()) throw Interrupted(resume);
  run_timing(config, subjects, store, build);
  if (interrupted()) throw Interrupted(resume);
  store.set_meta("finished", utc_now());
}

}  // namespace graze
