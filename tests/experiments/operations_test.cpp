// Counted solvers give the plain ones' answers bit for bit, and counts that a hand can check.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <graze/experiments/counted_kernel.hpp>
#include <graze/experiments/counted_solver.hpp>
#include <graze/solvers/math/cubic.hpp>
#include <graze/solvers/math/quartic.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/registry.hpp>
#include <surfaces/cells.hpp>

#include "cases.hpp"
#include "operations.hpp"

namespace graze {
namespace {

using counted::Number;
constexpr std::uint64_t kSeed = 20261122;

struct Answer {
  Roots roots;
  OperationCount count;
};

template <class Equation>
Answer solve_counted(std::string_view name, const Equation& equation) {
  Answer answer;
  make_counted_solver(name, {})->solve(equation, answer.roots, answer.count);
  return answer;
}

template <class Equation>
Roots plain(std::string_view name, const Equation& equation) {
  Roots roots;
  find_solver(name).make({})->solve(std::span(&equation, 1), std::span(&roots, 1));
  return roots;
}

void expect_same(const Roots& is, const Roots& wanted, const std::string& where) {
  EXPECT_EQ(is.status, wanted.status) << where;
  EXPECT_EQ(is.counters.evaluations, wanted.counters.evaluations) << where;
  EXPECT_EQ(is.counters.iterations, wanted.counters.iterations) << where;
  EXPECT_EQ(is.counters.starts, wanted.counters.starts) << where;
  EXPECT_EQ(is.counters.tier, wanted.counters.tier) << where;
  ASSERT_EQ(is.list.size(), wanted.list.size()) << where;
  for (std::size_t i = 0; i < is.list.size(); ++i) {
    EXPECT_EQ(is.list[i].x, wanted.list[i].x) << where;
    EXPECT_EQ(is.list[i].others, wanted.list[i].others) << where;
    EXPECT_EQ(is.list[i].multiplicity, wanted.list[i].multiplicity) << where;
    EXPECT_EQ(is.list[i].certified, wanted.list[i].certified) << where;
    EXPECT_EQ(is.list[i].placed, wanted.list[i].placed) << where;
    EXPECT_EQ(is.list[i].tail, wanted.list[i].tail) << where;
    EXPECT_EQ(is.list[i].side, wanted.list[i].side) << where;
    // A radius may be no number, on both sides.
    const bool is_same = is.list[i].radius == wanted.list[i].radius ||
                         (std::isnan(is.list[i].radius) && std::isnan(wanted.list[i].radius));
    EXPECT_TRUE(is_same) << where;
  }
}

/// Coefficients whose sizes differ by up to 2^8, now and then with a double root or bounds on their errors.
struct RandomPolynomial {
  std::vector<double> c, c_error;
  PolynomialEquation equation;

  RandomPolynomial(Rng& rng, int degree) : c(static_cast<std::size_t>(degree) + 1) {
    for (double& v : c) v = std::ldexp(rng.uniform(-1, 1), static_cast<int>(rng.next() % 9) - 4);
    if (degree >= 2 && rng.next() % 4 == 0) square_a_factor(rng.uniform(-1, 1));
    if (rng.next() % 2 == 0) {
      for (const double v : c) c_error.push_back(std::fabs(v) * 0x1p-52);
    }
    equation.c = c;
    equation.c_error = c_error;
    equation.lo = -2;
    equation.hi = 2;
  }

