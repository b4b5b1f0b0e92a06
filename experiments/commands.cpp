#include "commands.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "errors.hpp"

namespace graze {

void SceneOptions::add_to(CLI::App& command) {
  CLI::Option_group* const group = command.add_option_group("what to intersect");
  group->add_option("--scene", scene_file, "scene file (TOML, [[surface]] tables)")->type_name("FILE");
  group->add_option("--surface", surface, "one surface, values in TOML syntax: teardrop:s=1")
      ->type_name("NAME:key=value,...");
  group->require_option(1);
}

std::vector<SceneMember> SceneOptions::members() const {
  if (!scene_file.empty()) return read_scene(scene_file);
  SceneMember member;
  member.surface = parse_surface(surface);
  return {member};
}

void add_query_option(CLI::App& command, std::string& query) {
  command.add_option("--query", query, "all hits, the first hit, or any one hit (default all)")
      ->type_name("all|first|any")
      ->check(CLI::IsMember({"all", "first", "any"}));
}

Query parse_query(const std::string& text) {
  return text == "first" ? Query::first : text == "any" ? Query::any : Query::all;
}

void add_precision_option(CLI::App& command, std::string& precision) {
  command.add_option("--precision", precision, "arithmetic of the solver (default double)")
      ->type_name("double|float")
      ->check(CLI::IsMember({"double", "float"}));
}

Precision parse_precision(const std::string& text) {
  return text == "float" ? Precision::binary32 : Precision::binary64;
}

void add_jobs_option(CLI::App& command, int& jobs) {
  command.add_option("--jobs", jobs, "threads (default 1); the output does not depend on it")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
}

void parallel_for(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
  if (jobs <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < jobs; ++i) threads.emplace_back(run);
  run();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace graze
