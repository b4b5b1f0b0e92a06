#include <gtest/gtest.h>

#include <complex>
#include <graze/solvers/math/polynomial.hpp>
#include <vector>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

constexpr int kCases = 20'000;  // of about 5 multiplications each: 100 000 operations of every kind

std::vector<double> random_coefficients(Rng& rng, int low, int high) {
  std::vector<double> c(1 + rng.next() % 13);
  for (double& x : c) x = rng.next() % 8 == 0 ? 0 : log_uniform(rng, low, high);
  return c;
}

/// (x - r)^n and the like, rounded: an ill-conditioned place.
std::vector<double> clustered(Rng& rng, double r) {
  std::vector<double> c{1};
  for (std::uint64_t n = 1 + rng.next() % 9; n > 0; --n) {
    c.insert(c.begin(), 0);
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= r * c[i + 1];
  }
  return c;
}

/// Calls check(c, x) for random polynomials, a third of them close to a multiple root, a few near underflow.
template <class Check>
void for_polynomials(const Check& check) {
  Rng rng(21);
  for (int i = 0; i < kCases; ++i) {
    const double x = log_uniform(rng, -6, 6);
    const bool tiny = i % 10 == 9;
    const auto c = i % 3 == 0 ? clustered(rng, x * (1 + log_uniform(rng, -50, -8)))
                              : random_coefficients(rng, tiny ? -1074 : -30, tiny ? -1000 : 30);
    check(c, x, rng);
  }
}

std::vector<Exact> exact_derivative(const std::vector<Exact>& c) {
  std::vector<Exact> d;
  for (std::size_t i = 1; i < c.size(); ++i) d.push_back(Exact(static_cast<unsigned>(i)) * c[i]);
  return d;
}

TEST(Polynomial, RunningErrorBoundHolds) {
  Worst worst("Horner error / bound");
  for_polynomials([&](const auto& c, double x, Rng&) {
    const Evaluation p = evaluate(c, x);
    ASSERT_TRUE(worst.within(exact(p.value) - power_value(exact(c), exact(x)), p.error));
  });
}

TEST(Polynomial, CompensatedBoundHoldsAndIsSmallerNearMultipleRoots) {
  Worst worst("compensated Horner error / bound");
  int smaller = 0, all = 0;
  for_polynomials([&](const auto& c, double x, Rng&) {
    const Evaluation p = evaluate_compensated(c, x);
    ASSERT_TRUE(worst.within(exact(p.value) - power_value(exact(c), exact(x)), p.error));
    const double plain = evaluate(c, x).error;
    all += plain > 0x1p-900;
    smaller += plain > 0x1p-900 && p.error <= plain;
  });
  EXPECT_EQ(smaller, all);
}

TEST(Polynomial, ValueAndDerivativeBoundsHoldWithCoefficientErrors) {
  Worst worst_value("value error / bound"), worst_slope("derivative error / bound");
  for_polynomials([&](const auto& c, double x, Rng& rng) {
    // The true coefficients lie anywhere within the stated errors.
    std::vector<double> c_error;
    std::vector<Exact> truth;
    for (const double a : c) {
      c_error.push_back(std::fabs(a) * rng.uniform() * 0x1p-48);
      truth.push_back(exact(a) + exact(c_error.back()) * exact(rng.uniform(-1, 1)));
    }
    const auto p = evaluate_with_derivative(c, c_error, x);
    const Exact value = power_value(truth, exact(x)), slope = power_value(exact_derivative(truth), exact(x));
    ASSERT_TRUE(worst_value.within(exact(p.value) - value, p.error));
    ASSERT_TRUE(worst_slope.within(exact(p.derivative) - slope, p.derivative_error));
    const Evaluation alone = evaluate(c, c_error, x);
    ASSERT_TRUE(worst_value.within(exact(alone.value) - value, alone.error));
    std::vector<double> d(c.size()), d_error(c.size());
    derivative(c, c_error, d, d_error);
    const auto d_truth = exact_derivative(truth);
    for (std::size_t i = 0; i < d_truth.size(); ++i) {
      ASSERT_TRUE(worst_slope.within(exact(d[i]) - d_truth[i], d_error[i]));
    }
  });
}