 private:
  /// (x - r)^2 times what its own lower coefficients are.
  void square_a_factor(double r) {
    const std::vector<double> rest(c.begin(), c.end() - 2);
    std::fill(c.begin(), c.end(), 0.0);
    const std::array<double, 3> square{r * r, -2 * r, 1};
    for (std::size_t i = 0; i < rest.size(); ++i) {
      for (std::size_t k = 0; k < square.size(); ++k) c[i + k] += rest[i] * square[k];
    }
  }
};

TEST(CountedSolvers, AnswerRandomPolynomialsAsThePlainOnesBitForBit) {
  constexpr int kCases = 300;
  int solvers = 0;
  for (const CountedSolverEntry& entry : counted_solver_registry()) {
    if (!entry.make({})->takes(Form::polynomial)) continue;
    ++solvers;
    Rng rng(kSeed);
    for (int i = 0; i < kCases; ++i) {
      const int degree = 1 + static_cast<int>(rng.next() % (entry.name == "closed_form" ? 4 : 9));
      const RandomPolynomial random(rng, degree);
      const Answer answer = solve_counted(entry.name, random.equation);
      expect_same(answer.roots, plain(entry.name, random.equation),
                  std::string(entry.name) + ", case " + std::to_string(i));
      EXPECT_GT(answer.count.flops(), 0U) << entry.name;
      EXPECT_EQ(answer.count, solve_counted(entry.name, random.equation).count) << entry.name;
    }
  }
  EXPECT_GE(solvers, 1);
}

/// x^2 - a for a = 2 in form scalar.
Jet parabola(const void* /*self*/, double x) { return {x * x - 2, 2 * x, 2, 0x1p-52 * (x * x + 2)}; }

TEST(CountedSolvers, AnswerAScalarEquationBitForBitAndCallItAsOften) {
  const ScalarEquation equation{nullptr, parabola, -2, 3, 2, 7};
  for (const CountedSolverEntry& entry : counted_solver_registry()) {
    if (!entry.make({})->takes(Form::scalar)) continue;
    const Answer answer = solve_counted(entry.name, equation);
    expect_same(answer.roots, plain(entry.name, equation), std::string(entry.name));
    EXPECT_EQ(answer.roots.list.size(), 2U) << entry.name;
    EXPECT_GT(answer.count.flops(), answer.roots.counters.evaluations) << entry.name;
  }
}

/// x^2 + y^2 = 2, x = y.
SystemEquation circle_and_diagonal() {
  SystemEquation equation;
  equation.unknowns = 2;
  equation.eval = [](const void* /*self*/, const Vector& x, Vector& f, Matrix& jacobian) {
    f = {x[0] * x[0] + x[1] * x[1] - 2, x[0] - x[1], 0};
    jacobian = {{{2 * x[0], 2 * x[1], 0}, {1, -1, 0}, {0, 0, 0}}};
  };
  equation.start = [](const void* /*self*/, Rng& rng, Vector& x) {
    x = {rng.uniform(-2, 2), rng.uniform(-2, 2), 0};
    return true;
  };
  equation.lo = {-2, -2, 0};
  equation.hi = {2, 2, 0};
  equation.residual_scale = 2;
  equation.max_roots = 2;
  equation.seed = 3;
  return equation;
}

TEST(CountedSolvers, AnswerASystemBitForBit) {
  const SystemEquation equation = circle_and_diagonal();
  for (const CountedSolverEntry& entry : counted_solver_registry()) {
    if (!entry.make({})->takes(Form::system)) continue;
    const Answer answer = solve_counted(entry.name, equation);
    expect_same(answer.roots, plain(entry.name, equation), std::string(entry.name));
    EXPECT_EQ(answer.roots.list.size(), 2U) << entry.name;
    EXPECT_GT(answer.count.divisions, 0U) << entry.name;
  }
}

/// x^2 = 2 by inclusions, whose own operations no solver is charged for.
IntervalEquation parabola_in_intervals() {
  IntervalEquation equation;
  equation.value = [](const void* /*self*/, Interval x) { return x * x - Interval(2, 2); };
  equation.derivative = [](const void* /*self*/, Interval x) { return Interval(2, 2) * x; };
  equation.lo = -2;
  equation.hi = 3;
  return equation;
}

TEST(CountedSolvers, AnswerInclusionsBitForBit) {
  const IntervalEquation equation = parabola_in_intervals();
  for (const CountedSolverEntry& entry : counted_solver_registry()) {
    if (!entry.make({})->takes(Form::interval)) continue;
    const Answer answer = solve_counted(entry.name, equation);
    expect_same(answer.roots, plain(entry.name, equation), std::string(entry.name));
    EXPECT_EQ(answer.roots.list.size(), 2U) << entry.name;
    EXPECT_GT(answer.count.flops(), answer.roots.counters.evaluations) << entry.name;
  }
}

TEST(CountedSolvers, RefuseAFormTheyDoNotTake) {
  if (make_counted_solver("aberth", {}) == nullptr) GTEST_SKIP() << "not in this build";
  Answer answer;
  const auto solver = make_counted_solver("aberth", {});
  EXPECT_FALSE(solver->takes(Form::scalar));
  EXPECT_FALSE(solver->takes(Form::interval));
  EXPECT_THROW(solver->solve(ScalarEquation{}, answer.roots, answer.count), std::logic_error);
  EXPECT_EQ(make_counted_solver("no_such_solver", {}), nullptr);
}

OperationCount arithmetic(OperationCount count) {
  count.comparisons = 0;
  return count;
}

PolynomialEquation power(std::span<const double> c) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = -100;
  equation.hi = 100;
  return equation;
}

TEST(CountedSolvers, ALinearEquationInClosedFormTakesADivision) {
  const std::array<double, 2> c{3, 2};
  const Answer answer = solve_counted("closed_form", power(c));
  ASSERT_EQ(answer.roots.list.size(), 1U);
  // -c0 / c1; the radius: 4 eps |x|, and what the coefficients' errors add, which is none.
  EXPECT_EQ(arithmetic(answer.count), (OperationCount{.additions = 1, .multiplications = 1, .divisions = 1}));
}

TEST(CountedSolvers, ALinearEquationCertifiedTakesFifteenOperations) {
  if (make_counted_solver("certified", {}) == nullptr) GTEST_SKIP() << "not in this build";
  const std::array<double, 2> c{3, 2};
  const Answer answer = solve_counted("certified", power(c));
  ASSERT_EQ(answer.roots.list.size(), 1U);
  // Whether c1 is sure: a product. -c0 / c1. Its radius: a product and a sum for each coefficient's error,
  // the slope's term in 2 products and a sum, 4 eps |x| and what the errors add. Inside or outside: 4 sums.
  EXPECT_EQ(arithmetic(answer.count), (OperationCount{.additions = 8, .multiplications = 6, .divisions = 1}));
}

TEST(CountedSolvers, AQuadraticInClosedFormTakesTwentyOperations) {
  const std::array<double, 3> c{2, -3, 1};
  const Answer answer = solve_counted("closed_form", power(c));
  ASSERT_EQ(answer.roots.list.size(), 2U);
  // Half of c1: a division. Scaling: 3 powers of two on, 2 off. Discriminant: a product, 2 fma, a sum. Roots:
  // a square root, a sum, 2 quotients. Radii: a product and a sum each.
  EXPECT_EQ(
      arithmetic(answer.count),
      (OperationCount{.additions = 4, .multiplications = 8, .divisions = 3, .square_roots = 1, .fused = 2}));
  EXPECT_EQ(answer.count.flops(), 20U);
}

/// Means over random coefficients in (-1, 1).
struct Mean {
  double operations, divisions, square_roots;
};

constexpr int kCases = 10'000;

template <class Count>
Mean mean_over_random(int degree, int cases, const Count& count) {
  Rng rng(kSeed);
  OperationCount total;
  std::vector<double> c(static_cast<std::size_t>(degree) + 1);
  for (int i = 0; i < cases; ++i) {
    for (double& v : c) v = rng.uniform(-1, 1);
    total += count(c);
  }
  const auto mean = [&](std::uint64_t sum) { return static_cast<double>(sum) / cases; };
  return {mean(total.flops()), mean(total.divisions), mean(total.square_roots)};
}

/// What a page or header states, to the digits it has: 1 % for the library's cube root, which steers steps.
void expect_stated(const char* what, const Mean& is, double operations) {
  std::printf("%s: %.1f operations, of them %.1f divisions and %.1f square roots\n", what, is.operations,
              is.divisions, is.square_roots);
  EXPECT_NEAR(is.operations, operations, 0.01 * operations) << what;
}

TEST(CountedSolvers, ClosedFormTakesWhatItsPageStates) {
  const std::array<double, 3> stated{16.3, 196, 574};
  for (const int degree : {2, 3, 4}) {
    const Mean mean = mean_over_random(degree, kCases, [](const std::vector<double>& c) {
      PolynomialEquation equation;
      equation.c = c;
      return solve_counted("closed_form", equation).count;
    });
    expect_stated("closed_form", mean, stated[static_cast<std::size_t>(degree - 2)]);
  }
}

/// A formula's operations alone, without the scaling and the decision what is real.
template <std::size_t kSize, class Formula>
Mean mean_of_formula(const Formula& formula) {
  return mean_over_random(kSize - 1, kCases, [&](const std::vector<double>& c) {
    OperationCount count;
    std::array<Number, kSize> numbers;
    for (std::size_t i = 0; i < kSize; ++i) numbers[i] = {c[i], &count};
    std::array<ComplexRoot<Number>, kSize - 1> roots;
    int steps = 0;
    formula(numbers, roots, steps);
    return count;
  });
}

TEST(CountedSolvers, TheFormulasThemselvesTakeWhatTheirHeadersState) {
  const auto cubic = [](const auto& c, auto& roots, int& steps) { cubic_roots(c, roots, steps); };
  const auto quartic = [](const auto& c, auto& roots, int& steps) { quartic_roots(c, roots, steps); };
  expect_stated("cubic_roots", mean_of_formula<4>(cubic), 121);
  expect_stated("quartic_roots", mean_of_formula<5>(quartic), 453);
}

/// Yuksel's comparison without a clock (Proc. ACM Comput. Graph. Interact. Tech. 5(3), 2022, "Performance"):
/// his method takes less than the closed form of the cubic, and less than Jenkins and Traub's up to degree
/// 20, at an error of 6e-7 as at full accuracy.
TEST(CountedSolvers, YukselsMethodTakesLessThanJenkinsAndTraubsUpToDegree20) {
  Parameters paper;
  paper.set("tolerance", 6e-7);
  const auto yuksel = make_counted_solver("monotone", {}),
             to_tolerance = make_counted_solver("monotone", paper),
             jenkins_traub = make_counted_solver("jenkins_traub", {});
  if (yuksel == nullptr || jenkins_traub == nullptr) GTEST_SKIP() << "not in this build";
  const auto operations = [](const CountedSolver& solver, int degree) {
    return mean_over_random(degree, 1000,
                            [&](const std::vector<double>& c) {
                              PolynomialEquation equation;
                              equation.c = c;
                              equation.lo = -1;
                              equation.hi = 1;
                              Answer answer;
                              solver.solve(equation, answer.roots, answer.count);
                              return answer.count;
                            })
        .operations;
  };
  const auto closed_form = make_counted_solver("closed_form", {});
  if (closed_form != nullptr) {
    EXPECT_LT(operations(*yuksel, 3), operations(*closed_form, 3));
  }
  for (const int degree : {3, 5, 10, 20}) {
    const double full = operations(*yuksel, degree), paper_s = operations(*to_tolerance, degree),
                 other = operations(*jenkins_traub, degree);
    std::printf("degree %d: monotone %.0f, to 6e-7 %.0f, jenkins_traub %.0f operations\n", degree, full,
                paper_s, other);
    EXPECT_LT(full, other) << degree;
    EXPECT_LE(paper_s, full) << degree;
  }
}

// ---------------------------------------------------------------------------------------------------- cells

SurfaceSpec surface(std::string_view text) { return parse_surface(text); }

std::vector<Ray> rays_at(const SurfaceSpec& spec, std::size_t count) {
  const auto made = find_surface(spec.type).make(spec);
  Rng rng(kSeed);
  std::vector<Ray> rays;
  const double away = 4 * made->size();
  while (rays.size() < count) {
    const Vec3 origin{rng.uniform(-away, away), rng.uniform(-away, away), rng.uniform(-away, away)};
    const Vec3 target = made->sample(rng.uniform(0, 1), rng.uniform(0, 1)).point;
    rays.push_back({origin, target - origin});
  }
  return rays;
}

std::optional<OperationTotals> cell(std::string_view surface_text, std::string_view solver,
                                    std::string_view formulation = {}) {
  const SurfaceSpec spec = surface(surface_text);
  return count_operations(spec, formulation, parse_solver(solver), rays_at(spec, 100), Query::first);
}

TEST(CountedCells, PolynomialsAreCountedWholeAndFunctionsApart) {
  const auto companion = cell("torus:R=1,r=0.25", "companion");
  ASSERT_TRUE(companion.has_value());
  EXPECT_EQ(companion->rays, 100U);
  EXPECT_EQ(companion->evaluations, 0U);
  EXPECT_GT(companion->per_ray(companion->count.flops()), 100);
  const auto newton = cell("torus:R=1,r=0.25", "newton_slices");
  ASSERT_TRUE(newton.has_value());
  EXPECT_GT(newton->evaluations, 0U);
}

TEST(CountedCells, CountsAreDeterministicAndAddUpOverRays) {
  const SurfaceSpec spec = surface("torus:R=1,r=0.25");
  const std::vector<Ray> rays = rays_at(spec, 100);
  const SolverSpec solver = parse_solver("laguerre");
  const auto count = [&](std::size_t from, std::size_t to) {
    return count_operations(spec, "", solver, std::span(rays).subspan(from, to - from), Query::all)->count;
  };
  OperationCount sum = count(0, 37);
  sum += count(37, 100);
  EXPECT_EQ(sum, count(0, 100));
}

TEST(CountedCells, LaddersAreCountedInEveryBasisAndByInclusions) {
  const std::string torus = "torus:R=1,r=0.25", teardrop = "teardrop:s=1";
  struct Cell {
    std::string surface, solver, formulation;
    bool calls_f;
  };
  for (const auto& [text, solver, formulation, calls_f] :
       {Cell{torus, "certified", "quartic", false}, Cell{torus, "faithful", "quartic", false},
        Cell{torus, "descartes", "quartic_recentred", false},
        Cell{teardrop, "descartes", "implicit_sextic_bernstein", false},
        Cell{torus, "interval_bisection", "along_ray", true}}) {
    if (make_counted_solver(solver, {}) == nullptr) continue;
    const auto totals = cell(text, solver, formulation);
    ASSERT_TRUE(totals.has_value()) << solver;
    EXPECT_GT(totals->per_ray(totals->count.flops()), 50) << solver;
    EXPECT_EQ(totals->evaluations > 0, calls_f) << solver;
  }
}

TEST(CountedCells, WhatCannotBeCountedIsAbsent) {
  const std::string torus = "torus:R=1,r=0.25";
  // The change from the Bernstein basis is made in double.
  const std::string bezier = "bezier_revolution:control_points=[[0,0],[2,0],[3,2],[0,6]]";
  EXPECT_FALSE(cell(bezier, "companion").has_value());
  SolverSpec in_float = parse_solver("companion");
  in_float.precision = Precision::binary32;
  const SurfaceSpec spec = surface(torus);
  EXPECT_FALSE(count_operations(spec, "", in_float, rays_at(spec, 10), Query::all).has_value());
  EXPECT_FALSE(count_operations(spec, "", parse_solver("companion"), {}, Query::all).has_value());
}

// -------------------------------------------------------------------------------------------------- kernels

/// Surfaces of every type with a kernel: on and off the origin, and what their kernels tell apart.
constexpr std::string_view kSurfaces[] = {
    "teardrop:s=1",
    "teardrop:s=0.3",
    "bezier_revolution:control_points=[[0,0],[2,0],[3,2],[0,6]]",
    "bezier_revolution:control_points=[[0,0],[1,0],[4,3],[0.5,5],[1,7],[0,8],[0,9]]",
    "sphere:radius=1,center=[0,0,0]",
    "sphere:radius=0.7,center=[1,2,3]",
    "ellipsoid:semi_axes=[3,1,2],center=[0,0,0]",
    "ellipsoid:semi_axes=[1,2,3],center=[1,2,3]",
    "quadric:A=1,E=-1,H=1,J=-1",
    "quadric:A=1,G=-0.5,H=1",
    "quadric:A=1e-3,B=2,C=-0.7,E=3,F=0.11,H=0.3,J=-1",
    "torus:R=1,r=0.25",
    "torus:R=1,r=1.5"};

/// Rays from inside, near and far, at points on the surface, beside it, and almost along it.
std::vector<Ray> mixed_rays(const AnySurface& on, std::size_t count) {
  Rng rng(kSeed);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const auto near = on.sample(rng.uniform(0, 1), rng.uniform(0, 1)).point,
               next = on.sample(rng.uniform(0, 1), rng.uniform(0, 1)).point;
    const double away = std::ldexp(on.size(), static_cast<int>(rng.next() % 8) - 4);
    const Vec3 aside{rng.uniform(-away, away), rng.uniform(-away, away), rng.uniform(-away, away)};
    const Vec3 origin = near + aside;
    const Vec3 target = rng.next() % 4 == 0 ? next + 0.01 * aside : next;
    rays.push_back({origin, std::ldexp(1.0, static_cast<int>(rng.next() % 7) - 3) * (target - origin)});
  }
  return rays;
}

