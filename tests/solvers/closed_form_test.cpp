// closed_form: the error it states, held to it by exact signs, and the hard cases of quadratics.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include <graze/solvers/closed_form.hpp>
#include <graze/solvers/math/expansion.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze {
namespace {

constexpr std::uint64_t kSeed = 20261122;

template <class T>
Roots solve(const std::vector<T>& c, T lo = -std::numeric_limits<T>::infinity(),
            T hi = std::numeric_limits<T>::infinity()) {
  BasicPolynomialEquation<T> equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  ClosedForm(Parameters{}).solve(equation, roots);
  return roots;
}

/// Sign of p or p' at x, exactly.
template <class T>
int sign_at(const std::vector<T>& c, double x, int order = 0) {
  const auto exact = [](T v) { return Expansion(static_cast<double>(v)); };
  if (order == 1) return (exact(c[1]) + exact(c[2]) * Expansion(2) * Expansion(x)).sign();
  return (exact(c[0]) + Expansion(x) * (exact(c[1]) + exact(c[2]) * Expansion(x))).sign();
}

/// A true root lies within kError ulps of x: p changes its sign there; or, for two roots that are nearer than
/// that, p' does.
template <class T>
bool has_root_nearby(const std::vector<T>& c, double x) {
  const auto moved = [x](T towards) {
    T y = static_cast<T>(x);
    for (int i = 0; i < ClosedForm::kError; ++i) y = std::nextafter(y, towards);
    return static_cast<double>(y);
  };
  const double below = moved(-std::numeric_limits<T>::infinity());
  const double above = moved(std::numeric_limits<T>::infinity());
  return sign_at(c, below) * sign_at(c, above) <= 0 || sign_at(c, below, 1) * sign_at(c, above, 1) <= 0;
}

template <class T>
class ClosedFormIn : public testing::Test {};
using Precisions = testing::Types<double, float>;
TYPED_TEST_SUITE(ClosedFormIn, Precisions);

TYPED_TEST(ClosedFormIn, EveryRootOfRandomQuadraticsIsWithinTheStatedUlps) {
  using T = TypeParam;
  Rng rng(kSeed);
  // Magnitudes whose products stay exact in expansions, and in float's own range.
  const double span = std::is_same_v<T, double> ? 40 : 8;
  const auto random = [&] {
    return static_cast<T>(std::pow(10.0, rng.uniform(-span, span)) * (rng.uniform() < 0.5 ? -1 : 1));
  };
  std::size_t found = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::vector<T> c{random(), random(), random()};
    const Roots roots = solve(c);
    const int discriminant =
        (Expansion(static_cast<double>(c[1])) * Expansion(static_cast<double>(c[1])) -
         Expansion(4) * Expansion(static_cast<double>(c[0])) * Expansion(static_cast<double>(c[2])))
            .sign();
    ASSERT_EQ(roots.list.size(), discriminant < 0 ? 0U : discriminant == 0 ? 1U : 2U);
    for (const Root& root : roots.list) {
      ++found;
      EXPECT_TRUE(has_root_nearby(c, root.x)) << std::hexfloat << c[0] << " " << c[1] << " " << c[2];
    }
  }
  EXPECT_GT(found, 10000U);
}

TYPED_TEST(ClosedFormIn, RootsThatNearlyTouchAreCountedByTheExactDiscriminant) {
  using T = TypeParam;
  Rng rng(kSeed);
  std::array<int, 3> seen{};
  for (int i = 0; i < 20000; ++i) {
    // (x - r)^2 with the middle coefficient moved by a few ulps.
    const T r = static_cast<T>(std::ldexp(1 + std::floor(rng.uniform() * 1024) / 1024, 3));
    T b = -2 * r;
    const int steps = static_cast<int>(rng.uniform() * 5) - 2;
    for (int k = 0; k < std::abs(steps); ++k) b = std::nextafter(b, steps < 0 ? T{0} : T{-1000});
    const std::vector<T> c{r * r, b, 1};
    const Roots roots = solve(c);
    const std::size_t expected = steps < 0 ? 0 : steps == 0 ? 1 : 2;
    ASSERT_EQ(roots.list.size(), expected) << std::hexfloat << r << " " << steps;
    ++seen[expected];
    if (expected == 1) {
      EXPECT_EQ(roots.list[0].x, static_cast<double>(r));
      EXPECT_EQ(roots.list[0].multiplicity, 2U);
    }
    for (const Root& root : roots.list) EXPECT_TRUE(has_root_nearby(c, root.x));
  }
  for (const int count : seen) EXPECT_GT(count, 1000);
}

TEST(ClosedForm, SmallAndLargeRootTogetherKeepTheirDigits) {
  const Roots roots = solve<double>({1, -1e9, 1});
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_DOUBLE_EQ(roots.list[0].x, 1.000000000000000001e-9);
  EXPECT_DOUBLE_EQ(roots.list[1].x, 1e9);
}

TEST(ClosedForm, ExtremeCoefficientsNeitherOverflowNorVanish) {
  const Roots wide = solve<double>({-1e300, 0, 1e-300});
  ASSERT_EQ(wide.list.size(), 2U);
  EXPECT_DOUBLE_EQ(wide.list[1].x, 1e300);
  const Roots steep = solve<double>({1e-300, 1e300, 1e-300});
  ASSERT_EQ(steep.list.size(), 1U) << "the other root lies beyond the range of double";
  const Roots tiny = solve<double>({2e-320, -3e-320, 1e-320});
  ASSERT_EQ(tiny.list.size(), 2U);
  EXPECT_NEAR(tiny.list[0].x, 1, 1e-3);  // subnormal coefficients have few digits
}

TEST(ClosedForm, LowerDegreesAndTheClosedInterval) {
  EXPECT_EQ(solve<double>({0, 0, 0}).status, Status::coincident);
  EXPECT_TRUE(solve<double>({3, 0, 0}).list.empty());
  ASSERT_EQ(solve<double>({-3, 2, 0}).list.size(), 1U);
  EXPECT_EQ(solve<double>({-3, 2, 0}).list[0].x, 1.5);
  EXPECT_EQ(solve<double>({0, -2, 1}, 0, 2).list.size(), 2U) << "both ends belong to the interval";
  EXPECT_EQ(solve<double>({0, -2, 1}, 0.5, 1.5).list.size(), 0U);
  EXPECT_EQ(solve<double>({0, 0, 5}).list[0].multiplicity, 2U);
  EXPECT_EQ(solve<double>({1, 2, 3, 4}).status, Status::failed) << "of degree 3";
  EXPECT_EQ(solve<double>({1, std::numeric_limits<double>::quiet_NaN(), 3}).status, Status::invalid);
}

TEST(ClosedForm, BernsteinCoefficientsOnAnyInterval) {
  // 2 (x - 3)(x - 4) on [3, 5] is 8 s^2 - 4 s for s = (x - 3)/2: b = 0, 0 - 4/2, 8 - 4.
  const std::vector<double> b{0, -2, 4};
  PolynomialEquation equation;
  equation.c = b;
  equation.basis = Basis::bernstein;
  equation.lo = 3;
  equation.hi = 5;
  Roots roots;
  ClosedForm(Parameters{}).solve(equation, roots);
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_EQ(roots.list[0].x, 3);
  EXPECT_EQ(roots.list[1].x, 4);
}

}  // namespace
}  // namespace graze
