// GMP's integers beside ours, for the tests of exact arithmetic.
#pragma once

#include <boost/multiprecision/gmp.hpp>
#include <cinttypes>
#include <cstdint>
#include <cstdio>

#include <graze/solvers/math/big_integer.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze::test {

using Gmp = boost::multiprecision::number<boost::multiprecision::gmp_int, boost::multiprecision::et_off>;

inline constexpr std::uint64_t kSeed = 20261122;

/// A generator of its own for each test; its seed is printed.
inline Rng seeded(std::uint64_t offset) {
  std::printf("    seed %" PRIu64 "\n", kSeed + offset);
  return Rng(kSeed + offset);
}

inline Gmp gmp(const BigInteger& x) {
  Gmp value = 0;
  const auto limbs = x.limbs();
  for (std::size_t i = limbs.size(); i-- > 0;) value = (value << 64) + limbs[i];
  return x.sign() < 0 ? Gmp(-value) : value;
}

}  // namespace graze::test
