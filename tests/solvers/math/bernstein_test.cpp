#include <gtest/gtest.h>

#include <graze/solvers/math/bernstein.hpp>
#include <vector>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

constexpr int kCases = 3'000;  // of 50 and more coefficient operations each

struct Case {
  std::vector<double> b, b_error;
  std::vector<Exact> truth;  // anywhere within b_error of b
};

Case random_case(Rng& rng, std::size_t max_degree, int low = -20, int high = 20) {
  Case c;
  const std::size_t n = rng.next() % (max_degree + 1);
  const bool is_exact = rng.next() % 3 == 0;
  for (std::size_t i = 0; i <= n; ++i) {
    c.b.push_back(rng.next() % 8 == 0 ? 0 : log_uniform(rng, low, high));
    c.b_error.push_back(is_exact ? 0 : std::fabs(c.b[i]) * rng.uniform() * 0x1p-46);
    c.truth.push_back(exact(c.b[i]) + exact(c.b_error[i]) * exact(rng.uniform(-1, 1)));
  }
  return c;
}

double random_parameter(Rng& rng) {
  const double t = rng.next() % 2 == 0 ? rng.uniform() : std::fabs(log_uniform(rng, -40, -1));
  if (rng.next() % 5 == 0) return std::floor(16 * t) / 16;
  return rng.next() % 3 == 0 ? 1 - t : t;
}

Exact exact_slope(const std::vector<Exact>& b, const Exact& t) {
  if (b.size() == 1) return 0;
  std::vector<Exact> d;
  for (std::size_t i = 0; i + 1 < b.size(); ++i) d.push_back((b[i + 1] - b[i]) * Exact(b.size() - 1));
  return bernstein_value_exact(d, t);
}

TEST(Bernstein, ValueAndDerivativeBoundsHold) {
  Worst plain("de Casteljau error / bound"), value("value error / bound"), slope("derivative error / bound");
  Rng rng(31);
  for (int i = 0; i < kCases; ++i) {
    const bool tiny = i % 10 == 0;
    const Case c = random_case(rng, i % 50 == 0 ? 64 : 12, tiny ? -1074 : -20, tiny ? -1010 : 20);
    const double t = i % 20 == 1 ? rng.uniform(-2, 3) : random_parameter(rng);
    const Exact truth = bernstein_value_exact(c.truth, exact(t));
    const Evaluation p = bernstein_evaluate(c.b, c.b_error, t);
    ASSERT_TRUE(plain.within(exact(p.value) - truth, p.error)) << c.b.size() << ' ' << t;
    const auto q = bernstein_evaluate_with_derivative(c.b, c.b_error, t);
    ASSERT_TRUE(value.within(exact(q.value) - truth, q.error)) << c.b.size() << ' ' << t;
    ASSERT_TRUE(slope.within(exact(q.derivative) - exact_slope(c.truth, exact(t)), q.derivative_error));
  }
}

