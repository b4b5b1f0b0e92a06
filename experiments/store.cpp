#include "store.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "build_info.hpp"
#include "errors.hpp"
#include "numbers.hpp"
#include "schema.hpp"

namespace graze {
namespace {

/// Database errors as the program's own.
template <class Function>
auto guarded(const std::string& file, const Function& function) {
  try {
    return function();
  } catch (const SQLite::Exception& error) {
    throw EnvironmentError(fmt::format("{}: {}", file, error.what()));
  }
}

/// Histogram bins: floor(4 log2 value), with one bin for zero and one for infinity.
int histogram_bin(double value) {
  constexpr int kZero = -100000, kInfinite = 100000;
  if (value == 0) return kZero;
  if (std::isinf(value)) return kInfinite;
  return static_cast<int>(std::floor(4 * std::log2(value)));
}

struct Metric {
  const char* name;
  std::optional<double> Judgement::*value;
};
constexpr std::array<Metric, 4> kMetrics{{{"ulps", &Judgement::ulps},
                                          {"condition_units", &Judgement::condition_units},
                                          {"backward", &Judgement::backward},
                                          {"normal_error", &Judgement::normal_error}}};

void bind(SQLite::Statement& statement, int index, const std::optional<double>& value) {
  if (value) {
    statement.bind(index, *value);
  } else {
    statement.bind(index);
  }
}

/// Truth as JSON for the ray's row.
std::string truth_json(const truth::Answer& truth) {
  std::vector<std::string> hits;
  for (const truth::Hit& hit : truth.hits) {
    hits.push_back(fmt::format(R"({{"l":"{}","multiplicity":{},"cosine":{}}})", hit.l.decimal,
                               hit.multiplicity, hit.cosine));
  }
  return fmt::format("[{}]", fmt::join(hits, ","));
}

/// Counts over the rays of one (cell, block).
struct Tally {
  int rays = 0, missed = 0, spurious = 0, wrong_first = 0, ambiguous_wrong = 0;
  std::array<int, 4> verdicts{};
  std::int64_t evaluations = 0, iterations = 0, starts = 0;

  void add(const RecordRow& record, bool ambiguous) {
    const Judgement& j = record.judgement;
    ++rays;
    ++verdicts[static_cast<std::size_t>(j.verdict)];
    missed += j.missed > 0 ? 1 : 0;
    spurious += j.spurious > 0 ? 1 : 0;
    wrong_first += j.wrong_first ? 1 : 0;
    ambiguous_wrong += j.verdict == Verdict::wrong && ambiguous ? 1 : 0;
    evaluations += record.counters.evaluations;
    iterations += record.counters.iterations;
    starts += record.counters.starts;
  }
};

}  // namespace

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
}

struct Store::Implementation {
  std::string file;
  SQLite::Database database;

  explicit Implementation(const std::string& path)
      : file(path), database(path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE) {
    database.setBusyTimeout(10000);
    database.exec("PRAGMA journal_mode=WAL");
    database.exec("PRAGMA synchronous=NORMAL");
    database.exec(kSchema);
  }

  /// The id of a row that matches, or of the one that `insert` makes.
  template <class BindFunction>
  std::int64_t find_or_insert(const char* find, const char* insert, const BindFunction& bind_keys) {
    return guarded(file, [&]() -> std::int64_t {
      SQLite::Statement query(database, find);
      bind_keys(query);
      if (query.executeStep()) return query.getColumn(0).getInt64();
      SQLite::Statement make(database, insert);
      bind_keys(make);
      make.exec();
      return database.getLastInsertRowid();
    });
  }

  std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> triples(const char* sql,
                                                                         std::int64_t build) {
    return guarded(file, [&] {
      std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> found;
      SQLite::Statement query(database, sql);
      query.bind(1, build);
      while (query.executeStep()) {
        found.emplace(query.getColumn(0).getInt64(), query.getColumn(1).getInt64(),
                      query.getColumn(2).getInt64());
      }
      return found;
    });
  }

  void write_ray(const RayRow& row) {
    SQLite::Statement insert(
        database,
        "INSERT INTO ray VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?) ON CONFLICT(id) DO UPDATE "
        "SET ambiguous = coalesce(excluded.ambiguous, ambiguous)");
    int i = 0;
    insert.bind(++i, row.id);
    insert.bind(++i, row.surface);
    insert.bind(++i, row.family);
    insert.bind(++i, static_cast<std::int64_t>(row.index));
    insert.bind(++i, row.ray.difficulty);
    insert.bind(++i, row.scale);
    const Ray& ray = row.ray.ray;
    for (const double v : {ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z})
      insert.bind(++i, hex_float(v));
    insert.bind(++i, std::string(to_string(row.truth.status)));
    insert.bind(++i, static_cast<int>(row.truth.hits.size()));
    insert.bind(++i, truth_json(row.truth));
    bind(insert, ++i, row.condition);
    if (row.ambiguous) {
      insert.bind(++i, *row.ambiguous ? 1 : 0);
    } else {
      insert.bind(++i);
    }
    insert.exec();
  }

