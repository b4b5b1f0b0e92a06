// Ceres from random slices, where this build has it.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

Jet sine(const void* /*self*/, double x) { return {std::sin(x), std::cos(x), -std::sin(x), 0x1p-52}; }

class CeresSlices : public testing::Test {
 protected:
  void SetUp() override {
    for (const SolverEntry& entry : solver_registry()) {
      if (entry.name == "ceres_slices") entry_ = &entry;
    }
    if (entry_ == nullptr) GTEST_SKIP() << "this build has no Ceres";
  }
  [[nodiscard]] Roots solve(double tries, bool tiny) const {
    Parameters options;
    options.set("tries", tries);
    options.set("tiny", tiny);
    const ScalarEquation equation{nullptr, &sine, 1, 8, 0, 1};
    Roots roots;
    entry_->make(options)->solve({&equation, 1}, {&roots, 1});
    return roots;
  }

  const SolverEntry* entry_ = nullptr;
};

TEST_F(CeresSlices, FullAndTinySolverFindTheRoots) {
  for (const bool tiny : {false, true}) {
    const Roots roots = solve(50, tiny);
    ASSERT_EQ(roots.list.size(), 2U) << tiny;
    EXPECT_NEAR(roots.list[0].x, std::acos(-1.0), 1e-12);
    EXPECT_NEAR(roots.list[1].x, 2 * std::acos(-1.0), 1e-12);
    EXPECT_EQ(roots.counters.starts, 50U);
  }
}

TEST_F(CeresSlices, TheSameSeedGivesTheSameBits) {
  const Roots a = solve(10, false), b = solve(10, false);
  ASSERT_EQ(a.list.size(), b.list.size());
  for (std::size_t i = 0; i < a.list.size(); ++i) EXPECT_EQ(a.list[i].x, b.list[i].x);
}

TEST_F(CeresSlices, OptionsAreChecked) { EXPECT_THROW((void)solve(0, false), std::invalid_argument); }

}  // namespace
}  // namespace graze
