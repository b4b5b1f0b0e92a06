// `graze sweep`: runs an experiment's cells over its case families into a store; resumable.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "specs.hpp"

namespace graze {

/// experiments/configs/*.toml. Unknown fields are errors, so that a typing mistake cannot change a study.
struct SweepConfig {
  std::string path, text;
  std::string name, title;
  std::uint64_t seed = 1;
  std::size_t rays = 1000;       ///< a family
  double match_radius = 1e-6;    ///< see Measure
  std::size_t keep_all = 20000;  ///< families up to this size keep every record
  /// Beyond it, one record in this many is kept besides the wrong and the worst.
  std::size_t sample_every = 100;
  std::vector<SurfaceSpec> surfaces;
  std::vector<SolverSpec> solvers;
  bool all_formulations = true;  ///< a cell for each that a solver takes; else for the one it prefers
  std::vector<Precision> precisions{Precision::binary64};
  std::vector<std::string> cases;  ///< empty: every family that suits the surface
  int timing_repeats = 7;
  double timing_budget_ms = 100;   ///< of one turn
  std::size_t timing_rays = 1000;  ///< a family
  Query timing_query = Query::all;
};

/// Throws UsageError that names file, line and field.
SweepConfig read_sweep_config(const std::string& path);

struct SweepOptions {
  std::string out;
  int jobs = 1;
  std::string command;  ///< as the user would type it again, for the report
};

/// Runs what is not finished yet: first accuracy (parallel), then timing (one pinned core). Throws
/// Interrupted after Ctrl-C with everything finished kept.
void run_sweep(const SweepConfig& config, const SweepOptions& options);

}  // namespace graze