KernelAnswers answers_of(const KernelEntry& entry, const SurfaceSpec& spec, std::span<const Ray> rays,
                         bool all) {
  Parameters options;
  options.set("instruction_set", "baseline");
  const auto kernel = entry.make(options);
  kernel->add(spec);
  KernelAnswers answers;
  kernel->intersect(rays, all, answers);
  return answers;
}

void expect_same(const KernelAnswers& is, const KernelAnswers& wanted, const std::string& where) {
  EXPECT_EQ(is.hits, wanted.hits) << where;
  EXPECT_EQ(is.touching, wanted.touching) << where;
  EXPECT_EQ(is.tier, wanted.tier) << where;
  for (std::size_t i = 0; i < wanted.hits.size(); ++i) {
    for (int k = 0; k < wanted.hits[i]; ++k) {
      const auto rank = static_cast<std::size_t>(k);
      EXPECT_EQ(is.l[rank][i], wanted.l[rank][i]) << where << ", ray " << i;
    }
  }
}

TEST(CountedKernels, AnswerAsTheBaselineOnesBitForBit) {
  std::size_t cells = 0;
  for (const std::string_view text : kSurfaces) {
    const SurfaceSpec spec = surface(text);
    const SurfaceEntry& entry = find_surface(spec.type);
    const std::vector<Ray> rays = mixed_rays(*entry.make(spec), 1000);
    for (const KernelEntry& plain : entry.kernels) {
      const KernelEntry* const counted = find_counted_kernel(spec.type, plain.solver, plain.formulation);
      ASSERT_NE(counted, nullptr) << text << ", " << plain.solver;
      for (const bool all : {false, true}) {
        OperationCount count;
        const CountingScope scope(count);
        const std::string where = std::string(text) + ", " + std::string(plain.solver) + (all ? ", all" : "");
        expect_same(answers_of(*counted, spec, rays, all), answers_of(plain, spec, rays, all), where);
        EXPECT_GT(count.flops(), 20 * rays.size()) << where;
        std::printf("%s: %.1f operations\n", where.c_str(), static_cast<double>(count.flops()) / 1000);
        ++cells;
      }
    }
  }
  EXPECT_EQ(cells > 0, !counted_kernel_registry().empty());
}

