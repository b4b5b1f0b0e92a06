#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <graze/solvers/math/counting.hpp>
#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/interval.hpp>
#include <vector>

namespace graze {
namespace {

template <class T>
T horner(const std::vector<T>& c, const T& x) {
  T y = c.back();
  for (std::size_t i = c.size() - 1; i-- > 0;) y = y * x + c[i];
  return y;
}

template <class T, std::size_t N>
T dot(const std::array<T, N>& a, const std::array<T, N>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < N; ++i) sum += a[i] * b[i];
  return sum;
}

template <class T>
T nearer_root(const T& a, const T& b, const T& c) {
  using std::sqrt;
  const T discriminant = b * b - T(4.0) * a * c;
  if (discriminant < T(0.0)) return T(0.0);
  return (-b - sqrt(discriminant)) / (T(2.0) * a);
}

using Number = Counted<double>;

TEST(Counting, HornerOfDegreeNTakesNProductsAndNSums) {
  for (std::size_t n = 0; n <= 20; ++n) {
    OperationCount count;
    std::vector<Number> counted;
    std::vector<double> plain;
    for (std::size_t i = 0; i <= n; ++i) {
      plain.push_back(1.0 / static_cast<double>(i + 1));
      counted.emplace_back(plain.back(), &count);
    }
    const Number y = horner(counted, Number(0.3, &count));
    EXPECT_EQ(y.value(), horner(plain, 0.3));
    EXPECT_EQ(count, (OperationCount{.additions = n, .multiplications = n}));
    EXPECT_EQ(count.flops(), 2 * n);
  }
}

TEST(Counting, ADotProductOfNTermsTakesNProductsAndOneSumLess) {
  OperationCount count;
  std::array<Number, 5> a, b;
  for (std::size_t i = 0; i < 5; ++i) {
    a[i] = Number(static_cast<double>(i), &count);
    b[i] = Number(2.0, &count);
  }
  EXPECT_EQ(dot(a, b).value(), 20);
  EXPECT_EQ(count, (OperationCount{.additions = 4, .multiplications = 5}));
}

TEST(Counting, AQuadraticFormulaCountsEveryKindOnce) {
  OperationCount count;
  const Number x = nearer_root(Number(1, &count), Number(-3, &count), Number(2, &count));
  EXPECT_EQ(x.value(), nearer_root(1.0, -3.0, 2.0));
  EXPECT_EQ(count,
            (OperationCount{
                .additions = 2, .multiplications = 4, .divisions = 1, .square_roots = 1, .comparisons = 1}));
}

TEST(Counting, ConstantsAmongThemselvesAndSignsAreFree) {
  OperationCount count;
  const Number x(3.0, &count);
  const Number constant = Number(2.0) * Number(0.5) + Number(1);
  EXPECT_EQ(constant.count(), nullptr);
  EXPECT_EQ(abs(-x).value(), 3);
  EXPECT_EQ(count, OperationCount{});
  // One counted operand is enough, on either side, and mixed with a plain double.
  EXPECT_EQ((2.0 * x + constant).value(), 8);
  EXPECT_EQ((constant - x / 2.0).value(), 0.5);
  EXPECT_EQ(count, (OperationCount{.additions = 2, .multiplications = 1, .divisions = 1}));
}

TEST(Counting, ComparisonsAndFusedOperationsAreCounted) {
  OperationCount count;
  const Number x(3.0, &count), y(-4.0, &count);
  EXPECT_TRUE(x > y && !(x == y) && x >= y && x != 0.0);
  EXPECT_EQ(count.comparisons, 4U);
  EXPECT_EQ(std::max(x, y).value(), 3);
  EXPECT_EQ(count.comparisons, 5U);
  EXPECT_EQ(fma(x, y, Number(1.0)).value(), -11);
  EXPECT_EQ(count.fused, 1U);
  EXPECT_EQ(count.flops(), 2U);
}

TEST(Counting, FunctionsAndPowersOfTwoAreCountedBitsAreFree) {
  OperationCount count;
  const Number x(3.0, &count);
  EXPECT_EQ(log2(x).value(), std::log2(3.0));
  EXPECT_EQ(cbrt(x).value(), std::cbrt(3.0));
  EXPECT_EQ(pow(x, Number(2.0)).value(), 9);
  EXPECT_EQ(count, (OperationCount{.functions = 3}));
  EXPECT_EQ(ldexp(x, 4).value(), 48);
  EXPECT_EQ(count, (OperationCount{.multiplications = 1, .functions = 3}));
  EXPECT_TRUE(isfinite(x) && !isnan(x));
  EXPECT_EQ(count.comparisons, 2U);
  // These read or move bits.
  EXPECT_EQ(ilogb(x), 1);
  EXPECT_EQ(copysign(x, Number(-1.0)).value(), -3);
  EXPECT_EQ(nextafter(x, Number(4.0)).value(), std::nextafter(3.0, 4.0));
  EXPECT_EQ(count.flops(), 4U);
  EXPECT_EQ(copysign(x, Number(-1.0)).count(), &count);
}

TEST(Counting, ANumberThatLeavesIsAConstantAndLimitsAreThoseOfItsType) {
  OperationCount count;
  const Number x(3.0, &count);
  const double left = static_cast<double>(x);
  EXPECT_EQ((Number(left) * Number(2.0)).value(), 6);
  EXPECT_EQ(count, OperationCount{});
  EXPECT_EQ(std::numeric_limits<Number>::epsilon().value(), std::numeric_limits<double>::epsilon());
  EXPECT_EQ(std::numeric_limits<Number>::infinity().count(), nullptr);
  static_assert(std::numeric_limits<Number>::digits == std::numeric_limits<double>::digits);
}

TEST(Counting, OtherScalarsCountTheSame) {
  OperationCount single, twofold, ranges, total;
  const std::vector<Counted<float>> f{{1.5F, &single}, {2.5F, &single}, {0.5F, &single}};
  const std::vector<Counted<DoubleDouble>> d{{1.5, &twofold}, {2.5, &twofold}, {0.5, &twofold}};
  const std::vector<Counted<Interval>> r{
      {Interval(1.5), &ranges}, {Interval(2.5), &ranges}, {Interval(0.5), &ranges}};
  EXPECT_EQ(horner(f, Counted<float>(2.0)).value(), 8.5F);
  EXPECT_EQ(horner(d, Counted<DoubleDouble>(2.0)).value(), DoubleDouble(8.5));
  EXPECT_EQ(horner(r, Counted<Interval>(2.0)).value(), Interval(8.5));
  const OperationCount truth{.additions = 2, .multiplications = 2};
  for (const OperationCount& count : {single, twofold, ranges}) {
    EXPECT_EQ(count, truth);
    total += count;
  }
  EXPECT_EQ(total.flops(), 12U);
}

}  // namespace
}  // namespace graze
