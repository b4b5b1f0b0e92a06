// The program graze: parses the command line, runs one command, turns errors into messages and exit codes.
#include <cstdio>
#include <exception>
#include <map>
#include <new>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "build_info.hpp"
#include "commands.hpp"
#include "errors.hpp"

namespace graze {
namespace {

std::string version_text() {
  const BuildInfo& build = build_info();
  return fmt::format("graze {} (commit {}, {}, {}; this machine: {})", build.version, build.git_commit,
                     build.compiler, build.flags, this_machine().instruction_set);
}

/// What CLI11 found wrong, with the nearest command where one was mistyped.
std::string usage_message(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  std::string message = error.what();
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  const bool is_command = argc > 1 && std::find(known.begin(), known.end(), argv[1]) != known.end();
  if (argc > 1 && argv[1][0] != '-' && !is_command) message = unknown_name_message("command", argv[1], known);
  const std::string help = is_command ? fmt::format("graze {} --help", argv[1]) : "graze --help";
  return fmt::format("{} (see {})", message, help);
}

int run(int argc, char** argv) {
  CLI::App app{"graze: which root finder can I trust for this ray and this surface, and what does it cost?",
               "graze"};
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 2 wrong usage or configuration; 3 bad input data; 4 environment (input/output, "
      "missing\n"
      "component); 130 interrupted, what was finished is kept. Data goes to stdout, messages to stderr.");
  std::map<std::string, Action> actions;
  actions["list"] = add_list_command(app);
  actions["solve"] = add_solve_command(app);
  actions["truth"] = add_truth_command(app);
  actions["roots"] = add_roots_command(app);
  actions["bench"] = add_bench_command(app);
  actions["sweep"] = add_sweep_command(app);
  actions["report"] = add_report_command(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);  // --help, --version
  } catch (const CLI::ParseError& error) {
    throw UsageError(usage_message(app, error, argc, argv));
  }
  actions.at(app.get_subcommands().front()->get_name())();
  return 0;
}

}  // namespace
}  // namespace graze

int main(int argc, char** argv) {
  try {
    return graze::run(argc, argv);
  } catch (const graze::ProgramError& error) {
    fmt::print(stderr, "graze: {}\n", error.what());
    return error.code();
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "graze: out of memory\n");
    return 4;
  } catch (const std::exception& error) {
    fmt::print(stderr, "graze: internal error, please report it: {}\n", error.what());
    return 4;
  }
}
