#include <gtest/gtest.h>

#include <graze/solvers/math/chebyshev.hpp>
#include <vector>

#include "exact.hpp"

namespace graze {
namespace {

using namespace test;

constexpr int kCases = 2'000;

struct Case {
  std::vector<double> c, c_error;
  std::vector<Exact> truth;  // anywhere within c_error of c
};

Case random_case(Rng& rng, std::size_t max_degree, int low, int high) {
  Case c;
  const std::size_t n = rng.next() % (max_degree + 1);
  const bool is_exact = rng.next() % 3 == 0;
  for (std::size_t i = 0; i <= n; ++i) {
    c.c.push_back(rng.next() % 8 == 0 ? 0 : log_uniform(rng, low, high));
    c.c_error.push_back(is_exact ? 0 : std::fabs(c.c[i]) * rng.uniform() * 0x1p-46);
    c.truth.push_back(exact(c.c[i]) + exact(c.c_error[i]) * exact(rng.uniform(-1, 1)));
  }
  return c;
}

/// By T_{k+1} = 2 x T_k - T_{k-1} on power coefficients in x.
std::vector<Exact> exact_power(const std::vector<Exact>& c) {
  const std::size_t size = c.size();
  std::vector<Exact> before(size, 0), here(size, 0), sum(size, 0);
  here[0] = 1;
  for (std::size_t k = 0; k < size; ++k) {
    for (std::size_t i = 0; i < size; ++i) sum[i] += c[k] * here[i];
    std::vector<Exact> next(size, 0);
    for (std::size_t i = 0; i + 1 < size; ++i) next[i + 1] = (k == 0 ? 1 : 2) * here[i];
    for (std::size_t i = 0; i < size; ++i) next[i] -= before[i];
    before = here;
    here = next;
  }
  return sum;
}

/// p(2 t - 1) in powers of t by Horner's rule, then b_j = sum_i C(j,i) / C(n,i) a_i.
std::vector<Exact> exact_bernstein(const std::vector<Exact>& c) {
  const std::vector<Exact> power = exact_power(c);
  const std::size_t size = c.size();
  std::vector<Exact> a(size, 0);
  for (std::size_t k = size; k-- > 0;) {
    std::vector<Exact> next(size, 0);
    for (std::size_t i = 0; i < size; ++i) {
      next[i] -= a[i];
      if (i > 0) next[i] += 2 * a[i - 1];
    }
    a = next;
    a[0] += power[k];
  }
  std::vector<Exact> b(size, 0);
  for (std::size_t j = 0; j < size; ++j) {
    Exact weight = 1;  // C(j,i) / C(n,i)
    for (std::size_t i = 0; i <= j; ++i) {
      b[j] += weight * a[i];
      if (i < j) weight *= Exact(j - i) / Exact(size - 1 - i);
    }
  }
  return b;
}

template <class Convert, class Truth>
void expect_bounds(const char* name, const Convert& convert, const Truth& truth_of) {
  Worst worst(name);
  Rng rng(41);
  for (int i = 0; i < kCases; ++i) {
    const bool tiny = i % 10 == 0;
    const Case c = random_case(rng, i % 20 == 0 ? static_cast<std::size_t>(kMaxChebyshevDegree) : 8,
                               tiny ? -1074 : -20, tiny ? -1010 : 20);
    std::vector<double> out(c.c.size()), out_error(c.c.size());
    convert(c.c, c.c_error, out, out_error);
    const std::vector<Exact> truth = truth_of(c.truth);
    for (std::size_t k = 0; k < out.size(); ++k)
      ASSERT_TRUE(worst.within(exact(out[k]) - truth[k], out_error[k])) << c.c.size() << ' ' << k;
  }
}

TEST(Chebyshev, PowerCoefficientsLieWithinTheirBounds) {
  expect_bounds("to power, error / bound", chebyshev_to_power, exact_power);
}

TEST(Chebyshev, BernsteinCoefficientsLieWithinTheirBounds) {
  expect_bounds("to Bernstein, error / bound", chebyshev_to_bernstein, exact_bernstein);
}

TEST(Chebyshev, SmallIntegersChangeBasisWithoutAnError) {
  // T_2 = 2 x^2 - 1 = 8 t^2 - 8 t + 1.
  const std::vector<double> c{0, 0, 1};
  std::vector<double> out(3), error(3);
  chebyshev_to_power(c, {}, out, error);
  EXPECT_EQ(out, (std::vector<double>{-1, 0, 2}));
  EXPECT_EQ(error, (std::vector<double>{0, 0, 0}));
  chebyshev_to_bernstein(c, {}, out, error);
  EXPECT_EQ(out, (std::vector<double>{1, -3, 1}));
  EXPECT_EQ(error, (std::vector<double>{0, 0, 0}));
}

TEST(Chebyshev, BeyondTheDegreeLimitNothingIsKnown) {
  const std::vector<double> c(kMaxChebyshevSize + 1, 1.0);
  std::vector<double> out(c.size()), error(c.size());
  chebyshev_to_bernstein(c, {}, out, error);
  for (const double e : error) EXPECT_EQ(e, kInfinity);
}

TEST(Chebyshev, ValuesAndSlopesAreThoseOfThePowerBasis) {
  double worst = 0, worst_slope = 0;
  Rng rng(42);
  for (int i = 0; i < kCases; ++i) {
    const Case c = random_case(rng, 12, -4, 4);
    const double x = i % 5 == 0 ? (i % 2 == 0 ? 1.0 : -1.0) : rng.uniform(-1, 1);
    std::vector<Exact> coefficients;
    double size = 0;
    for (const double v : c.c) {
      coefficients.push_back(exact(v));
      size += std::fabs(v);
    }
    const std::vector<Exact> power = exact_power(coefficients);
    std::vector<Exact> slope;
    for (std::size_t k = 1; k < power.size(); ++k) slope.push_back(Exact(k) * power[k]);
    const auto p = chebyshev_value<double>(c.c, x);
    const double n = static_cast<double>(c.c.size());
    const double unit = 0x1p-53 * (size > 0 ? size : 1);
    worst = std::max(worst, std::fabs(to_double(exact(p.value) - power_value(power, exact(x)))) / (n * unit));
    worst_slope =
        std::max(worst_slope, std::fabs(to_double(exact(p.derivative) - power_value(slope, exact(x)))) /
                                  (n * n * n * unit));
  }
  std::printf("worst error in n u sum |c|: %.3g; of the slope in n^3 u sum |c|: %.3g\n", worst, worst_slope);
  EXPECT_LE(worst, 4);
  EXPECT_LE(worst_slope, 4);
}

}  // namespace
}  // namespace graze
