// The store of one run: DIR/run.sqlite (schema.sql says what is in it).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "cases.hpp"
#include "judge.hpp"

namespace graze {

/// A cell as the store names it.
struct CellRow {
  std::int64_t surface = 0;
  std::string formulation, form, solver, options, precision;
  bool certified = false;
};

/// One (ray, cell) on its way to the store.
struct RecordRow {
  std::int64_t cell = 0;
  std::int64_t ray = 0;
  Status status = Status::ok;
  std::vector<double> l;
  Counters counters;
  Judgement judgement;
  std::string kept;  ///< all | wrong | worst | sample; empty: counted, not kept
};

struct RayRow {
  std::int64_t id = 0, surface = 0, family = 0;
  std::size_t index = 0;
  CaseRay ray;
  double scale = 1;
  truth::Answer truth;
  std::optional<double> condition;
  std::optional<bool> ambiguous;
};

struct TimingRow {
  std::int64_t cell = 0, family = 0;
  int repeat = 0;
  std::size_t turn = 0, rays = 0;
  double ns_per_ray = 0;
  std::string query;
  bool censored = false;
};

/// Now, as the store writes it: "2026-01-31T12:00:00Z".
std::string utc_now();

/// All results of one block of rays: written whole or not at all.
struct BlockResult {
  std::int64_t family = 0;
  std::size_t block = 0;
  std::vector<RayRow> rays;
  std::vector<std::int64_t> cells;  ///< the cells that were judged in this block
  std::vector<RecordRow> records;   ///< every (ray, cell), kept or only counted
};

/// Exceptions of the database become EnvironmentError (full disk, not writable) with the file's name.
class Store {
 public:
  /// Opens or makes DIR/run.sqlite. Throws EnvironmentError.
  explicit Store(const std::string& directory);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  [[nodiscard]] std::optional<std::string> meta(const std::string& key) const;
  void set_meta(const std::string& key, const std::string& value);

  /// Ids of rows, made if they are not there yet. The same run gives the same ids.
  std::int64_t build_id();
  std::int64_t surface_id(const std::string& label, const std::string& type, double size);
  std::int64_t family_id(const CaseFamily& family);
  std::int64_t cell_id(const CellRow& cell);
  void skip(const std::string& what, const std::string& reason);
  void note(std::int64_t build, const std::string& pass, const std::string& text);

  /// (cell, family, block) that are finished for this build.
  [[nodiscard]] std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> finished_blocks(
      std::int64_t build) const;
  /// (cell, family, repeat) that are timed for this build.
  [[nodiscard]] std::set<std::tuple<std::int64_t, std::int64_t, std::int64_t>> finished_timings(
      std::int64_t build) const;

  /// One transaction.
  void write(std::int64_t build, const BlockResult& result);
  void write(std::int64_t build, const TimingRow& timing);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace graze
