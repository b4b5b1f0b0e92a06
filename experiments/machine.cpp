#include <sys/utsname.h>

#include <fstream>
#include <thread>

#include <fmt/format.h>

#include <graze/solvers/math/rng.hpp>

#include "build_info.hpp"

namespace graze {
namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string vector_set() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return "avx512";
  if (__builtin_cpu_supports("avx2")) return "avx2";
  return "sse2";
#else
  return "unknown";
#endif
}

}  // namespace

Machine this_machine() {
  utsname names{};
  uname(&names);
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return {cpu_model(), vector_set(), fmt::format("{} {} {}", names.sysname, names.release, names.machine),
          cores};
}

std::string build_key() {
  const BuildInfo& build = build_info();
  std::uint64_t hash = 0;
  for (const std::string& part : {build.version, build.git_commit, build.compiler, build.flags}) {
    for (const char c : part)
      hash = hash_combine(hash, static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace graze
