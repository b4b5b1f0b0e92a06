// The quartic formula: the test set of its own paper (Orellana, De Michele, Algorithm 1010, tables 1 and 4),
// and the backward error that its header states.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include <graze/solvers/math/quartic.hpp>
#include <graze/solvers/math/rng.hpp>

#include "complex_root_errors.hpp"

namespace graze {
namespace {

using root_errors::WideRoots;

constexpr std::uint64_t kSeed = 20261122;

template <class T>
WideRoots solve(const std::vector<T>& c, int* most_steps = nullptr) {
  const auto formula = [](const auto& scaled, auto& roots, int& steps) {
    return quartic_roots(scaled, roots, steps);
  };
  return root_errors::solve<T, 4>(c, formula, most_steps);
}

/// Cases 1 to 22 by their roots, from which the coefficients come, so no printed table is needed. Allowed is
/// what kQuarticBackward u in the coefficients does to simple roots; to the multiple ones what is said here.
struct Case {
  int number;
  WideRoots roots;
  std::optional<double> allowed = std::nullopt;

  [[nodiscard]] double most() const {
    return allowed ? *allowed : kQuarticBackward * 0x1p-53 * root_errors::condition(roots);
  }
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {1, {1e9L, 1e6L, 1e3L, 1}},
      {2, {2.003L, 2.002L, 2.001L, 2}},
      {3, {1e53L, 1e50L, 1e49L, 1e47L}},
      {4, {1e14L, 2, 1, -1}},
      {5, {-2e7L, 1e7L, 1, -1}},
      {6, {1e7L, -1e6L, {1, 1}, {1, -1}}},
      {7, {-7, -4, {-1e6L, 1e5L}, {-1e6L, -1e5L}}},
      {8, {1e8L, 11, {1e3L, 1}, {1e3L, -1}}},
      {9, {{1e7L, 1e6L}, {1e7L, -1e6L}, {1, 2}, {1, -2}}},
      {10, {{1e4L, 3}, {1e4L, -3}, {-7, 1e3L}, {-7, -1e3L}}},
      {11, {{1.001L, 4.998L}, {1.001L, -4.998L}, {1, 5.001L}, {1, -5.001L}}},
      {12, {{1e3L, 3}, {1e3L, -3}, {1e3L, 1}, {1e3L, -1}}},
      {13, {{2, 1e4L}, {2, -1e4L}, {1, 1e3L}, {1, -1e3L}}},
      {14, {1000, 1000, 1000, 1000}, 0},  // exact coefficients
      {15, {1000, 1000, 1000, 1e-15L}, 1e-15},
      {16, {{1, 0.1L}, {1, -0.1L}, {1e16L, 1e7L}, {1e16L, -1e7L}}},
      {17, {10000, 10001, 10010, 10100}},
      {18, {{4e5L, 3e2L}, {4e5L, -3e2L}, {3e4L, 7e3L}, {3e4L, -7e3L}}},
      {19, {1e44L, 1e30L, 1e30L, 1}, 5e-8},  // a double root: the square root of rounding
      {20, {1e14L, 1e7L, 1e7L, 1}, 5e-8},
      {21, {1e15L, 1e7L, 1e7L, 1}, 5e-8},
      {22, {1e154L, 1e152L, 10, 1}},
  };
  return all;
}

TEST(Quartic, Algorithm1010CasesByRootsAreSolvedAsWellAsTheirRoundedCoefficientsAllow) {
  for (const Case& given : cases()) {
    const auto c = root_errors::coefficients_of<double>(given.roots);
    const WideRoots roots = solve(c);
    ASSERT_EQ(roots.size(), 4U) << given.number;
    const double error = root_errors::relative_error(roots, given.roots);
    const double backward = root_errors::backward_error(c, roots);
    std::printf("case %2d: relative error %.2e, backward %.2f u\n", given.number, error, backward);
    EXPECT_LE(error, given.most()) << given.number;
    EXPECT_LE(backward, kQuarticBackward) << given.number;
  }
}

TEST(Quartic, Algorithm1010Cases23And24ByCoefficients) {
  for (const std::vector<double>& c :
       {std::vector<double>{0.001, 3.0 / 8, 1, 1, 1},
        std::vector<double>{-1e30, 1e60 + 1e30, 1e-30 - 1e60, -(1 + 1e-30), 1}}) {
    const WideRoots roots = solve(c);
    ASSERT_EQ(roots.size(), 4U);
    EXPECT_LE(root_errors::backward_error(c, roots), kQuarticBackward);
  }
  // Case 24 has the roots 1, 1/S, S and -S for S = 1e30, but for rounding.
  const double s = 1e30;
  const WideRoots roots = solve<double>({-s, s * s + s, 1 / s - s * s, -(1 + 1 / s), 1});
  EXPECT_LE(root_errors::relative_error(roots, {1, 1e-30L, 1e30L, -1e30L}), 4e-16);
}

/// Table 4: four real roots; two real and a pair; two pairs; the same two with roots up to 5e5; random
/// coefficients. Empty roots: known by their coefficients only.
struct Sampled {
  WideRoots roots;
  std::vector<double> c;
};

Sampled sample(Rng& rng, char name) {
  const auto in = [&](double width) { return static_cast<long double>(rng.uniform(-width / 2, width / 2)); };
  if (name == 'F')
    return {
        {},
        {rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), 1}};
  WideRoots roots;
  const auto add_pair = [&](double width) {
    const long double re = in(width), im = in(width);
    roots.emplace_back(re, im);
    roots.emplace_back(re, -im);
  };
  const double small = name == 'E' ? 1e6 : 1, large = name == 'D' || name == 'E' ? 1e6 : 1;
  if (name != 'A') add_pair(large);
  if (name == 'C' || name == 'E') add_pair(small);
  while (roots.size() < 4) roots.emplace_back(in(small));
  auto c = root_errors::coefficients_of<double>(roots);
  return {std::move(roots), std::move(c)};
}