/// Lanes of `certified` on these rays at that sphere, first hit.
OperationCount count_sphere(std::string_view text, std::span<const Ray> rays) {
  const KernelEntry* const kernel = find_counted_kernel("sphere", "certified", "foot");
  OperationCount count;
  const CountingScope scope(count);
  const KernelAnswers answers = answers_of(*kernel, surface(text), rays, false);
  for (const std::int8_t hits : answers.hits) EXPECT_EQ(hits, 1);
  return count;
}

TEST(CountedKernels, ASphereAboutTheOriginTakesSixtyOneOperations) {
  if (find_counted_kernel("sphere", "certified", "foot") == nullptr) GTEST_SKIP() << "not in this build";
  const Ray ray{{-3, 0.25, 0.125}, {2, -0.25, -0.0625}};
  const std::string_view centred = "sphere:radius=1,center=[0,0,0]";
  // Units: 7 products. a, b, |o|^2 and their two at the foot: a product and 2 fma each. |o|^2 - r^2, 1/a, the
  // foot's l and point: a sum, a quotient, a product, 3 fma. Discriminant: a square, a sum, an fma; its
  // bound: a product, 2 fma; its root. Both hits: a sum and an fma each. Whether b's sign is sure: 3
  // products. l in the caller's units: a product. Comparisons: the largest of |d_i| 2, the filter 8, the
  // range of l 2.
  const OperationCount once{.additions = 4,
                            .multiplications = 19,
                            .divisions = 1,
                            .square_roots = 1,
                            .comparisons = 12,
                            .fused = 18};
  EXPECT_EQ(count_sphere(centred, {&ray, 1}), once);
  EXPECT_EQ(once.flops(), 61U);
  // Three of them: three times as much, whatever a vector holds.
  const std::array<Ray, 3> rays{ray, ray, ray};
  OperationCount three = once;
  three += once;
  three += once;
  EXPECT_EQ(count_sphere(centred, rays), three);
  // Off the origin: o - c with its rest in 6 sums a coordinate, and the rest once more at the foot.
  OperationCount aside = once;
  aside.additions += 3 * 6 + 3;
  EXPECT_EQ(count_sphere("sphere:radius=1,center=[0.5,0,0]", {&ray, 1}), aside);
}

