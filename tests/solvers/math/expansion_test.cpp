#include <gtest/gtest.h>

#include <bit>
#include <cinttypes>
#include <cstdio>
#include <vector>

#include <graze/solvers/math/expansion.hpp>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

constexpr std::uint64_t kSeed = 20261122;
constexpr int kCases = 20'000;

Rng seeded(std::uint64_t offset) {
  std::printf("    seed %" PRIu64 "\n", kSeed + offset);
  return Rng(kSeed + offset);
}

Exact exact_of(const Expansion& x) {
  Exact sum = 0;
  for (const double part : x.parts()) sum += exact(part);
  return sum;
}

int sign_of(const Exact& x) { return x < 0 ? -1 : x > 0 ? 1 : 0; }

/// The weight of the last bit set in a normal x.
double last_bit(double x) {
  const std::uint64_t significand = std::bit_cast<std::uint64_t>(x) | std::uint64_t{1} << 52U;
  return std::ldexp(ulp(x), std::countr_zero(significand));
}

/// Non-zero parts, ascending, with an unused bit between each and the next (nonadjacent).
bool is_well_formed(const Expansion& x) {
  const std::span<const double> parts = x.parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] == 0) return false;
    if (i > 0 && std::fabs(parts[i - 1]) >= last_bit(parts[i]) / 2) return false;
  }
  return true;
}

/// Is x the double nearest to q, the even one of two?
bool is_nearest(double x, const Exact& q) {
  const Exact error = abs(exact(x) - q);
  const Exact below = abs(exact(next_below(x)) - q), above = abs(exact(next_above(x)) - q);
  if (error > below || error > above) return false;
  const bool even = (std::bit_cast<std::uint64_t>(x) & 1U) == 0;
  return even || (error != below && error != above);
}

/// A sum of a few doubles of all magnitudes, often with cancellation.
Expansion random_expansion(Rng& rng, int low, int high, Exact& truth) {
  Expansion sum;
  truth = 0;
  const std::uint64_t terms = 1 + rng.next() % 6;
  for (std::uint64_t i = 0; i < terms; ++i) {
    const double x = rng.next() % 3 == 0 ? -sum.value() : log_uniform(rng, low, high);
    sum += Expansion(x);
    truth += exact(x);
  }
  return sum;
}

TEST(Expansion, SumsDifferencesAndProductsAreExact) {
  Rng rng = seeded(0);
  std::size_t longest = 0;
  for (int i = 0; i < kCases; ++i) {
    const int spread = i % 2 == 0 ? 30 : 220;
    Exact p, q;
    const Expansion x = random_expansion(rng, -spread, spread, p),
                    y = random_expansion(rng, -spread, spread, q);
    const double k = log_uniform(rng, -spread, spread);
    for (const auto& [result, truth] :
         {std::pair{x, p}, std::pair{x + y, Exact(p + q)}, std::pair{x - y, Exact(p - q)},
          std::pair{x * y, Exact(p * q)}, std::pair{x * k, Exact(p * exact(k))},
          std::pair{k - x, Exact(exact(k) - p)}, std::pair{-x, Exact(-p)},
          std::pair{abs(x), Exact(abs(p))}}) {
      ASSERT_EQ(exact_of(result), truth) << i;
      ASSERT_EQ(result.sign(), sign_of(truth)) << i;
      ASSERT_EQ(result.is_zero(), truth == 0) << i;
      ASSERT_TRUE(is_well_formed(result)) << i;
      longest = std::max(longest, result.parts().size());
    }
    ASSERT_EQ(x < y, p < q);
    ASSERT_EQ(x == y, p == q);
    ASSERT_TRUE((x - x).is_zero());
    ASSERT_TRUE((x + y) * (x - y) == x * x - y * y);
  }
  std::printf("    longest expansion: %zu parts\n", longest);
}

