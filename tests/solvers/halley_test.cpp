// Halley from outside and from equidistant starts: order, suppression, safeguards, and what it may miss.
#include <gtest/gtest.h>

#include <cmath>

#include <graze/solvers/from_starts.hpp>
#include <graze/solvers/halley.hpp>
#include <graze/solvers/newton.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Halley halley(double starts = 32) {
  Parameters options;
  options.set("starts", starts);
  return Halley(options);
}

Roots solve(const std::vector<double>& c, double lo = -kInfinity, double hi = kInfinity) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  halley().solve(equation, roots);
  return roots;
}

/// The steps from 1.2 to the root of x^3 = 2, and whether each error is a fixed multiple of the last one's
/// cube.
TEST(Halley, ConvergesWithThirdOrderOnACubeRoot) {
  const double root = std::cbrt(2.0);
  double x = 1.2, error = std::fabs(x - root);
  for (int step = 0; step < 2; ++step) {
    const from_starts::Local<double> local{.ratio = (x * x * x - 2) / (3 * x * x), .curvature = 2 / x};
    x += from_starts::halley_step(local);
    const double next = std::fabs(x - root);
    // For x^n = a the constant is (n^2 - 1) / (12 a^(2/n)).
    EXPECT_NEAR(next / (error * error * error), 8 / (12 * root * root), 0.05);
    error = next;
  }
  EXPECT_LT(error, 1e-4);
}

TEST(Halley, NeedsFewerStepsThanNewton) {
  const std::vector<double> c{-5040, 13068, -13132, 6769, -1960, 322, -28, 1};
  Roots newton_roots;
  PolynomialEquation equation;
  equation.c = c;
  Newton(Parameters{}).solve(equation, newton_roots);
  const Roots roots = solve(c);
  std::printf("1 ... 7: %u steps, Newton %u\n", roots.counters.iterations, newton_roots.counters.iterations);
  EXPECT_LT(roots.counters.iterations, newton_roots.counters.iterations);
}

TEST(Halley, OptionsAreChecked) { EXPECT_THROW(halley(0), std::invalid_argument); }

}  // namespace
}  // namespace graze
