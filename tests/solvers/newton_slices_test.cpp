// Newton from random slices: tries, seeds and bounds.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/solvers/newton_slices.hpp>

namespace graze {
namespace {

/// sin on [1, 20]: six roots.
Jet sine(const void* /*self*/, double x) { return {std::sin(x), std::cos(x), -std::sin(x), 0x1p-52}; }

Roots solve(double tries, double seed, std::uint64_t equation_seed = 1, int max_roots = 0) {
  Parameters options;
  options.set("tries", tries);
  options.set("seed", seed);
  Roots roots;
  NewtonSlices(options).solve(ScalarEquation{nullptr, &sine, 1, 20, max_roots, equation_seed}, roots);
  return roots;
}

TEST(NewtonSlices, ReportsTheTriesItUsed) {
  for (const double tries : {1.0, 7.0, 30.0}) {
    EXPECT_EQ(solve(tries, 0).counters.starts, static_cast<std::uint32_t>(tries));
  }
}

TEST(NewtonSlices, EndsEarlyOnceThereCanBeNoFurtherRoot) {
  const Roots roots = solve(1000, 0, 1, 2);
  EXPECT_EQ(roots.list.size(), 2U);
  EXPECT_LT(roots.counters.starts, 1000U);
}

TEST(NewtonSlices, EnoughTriesFindEveryRootInOrder) {
  const Roots roots = solve(300, 0);
  ASSERT_EQ(roots.list.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(roots.list[i].x, static_cast<double>(i + 1) * std::acos(-1.0), 1e-13);
}

TEST(NewtonSlices, MoreTriesNeverFindFewerRoots) {
  std::size_t last = 0;
  for (const double tries : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
    const std::size_t found = solve(tries, 0).list.size();
    EXPECT_GE(found, last);
    last = found;
  }
}

TEST(NewtonSlices, TheSameSeedsGiveTheSameBitsAndOthersGiveOtherStarts) {
  const Roots a = solve(3, 0), b = solve(3, 0), c = solve(3, 1), d = solve(3, 0, 2);
  ASSERT_EQ(a.list.size(), b.list.size());
  for (std::size_t i = 0; i < a.list.size(); ++i) EXPECT_EQ(a.list[i].x, b.list[i].x);
  EXPECT_EQ(a.counters.evaluations, b.counters.evaluations);
  const auto bits = [](const Roots& roots) {
    std::vector<double> x;
    for (const Root& root : roots.list) x.insert(x.end(), {root.x, root.radius});
    return x;
  };
  EXPECT_TRUE(bits(a) != bits(c) || bits(a) != bits(d));
}

TEST(NewtonSlices, OptionsAreChecked) {
  EXPECT_THROW(solve(0, 0), std::invalid_argument);
  EXPECT_THROW(solve(2.5, 0), std::invalid_argument);
  EXPECT_THROW(solve(30, -1), std::invalid_argument);
}

}  // namespace
}  // namespace graze
