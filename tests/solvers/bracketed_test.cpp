// Bracketing methods against their papers' own counts, and the solver built on them, where this build has it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include <graze/solvers/bracket_methods.hpp>
#include <graze/surfaces/registry.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze {
namespace {

using bracket::Bracket;
using Function = std::function<double(double)>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Bracket<double> bracket_of(const Function& f, double a, double b) { return {a, b, f(a), f(b)}; }

// ------------------------------------------------------------------------------- itp, on its own examples

struct ItpRun {
  double root = 0;
  std::vector<double> points;
};

ItpRun itp_run(const Function& f, double a, double b, double epsilon, double kappa_1) {
  ItpRun run;
  const auto counted = [&](double x) {
    run.points.push_back(x);
    return f(x);
  };
  const auto never = [](double, double) { return false; };
  const auto end =
      itp(counted, bracket_of(f, a, b), epsilon, bracket::ItpParameters<double>{kappa_1}, never, 1000);
  run.root = bracket::middle(end);
  return run;
}

// The example published with the method: x^3 - x - 2 on [1, 2], epsilon 0.0005, kappa_1 0.1, kappa_2 2,
// n_0 1.
TEST(Itp, VisitsThePointsOfThePublishedExample) {
  const ItpRun run = itp_run([](double x) { return x * x * x - x - 2; }, 1, 2, 0.0005, 0.1);
  const std::array<double, 5> published{1.43333333333333, 1.52713145056966, 1.52009281150978,
                                        1.52137899116052, 1.52138301273268};
  ASSERT_EQ(run.points.size(), published.size());
  for (std::size_t i = 0; i < published.size(); ++i) EXPECT_NEAR(run.points[i], published[i], 1e-14);
}

// Functions of the paper's table 1 on [-1, 1] to 1e-10; counts as published with the R package itp.
TEST(Itp, NeedsThePublishedNumberOfStepsOnThePapersFunctions) {
  EXPECT_EQ(itp_run([](double x) { return x * std::exp(x) - 1; }, -1, 1, 1e-10, 0.1).points.size(), 8U);
  EXPECT_EQ(itp_run([](double x) { return std::ceil(10 * x - 1) + 0.5; }, -1, 1, 1e-10, 0.1).points.size(),
            31U);
}

// Theorem 2.1: no more than bisection's ceil(log2((b - a) / (2 epsilon))) plus n_0 = 1 evaluations.
TEST(Itp, NeverNeedsMoreThanOneStepBeyondBisection) {
  const std::size_t bisection = 34;
  for (int power = 1; power <= 41; power += 2) {
    for (const double shift : {0.25, -0.7, 0.999, -1e-7}) {
      const auto f = [&](double x) { return std::pow(x, power) - std::pow(shift, power); };
      const ItpRun run = itp_run(f, -1, 1.5, 1e-10, 0.2 / 2.5);
      EXPECT_LE(run.points.size(), bisection + 1) << power << " " << shift;
      EXPECT_NEAR(f(run.root), 0, 1e-3);
    }
  }
}

// ---------------------------------------------------------------- Chandrupatla, on the table of his paper

struct PaperCase {
  int function;
  double a, b;
  std::size_t evaluations;
};

double chandrupatla_function(int k, double x) {
  constexpr double kXi = 0.61489;
  switch (k) {
    case 1:
      return x * x * x - 2 * x - 5;
    case 2:
      return 1 - 1 / (x * x);
    case 3:
      return std::pow(x - 3, 3);
    case 4:
      return 6 * std::pow(x - 2, 5);
    case 5:
      return std::pow(x, 9);
    case 6:
      return std::pow(x, 19);
    case 7:
      return std::fabs(x) < 3.8e-4 ? 0 : x * std::exp(-1 / (x * x));
    case 8: {
      const double e = (1 - kXi) * std::exp(-x);
      return -3062 * e / (kXi + e) - 1013 + 1628 / x;
    }
    default:
      return std::exp(x) - 2 - 0.01 / (x * x) + 0.000002 / (x * x * x);
  }
}

/// Evaluations of table 1 of the paper, of which the first two are the ends'.
const std::vector<PaperCase>& chandrupatla_table() {
  static const std::vector<PaperCase> table{
      {1, 2, 3, 7},      {1, 1, 10, 11},     {1, 1, 100, 14},    {1, -1e4, 1e4, 23},   {1, -1e10, 1e10, 43},
      {2, 0.5, 1.51, 8}, {2, 1e-4, 1e4, 22}, {2, 1e-6, 1e6, 28}, {2, 1e-10, 1e10, 41}, {2, 1e-12, 1e12, 48},
      {3, 0, 5, 21},     {3, -10, 10, 23},   {3, -1e4, 1e4, 36}, {3, -1e6, 1e6, 45},   {3, -1e10, 1e10, 55},
      {4, 0, 5, 21},     {4, -10, 10, 23},   {4, -1e4, 1e4, 33}, {4, -1e6, 1e6, 43},   {4, -1e10, 1e10, 54},
      {5, -1, 4, 21},    {5, -2, 5, 22},     {5, -1, 10, 23},    {5, -5, 50, 25},      {5, -10, 100, 26},
      {6, -1, 4, 21},    {6, -2, 5, 22},     {6, -1, 10, 23},    {6, -5, 50, 25},      {6, -10, 100, 26},
      {7, -1, 4, 8},     {7, -2, 5, 8},      {7, -1, 10, 11},    {7, -5, 50, 18},      {7, -10, 100, 19},
      {8, 2e-4, 2, 9},   {8, 2e-4, 3, 10},   {8, 2e-4, 9, 11},   {8, 2e-4, 27, 12},    {8, 2e-4, 81, 14},
      {9, 2e-4, 1, 7},   {9, 2e-4, 3, 8},    {9, 2e-4, 9, 10},   {9, 2e-4, 27, 11},    {9, 2e-4, 81, 13}};
  return table;
}

TEST(Chandrupatla, SpendsTheEvaluationsOfThePapersTable) {
  std::size_t spent = 0, published = 0;
  for (const PaperCase& row : chandrupatla_table()) {
    std::size_t count = 2;
    const Function f = [&](double x) { return chandrupatla_function(row.function, x); };
    const auto counted = [&](double x) {
      ++count;
      return f(x);
    };
    // The paper stops at 2 eps_m |x| + eps_a with eps_m = 1e-10 and eps_a = 1e-5 for half the width.
    const auto resolution = [](double x) { return 4e-10 * std::fabs(x) + 1e-5; };
    chandrupatla(counted, bracket_of(f, row.a, row.b), resolution, 1000);
    EXPECT_EQ(count, row.evaluations) << row.function << " [" << row.a << ", " << row.b << "]";
    spent += count;
    published += row.evaluations;
  }
  std::printf("Chandrupatla: %zu evaluations, published %zu\n", spent, published);
  EXPECT_EQ(spent, published);
}

// --------------------------------------------------------------------- TOMS 748, on the set of its paper

/// The 15 families of Alefeld, Potra, Shi (1995), table I.
double aps_function(int k, int n, double x) {
  switch (k) {
    case 1:
      return std::sin(x) - x / 2;
    case 2: {
      double sum = 0;
      for (int i = 1; i <= 20; ++i) sum += std::pow(2.0 * i - 5, 2) / std::pow(x - i * i, 3);
      return -2 * sum;
    }
    case 3:
      return -40.0 * (n == 1 ? 1 : n == 2 ? 2.5 : 5) * x * std::exp(-n * x);
    case 4:
      return std::pow(x, n) - 0.2;
    case 5:
      return std::sin(x) - 0.5;
    case 6:
      return 2 * x * std::exp(-n) - 2 * std::exp(-n * x) + 1;
    case 7:
      return (1 + std::pow(1.0 - n, 2)) * x - std::pow(1 - n * x, 2);
    case 8:
      return x * x - std::pow(1 - x, n);
    case 9:
      return (1 + std::pow(1.0 - n, 4)) * x - std::pow(1 - n * x, 4);
    case 10:
      return std::exp(-n * x) * (x - 1) + std::pow(x, n);
    case 11:
      return (n * x - 1) / ((n - 1) * x);
    case 12:
      return std::pow(x, 1.0 / n) - std::pow(n, 1.0 / n);
    case 13:
      return x == 0 ? 0 : x * std::exp(-1 / (x * x));
    case 14:
      return x >= 0 ? n / 20.0 * (x / 1.5 + std::sin(x) - 1) : -n / 20.0;
    case 15:
      return x > 2e-3 / (1 + n) ? std::exp(1.0) - 1.859
             : x > 0            ? std::exp((n + 1) * x * 1000 / 2) - 1.859
                                : -0.859;
    default:
      return std::pow(x, n) - 1;  // the other half of family 4
  }
}

struct ApsCase {
  int k, n;
  double a, b;
};

std::vector<ApsCase> aps_set() {
  std::vector<ApsCase> all{{1, 0, std::acos(-1.0) / 2, std::acos(-1.0)}, {5, 0, 0, 1.5}, {13, 0, -1, 4}};
  const auto add = [&](int k, std::vector<int> ns, double a, double b) {
    for (const int n : ns) all.push_back({k, n, a, b});
  };
  for (int i = 1; i <= 10; ++i) all.push_back({2, 0, i * i + 1e-9, (i + 1) * (i + 1) - 1e-9});
  add(3, {1, 2, 3}, -9, 31);
  add(4, {4, 6, 8, 10, 12}, 0, 5);
  add(16, {4, 6, 8, 10, 12}, 0, 5);
  add(16, {8, 10, 12, 14}, -0.95, 4.05);
  add(6, {1, 2, 3, 4, 5, 20, 40, 60, 80, 100}, 0, 1);
  add(7, {5, 10, 20}, 0, 1);
  add(8, {2, 5, 10, 15, 20}, 0, 1);
  add(9, {1, 2, 4, 5, 8, 15, 20}, 0, 1);
  add(10, {1, 5, 10, 15, 20}, 0, 1);
  add(11, {2, 5, 15, 20}, 0.01, 1);
  add(12, {2, 3, 4, 5, 6, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31, 33}, 1, 100);
  for (int n = 1; n <= 40; ++n) all.push_back({14, n, -1e4, std::acos(-1.0) / 2});
  for (int n = 20; n <= 40; ++n) all.push_back({15, n, -1e4, 1e-4});
  for (int n = 100; n <= 1000; n += 100) all.push_back({15, n, -1e4, 1e-4});
  return all;
}

class Bracketed : public testing::Test {
 protected:
  void SetUp() override {
    for (const SolverEntry& entry : solver_registry()) {
      if (entry.name == "bracketed") entry_ = &entry;
    }
    if (entry_ == nullptr) GTEST_SKIP() << "this build has no Boost.Math";
  }
  [[nodiscard]] std::unique_ptr<AnySolver> make(const std::string& method, double pieces = 32) const {
    Parameters options;
    options.set("method", method);
    options.set("pieces", pieces);
    return entry_->make(options);
  }
  [[nodiscard]] Roots solve(const std::vector<double>& c, const std::string& method = "toms748",
                            double lo = -kInfinity, double hi = kInfinity) const {
    PolynomialEquation equation;
    equation.c = c;
    equation.lo = lo;
    equation.hi = hi;
    Roots roots;
    make(method)->solve({&equation, 1}, {&roots, 1});
    return roots;
  }