TEST(Quartic, Algorithm1010SamplesAToFAreSolvedWithinTheStatedBackwardError) {
  Rng rng(kSeed);
  for (const char name : {'A', 'B', 'C', 'D', 'E', 'F'}) {
    double backward = 0, forward = 0;
    std::vector<double> errors;
    int most_steps = 0;
    for (int i = 0; i < 20000; ++i) {
      const Sampled sampled = sample(rng, name);
      const WideRoots roots = solve(sampled.c, &most_steps);
      ASSERT_EQ(roots.size(), 4U) << name << i;
      backward = std::max(backward, root_errors::backward_error(sampled.c, roots));
      if (sampled.roots.empty()) continue;
      const double error = root_errors::relative_error(roots, sampled.roots) / 0x1p-53;
      const double condition = root_errors::condition(sampled.roots);
      errors.push_back(error);
      // Beyond this condition roots move by more than first order says.
      if (condition < 1e6) forward = std::max(forward, error / condition);
    }
    std::sort(errors.begin(), errors.end());
    const double median = errors.empty() ? 0 : errors[errors.size() / 2];
    std::printf("sample %c: backward %.2f u; error %.2f condition units, median %.2g u; at most %d steps\n",
                name, backward, forward, median, most_steps);
    EXPECT_LE(backward, kQuarticBackward) << name;
    EXPECT_LE(forward, kQuarticBackward) << name;
    EXPECT_LE(median, 32) << "well-conditioned ones come near rounding; the worst of four roots counts";
    EXPECT_LE(most_steps, 24) << name;
  }
}

TEST(Quartic, RootsOfAllMagnitudesAndSignsKeepTheStatedBackwardError) {
  Rng rng(kSeed);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<double> c;
    for (int k = 0; k < 5; ++k)
      c.push_back(std::pow(10.0, rng.uniform(-8, 8)) * (rng.uniform() < 0.5 ? -1 : 1));
    const WideRoots roots = solve(c);
    ASSERT_EQ(roots.size(), 4U) << i;
    worst = std::max(worst, root_errors::backward_error(c, roots));
  }
  std::printf("seed %llu: backward error %.2f u\n", static_cast<unsigned long long>(kSeed), worst);
  EXPECT_LE(worst, kQuarticBackward);
}

TEST(Quartic, InFloatToo) {
  Rng rng(kSeed);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<float> c;
    for (int k = 0; k < 5; ++k) c.push_back(static_cast<float>(rng.uniform(-1, 1)));
    const WideRoots roots = solve(c);
    ASSERT_EQ(roots.size(), 4U) << i;
    worst = std::max(worst, root_errors::backward_error(c, roots));
  }
  std::printf("seed %llu: backward error %.2f u\n", static_cast<unsigned long long>(kSeed), worst);
  EXPECT_LE(worst, kQuarticBackward);
}

TEST(Quartic, TwoSquaresAreFoundToRounding) {
  for (const root_errors::Wide& root : solve<double>({1, 0, -2, 0, 1})) EXPECT_EQ(std::abs(root), 1);
}

TEST(Quartic, WhatTheRangeCannotHoldIsAFailureAndNoWrongRoot) {
  // The resolvent's terms span more than float does: answered rightly or not at all.
  Rng rng(kSeed);
  int failed = 0;
  for (int i = 0; i < 20000; ++i) {
    std::vector<float> c;
    for (int k = 0; k < 5; ++k)
      c.push_back(static_cast<float>(std::pow(10.0, rng.uniform(-9, 9)) * (rng.uniform() < 0.5 ? -1 : 1)));
    const WideRoots roots = solve(c);
    failed += roots.empty() ? 1 : 0;
    if (!roots.empty()) {
      EXPECT_LE(root_errors::backward_error(c, roots), kQuarticBackward);
    }
  }
  std::printf("%d of 20000 in float failed\n", failed);
  EXPECT_GT(failed, 0);
  EXPECT_LT(failed, 400);
}

}  // namespace
}  // namespace graze