TEST(Polynomial, InclusionsContainValuesAndDerivatives) {
  for_polynomials([&](const auto& c, double x, Rng& rng) {
    const Interval t{std::min(x, x * 1.125), std::max(x, x * 1.125)};
    const Exact v = exact(t.lo) + (exact(t.hi) - exact(t.lo)) * exact(rng.uniform());
    const auto truth = exact(c);
    ASSERT_TRUE(holds(evaluate(c, {}, t), power_value(truth, v)));
    ASSERT_TRUE(holds(evaluate_derivative(c, {}, t), power_value(exact_derivative(truth), v)));
  });
}

TEST(Polynomial, HornerInDoubleDoubleKeepsTwiceTheDigits) {
  for_polynomials([&](const auto& c, double x, Rng&) {
    if (std::fabs(c.back()) < 0x1p-900) return;
    const Exact truth = power_value(exact(c), exact(x));
    Exact size = 0;
    for (std::size_t i = c.size(); i-- > 0;) size = size * exact(std::fabs(x)) + exact(std::fabs(c[i]));
    // A step is a product with error 5 u^2 and a sum with error 2 u^2.
    const Exact bound = size * Exact(7 * c.size()) * exact(0x1.01p-106);
    ASSERT_LE(abs(exact(horner(c, DoubleDouble(x))) - truth), bound);
  });
}

TEST(Polynomial, RootBoundIsNotExceededAndScalesExactly) {
  Rng rng(22);
  for (int i = 0; i < kCases; ++i) {
    // Known roots; the polynomial is exact because roots are small integers over 8.
    std::vector<double> c{1};
    double largest = 0;
    for (std::uint64_t n = 1 + rng.next() % 5; n > 0; --n) {
      const double r = static_cast<double>(rng.next() % 65) / 8 - 4;
      largest = std::max(largest, std::fabs(r));
      c.insert(c.begin(), 0);
      for (std::size_t k = 0; k + 1 < c.size(); ++k) c[k] -= r * c[k + 1];
    }
    const double bound = root_bound(c);
    ASSERT_GE(bound, largest);
    ASSERT_LE(bound, 2.001 * static_cast<double>(c.size() - 1) * largest);
    const int k = static_cast<int>(rng.next() % 200) - 100;
    for (std::size_t j = 0; j < c.size(); ++j) c[j] = scale_by_power(c[j], 30 - k * static_cast<int>(j));
    ASSERT_EQ(root_bound(c), scale_by_power(bound, k));
  }
}

TEST(Polynomial, RootBoundSurvivesExtremeCoefficients) {
  EXPECT_EQ(root_bound(std::vector{kMax, kTiny}), kInfinity);
  EXPECT_GE(root_bound(std::vector{kTiny, kMax}), kTiny);
  EXPECT_LT(root_bound(std::vector{kTiny, kMax}), 4 * kTiny);
  EXPECT_EQ(root_bound(std::vector{kMax, 0.0, kTiny}), kInfinity);
  // The ratio of these coefficients overflows, their roots, about 2^1020 i, do not.
  EXPECT_GE(root_bound(std::vector{0x1p1000, 0.0, 0x1p-1040}), 0x1p1020);
  EXPECT_LT(root_bound(std::vector{0x1p1000, 0.0, 0x1p-1040}), kInfinity);
  EXPECT_EQ(root_bound(std::vector{5.0}), 0);
  EXPECT_EQ(root_bound(std::vector<double>{}), 0);
  EXPECT_EQ(root_bound(std::vector{1.0, kInfinity}), kInfinity);
}

TEST(Polynomial, EffectiveDegreeIgnoresLeadingZeros) {
  EXPECT_EQ(effective_degree(std::vector{1.0, 2.0, 0.0}), 1);
  EXPECT_EQ(effective_degree(std::vector{3.0}), 0);
  EXPECT_EQ(effective_degree(std::vector{0.0, -0.0}), -1);
  EXPECT_EQ(effective_degree({}), -1);
}

TEST(Polynomial, OverflowGivesAnInfiniteBound) {
  const std::vector<double> c{1, kMax, kMax};
  for (const double x : {4.0, -4.0, kInfinity, std::nan("")}) {
    EXPECT_EQ(evaluate(c, x).error, kInfinity);
    EXPECT_EQ(evaluate_compensated(c, x).error, kInfinity);
    EXPECT_EQ(evaluate_with_derivative(c, x).derivative_error, kInfinity);
  }
}

}  // namespace
}  // namespace graze