  void write_record(SQLite::Statement& insert, std::int64_t build, const RecordRow& record) {
    const Judgement& j = record.judgement;
    std::vector<std::string> hits;
    for (const double l : record.l) hits.push_back(hex_float(l));
    insert.reset();
    insert.clearBindings();
    int i = 0;
    insert.bind(++i, build);
    insert.bind(++i, record.cell);
    insert.bind(++i, record.ray);
    insert.bind(++i, std::string(to_string(j.verdict)));
    insert.bind(++i, std::string(to_string(record.status)));
    insert.bind(++i, fmt::format("{}", fmt::join(hits, " ")));
    insert.bind(++i, j.missed);
    insert.bind(++i, j.spurious);
    insert.bind(++i, j.wrong_first ? 1 : 0);
    for (const Metric& metric : kMetrics) bind(insert, ++i, j.*metric.value);
    insert.bind(++i, static_cast<std::int64_t>(record.counters.evaluations));
    insert.bind(++i, static_cast<std::int64_t>(record.counters.iterations));
    insert.bind(++i, static_cast<std::int64_t>(record.counters.starts));
    insert.bind(++i, record.kept);
    insert.exec();
  }

  void write_tally(std::int64_t build, const BlockResult& result, std::int64_t cell, const Tally& tally) {
    SQLite::Statement insert(database, "INSERT INTO tally VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    int i = 0;
    for (const std::int64_t key : {build, cell, result.family, static_cast<std::int64_t>(result.block)}) {
      insert.bind(++i, key);
    }
    insert.bind(++i, tally.rays);
    for (const int count : tally.verdicts) insert.bind(++i, count);
    for (const int count : {tally.missed, tally.spurious, tally.wrong_first, tally.ambiguous_wrong}) {
      insert.bind(++i, count);
    }
    for (const std::int64_t work : {tally.evaluations, tally.iterations, tally.starts})
      insert.bind(++i, work);
    insert.exec();
  }

  void write_histograms(std::int64_t build, const BlockResult& result) {
    std::map<std::tuple<std::int64_t, std::size_t, int>, int> counts;
    for (const RecordRow& record : result.records) {
      for (std::size_t m = 0; m < kMetrics.size(); ++m) {
        if (const auto& value = record.judgement.*kMetrics[m].value) {
          ++counts[{record.cell, m, histogram_bin(*value)}];
        }
      }
    }
    SQLite::Statement add(database,
                          "INSERT INTO histogram VALUES(?,?,?,?,?,?) ON CONFLICT DO UPDATE SET "
                          "count = count + excluded.count");
    for (const auto& [key, count] : counts) {
      const auto& [cell, metric, bin] = key;
      add.reset();
      add.bind(1, build);
      add.bind(2, cell);
      add.bind(3, result.family);
      add.bind(4, std::string(kMetrics[metric].name));
      add.bind(5, bin);
      add.bind(6, count);
      add.exec();
    }
  }
};

Store::Store(const std::string& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error)
    throw EnvironmentError(fmt::format("{}: cannot make this folder: {}", directory, error.message()));
  const std::string file = (std::filesystem::path(directory) / "run.sqlite").string();
  implementation_ = guarded(file, [&] { return std::make_unique<Implementation>(file); });
}

Store::~Store() = default;

std::optional<std::string> Store::meta(const std::string& key) const {
  return guarded(implementation_->file, [&]() -> std::optional<std::string> {
    SQLite::Statement query(implementation_->database, "SELECT value FROM meta WHERE key = ?");
    query.bind(1, key);
    if (query.executeStep()) return query.getColumn(0).getString();
    return std::nullopt;
  });
}

void Store::set_meta(const std::string& key, const std::string& value) {
  guarded(implementation_->file, [&] {
    SQLite::Statement insert(implementation_->database, "INSERT OR REPLACE INTO meta VALUES(?,?)");
    insert.bind(1, key);
    insert.bind(2, value);
    return insert.exec();
  });
}

std::int64_t Store::build_id() {
  return guarded(implementation_->file, [&]() -> std::int64_t {
    SQLite::Statement query(implementation_->database, "SELECT id FROM build WHERE key = ?");
    query.bind(1, build_key());
    if (query.executeStep()) return query.getColumn(0).getInt64();
    const BuildInfo& build = build_info();
    const Machine machine = this_machine();
    SQLite::Statement insert(
        implementation_->database,
        "INSERT INTO build(key,version,git_commit,compiler,flags,instruction_set,cpu,cores,"
        "system,started) VALUES(?,?,?,?,?,?,?,?,?,?)");
    int i = 0;
    for (const std::string& text : {build_key(), build.version, build.git_commit, build.compiler, build.flags,
                                    machine.instruction_set, machine.cpu}) {
      insert.bind(++i, text);
    }
    insert.bind(++i, machine.cores);
    insert.bind(++i, machine.system);
    insert.bind(++i, utc_now());
    insert.exec();
    return implementation_->database.getLastInsertRowid();
  });
}

