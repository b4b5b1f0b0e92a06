// Double-doubles with error bounds: the exact result is inside, and the ball is small.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include <graze/solvers/math/double_double_ball.hpp>
#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze {
namespace {

constexpr std::uint64_t kSeed = 20261122;

double wide_range(Rng& rng) {
  return (rng.uniform() < 0.5 ? -1 : 1) * rng.uniform(1, 2) * std::exp2(std::floor(rng.uniform(-20, 20)));
}

/// A formula of degree 6 with cancellation: (a b - c d)^2 (e + f) - (a b)^2 e.
template <class T>
T formula(const std::array<T, 6>& x) {
  const T det = x[0] * x[1] - x[2] * x[3];
  const T product = x[0] * x[1];
  return det * det * (x[4] + x[5]) - product * product * x[4];
}

TEST(DoubleDoubleBall, ContainsTheExactResultAndIsNarrow) {
  Rng rng(kSeed);
  double widest = 0;
  for (int i = 0; i < 20000; ++i) {
    std::array<double, 6> x{};
    for (double& v : x) v = wide_range(rng);
    // Every other time the determinant nearly cancels.
    if (i % 2 == 0) x[3] = x[0] * x[1] / x[2];
    std::array<DoubleDoubleBall, 6> balls;
    std::array<Expansion, 6> numbers;
    for (std::size_t k = 0; k < 6; ++k) {
      balls[k] = DoubleDoubleBall(x[k]);
      numbers[k] = Expansion(x[k]);
    }
    const DoubleDoubleBall ball = formula(balls);
    const Expansion exact = formula(numbers);
    const Expansion distance = abs(exact - Expansion(ball.value()));
    ASSERT_TRUE(distance <= Expansion(ball.error())) << i;
    const Interval range = ball.enclosure();
    ASSERT_TRUE(Expansion(range.lo) <= exact && exact <= Expansion(range.hi)) << i;
    const double size = std::fabs(static_cast<double>(ball));
    if (i % 2 != 0 && size > 0) widest = std::max(widest, ball.error() / size);
  }
  std::printf("widest relative radius without cancellation of the determinant: %.3g\n", widest);
}

TEST(DoubleDoubleBall, ExactZerosStayZeroAndDoubtIsSaid) {
  const DoubleDoubleBall zero, one(1.0);
  EXPECT_EQ((zero * DoubleDoubleBall(0x1p500)).enclosure(), Interval{});
  EXPECT_TRUE((one - one).contains_zero());
  EXPECT_FALSE((one - DoubleDoubleBall(1 - 0x1p-53)).contains_zero());
  // A product in the range where low parts underflow is still inside.
  const DoubleDoubleBall tiny(0x1.123456789abcdp-500);
  EXPECT_GT((tiny * tiny).error(), 0x1p-1010);
  // Overflow is seen.
  EXPECT_FALSE(std::isfinite((DoubleDoubleBall(0x1p600) * DoubleDoubleBall(0x1p600)).enclosure().hi));
}

}  // namespace
}  // namespace graze
