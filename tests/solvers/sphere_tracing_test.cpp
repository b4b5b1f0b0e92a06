// Sphere tracing: the interval form never passes a root, the scalar form may; steps, tolerance, relaxation.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/sphere_tracing.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze {
namespace {

/// A polynomial by interval Horner, and at points.
struct Horner {
  std::vector<double> c;
  static const std::vector<double>& of(const void* self) { return static_cast<const Horner*>(self)->c; }
  static Interval value(const void* self, Interval x) { return evaluate(of(self), {}, x); }
  static Interval derivative(const void* self, Interval x) { return evaluate_derivative(of(self), {}, x); }
  static Jet jet(const void* self, double x) {
    Jet jet;
    for (std::size_t i = of(self).size(); i-- > 0;) {
      jet.ddf = jet.ddf * x + 2 * jet.df;
      jet.df = jet.df * x + jet.f;
      jet.f = jet.f * x + of(self)[i];
    }
    jet.f_error = evaluate(of(self), x).error;
    return jet;
  }
  [[nodiscard]] IntervalEquation on(double lo, double hi) const {
    return {this, &value, &derivative, lo, hi, {}};
  }
  [[nodiscard]] ScalarEquation at_points(double lo, double hi, int max_roots = 0) const {
    return {this, &jet, lo, hi, max_roots, 0};
  }
};

SphereTracing tracer(double tolerance = 0x1p-44, double relaxation = 1.2, double budget = 20000) {
  Parameters options;
  options.set("tolerance", tolerance);
  options.set("relaxation", relaxation);
  options.set("budget", budget);
  return SphereTracing(options);
}

template <class Equation>
Roots solve(const SphereTracing& solver, const Equation& equation) {
  Roots roots;
  solver.solve(equation, roots);
  return roots;
}

Horner seven_roots() { return {{-5040, 13068, -13132, 6769, -1960, 322, -28, 1}}; }

TEST(SphereTracing, TheIntervalFormProvesTheRootsAndNoOther) {
  const Horner seven = seven_roots();
  const Roots roots = solve(tracer(), seven.on(0.5, 6.5));
  EXPECT_EQ(roots.status, Status::ok);
  ASSERT_EQ(roots.list.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_TRUE(roots.list[i].certified);
    EXPECT_LE(std::fabs(roots.list[i].x - static_cast<double>(i + 1)), roots.list[i].radius);
  }
  std::printf("interval: %u evaluations, %u steps\n", roots.counters.evaluations, roots.counters.iterations);
}

TEST(SphereTracing, TheScalarFormFindsThemAtLessCost) {
  const Horner seven = seven_roots();
  const Roots proved = solve(tracer(), seven.on(0.5, 6.5));
  const Roots roots = solve(tracer(), seven.at_points(0.5, 6.5));
  EXPECT_EQ(roots.status, Status::ok);
  ASSERT_EQ(roots.list.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(roots.list[i].x, static_cast<double>(i + 1), 1e-11);
  EXPECT_LT(roots.counters.evaluations, proved.counters.evaluations);
  std::printf("scalar: %u evaluations, %u steps\n", roots.counters.evaluations, roots.counters.iterations);
}

// Hart's case: for a distance function, slope 1, one step reaches the surface.
TEST(SphereTracing, OneStepReachesTheRootOfADistanceFunction) {
  const Horner line{{-3, 1}};
  const Roots roots = solve(tracer(), line.on(0, 10));
  EXPECT_EQ(roots.status, Status::ok);
  ASSERT_EQ(roots.list.size(), 1U);
  EXPECT_LE(std::fabs(roots.list[0].x - 3), roots.list[0].radius);
  EXPECT_LE(roots.counters.iterations, 6U);
}

/// 1 - 2 exp(-(1000 (x - 0.37))^2): two roots 0.0017 apart that f' and f'' of x < 0.36 show nothing of.
Interval narrow_value(const void* /*self*/, Interval x) {
  const Interval t = sqr((x - point(0.37)) * 1000.0);
  return point(1) - 2.0 * Interval{next_below(std::exp(-t.hi)), next_above(std::exp(-t.lo))};
}
Interval narrow_slope(const void* /*self*/, Interval x) {
  const Interval s = x - point(0.37), t = sqr(s * 1000.0);
  return 4e6 * s * Interval{std::max(0.0, next_below(std::exp(-t.hi))), next_above(std::exp(-t.lo))};
}
Jet narrow_jet(const void* /*self*/, double x) {
  const double s = x - 0.37, bell = std::exp(-1e6 * s * s);
  return {1 - 2 * bell, 4e6 * s * bell, 4e6 * bell * (1 - 2e6 * s * s), 0x1p-51};
}

TEST(SphereTracing, TheIntervalFormNeverPassesADipThatTheScalarFormPasses) {
  const Roots proved = solve(tracer(), IntervalEquation{nullptr, &narrow_value, &narrow_slope, 0, 1, {}});
  EXPECT_EQ(proved.status, Status::ok);
  EXPECT_EQ(proved.list.size(), 2U);
  const Roots passed = solve(tracer(), ScalarEquation{nullptr, &narrow_jet, 0, 1, 0, 0});
  EXPECT_EQ(passed.status, Status::ok);
  EXPECT_TRUE(passed.list.empty()) << "a miss that the page names";
}

TEST(SphereTracing, ATouchingRootIsUncertainByIntervalsAndANearMissIsDecided) {
  const Horner touch{{1, -2, 1}}, miss{{1 + 0x1p-30, -2, 1}};
  EXPECT_EQ(solve(tracer(), touch.on(-1, 4)).status, Status::uncertain);
  EXPECT_EQ(solve(tracer(), miss.on(-1, 4)).status, Status::ok);
  EXPECT_TRUE(solve(tracer(), miss.on(-1, 4)).list.empty());
}

// Keinert's claim: longer steps that are taken back where they were too long need fewer evaluations. The ray
// passes near the surface without meeting it for long.
TEST(SphereTracing, OverRelaxationSavesEvaluationsAlongAGrazingRay) {
  const Horner shallow{{1 + 0x1p-12, -2, 1}};
  const Roots plain = solve(tracer(0x1p-44, 1), shallow.at_points(-100, 100));
  const Roots relaxed = solve(tracer(0x1p-44, 1.4), shallow.at_points(-100, 100));
  std::printf("evaluations: %u, relaxed %u\n", plain.counters.evaluations, relaxed.counters.evaluations);
  EXPECT_LT(relaxed.counters.evaluations, plain.counters.evaluations);
  EXPECT_TRUE(plain.list.empty());
  EXPECT_TRUE(relaxed.list.empty());
}

TEST(SphereTracing, TheToleranceBoundsTheRadius) {
  const Horner square{{-2, 0, 1}};
  for (const double tolerance : {0x1p-10, 0x1p-20, 0x1p-40}) {
    const Roots roots = solve(tracer(tolerance), square.on(0, 2));
    ASSERT_EQ(roots.list.size(), 1U);
    EXPECT_LE(roots.list[0].radius, tolerance * 2);
    EXPECT_LE(std::fabs(roots.list[0].x - std::sqrt(2.0)), roots.list[0].radius);
    const Roots points = solve(tracer(tolerance), square.at_points(0, 2));
    ASSERT_EQ(points.list.size(), 1U);
    EXPECT_NEAR(points.list[0].x, std::sqrt(2.0), 2 * tolerance);
  }
}

TEST(SphereTracing, TheFirstRootAloneCostsLess) {
  const Horner seven = seven_roots();
  const Roots all = solve(tracer(), seven.at_points(0.5, 6.5)),
              first = solve(tracer(), seven.at_points(0.5, 6.5, 1));
  ASSERT_EQ(first.list.size(), 1U);
  EXPECT_EQ(first.list[0].x, all.list[0].x);
  EXPECT_LT(2 * first.counters.evaluations, all.counters.evaluations);
}

TEST(SphereTracing, ABudgetTooSmallIsUncertain) {
  const Horner seven = seven_roots();
  EXPECT_EQ(solve(tracer(0x1p-44, 1.2, 10), seven.on(0.5, 6.5)).status, Status::uncertain);
}

TEST(SphereTracing, ScalingByPowersOfTwoScalesTheAnswerExactly) {
  const Horner plain{{3, -7, 1, 1.5}};
  const Roots proved = solve(tracer(), plain.on(-4, 4)), found = solve(tracer(), plain.at_points(-4, 4));
  ASSERT_EQ(proved.list.size(), 3U);
  ASSERT_EQ(found.list.size(), 3U);
  for (const int k : {-40, -3, 5, 60}) {
    Horner scaled = plain;
    for (std::size_t i = 0; i < 4; ++i) scaled.c[i] = std::ldexp(plain.c[i], 17 - k * static_cast<int>(i));
    const double reach = std::ldexp(4, k);
    const Roots proved_k = solve(tracer(), scaled.on(-reach, reach));
    const Roots found_k = solve(tracer(), scaled.at_points(-reach, reach));
    ASSERT_EQ(proved_k.list.size(), 3U) << k;
    ASSERT_EQ(found_k.list.size(), 3U) << k;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(proved_k.list[i].x, std::ldexp(proved.list[i].x, k)) << k;
      EXPECT_EQ(found_k.list[i].x, std::ldexp(found.list[i].x, k)) << k;
    }
  }
}

// By intervals: never wrong. Those that stay uncertain are named.
TEST(SphereTracing, HardPublishedPolynomialsAreRightOrUncertain) {
  std::size_t solved = 0;
  for (const HardPolynomial& hard : hard_polynomials()) {
    const double reach = 2 * root_bound(hard.c);
    const Roots roots = solve(tracer(0x1p-44, 1.2, 200000), Horner{hard.c}.on(-reach, reach));
    for (const Root& root : roots.list) {
      const auto inside = [&](double x) { return std::fabs(x - root.x) <= root.radius + ulp(x); };
      EXPECT_EQ(std::count_if(hard.roots.begin(), hard.roots.end(), inside), 1) << hard.origin;
    }
    // Uncertain: f is rounding over more than the grazing epsilon, or 2^-24 of the interval holds several
    // roots.
    if (roots.status == Status::ok) {
      ++solved;
      EXPECT_EQ(roots.list.size(), hard.roots.size()) << hard.origin;
    } else {
      std::printf("%s: %s with %zu of %zu\n", hard.origin.c_str(),
                  std::string(to_string(roots.status)).c_str(), roots.list.size(), hard.roots.size());
    }
  }
  EXPECT_GE(solved, 45U);  // of 84
}

TEST(SphereTracing, OptionsAreChecked) {
  EXPECT_THROW(tracer(-1), std::invalid_argument);
  EXPECT_THROW(tracer(0x1p-44, 2), std::invalid_argument);
  EXPECT_THROW(tracer(0x1p-44, 1.2, 1), std::invalid_argument);
}

}  // namespace
}  // namespace graze
