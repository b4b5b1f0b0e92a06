// Lanes give, bit for bit, what scalar doubles give: for the instruction set that this test is compiled for.
// The other ones are held to it by the kernels' tests, which compare them with one another.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/lanes.hpp>
#include <graze/solvers/math/lanes_double_double.hpp>
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
    const Lanes chosen = select(mask, all(3.0), all(5.0));
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
    for (std::size_t k = 0; k < packed.size(); ++k) packed[k] = static_cast<double>(k + 1);
    const Lanes back = load_selected(packed.data(), wanted);
    next = 0;
    for (int k = 0; k < kLanes; ++k) {
      const bool is_set = (wanted >> static_cast<unsigned>(k) & 1U) != 0;
      EXPECT_EQ(back[k], is_set ? packed[next++] : 0);
    }
  }
}

TEST(Lanes, FloatsAreTheScalarOnesInEveryLane) {
  const std::vector<double> x = numbers();
  for (std::size_t i = 0; i + 2 * kFloats <= x.size(); i += kFloats) {
    const Floats a = narrow(load(&x[i]), load(&x[i + kLanes]));
    const Floats b = narrow(load(&x[i + kFloats]), load(&x[i + kFloats + kLanes]));
    const Floats results[] = {a + b, a / b, fma(a, b, a), sqrt(abs(a)), max(a, b), select(a < b, a, b)};
    const TwoLanes back = widen(a);
    for (std::size_t k = 0; k < kFloats; ++k) {
      const float p = static_cast<float>(x[i + k]), q = static_cast<float>(x[i + kFloats + k]);
      expect_same(static_cast<double>(a[k]), static_cast<double>(p));
      expect_same(k < kLanes ? back.first[k] : back.second[k - kLanes], static_cast<double>(p));
      const float expected[] = {p + q,         p / q,        std::fma(p, q, p), std::sqrt(std::fabs(p)),
                                p > q ? p : q, p < q ? p : q};
      for (std::size_t r = 0; r < std::size(expected); ++r)
        expect_same(static_cast<double>(results[r][k]), static_cast<double>(expected[r]));
    }
  }
}

TEST(Lanes, SelectedFloatsAndNumbersAreWrittenInOrder) {
  Rng rng(7);
  for (int repeat = 0; repeat < 1000; ++repeat) {
    const auto bits = static_cast<unsigned>(rng.next() & ((1U << kFloats) - 1));
    float from[kFloats], floats[2 * kFloats] = {};
    std::int32_t ids[2 * kFloats] = {};
    for (std::size_t k = 0; k < kFloats; ++k) from[k] = static_cast<float>(k + 1);
    store_selected(floats, bits, load(from));
    store_selected_numbers(ids, bits, 100);
    EXPECT_EQ(to_bits(load(from) > 3), ((1U << kFloats) - 1) & ~7U);
    std::size_t next = 0;
    for (std::size_t k = 0; k < kFloats; ++k) {
      if ((bits >> k & 1U) == 0) continue;
      EXPECT_EQ(floats[next], from[k]);
      EXPECT_EQ(ids[next++], static_cast<std::int32_t>(100 + k));
    }
  }
}

TEST(Lanes, PowersBytesAndRecordsAreExact) {
  for (const double x : {1.0, 1.5, 0.3, 1e-300, 1e300, 123.456}) {
    EXPECT_EQ(reciprocal_power(all(x))[0], std::ldexp(1.0, -std::ilogb(x)));
  }
  std::vector<double> from(6 * kLanes);
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = static_cast<double>(i);
  Lanes records[6];
  load_records(from.data(), records);
  for (std::size_t part = 0; part < 6; ++part) {
    for (std::size_t k = 0; k < kLanes; ++k)
      EXPECT_EQ(records[part][k], static_cast<double>(part) + 6.0 * static_cast<double>(k));
  }
  Lanes counts{};
  for (std::size_t k = 0; k < kLanes; ++k) counts[k] = static_cast<double>(k % 4) - 1;
  std::int8_t bytes[kLanes];
  store_bytes(bytes, counts);
  for (std::size_t k = 0; k < kLanes; ++k) EXPECT_EQ(bytes[k], static_cast<int>(k % 4) - 1);
}

// The sums and products of double_double.hpp, in lanes.
TEST(Lanes, DoubleDoublesAreTheScalarOnesInEveryLane) {
  Rng rng(11);
  const auto number = [&] {
    const double hi = std::ldexp(rng.uniform(1, 2), static_cast<int>(rng.uniform(-20, 20)));
    return DoubleDouble(hi, hi * rng.uniform(-1, 1) * 0x1p-54);
  };
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const DoubleDouble x = number(), y = number() * (repeat % 2 == 0 ? 1.0 : -1.0);
    const Wide a{all(x.hi), all(x.lo)}, b{all(y.hi), all(y.lo)};
    const Wide results[] = {a + b, a - b, a * b, a / b, a + all(y.hi), a * all(y.hi), a / all(y.hi), sqrt(a)};
    const DoubleDouble expected[] = {x + y,    x - y,    x * y,    x / y,
                                     x + y.hi, x * y.hi, x / y.hi, graze::sqrt(x)};
    for (std::size_t r = 0; r < std::size(expected); ++r) {
      for (std::size_t k = 0; k < kLanes; ++k) {
        expect_same(results[r].hi[k], expected[r].hi);
        expect_same(results[r].lo[k], expected[r].lo);
      }
    }
  }
}

}  // namespace
}  // namespace graze::GRAZE_LANES
