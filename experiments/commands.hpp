// The program's commands. Each adds itself to the command line and returns what to run when it is chosen.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "specs.hpp"

namespace graze {

/// A command's work, run after parsing. Throws ProgramError.
using Action = std::function<void()>;

Action add_list_command(CLI::App& app);
Action add_solve_command(CLI::App& app);
Action add_truth_command(CLI::App& app);
Action add_roots_command(CLI::App& app);
Action add_bench_command(CLI::App& app);
Action add_sweep_command(CLI::App& app);
Action add_report_command(CLI::App& app);

/// Options that name what is intersected: exactly one of --scene and --surface.
struct SceneOptions {
  std::string scene_file;
  std::string surface;

  void add_to(CLI::App& command);
  [[nodiscard]] std::vector<SceneMember> members() const;
};

/// --query all|first|any.
void add_query_option(CLI::App& command, std::string& query);
Query parse_query(const std::string& text);
/// --precision double|float.
void add_precision_option(CLI::App& command, std::string& precision);
Precision parse_precision(const std::string& text);
/// --jobs N, 1 or more.
void add_jobs_option(CLI::App& command, int& jobs);

/// Calls work(i) for i in [0, count) on `jobs` threads; rethrows the first exception.
void parallel_for(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

}  // namespace graze
