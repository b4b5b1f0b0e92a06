// Values with error bounds, start values and discs of the methods that find all complex roots.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

#include <graze/solvers/math/complex_roots.hpp>
#include <graze/solvers/math/rng.hpp>

namespace graze::complex_roots {
namespace {

// 100 digits: exact enough for what double rounds away.
using Wide = boost::multiprecision::cpp_bin_float_100;

struct WideComplex {
  Wide real, imag;
};
WideComplex operator*(const WideComplex& a, const WideComplex& b) {
  return {a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real};
}

/// p or, reversed, its reversed polynomial.
WideComplex wide_value(const std::vector<double>& c, const WideComplex& z, bool reversed) {
  WideComplex p{0, 0};
  for (std::size_t i = c.size(); i-- > 0;) {
    p = p * z;
    p.real += Wide(c[reversed ? c.size() - 1 - i : i]);
  }
  return p;
}

WideComplex widened(Complex<double> z) { return {Wide(z.real()), Wide(z.imag())}; }

double distance(const WideComplex& a, const WideComplex& b) {
  const Wide x = a.real - b.real, y = a.imag - b.imag;
  return static_cast<double>(sqrt(x * x + y * y));
}

TEST(ScaledEvaluation, TheRunningBoundHoldsAndIsNoLargerThanItNeedsToBe) {
  Rng rng(20261122);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    std::vector<double> c;
    const int n = 1 + static_cast<int>(rng.uniform() * 20);
    for (int k = 0; k <= n; ++k) c.push_back(rng.uniform(-1, 1));
    const double size = std::exp2(rng.uniform(-2, 2)), angle = rng.uniform(0, 6.3);
    const Complex<double> z{size * std::cos(angle), size * std::sin(angle)};
    const ScaledValue<double> p = evaluate_scaled<false, double>(c, z);
    EXPECT_EQ(p.reversed, magnitude(z) > 1);
    // The reversed value is meant for the rounded 1/z.
    const WideComplex at = widened(p.reversed ? quotient(Complex<double>{1, 0}, z) : z);
    const double error = distance(wide_value(c, at, p.reversed), widened(p.value));
    EXPECT_LE(error, p.error) << i;
    worst = std::max(worst, error / p.error);
  }
  std::printf("worst error %.2f of the bound\n", worst);
  EXPECT_GT(worst, 0.1);
}

TEST(ScaledEvaluation, DerivativesInsideAndOutsideTheUnitCircleAreThoseOfOnePolynomial) {
  const std::vector<double> c{1, -2, 0.5, 3, -1};
  for (const double x : {0.5, -0.75, 1.5, -3.0}) {
    const auto p = evaluate_scaled<true, double>(c, Complex<double>{x, 0});
    const double scale = p.reversed ? std::pow(x, 4) : 1;
    EXPECT_NEAR(p.value.real() * scale, 1 + x * (-2 + x * (0.5 + x * (3 - x))), 1e-12);
    EXPECT_NEAR(p.derivative.real() * scale, -2 + x * (1 + x * (9 - 4 * x)), 1e-12);
    EXPECT_NEAR(p.second.real() * scale, 1 + x * (18 - 12 * x), 1e-12);
  }
}

TEST(StartValues, TheNewtonPolygonGivesEveryMagnitudeItsShare) {
  // 2^-20 once, about 1 twice, 2^30 once.
  const std::vector<double> c{0x1p-20, 1, 0x1p-1, 1, 0x1p-30};
  std::vector<Complex<double>> z(4);
  newton_polygon_points<double>(c, z);
  EXPECT_NEAR(std::log2(magnitude(z[0])), -20, 1e-12);
  EXPECT_NEAR(std::log2(magnitude(z[1])), 0, 1e-12);
  EXPECT_NEAR(std::log2(magnitude(z[2])), 0, 1e-12);
  EXPECT_NEAR(std::log2(magnitude(z[3])), 30, 1e-12);
  for (const Complex<double> point : z) EXPECT_NE(point.imag(), 0);
  EXPECT_GT(magnitude(z[1] - z[2]), 1);
}

TEST(LongProducts, DoNotOverflowOnTheWay) {
  LongProduct<double> product(Complex<double>{1, 0});
  for (int i = 0; i < 20; ++i) product.multiply({0, 1e200});
  for (int i = 0; i < 20; ++i) product.divide({1e200, 0});
  EXPECT_NEAR(product.value().real(), 1, 1e-14);  // i^20
  EXPECT_EQ(product.value().imag(), 0);
}

TEST(Discs, HoldTheRootsOfPerturbedApproximations) {
  // (x - 1)(x - 2)(x - 4), exact
  const std::vector<double> c{-8, 14, -7, 1};
  const power_basis::Problem<double> problem{c, {}, -10, 10};
  Rng rng(7);
  for (int i = 0; i < 1000; ++i) {
    const double size = std::exp2(rng.uniform(-50, -2));
    std::vector<Complex<double>> z;
    for (const double root : {1.0, 2.0, 4.0}) {
      z.push_back({root + size * rng.uniform(-1, 1), size * rng.uniform(-1, 1)});
    }
    double root = 1;
    for (std::size_t k = 0; k < 3; ++k, root *= 2) {
      const double radius = inclusion_radius<double>(problem, z, k);
      EXPECT_LE(magnitude(z[k] - root), radius) << i;
      // n times the Weierstrass correction, which is about the error; and the rounding of p.
      EXPECT_LE(radius, 16 * size + 1e-13) << i;
    }
  }
}

TEST(Discs, ClustersAreThoseThatOverlapOrMeetTheirMirrorImages) {
  const std::vector<Complex<double>> z{{0, 0.5}, {0.9, -0.5}, {5, 1}, {5, -1}, {9, 0}};
  const std::vector<double> radius{0.6, 0.6, 0.5, 0.5, 0.1};
  std::vector<int> label(z.size());
  label_clusters<double>(z, radius, label);
  EXPECT_EQ(label[0], label[1]) << "apart, but the one overlaps the other's mirror image on the axis";
  EXPECT_NE(label[2], label[3]) << "a pair off the axis is no cluster";
  EXPECT_NE(label[3], label[4]);
}

TEST(SolveScaled, PutsRootsBackInTheUnknownsUnits) {
  const std::vector<double> c{-0x1p+100, 0x1p-100};  // x = 2^200
  PolynomialEquation equation;
  equation.c = c;
  Roots roots;
  solve_scaled(equation, roots, [](const Problem<double>& problem, Roots& found) {
    EXPECT_EQ(std::fabs(problem.c[0]), 1);
    EXPECT_EQ(problem.c[1], 1);
    add_real(problem, -problem.c[0] / problem.c[1], 0x1p-50, 1, found);
  });
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_EQ(roots.list[0].x, 0x1p+200);
  EXPECT_EQ(roots.list[0].radius, 0x1p+150);
}

}  // namespace
}  // namespace graze::complex_roots
