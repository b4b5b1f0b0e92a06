// Which of the instruction sets that lanes are compiled for this processor has.
#pragma once

#include <cstdint>
#include <string_view>

namespace graze {

/// Ascending: each runs everything that those before it run.
enum class InstructionSet : std::uint8_t { baseline, avx2, avx512 };

/// "baseline", "avx2", "avx512".
constexpr std::string_view to_string(InstructionSet set) {
  return set == InstructionSet::avx512 ? "avx512" : set == InstructionSet::avx2 ? "avx2" : "baseline";
}

/// The best one that this processor has and the build contains.
inline InstructionSet best_instruction_set() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0)
    return InstructionSet::avx512;
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0) return InstructionSet::avx2;
#endif
  return InstructionSet::baseline;
}

}  // namespace graze
