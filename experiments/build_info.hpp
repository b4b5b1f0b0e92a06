// What this program was built from and runs on.
#pragma once

#include <string>

namespace graze {

struct BuildInfo {
  std::string version, git_commit, compiler, flags;
};
const BuildInfo& build_info();

struct Machine {
  std::string cpu;              ///< model name
  std::string instruction_set;  ///< widest vector set of this machine: "avx512", "avx2", "sse2"
  std::string system;           ///< kernel and architecture
  int cores = 1;
};
Machine this_machine();

/// Names the build for resume: equal keys give equal numbers.
std::string build_key();

}  // namespace graze