  static inline const std::array<std::string, 3> kMethods{"toms748", "itp", "chandrupatla"};
  const SolverEntry* entry_ = nullptr;
};

/// A slope that says "monotone", so that the solver has one bracket and no extrema to look for.
struct MonotoneAps {
  ApsCase row;
  double slope;
  static Jet eval(const void* self, double x) {
    const auto& s = *static_cast<const MonotoneAps*>(self);
    return {aps_function(s.row.k, s.row.n, x), s.slope, 0, 0};
  }
};

TEST_F(Bracketed, SolvesThePapersSetOf154BracketsWithinTheKnownTotal) {
  ASSERT_EQ(aps_set().size(), 154U);
  for (const std::string& method : kMethods) {
    std::size_t total = 0, worst = 0;
    for (const ApsCase& row : aps_set()) {
      const double rise = aps_function(row.k, row.n, row.b) - aps_function(row.k, row.n, row.a);
      const MonotoneAps self{row, rise > 0 ? 1.0 : -1.0};
      const ScalarEquation equation{&self, &MonotoneAps::eval, row.a, row.b, 0, 0};
      Roots roots;
      make(method, 1)->solve({&equation, 1}, {&roots, 1});
      EXPECT_EQ(roots.list.size(), 1U) << method << " " << row.k << " " << row.n;
      EXPECT_EQ(roots.status, Status::ok) << method << " " << row.k << " " << row.n;
      total += roots.counters.evaluations;
      worst = std::max<std::size_t>(worst, roots.counters.evaluations);
    }
    std::printf("%s: %zu evaluations for 154 brackets, at most %zu\n", method.c_str(), total, worst);
    // Boost.Math's own test of the same set, at full precision, asks for fewer than 3150; ours counts one
    // more a bracket, the value at the root it lists. itp pays for its bound: at most bisection plus one.
    if (method == "toms748") {
      EXPECT_LT(total, 3150U + 154U);
    }
  }
}

// ------------------------------------------------------------------------------------- the whole solver

TEST_F(Bracketed, EveryMethodFindsTheSameRootsWithinTheirRadii) {
  const std::vector<double> c{-5040, 13068, -13132, 6769, -1960, 322, -28, 1};  // 1 ... 7
  for (const std::string& method : kMethods) {
    const Roots roots = solve(c, method);
    ASSERT_EQ(roots.list.size(), 7U) << method;
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_LE(std::fabs(roots.list[i].x - static_cast<double>(i + 1)), roots.list[i].radius) << method;
    }
    std::printf("%s: %u evaluations\n", method.c_str(), roots.counters.evaluations);
  }
}