/// Operations on the rays that `graze bench` counts by default.
double camera_operations(std::string_view text, std::string_view solver) {
  const SurfaceSpec spec = surface(text);
  const auto made = find_surface(spec.type).make(spec);
  constexpr std::size_t kRays = 1000;
  std::vector<Ray> rays;
  for (std::size_t block = 0; rays.size() < kRays; ++block) {
    for (const CaseRay& ray : make_block(find_family("camera"), *made, 1, block, kCaseBlock))
      rays.push_back(ray.ray);
  }
  const auto totals = count_operations(spec, "", parse_solver(solver), rays, Query::first);
  return totals.has_value() ? totals->per_ray(totals->count.flops()) : 0;
}

TEST(CountedKernels, CameraRaysTakeWhatThePagesState) {
  struct Stated {
    std::string_view surface, solver;
    double operations;
  };
  constexpr Stated kStated[] = {
      {"teardrop:s=1", "certified", 312},
      {"teardrop:s=1", "faithful", 460},
      {"sphere:radius=1", "certified", 61},
      {"sphere:radius=1", "faithful", 161},
      {"ellipsoid:semi_axes=[1,2,0.5]", "certified", 75},
      {"ellipsoid:semi_axes=[1,2,0.5]", "faithful", 199},
      {"quadric:A=1,E=0.25,H=1,J=-1", "certified", 75},
      {"quadric:A=1,E=0.25,H=1,J=-1", "faithful", 208},
      {"quadric:A=1,E=-1,H=1,J=-1", "certified", 210},
      {"quadric:A=1,E=-1,H=1,J=-1", "faithful", 336},
      {"torus:R=1,r=0.25", "certified", 622},
      {"torus:R=1,r=0.25", "faithful", 791},
      {"bezier_revolution:control_points=[[0,0],[2,0],[3,2],[0,6]]", "certified", 895},
      {"bezier_revolution:control_points=[[0,0],[2,0],[3,2],[0,6]]", "faithful", 1179}};
  for (const Stated& stated : kStated) {
    const auto& kernels = find_surface(surface(stated.surface).type).kernels;
    const bool is_built = std::any_of(kernels.begin(), kernels.end(), [&](const KernelEntry& kernel) {
      return kernel.solver == stated.solver;
    });
    if (!is_built) continue;
    // Aiming the rays takes functions of the C library.
    constexpr double kShare = 0.01;
    EXPECT_NEAR(camera_operations(stated.surface, stated.solver), stated.operations,
                kShare * stated.operations)
        << stated.surface << ", " << stated.solver;
  }
}