std::int64_t Store::surface_id(const std::string& label, const std::string& type, double size) {
  return implementation_->find_or_insert("SELECT id FROM surface WHERE label = ?1",
                                         "INSERT INTO surface(label,type,size) VALUES(?1,?2,?3)",
                                         [&](SQLite::Statement& statement) {
                                           statement.bind(1, label);
                                           if (statement.getBindParameterCount() < 3) return;
                                           statement.bind(2, type);
                                           statement.bind(3, size);
                                         });
}

std::int64_t Store::family_id(const CaseFamily& family) {
  return implementation_->find_or_insert("SELECT id FROM family WHERE name = ?1",
                                         "INSERT INTO family(name,summary,difficulty) VALUES(?1,?2,?3)",
                                         [&](SQLite::Statement& statement) {
                                           statement.bind(1, std::string(family.name));
                                           if (statement.getBindParameterCount() < 3) return;
                                           statement.bind(2, std::string(family.summary));
                                           statement.bind(3, std::string(family.difficulty));
                                         });
}

std::int64_t Store::cell_id(const CellRow& cell) {
  return implementation_->find_or_insert(
      "SELECT id FROM cell WHERE surface = ?1 AND formulation = ?2 AND solver = ?3 AND options = ?4 AND "
      "precision = ?5",
      "INSERT INTO cell(surface,formulation,solver,options,precision,form,certified) "
      "VALUES(?1,?2,?3,?4,?5,?6,?7)",
      [&](SQLite::Statement& statement) {
        statement.bind(1, cell.surface);
        statement.bind(2, cell.formulation);
        statement.bind(3, cell.solver);
        statement.bind(4, cell.options);
        statement.bind(5, cell.precision);
        if (statement.getBindParameterCount() < 7) return;
        statement.bind(6, cell.form);
        statement.bind(7, cell.certified ? 1 : 0);
      });
}

void Store::skip(const std::string& what, const std::string& reason) {
  guarded(implementation_->file, [&] {
    SQLite::Statement insert(implementation_->database, "INSERT OR REPLACE INTO skipped VALUES(?,?)");
    insert.bind(1, what);
    insert.bind(2, reason);
    return insert.exec();
  });
}

void Store::note(std::int64_t build, const std::string& pass, const std::string& text) {
  guarded(implementation_->file, [&] {
    SQLite::Statement insert(implementation_->database, "INSERT INTO note(build,pass,text) VALUES(?,?,?)");
    insert.bind(1, build);
    insert.bind(2, pass);
    insert.bind(3, text);
    return insert.exec();
  });
}

std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> Store::finished_blocks(
    std::int64_t build) const {
  return implementation_->triples("SELECT cell, family, block FROM tally WHERE build = ?", build);
}

std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> Store::finished_timings(
    std::int64_t build) const {
  return implementation_->triples("SELECT cell, family, repeat FROM timing WHERE build = ?", build);
}

void Store::write(std::int64_t build, const BlockResult& result) {
  guarded(implementation_->file, [&] {
    SQLite::Transaction transaction(implementation_->database);
    std::map<std::int64_t, bool> ambiguous;
    for (const RayRow& ray : result.rays) {
      implementation_->write_ray(ray);
      ambiguous[ray.id] = ray.ambiguous.value_or(false);
    }
    std::map<std::int64_t, Tally> tallies;
    for (const std::int64_t cell : result.cells) tallies[cell] = {};
    SQLite::Statement insert(implementation_->database,
                             "INSERT INTO record VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
    for (const RecordRow& record : result.records) {
      tallies[record.cell].add(record, ambiguous[record.ray]);
      if (!record.kept.empty()) implementation_->write_record(insert, build, record);
    }
    for (const auto& [cell, tally] : tallies) implementation_->write_tally(build, result, cell, tally);
    implementation_->write_histograms(build, result);
    transaction.commit();
    return 0;
  });
}

void Store::write(std::int64_t build, const TimingRow& timing) {
  guarded(implementation_->file, [&] {
    SQLite::Statement insert(implementation_->database,
                             "INSERT OR REPLACE INTO timing VALUES(?,?,?,?,?,?,?,?,?)");
    insert.bind(1, build);
    insert.bind(2, timing.cell);
    insert.bind(3, timing.family);
    insert.bind(4, timing.repeat);
    insert.bind(5, static_cast<std::int64_t>(timing.turn));
    insert.bind(6, static_cast<std::int64_t>(timing.rays));
    insert.bind(7, timing.ns_per_ray);
    insert.bind(8, timing.query);
    insert.bind(9, timing.censored ? 1 : 0);
    return insert.exec();
  });
}

}  // namespace graze
