// The cubic formula: the backward error that its header states, and Flocke's cubics.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include <graze/solvers/math/cubic.hpp>
#include <graze/solvers/math/rng.hpp>

#include "complex_root_errors.hpp"

namespace graze {
namespace {

using root_errors::Wide;
using root_errors::WideRoots;

constexpr std::uint64_t kSeed = 20261122;

template <class T>
WideRoots solve(const std::vector<T>& c, int* most_steps = nullptr) {
  const auto formula = [](const auto& scaled, auto& roots, int& steps) {
    return cubic_roots(scaled, roots, steps);
  };
  return root_errors::solve<T, 3>(c, formula, most_steps);
}

/// Flocke's test set by roots, from which the coefficients come. Allowed is what kCubicBackward u in the
/// coefficients does to simple roots, and its square root for the double one.
struct FlockeCubic {
  WideRoots roots;
  bool has_double_root = false;

  [[nodiscard]] double most() const {
    if (has_double_root) return std::sqrt(kCubicBackward * 0x1p-53);
    return kCubicBackward * 0x1p-53 * root_errors::condition(roots);
  }
};

const std::vector<FlockeCubic>& flocke_cubics() {
  static const std::vector<FlockeCubic> cubics{
      {{1, 1e7L, 1e14L}},           {{1, 1.000001L, 1.000002L}},
      {{-1e81L, 1e77L, 1e80L}},     {{1, -1, -1e24L}},
      {{-1, 1e14L, 1e14L}, true},   {{1e5L, {1e5L, 1}, {1e5L, -1}}},
      {{1, {1, 1e7L}, {1, -1e7L}}}, {{1, {1e7L, 1}, {1e7L, -1}}},
      {{-1e14L, {1, 1}, {1, -1}}},
  };
  return cubics;
}

TEST(Cubic, FlockesCubicsAreSolvedAsWellAsTheirRoundedCoefficientsAllow) {
  int number = 0;
  for (const FlockeCubic& cubic : flocke_cubics()) {
    const auto c = root_errors::coefficients_of<double>(cubic.roots);
    const WideRoots roots = solve(c);
    ASSERT_EQ(roots.size(), 3U);
    const double error = root_errors::relative_error(roots, cubic.roots);
    const double backward = root_errors::backward_error(c, roots);
    std::printf("Flocke %d: relative error %.2e, backward %.2f u\n", ++number, error, backward);
    EXPECT_LE(error, cubic.most()) << number;
    EXPECT_LE(backward, kCubicBackward) << number;
  }
}

template <class T>
class CubicIn : public testing::Test {};
using Precisions = testing::Types<double, float>;
TYPED_TEST_SUITE(CubicIn, Precisions);

/// Coefficients uniform; of all magnitudes; from real roots; from one real root and a pair.
template <class T>
std::vector<T> random_cubic(Rng& rng, int kind) {
  const auto uniform = [&] { return static_cast<long double>(rng.uniform(-1, 1)); };
  const auto any = [&](double most) {
    return static_cast<T>(std::pow(10.0, rng.uniform(-most, most)) * (rng.uniform() < 0.5 ? -1 : 1));
  };
  if (kind == 0) return {any(0), any(0), any(0), any(0)};
  if (kind == 1) return {any(4), any(4), any(4), any(4)};
  if (kind == 2) return root_errors::coefficients_of<T>({uniform(), uniform(), uniform()});
  const long double re = uniform(), im = uniform();
  return root_errors::coefficients_of<T>({uniform(), {re, im}, {re, -im}});
}

TYPED_TEST(CubicIn, EveryRootBelongsToANearbyCubic) {
  using T = TypeParam;
  Rng rng(kSeed);
  double worst = 0;
  int most_steps = 0;
  for (int i = 0; i < 40000; ++i) {
    const std::vector<T> c = random_cubic<T>(rng, i % 4);
    const WideRoots roots = solve(c, &most_steps);
    ASSERT_EQ(roots.size(), 3U) << std::hexfloat << c[0] << " " << c[1] << " " << c[2] << " " << c[3];
    worst = std::max(worst, root_errors::backward_error(c, roots));
  }
  std::printf("seed %llu: backward error %.2f u, at most %d evaluations\n",
              static_cast<unsigned long long>(kSeed), worst, most_steps);
  EXPECT_LE(worst, kCubicBackward);
  EXPECT_LE(most_steps, 16) << "the iteration converges as its header says";
}

TYPED_TEST(CubicIn, ATripleRootIsExactWhereItsCoefficientsAre) {
  using T = TypeParam;
  for (const Wide& root : solve<T>({-27, 27, -9, 1})) EXPECT_EQ(root, Wide(3));
}

TYPED_TEST(CubicIn, ASmallRealRootBesideALargePairKeepsItsDigits) {
  using T = TypeParam;
  // 2^-20 (1 + ...) beside +- 2^10 i: the iteration comes from far off.
  const WideRoots roots = solve<T>({-1, static_cast<T>(1 << 20), 0, 1});
  ASSERT_EQ(roots.size(), 3U);
  const long double u = static_cast<long double>(power_basis::kU<T>);
  EXPECT_LE(std::fabs(roots[0].real() * 0x1p20L - 1), 4 * u);
}

TYPED_TEST(CubicIn, CoefficientsThatLeaveTheRangeAreAFailure) {
  using T = TypeParam;
  constexpr T kLeast = std::numeric_limits<T>::min();
  EXPECT_TRUE(solve<T>({1, 1 / kLeast, 1 / kLeast, kLeast}).empty());
}

}  // namespace
}  // namespace graze