TEST(CountedKernels, CountNothingOutsideAScope) {
  const KernelEntry* const kernel = find_counted_kernel("sphere", "certified", "foot");
  if (kernel == nullptr) GTEST_SKIP() << "not in this build";
  const SurfaceSpec spec = surface("sphere:radius=1,center=[0,0,0]");
  const std::vector<Ray> rays = rays_at(spec, 10);
  OperationCount outer, inner;
  {
    const CountingScope scope(outer);
    const CountingScope nested(inner);
    answers_of(*kernel, spec, rays, true);
  }
  const OperationCount before = inner;
  answers_of(*kernel, spec, rays, true);
  EXPECT_EQ(outer, OperationCount{});
  EXPECT_EQ(inner, before);
  EXPECT_GT(inner.flops(), 0U);
}

TEST(CountedKernels, CellsAddUpOverRays) {
  for (const std::string_view text : kSurfaces) {
    const SurfaceSpec spec = surface(text);
    const std::vector<Ray> rays = rays_at(spec, 99);
    for (const KernelEntry& kernel : find_surface(spec.type).kernels) {
      const SolverSpec solver = parse_solver(std::string(kernel.solver));
      const auto count = [&](std::size_t from, std::size_t to) {
        const auto totals =
            count_operations(spec, "", solver, std::span(rays).subspan(from, to - from), Query::first);
        EXPECT_TRUE(totals.has_value()) << text;
        return totals.value_or(OperationTotals{}).count;
      };
      OperationCount sum = count(0, 37);
      sum += count(37, 99);
      EXPECT_EQ(sum, count(0, 99)) << text << ", " << kernel.solver;
      EXPECT_GT(sum.flops(), 0U) << text << ", " << kernel.solver;
    }
  }
}

}  // namespace
}  // namespace graze