TEST_F(Bracketed, ATripleRootIsOneOfMultiplicityThree) {
  for (const std::string& method : kMethods) {
    const Roots roots = solve({-1, 3, -3, 1}, method);
    ASSERT_EQ(roots.list.size(), 1U) << method;
    EXPECT_EQ(roots.list[0].multiplicity, 3U) << method;
    EXPECT_NEAR(roots.list[0].x, 1, roots.list[0].radius);
  }
}

TEST_F(Bracketed, ScalingTheUnknownByPowersOfTwoScalesTheRootsExactly) {
  const std::vector<double> c{3, -7, 1, 1.5};
  for (const std::string& method : kMethods) {
    const Roots plain = solve(c, method);
    ASSERT_EQ(plain.list.size(), 3U);
    for (const int k : {-60, -7, 1, 33}) {
      std::vector<double> scaled;
      for (std::size_t i = 0; i < c.size(); ++i) scaled.push_back(std::ldexp(c[i], -k * static_cast<int>(i)));
      const Roots roots = solve(scaled, method);
      ASSERT_EQ(roots.list.size(), 3U) << method << " " << k;
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(roots.list[i].x, std::ldexp(plain.list[i].x, k)) << method;
    }
  }
}

/// (x - 1)^2 (x - 3) + offset.
struct Dip {
  double offset;
  static Jet eval(const void* self, double x) {
    const double offset = static_cast<const Dip*>(self)->offset, t = x - 1;
    return {t * t * (x - 3) + offset, t * (3 * x - 7), 6 * x - 10, 0x1p-50};
  }
};

