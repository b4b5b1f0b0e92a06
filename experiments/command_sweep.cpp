// graze sweep and graze report.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "commands.hpp"
#include "errors.hpp"
#include "report_location.hpp"
#include "sweep.hpp"

namespace graze {
namespace {

struct SweepCommandOptions : SweepOptions {
  std::string config;
};

void sweep(SweepCommandOptions options) {
  const SweepConfig config = read_sweep_config(options.config);
  options.command = fmt::format("graze sweep {} --out {}", options.config, options.out);
  run_sweep(config, options);
  fmt::print(stderr, "graze sweep: done; next: graze report {}\n", options.out);
}

// -------------------------------------------------------------------------------------------------- report

struct ReportOptions {
  std::string directory;
  std::string out;
};

/// The generator: beside an installed program, else in the source tree this program was built from.
std::filesystem::path generator() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto installed =
      program.parent_path().parent_path() / "share" / "graze" / "report" / "graze_report.py";
  if (!error && std::filesystem::exists(installed)) return installed;
  const std::filesystem::path source = std::filesystem::path(kReportSource) / "graze_report.py";
  if (std::filesystem::exists(source)) return source;
  throw EnvironmentError(fmt::format("the report generator is missing: looked for {} and {}",
                                     installed.string(), source.string()));
}

/// Debian's python3 has the packages; another one may come first on PATH.
std::string python() {
  constexpr const char* kSystem = "/usr/bin/python3";
  return access(kSystem, X_OK) == 0 ? kSystem : "python3";
}

void report(const ReportOptions& options) {
  std::vector<std::string> words{python(), generator().string(), options.directory};
  if (!options.out.empty()) {
    words.emplace_back("--out");
    words.push_back(options.out);
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw EnvironmentError(fmt::format("cannot start python3: {}", std::strerror(errno)));
  if (child == 0) {
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 4;
  if (code == 127) throw EnvironmentError("cannot start python3: install the Debian package python3");
  // The generator has said what is wrong; its codes are the program's own.
  if (code != 0) throw ProgramError(code >= 2 && code <= 4 ? code : 4, "no report was made");
}

}  // namespace

Action add_sweep_command(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("sweep", "run an experiment; run again to resume");
  const auto options = std::make_shared<SweepCommandOptions>();
  command->add_option("CONFIG", options->config, "experiment (TOML)")->type_name("FILE")->required();
  command->add_option("--out", options->out, "folder of the run's store")->type_name("DIR")->required();
  add_jobs_option(*command, options->jobs);
  return [options] { sweep(*options); };
}

Action add_report_command(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("report", "HTML page, CSV and figures from a run's store");
  const auto options = std::make_shared<ReportOptions>();
  command->add_option("DIR", options->directory, "folder of the run's store")->type_name("DIR")->required();
  command->add_option("--out", options->out, "folder to write to (default DIR/report)")->type_name("DIR");
  return [options] { report(*options); };
}

}  // namespace graze
