// Lanes give, bit for bit, what scalar doubles give: for the instruction set that this test is compiled for.
// The other ones are held to it by the kernels' tests, which compare them with one another.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <graze/solvers/math/lanes.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze::GRAZE_LANES {
namespace {

/// Numbers of all magnitudes and the special ones.
std::vector<double> numbers() {
  std::vector<double> all{0.0,
                          -0.0,
                          1.0,
                          -1.0,
                          5e-324,
                          1e-310,
                          1.7e308,
                          -1.7e308,
                          std::numeric_limits<double>::infinity(),
                          -std::numeric_limits<double>::infinity()};
  Rng rng(3);
  while (all.size() < 4096)
    all.push_back(std::ldexp(rng.uniform(-1, 1), static_cast<int>(rng.uniform(-400, 400))));
  return all;
}

void expect_same(double lane, double scalar) {
  if (std::isnan(scalar)) {
    EXPECT_TRUE(std::isnan(lane));
  } else {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(lane), std::bit_cast<std::uint64_t>(scalar));
  }
}

TEST(Lanes, EveryOperationIsTheScalarOneInEveryLane) {
  const std::vector<double> x = numbers();
  for (std::size_t i = 0; i + 3 * kLanes <= x.size(); ++i) {
    const Lanes a = load(&x[i]), b = load(&x[i + kLanes]), c = load(&x[i + 2 * kLanes]);
    const Lanes results[] = {a + b, a - b, a * b, a / b, fma(a, b, c), sqrt(abs(a)), max(a, b), min(a, b)};
    for (int k = 0; k < kLanes; ++k) {
      const double p = a[k], q = b[k], r = c[k];
      expect_same(results[0][k], p + q);
      expect_same(results[1][k], p - q);
      expect_same(results[2][k], p * q);
      expect_same(results[3][k], p / q);
      expect_same(results[4][k], std::fma(p, q, r));
      expect_same(results[5][k], std::sqrt(std::fabs(p)));
      expect_same(results[6][k], p > q ? p : q);
      expect_same(results[7][k], p < q ? p : q);
    }
  }
}

TEST(Lanes, MasksSelectByLaneAndBecomeBits) {
  for (unsigned wanted = 0; wanted < (1U << kLanes); ++wanted) {
    Lanes x{};
    for (int k = 0; k < kLanes; ++k) x[k] = (wanted >> static_cast<unsigned>(k) & 1U) != 0 ? 1 : -1;
    const Mask mask = x > Lanes{};
    EXPECT_EQ(to_bits(mask), wanted);
    const Lanes chosen = select(mask, all(3), all(5));
    std::vector<double> packed(2 * kLanes, 0);
    store_selected(packed.data(), wanted, chosen + x);
    std::size_t next = 0;
    for (int k = 0; k < kLanes; ++k) {
      const bool is_set = (wanted >> static_cast<unsigned>(k) & 1U) != 0;
      EXPECT_EQ(chosen[k], is_set ? 3 : 5);
      if (is_set) {
        EXPECT_EQ(packed[next++], 4);
      }
    }
  }
}

TEST(Lanes, PowersAndStridesAreExact) {
  for (const double x : {1.0, 1.5, 0.3, 1e-300, 1e300, 123.456}) {
    EXPECT_EQ(reciprocal_power(all(x))[0], std::ldexp(1.0, -std::ilogb(x)));
  }
  std::vector<double> from(6 * kLanes);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<double>(i);
  for (std::size_t part = 0; part < 6; ++part) {
    const Lanes x = load_strided(from.data() + part, 6);
    for (int k = 0; k < kLanes; ++k) EXPECT_EQ(x[k], static_cast<double>(part) + 6.0 * k);
  }
}

}  // namespace
}  // namespace graze::GRAZE_LANES