TEST_F(Bracketed, ADipBetweenSamplesIsTwoRootsATouchOrNone) {
  for (const std::string& method : kMethods) {
    const auto count = [&](double offset) {
      const Dip dip{offset};
      const ScalarEquation equation{&dip, &Dip::eval, 0.3, 2.7, 0, 0};
      Roots roots;
      make(method, 3)->solve({&equation, 1}, {&roots, 1});
      std::uint32_t multiplicity = 0;
      for (const Root& root : roots.list) multiplicity += root.multiplicity;
      return std::pair{roots.list.size(), multiplicity};
    };
    EXPECT_EQ(count(0x1p-20), std::pair(std::size_t{2}, 2U)) << method;
    EXPECT_EQ(count(0), std::pair(std::size_t{1}, 2U)) << method;
    EXPECT_EQ(count(-0x1p-20), std::pair(std::size_t{0}, 0U)) << method;
  }
}

TEST_F(Bracketed, EndsEarlyOnceThereCanBeNoFurtherRoot) {
  const auto sine = [](const void*, double x) {
    return Jet{std::sin(x), std::cos(x), -std::sin(x), 0x1p-52};
  };
  std::array<Roots, 2> roots;
  const std::array<ScalarEquation, 2> equations{ScalarEquation{nullptr, sine, 1, 20, 0, 0},
                                                ScalarEquation{nullptr, sine, 1, 20, 2, 0}};
  make("toms748")->solve(equations, roots);
  EXPECT_EQ(roots[0].list.size(), 6U);
  ASSERT_EQ(roots[1].list.size(), 2U);
  EXPECT_LT(roots[1].counters.evaluations, roots[0].counters.evaluations);
  EXPECT_EQ(roots[1].list[1].x, roots[0].list[1].x);
}

TEST_F(Bracketed, HardPublishedPolynomialsAreRightButForClustersThatRoundingHides) {
  for (const HardPolynomial& hard : hard_polynomials()) {
    for (const std::string& method : kMethods) {
      const Roots roots = solve(hard.c, method);
      EXPECT_EQ(roots.status, Status::ok) << hard.origin;
      const std::size_t right = count_right(hard, roots, 4);
      // Between these roots |p| is no more than 4 u sum |c_i x^i|: they come as one with the multiplicity of
      // all, by the rule that all polynomial methods share.
      // Of roots further apart than doubles have digits, or of values out of their range, some are lost.
      const bool lost = is_one_of(hard.origin, {"Orellana, De Michele 2020, Algorithm 1010, case 22",
                                                "Orellana, De Michele 2020, Algorithm 1010, case 24"});
      if (!is_hidden(hard) && !lost) {
        EXPECT_EQ(right, hard.roots.size()) << hard.origin << " " << method;
      }
      std::uint32_t multiplicity = 0;
      for (const Root& root : roots.list) multiplicity += root.multiplicity;
      if (!lost) {
        EXPECT_GE(multiplicity, hard.roots.size()) << hard.origin << " " << method;
      }
      EXPECT_LE(multiplicity, hard.c.size() - 1) << hard.origin << " " << method;
    }
  }
}

TEST_F(Bracketed, OptionsAreChecked) {
  EXPECT_THROW(static_cast<void>(make("brent")), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(make("itp", 0)), std::invalid_argument);
}

}  // namespace
}  // namespace graze