TEST(Bernstein, SubdivisionBoundsHoldAndStayZeroWhereNothingIsRounded) {
  Worst worst("subdivision error / bound");
  Rng rng(32);
  for (int i = 0; i < kCases; ++i) {
    Case c = random_case(rng, 12, i % 10 == 0 ? -1074 : -20, i % 10 == 0 ? -1050 : 20);
    const double t = random_parameter(rng);
    const std::size_t n = c.b.size() - 1;
    std::vector<double> right(n + 1), right_error(n + 1);
    // In place: the left half replaces the input.
    bernstein_subdivide(c.b, c.b_error, t, c.b, c.b_error, right, right_error);
    std::vector<Exact> work = c.truth;
    for (std::size_t k = 0; k <= n; ++k) {
      ASSERT_TRUE(worst.within(exact(c.b[k]) - work[0], c.b_error[k]));
      ASSERT_TRUE(worst.within(exact(right[n - k]) - work[n - k], right_error[n - k]));
      for (std::size_t j = 0; j + k < n; ++j) work[j] = (1 - exact(t)) * work[j] + exact(t) * work[j + 1];
    }
  }
  std::vector<double> b{1, -1, 3}, e{0, 0, 0}, r(3), re(3);
  bernstein_subdivide(b, e, 0.5, b, e, r, re);
  EXPECT_EQ(b, (std::vector<double>{1, 0, 0.5}));
  EXPECT_EQ(e, (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(r, (std::vector<double>{0.5, 1, 3}));
}

TEST(Bernstein, IntervalValuesContainAndAreQuadraticallyTight) {
  Rng rng(33);
  for (int i = 0; i < kCases; ++i) {
    const Case c = random_case(rng, 12);
    const double u = i % 10 == 0 ? rng.uniform(-1, 2) : random_parameter(rng), v = random_parameter(rng);
    const Interval t{std::min(u, v), std::max(u, v)};
    const Interval range = bernstein_evaluate(c.b, c.b_error, t);
    const Interval slopes = bernstein_evaluate_derivative(c.b, c.b_error, t);
    for (int k = 0; k <= 4; ++k) {
      const Exact x = exact(t.lo) + (exact(t.hi) - exact(t.lo)) * k / 4;
      ASSERT_TRUE(holds(range, bernstein_value_exact(c.truth, x))) << t.lo << ' ' << t.hi;
      ASSERT_TRUE(holds(slopes, exact_slope(c.truth, x))) << t.lo << ' ' << t.hi;
    }
    if (t.lo >= 0 && t.hi <= 1) {
      const double all = width(bernstein_range(c.b, c.b_error));
      ASSERT_LE(width(range), all * (1 + 0x1p-40) + 0x1p-40 * mag(bernstein_range(c.b, c.b_error)));
    }
  }
  // p = (2t - 1)^2 on [0.5 - h, 0.5 + h] is [0, 4 h^2]; the hull adds as much below.
  const std::vector<double> b{1, -1, 1};
  const Interval near_minimum = bernstein_evaluate(b, {}, Interval{0.5 - 0x1p-10, 0.5 + 0x1p-10});
  EXPECT_TRUE(contains(near_minimum, Interval{0, 0x1p-18}));
  EXPECT_LE(width(near_minimum), 2.01 * 0x1p-18);
}

TEST(Bernstein, ProductBoundsHold) {
  Worst worst("product error / bound");
  Rng rng(34);
  for (int i = 0; i < kCases; ++i) {
    const int low = i % 10 == 0 ? -560 : -20, high = i % 10 == 0 ? -500 : 20;
    const std::size_t degree = i % 100 == 0 ? 32 : 6;
    const Case a = random_case(rng, degree, low, high), b = random_case(rng, degree, low, high);
    const std::size_t size = a.b.size() + b.b.size() - 1;
    std::vector<double> out(size), out_error(size);
    bernstein_product(a.b, a.b_error, b.b, b.b_error, out, out_error);
    const int m = static_cast<int>(a.b.size()) - 1, n = static_cast<int>(b.b.size()) - 1;
    for (int k = 0; k <= m + n; ++k) {
      Exact sum = 0;
      for (int j = std::max(0, k - n); j <= std::min(k, m); ++j)
        sum += exact(binomial(m, j)) * exact(binomial(n, k - j)) * a.truth[static_cast<std::size_t>(j)] *
               b.truth[static_cast<std::size_t>(k - j)];
      // C(64, 32) and its neighbours are no doubles: the reference forms them exactly.
      Exact ways = 1;
      for (int j = 1; j <= k; ++j) ways = ways * (m + n - j + 1) / j;
      const auto at = static_cast<std::size_t>(k);
      ASSERT_TRUE(worst.within(exact(out[at]) - sum / ways, out_error[at])) << m << ' ' << n << ' ' << k;
    }
  }
}

TEST(Bernstein, ConversionBoundsHoldBothWays) {
  Worst to("power to Bernstein error / bound"), from("Bernstein to power error / bound");
  Rng rng(35);
  for (int i = 0; i < kCases; ++i) {
    const bool tiny = i % 10 == 0;
    const Case c = random_case(rng, i % 100 == 1 ? 64 : 12, tiny ? -1074 : -20, tiny ? -1030 : 20);
    const std::size_t size = c.b.size();
    std::vector<double> b(size), b_error(size), p(size), p_error(size);
    power_to_bernstein(c.b, c.b_error, b, b_error);
    bernstein_to_power(c.b, c.b_error, p, p_error);
    const Exact n = Exact(size - 1);
    std::vector<Exact> row(size), differences = c.truth;
    Exact ways = 1;  // C(n, k)
    for (std::size_t k = 0; k < size; ++k) {
      // Power: C(n,k) times the k-th forward difference at 0.
      ASSERT_TRUE(from.within(exact(p[k]) - ways * differences[0], p_error[k])) << size << ' ' << k;
      for (std::size_t j = 0; j + 1 + k < size; ++j) differences[j] = differences[j + 1] - differences[j];
      row[k] = c.truth[k] / ways;
      ways = ways * (n - Exact(k)) / Exact(k + 1);
    }
    // Bernstein: repeated sums of c[i] / C(n,i), the inverse of the differences.
    for (std::size_t k = 0; k < size; ++k) {
      Exact sum = 0, choose = 1;
      for (std::size_t j = 0; j <= k; ++j) {
        sum += choose * row[j];
        choose = choose * Exact(k - j) / Exact(j + 1);
      }
      ASSERT_TRUE(to.within(exact(b[k]) - sum, b_error[k])) << size << ' ' << k;
    }
  }
}

TEST(Bernstein, DerivativeCoefficientsKeepTheirBounds) {
  Worst worst("derivative coefficient error / bound");
  Rng rng(36);
  for (int i = 0; i < kCases; ++i) {
    const Case c = random_case(rng, 12);
    std::vector<double> d(c.b.size()), d_error(c.b.size());
    bernstein_derivative(c.b, c.b_error, d, d_error);
    for (std::size_t k = 0; k + 1 < c.b.size(); ++k) {
      const Exact truth = (c.truth[k + 1] - c.truth[k]) * Exact(c.b.size() - 1);
      ASSERT_TRUE(worst.within(exact(d[k]) - truth, d_error[k]));
    }
  }
}

TEST(Bernstein, BinomialsAreExactUpToFiftySix) {
  for (int n = 0; n <= kMaxBernsteinDegree; ++n) {
    Exact ways = 1;
    for (int k = 0; k <= n; ++k) {
      const Exact error = abs(exact(binomial(n, k)) - ways);
      ASSERT_LE(error, n <= kMaxExactBinomial ? Exact(0) : ways * exact(0x1p-53)) << n << ' ' << k;
      ways = ways * (n - k) / (k + 1);
    }
  }
}

/// All sign choices by brute force.
SignVariations brute_force(const std::vector<double>& b, const std::vector<double>& e) {
  SignVariations result{1000, -1000};
  std::size_t choices = 1;
  for (std::size_t i = 0; i < b.size(); ++i) choices *= 3;
  for (std::size_t choice = 0; choice < choices; ++choice) {
    int last = 0, changes = 0;
    bool possible = true;
    std::size_t rest = choice;
    for (std::size_t i = 0; i < b.size(); ++i, rest /= 3) {
      const int sign = static_cast<int>(rest % 3) - 1;
      const double lo = b[i] - e[i], hi = b[i] + e[i];
      possible = possible && (sign < 0 ? lo < 0 : sign > 0 ? hi > 0 : lo <= 0 && hi >= 0);
      if (sign != 0) changes += last != 0 && sign != last;
      if (sign != 0) last = sign;
    }
    if (possible) result = {std::min(result.lower, changes), std::max(result.upper, changes)};
  }
  return result;
}

TEST(Bernstein, SignVariationsAreTheExtremesOverAllChoices) {
  Rng rng(37);
  for (int i = 0; i < kCases; ++i) {
    std::vector<double> b(1 + rng.next() % 6), e;
    for (double& x : b) x = static_cast<double>(rng.next() % 5) - 2;
    for (std::size_t k = 0; k < b.size(); ++k) e.push_back(rng.next() % 3 == 0 ? 1.5 : 0);
    const auto mine = sign_variations(b, e), reference = brute_force(b, e);
    ASSERT_EQ(mine.lower, reference.lower);
    ASSERT_EQ(mine.upper, reference.upper);
  }
}

TEST(Bernstein, BeyondTheDegreeLimitTheBoundIsInfinite) {
  const std::vector<double> b(kMaxBernsteinSize + 1, 1.0);
  std::vector<double> out(b.size()), error(b.size());
  EXPECT_EQ(bernstein_evaluate(b, 0.5).error, kInfinity);
  EXPECT_EQ(bernstein_evaluate_with_derivative(b, 0.5).error, kInfinity);
  EXPECT_EQ(bernstein_evaluate(b, {}, Interval{0, 1}), entire());
  power_to_bernstein(b, {}, out, error);
  EXPECT_EQ(error, std::vector<double>(b.size(), kInfinity));
}

TEST(Bernstein, EndsAndZerosAreExact) {
  const std::vector<double> b{0.1, 0.7, -0.3}, zero(5, 0.0);
  EXPECT_EQ(bernstein_evaluate(b, 0).value, 0.1);
  EXPECT_EQ(bernstein_evaluate(b, 1).value, -0.3);
  EXPECT_EQ(bernstein_evaluate(b, 0).error + bernstein_evaluate(b, 1).error, 0);
  EXPECT_EQ(bernstein_evaluate(zero, 0.3).error, 0);
  EXPECT_EQ(bernstein_evaluate(std::vector{1.0, kMax, -kMax}, 3).error, kInfinity);
}

}  // namespace
}  // namespace graze