TEST(Expansion, ValueIsTheNearestDoubleTiesToEven) {
  Rng rng = seeded(1);
  for (int i = 0; i < kCases; ++i) {
    Exact truth;
    const Expansion x = random_expansion(rng, -60, 60, truth);
    ASSERT_TRUE(is_nearest(x.value(), truth)) << std::hexfloat << x.value();
    ASSERT_LE(abs(exact(x.to_double_double()) - truth), abs(truth) * exact(0x1p-106));
  }
  // Half an ulp above 1 is a tie; what lies far below decides it.
  for (const double tail : {0x1p-200, 0.0, -0x1p-200}) {
    for (const double odd : {1.0, 1 + 0x1p-52, -1.0, -1 - 0x1p-52}) {
      for (const double half : {0x1p-53, -0x1p-53}) {
        const Expansion x = Expansion(odd) + half + tail;
        ASSERT_TRUE(is_nearest(x.value(), exact(odd) + exact(half) + exact(tail))) << odd << half << tail;
      }
    }
  }
  EXPECT_EQ(Expansion().value(), 0);
  EXPECT_EQ(Expansion(0x1p-1074).value(), 0x1p-1074);
}

TEST(Expansion, ManyPartsMoveToTheHeapAndStayExact) {
  Rng rng = seeded(2);
  Expansion sum;
  Exact truth = 0;
  for (int k = -1000; k <= 900; k += 10) {
    const double x = log_uniform(rng, k, k);
    sum += Expansion(x);
    truth += exact(x);
  }
  const double top = sum.value();
  // Powers two hundred places apart cannot share a part: more parts than fit inline.
  for (int k = -1060; k <= 1000; k += 54) {
    sum += Expansion(std::ldexp(1.0, k));
    truth += exact(std::ldexp(1.0, k));
  }
  EXPECT_GT(sum.parts().size(), Expansion::kInlineParts);
  EXPECT_GT(sum.value(), top);
  const Expansion copy = sum;
  EXPECT_EQ(exact_of(copy), truth);
  EXPECT_TRUE((copy - sum).is_zero());
}

TEST(Expansion, DeterminantsAndDotProductsAreExact) {
  Rng rng = seeded(3);
  for (int i = 0; i < kCases; ++i) {
    std::array<std::array<double, 3>, 3> m;
    for (auto& row : m)
      for (double& x : row) x = log_uniform(rng, -100, 100);
    // Every third matrix is singular: the last row repeats another, up to a power of two.
    if (i % 3 == 0)
      for (std::size_t k = 0; k < 3; ++k) m[2][k] = 0x1p7 * m[static_cast<std::size_t>(i / 3 % 2)][k];
    const auto e = [&](std::size_t r, std::size_t c) { return exact(m[r][c]); };
    const Exact truth = e(0, 0) * (e(1, 1) * e(2, 2) - e(1, 2) * e(2, 1)) -
                        e(0, 1) * (e(1, 0) * e(2, 2) - e(1, 2) * e(2, 0)) +
                        e(0, 2) * (e(1, 0) * e(2, 1) - e(1, 1) * e(2, 0));
    ASSERT_EQ(exact_of(exact_determinant(m)), truth);
    ASSERT_EQ(exact_determinant(m).is_zero(), i % 3 == 0);
    const std::array<std::array<double, 2>, 2> minor{{{m[0][0], m[0][1]}, {m[1][0], m[1][1]}}};
    ASSERT_EQ(exact_of(exact_determinant(minor)), Exact(e(0, 0) * e(1, 1) - e(0, 1) * e(1, 0)));
    ASSERT_EQ(exact_of(exact_dot(m[0], m[1])),
              Exact(e(0, 0) * e(1, 0) + e(0, 1) * e(1, 1) + e(0, 2) * e(1, 2)));
  }
  // Entries that are differences: the same matrix, moved.
  const std::array<std::array<Expansion, 2>, 2> moved{
      {{Expansion(1e30) - 0.1, Expansion(3.0)}, {Expansion(1e30) - 0.1, Expansion(3.0)}}};
  EXPECT_TRUE(exact_determinant(moved).is_zero());
}

