// Small seeded generator: the same seed gives the same numbers on every machine and compiler.
#pragma once

#include <bit>
#include <cstdint>

namespace graze {

/// Mixes 64 bits so that every input bit reaches every output bit (finaliser of SplitMix64; Steele, Lea,
/// Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
constexpr std::uint64_t mix64(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Folds a further value into a hash; order matters. Doubles enter by their bits.
constexpr std::uint64_t hash_combine(std::uint64_t hash, std::uint64_t value) {
  return mix64(hash + 0x9e3779b97f4a7c15ULL + mix64(value));
}
constexpr std::uint64_t hash_combine(std::uint64_t hash, double value) {
  return hash_combine(hash, std::bit_cast<std::uint64_t>(value));
}

/// SplitMix64: state + golden-ratio increments, finalised. Period 2^64; passes BigCrush.
class Rng {
 public:
  constexpr explicit Rng(std::uint64_t seed) : state_(seed) {}
  constexpr std::uint64_t next() { return mix64(state_ += 0x9e3779b97f4a7c15ULL); }
  /// Uniform in [0, 1) on multiples of 2^-53.
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  /// Uniform in [lo, hi).
  constexpr double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }

 private:
  std::uint64_t state_;
};

}  // namespace graze