/// The largest and the smallest inputs of a degree, as in_range() promises.
TEST(Expansion, TheStatedRangeIsExactAtItsEnds) {
  Rng rng = seeded(4);
  for (const int degree : {1, 2, 3, 4, 6}) {
    const int low = 52 - 1074 / degree, high = 1000 / degree;
    EXPECT_TRUE(Expansion::in_range(std::ldexp(1.0, low), degree));
    EXPECT_FALSE(Expansion::in_range(std::ldexp(1.0, low - 1), degree));
    EXPECT_TRUE(Expansion::in_range(-std::ldexp(1.0, high), degree));
    EXPECT_FALSE(Expansion::in_range(std::ldexp(1.5, high), degree));
    for (int i = 0; i < 2000; ++i) {
      Expansion product(1.0), sum;
      Exact truth = 1, total = 0;
      for (int k = 0; k < degree; ++k) {
        const double x = i % 2 == 0 ? log_uniform(rng, low, low + 3) : log_uniform(rng, low, high - 1);
        product *= Expansion(x) + std::ldexp(1.0, low);
        truth *= exact(x) + exact(std::ldexp(1.0, low));
        sum += product;
        total += truth;
      }
      ASSERT_EQ(exact_of(product), truth) << "degree " << degree;
      ASSERT_EQ(exact_of(sum), total) << "degree " << degree;
    }
  }
  EXPECT_TRUE(Expansion::in_range(0x1p-480) && Expansion::in_range(0x1p480) && Expansion::in_range(0));
}

/// A sum of `count` doubles whose bits lie far apart: its parts are the doubles.
Expansion spread_out(int count) {
  Expansion sum;
  for (int k = 0; k < count; ++k) sum += Expansion(std::ldexp(1.0, 1000 - 60 * k));
  return sum;
}

TEST(Expansion, WhatLeavesTheDoublesIsSeenAndWritesNothingOutOfBounds) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  // Lengths on both sides of where parts, or the sums and products of them, move to the heap.
  for (int count = 0; count <= static_cast<int>(Expansion::kInlineParts) + 1; ++count) {
    const Expansion x = spread_out(count);
    ASSERT_TRUE(x.is_finite());
    for (const double y : {kInfinity, -kInfinity, kNan}) {
      const Expansion wild(y);
      EXPECT_FALSE(wild.is_finite());
      for (const Expansion& result : {x * y, x + y, x - y, y - x, x * wild, wild * x, wild * wild - x, -wild,
                                      abs(wild) + x, (x + wild) * (x - wild), (wild - wild) * x})
        ASSERT_FALSE(result.is_finite()) << count << " parts, " << y;
      EXPECT_FALSE(std::isfinite((x * y).value()));
    }
    // The largest products overflow, smaller ones do not.
    EXPECT_EQ((x * 0x1p900).is_finite(), count == 0) << count;
    EXPECT_EQ((x * x).is_finite(), count == 0) << count;
  }
}

/// A capacity is asked for before the numbers are seen: whatever they are, no more parts may come.
TEST(Expansion, SumsAndProductsKeepTheirCapacityWhateverTheNumbers) {
  Rng rng = seeded(5);
  for (int i = 0; i < kCases; ++i) {
    std::vector<double> e(rng.next() % 40), f(rng.next() % 40);
    for (std::vector<double>* const parts : {&e, &f})
      for (double& part : *parts) part = std::bit_cast<double>(rng.next());
    const double k = std::bit_cast<double>(rng.next() | (i % 2 == 0 ? 0x7ff0000000000000U : 0U));
    ASSERT_LE(detail::product_of(e, k).size(), 2 * e.size() + 1);
    ASSERT_LE(detail::sum_of(e, f).size(), e.size() + f.size() + 1);
    ASSERT_LE(detail::compressed(e).size(), e.size());
  }
}

template <class T>
T generic(T a, T b) {
  T c = a * b + T(2.0) * a;
  c -= b;
  c *= -a;
  c += T(0.5);
  return c - b * (a - b);
}

TEST(Expansion, GenericFormulasRunOnEveryScalar) {
  // Small dyadic numbers: exact in every type, so all must agree.
  const double a = 1.25, b = -3.5, truth = generic(a, b);
  EXPECT_EQ(static_cast<double>(generic(1.25F, -3.5F)), truth);
  EXPECT_EQ(generic(DoubleDouble(a), DoubleDouble(b)), DoubleDouble(truth));
  EXPECT_EQ(generic(Interval(a), Interval(b)), Interval(truth));
  EXPECT_EQ(generic(Expansion(a), Expansion(b)).value(), truth);
  EXPECT_EQ(Interval(a), (Interval{a, a}));
  EXPECT_EQ(Interval(kInfinity), (Interval{kMax, kInfinity}));
  EXPECT_TRUE(is_entire(Interval(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace graze
