// What every (solver, form) cell of the build must do, one named case a cell, on equations built from known
// answers; and that a solver defined here, outside the library, is as good as a built-in one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <graze/solvers/solver.hpp>
#include <graze/surfaces/intersector.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

__extension__ using Wide = __int128;  // products of small integers, exactly

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct KnownRoot {
  double x;
  std::uint32_t multiplicity = 1;
};

/// An equation with the answer it must get: exact coefficients, power basis.
struct Known {
  std::string name;
  std::vector<double> c;
  double lo, hi;
  std::vector<KnownRoot> roots;

  [[nodiscard]] bool touches() const {
    return std::any_of(roots.begin(), roots.end(),
                       [](const KnownRoot& r) { return r.multiplicity % 2 == 0; });
  }
  [[nodiscard]] bool is_simple() const {
    return std::all_of(roots.begin(), roots.end(), [](const KnownRoot& r) { return r.multiplicity == 1; });
  }
  /// Largest |x| asked for.
  [[nodiscard]] double reach() const { return std::max(std::fabs(lo), std::fabs(hi)); }
};

using Integers = std::vector<Wide>;

Integers product(const Integers& a, const Integers& b) {
  Integers result(a.size() + b.size() - 1, 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
  }
  return result;
}

/// prod (d x - n) over the fractions n/d, times the extra factor.
Integers from_roots(const std::vector<std::array<int, 2>>& fractions, Integers extra = {1}) {
  for (const auto& [n, d] : fractions) extra = product(extra, {-n, d});
  return extra;
}

/// As doubles; the test must not pose another equation than it thinks.
std::vector<double> exact_doubles(const Integers& integers) {
  std::vector<double> doubles;
  for (const Wide value : integers) {
    doubles.push_back(static_cast<double>(value));
    if (static_cast<Wide>(doubles.back()) != value) throw std::logic_error("a coefficient is not a double");
  }
  return doubles;
}

/// prod (d x - n) on [lo, hi]: the roots in it are those fractions, repeated ones with their multiplicity.
Known of_fractions(std::string name, std::vector<std::array<int, 2>> fractions, double lo, double hi,
                   const Integers& extra = {1}) {
  Known known{std::move(name), exact_doubles(from_roots(fractions, extra)), lo, hi, {}};
  std::sort(fractions.begin(), fractions.end(), [](auto a, auto b) { return a[0] * b[1] < b[0] * a[1]; });
  for (const auto& [n, d] : fractions) {
    const double x = static_cast<double>(n) / d;
    if (x < lo || x > hi) continue;
    if (!known.roots.empty() && known.roots.back().x == x) {
      ++known.roots.back().multiplicity;
    } else {
      known.roots.push_back({x});
    }
  }
  return known;
}

/// Simple, well-separated roots of every degree from 1 to 12.
std::vector<Known> simple_equations() {
  std::vector<Known> all;
  std::vector<std::array<int, 2>> fractions;
  for (int degree = 1; degree <= 12; ++degree) {
    fractions.push_back({degree % 2 == 0 ? degree / 2 : -(degree / 2), 1});
    all.push_back(of_fractions("integers, degree " + std::to_string(degree), fractions, -6.5, 6.5));
  }
  all.push_back(of_fractions("quarters in the unit interval", {{1, 4}, {1, 2}, {3, 4}}, 0, 1));
  all.push_back(of_fractions("eighths, one outside", {{1, 8}, {5, 8}, {9, 8}}, 0, 1));
  all.push_back(of_fractions("roots at both closed ends", {{0, 1}, {1, 1}, {3, 8}}, 0, 1));
  all.push_back(of_fractions("a root at the upper end only", {{2, 1}, {-5, 1}}, -1, 2));
  all.push_back(of_fractions("two in the unit interval", {{1, 8}, {3, 4}}, 0, 1));
  all.push_back(of_fractions("one real root beside a pair", {{3, 4}}, 0, 1, {1, 0, 1}));
  all.push_back(of_fractions("no real root", {}, -3, 3, {1, 0, 1}));
  all.push_back(of_fractions("no root in the interval", {{5, 1}, {-7, 2}}, 0, 1));
  all.push_back(of_fractions("a cubic function", {{-3, 2}, {1, 2}, {2, 1}}, -4, 4));
  return all;
}

std::vector<Known> touching_equations() {
  return {of_fractions("a square", {{1, 2}, {1, 2}}, -1, 2),
          of_fractions("a square and a simple root", {{1, 4}, {1, 4}, {3, 1}}, 0, 4),
          of_fractions("two squares", {{-1, 1}, {-1, 1}, {1, 1}, {1, 1}}, -2, 2),
          of_fractions("a square beside a pair", {{3, 4}, {3, 4}}, 0, 1, {1, 0, 1})};
}

// ---------------------------------------------------------------------------------- one equation, four forms

double derivative_coefficient(const std::vector<double>& c, std::size_t i, int order) {
  double factor = 1;
  for (int k = 0; k < order; ++k) factor *= static_cast<double>(i) - k;
  return factor * c[i];
}

template <class T>
T horner(const std::vector<double>& c, T x, int order, T zero) {
  T sum = zero;
  for (std::size_t i = c.size(); i-- > static_cast<std::size_t>(order);) {
    const double value = derivative_coefficient(c, i, order);
    if constexpr (std::is_same_v<T, Interval>) {
      sum = sum * x + point(value);
    } else {
      sum = sum * x + value;
    }
  }
  return sum;
}

double size_of_terms(const std::vector<double>& c, double x) {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * std::fabs(x) + std::fabs(c[i]);
  return sum;
}

const Known& known_of(const void* self) { return *static_cast<const Known*>(self); }

Jet jet(const void* self, double x) {
  const auto& c = known_of(self).c;
  // Over the whole interval: a bound by the terms at x alone would be zero at a root at zero.
  const double bound =
      2.0 * static_cast<double>(c.size()) * 0x1p-53 * size_of_terms(c, known_of(self).reach());
  return {horner(c, x, 0, 0.0), horner(c, x, 1, 0.0), horner(c, x, 2, 0.0), bound};
}

Interval value(const void* self, Interval x) { return horner(known_of(self).c, x, 0, point(0)); }
Interval slope(const void* self, Interval x) { return horner(known_of(self).c, x, 1, point(0)); }

/// y = f(x), z = y, y + z = 0: f as a system of three.
void system_eval(const void* self, const Vector& x, Vector& f, Matrix& jacobian) {
  const auto& c = known_of(self).c;
  f = {x[1] - horner(c, x[0], 0, 0.0), x[2] - x[1], x[1] + x[2]};
  jacobian[0] = {-horner(c, x[0], 1, 0.0), 1, 0};
  jacobian[1] = {0, -1, 1};
  jacobian[2] = {0, 1, 1};
}

bool system_start(const void* self, Rng& rng, Vector& x) {
  x = {rng.uniform(known_of(self).lo, known_of(self).hi), 0, 0};
  return true;
}

Roots solve_form(const AnySolver& solver, Form form, const Known& known) {
  Roots roots;
  if (form == Form::polynomial) {
    const PolynomialEquation equation{
        .c = known.c, .c_error = {}, .basis = Basis::power, .lo = known.lo, .hi = known.hi, .epsilons = {}};
    solver.solve({&equation, 1}, {&roots, 1});
  } else if (form == Form::scalar) {
    const ScalarEquation equation{&known, &jet, known.lo, known.hi, 0, 1};
    solver.solve({&equation, 1}, {&roots, 1});
  } else if (form == Form::interval) {
    const IntervalEquation equation{&known, &value, &slope, known.lo, known.hi, {}};
    solver.solve({&equation, 1}, {&roots, 1});
  } else {
    SystemEquation equation;
    equation.self = &known;
    equation.unknowns = 3;
    equation.eval = &system_eval;
    equation.start = &system_start;
    equation.lo = {known.lo, -kInfinity, -kInfinity};
    equation.hi = {known.hi, kInfinity, kInfinity};
    equation.residual_scale = size_of_terms(known.c, known.reach());
    equation.seed = 1;
    solver.solve({&equation, 1}, {&roots, 1});
  }
  return roots;
}

// ----------------------------------------------------------------------------------------------------- cells

struct Cell {
  const SolverEntry* solver;
  Form form;

  [[nodiscard]] const SolverInfo::Claims& claims() const { return solver->info.claims; }
  /// No method can by inclusions: a touch and a near miss look alike.
  [[nodiscard]] bool finds_touching_roots() const {
    return claims().finds_touching_roots && form != Form::interval;
  }
  /// It promises digits that inclusions do not prove: a proved root may leave the answer uncertain.
  [[nodiscard]] bool may_doubt_digits() const {
    return solver->info.digits == Digits::placed && form == Form::interval;
  }
  /// A solver from random starts gets enough of them for what is asked here.
  [[nodiscard]] std::unique_ptr<AnySolver> make() const {
    Parameters options;
    for (const auto& option : solver->info.options) {
      if (option.name == "tries") options.set("tries", 200.0);
    }
    return solver->make(options);
  }
  /// Random starts, and inclusion functions in their plainest form, are for equations of low degree.
  [[nodiscard]] bool takes_degree(int degree) const {
    const int limit = solver->info.max_degree;
    return form != Form::polynomial || limit == 0 || degree <= limit;
  }
  [[nodiscard]] bool is_for(const Known& known) const {
    const std::size_t most = form == Form::polynomial ? 12 : claims().deterministic ? 7 : 3;
    return known.c.size() <= most + 1 && takes_degree(static_cast<int>(known.c.size()) - 1);
  }
};

void PrintTo(const Cell& cell, std::ostream* out) {
  *out << cell.solver->name << " " << to_string(cell.form);
}

std::vector<Cell> all_cells() {
  std::vector<Cell> cells;
  for (const SolverEntry& solver : solver_registry()) {
    for (const Form form : solver.info.forms) cells.push_back({&solver, form});
  }
  return cells;
}

class SolverCell : public testing::TestWithParam<Cell> {
 protected:
  static Roots solve(const Known& known) { return solve_form(*GetParam().make(), GetParam().form, known); }
  static const SolverInfo::Claims& claims() { return GetParam().claims(); }
};

/// Ascending, inside the interval, finite.
void expect_orderly(const Known& known, const Roots& roots) {
  for (std::size_t i = 0; i < roots.list.size(); ++i) {
    EXPECT_GE(roots.list[i].x, known.lo) << known.name;
    EXPECT_LE(roots.list[i].x, known.hi) << known.name;
    EXPECT_GE(roots.list[i].radius, 0) << known.name;
    if (i > 0) {
      EXPECT_LT(roots.list[i - 1].x, roots.list[i].x) << known.name;
    }
  }
}

/// Every root listed as certified has exactly one true root, a simple one, in its enclosure.
void expect_certificates_hold(const Known& known, const Roots& roots) {
  for (const Root& root : roots.list) {
    if (!root.certified) continue;
    const auto inside = [&](const KnownRoot& r) { return std::fabs(r.x - root.x) <= root.radius; };
    EXPECT_EQ(std::count_if(known.roots.begin(), known.roots.end(), inside), 1)
        << known.name << std::hexfloat << ": " << root.x << " +- " << root.radius;
  }
}

/// The same distinct roots, each within `tolerance` of the interval's reach.
void expect_roots(const Known& known, const Roots& roots, double tolerance) {
  ASSERT_EQ(roots.list.size(), known.roots.size()) << known.name;
  for (std::size_t i = 0; i < known.roots.size(); ++i) {
    EXPECT_NEAR(roots.list[i].x, known.roots[i].x, tolerance * known.reach()) << known.name;
    EXPECT_EQ(roots.list[i].multiplicity, known.roots[i].multiplicity)
        << known.name << " at " << known.roots[i].x;
  }
}

/// Near every true root, roots of its multiplicity in all: a touching root may come as two that rounding
/// parted. 1e-6: rounding moves a double root by sqrt(eps) times the root of the condition.
void expect_multiplicities(const Known& known, const Roots& roots) {
  constexpr double kNear = 1e-6;
  std::uint32_t claimed = 0, wanted = 0;
  for (const KnownRoot& r : known.roots) {
    std::uint32_t near = 0;
    for (const Root& root : roots.list) {
      near += std::fabs(root.x - r.x) <= kNear * known.reach() ? root.multiplicity : 0;
    }
    EXPECT_EQ(near, r.multiplicity) << known.name << " at " << r.x;
    wanted += r.multiplicity;
  }
  for (const Root& root : roots.list) claimed += root.multiplicity;
  EXPECT_EQ(claimed, wanted) << known.name;
}

TEST_P(SolverCell, FindsTheKnownSimpleRootsAndNoOther) {
  int solved = 0;
  for (const Known& known : simple_equations()) {
    if (!GetParam().is_for(known)) continue;
    const Roots roots = solve(known);
    expect_orderly(known, roots);
    expect_certificates_hold(known, roots);
    if (!GetParam().may_doubt_digits()) {
      EXPECT_EQ(roots.status, Status::ok) << known.name;
    }
    // 1e-9: degree 12 on [-6, 6] has roots of condition 1e6 or so.
    expect_roots(known, roots, 1e-9);
    ++solved;
  }
  EXPECT_GT(solved, 5);
}

TEST_P(SolverCell, SeesTouchingRootsOrSaysThatItCannotDecide) {
  for (const Known& known : touching_equations()) {
    if (!GetParam().is_for(known)) continue;
    const Roots roots = solve(known);
    expect_orderly(known, roots);
    expect_certificates_hold(known, roots);
    // Random starts promise no root; what they list must still be true.
    if (!claims().deterministic && roots.list.empty()) continue;
    if (GetParam().finds_touching_roots()) {
      EXPECT_EQ(roots.status, Status::ok) << known.name;
      expect_multiplicities(known, roots);
    } else if (claims().certified) {
      EXPECT_EQ(roots.status, Status::uncertain) << known.name;
    }
  }
}

TEST_P(SolverCell, AnswersTheSameAgainAndInABatchWithUsedMemory) {
  const auto solver = GetParam().make();
  Roots dirty;
  for (const Known& known : simple_equations()) {
    if (!GetParam().is_for(known)) continue;
    const Roots first = solve_form(*solver, GetParam().form, known);
    const Roots again = solve_form(*solver, GetParam().form, known);
    ASSERT_EQ(first.list.size(), again.list.size()) << known.name;
    for (std::size_t i = 0; i < first.list.size(); ++i) EXPECT_EQ(first.list[i].x, again.list[i].x);
    EXPECT_EQ(first.counters.evaluations, again.counters.evaluations) << known.name;
  }
}

TEST_P(SolverCell, CountsItsWork) {
  const Known known = of_fractions("a quadratic function", {{-3, 2}, {1, 2}}, -4, 4);
  EXPECT_GT(solve(known).counters.evaluations, 0U);
}

TEST_P(SolverCell, TakesWhatItSaysAndRefusesTheRest) {
  const auto solver = GetParam().make();
  EXPECT_TRUE(solver->takes(GetParam().form));
  const auto& forms = GetParam().solver->info.forms;
  for (const Form form : {Form::polynomial, Form::scalar, Form::interval, Form::system}) {
    const bool listed = std::find(forms.begin(), forms.end(), form) != forms.end();
    EXPECT_EQ(solver->takes(form), listed) << to_string(form);
    if (listed) continue;
    const Known known = of_fractions("a line", {{1, 2}}, 0, 1);
    EXPECT_THROW(solve_form(*solver, form, known), std::logic_error) << to_string(form);
  }
}

TEST_P(SolverCell, RefusesUnknownOptions) {
  Parameters options;
  options.set("no_such_option", 1.0);
  EXPECT_THROW(GetParam().solver->make(options), std::invalid_argument);
}

/// Random products of linear factors with small integer roots, some repeated: built, so that the answer is
/// known.
Known random_equation(Rng& rng, std::size_t most) {
  const auto degree = 1 + static_cast<std::size_t>(rng.uniform() * static_cast<double>(most));
  std::vector<std::array<int, 2>> fractions;
  for (std::size_t i = 0; i < degree; ++i) {
    const int denominator = rng.uniform() < 0.3 ? 4 : 1;
    fractions.push_back({static_cast<int>(rng.uniform(-12, 12)), denominator});
  }
  const Integers extra = rng.uniform() < 0.3 ? Integers{1, 0, 1} : Integers{1};
  return of_fractions("random", fractions, -8, 8, extra);
}

TEST_P(SolverCell, AnOkUnderACertifiedClaimIsNeverWrong) {
  constexpr std::uint64_t kSeed = 20261122;
  RecordProperty("seed", std::to_string(kSeed));
  Rng rng(kSeed);
  int ok = 0;
  const int count = claims().deterministic ? 300 : 20;
  for (int i = 0; i < count; ++i) {
    const Known known = random_equation(rng, GetParam().form == Form::polynomial ? 7 : 3);
    if (!GetParam().takes_degree(static_cast<int>(known.c.size()) - 1)) continue;
    const Roots roots = solve(known);
    expect_orderly(known, roots);
    expect_certificates_hold(known, roots);
    if (!claims().certified || roots.status != Status::ok) continue;
    ++ok;
    EXPECT_EQ(roots.list.size(), known.roots.size()) << i;
    EXPECT_TRUE(!known.touches() || GetParam().finds_touching_roots()) << i;
  }
  std::printf("seed %llu: %d of %d certified\n", static_cast<unsigned long long>(kSeed), ok, count);
  if (claims().certified && !GetParam().may_doubt_digits()) {
    EXPECT_GT(ok, count / 3);
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, SolverCell, testing::ValuesIn(all_cells()), [](const auto& cell) {
  return std::string(cell.param.solver->name) + "_" + std::string(to_string(cell.param.form));
});

// ------------------------------------------------------------------------------------------------- in float

/// The known equation with every number a float, as Known is in double.
struct KnownInFloat {
  std::vector<float> c;

  static BasicJet<float> jet(const void* self, float x) {
    const auto& c = static_cast<const KnownInFloat*>(self)->c;
    BasicJet<float> jet;
    float size = 0;
    for (std::size_t i = c.size(); i-- > 0;) {
      jet.ddf = jet.ddf * x + 2 * jet.df;
      jet.df = jet.df * x + jet.f;
      jet.f = jet.f * x + c[i];
      size = size * 8 + std::fabs(c[i]);  // the intervals reach to 8 at most
    }
    jet.f_error = 2 * static_cast<float>(c.size()) * 0x1p-24F * size;
    return jet;
  }
  static void eval(const void* self, const BasicVector<float>& x, BasicVector<float>& f,
                   BasicMatrix<float>& jacobian) {
    const BasicJet<float> j = jet(self, x[0]);
    f = {x[1] - j.f, x[1], 0};
    jacobian[0] = {-j.df, 1, 0};
    jacobian[1] = {0, 1, 0};
  }
  static bool start(const void* /*self*/, Rng& rng, BasicVector<float>& x) {
    x = {static_cast<float>(rng.uniform(-8, 8)), 0, 0};
    return true;
  }
};

Roots solve_in_float(const AnySolver& solver, Form form, const Known& known) {
  KnownInFloat narrow;
  for (const double c : known.c) narrow.c.push_back(static_cast<float>(c));
  const auto lo = static_cast<float>(known.lo), hi = static_cast<float>(known.hi);
  Roots roots;
  if (form == Form::polynomial) {
    const BasicPolynomialEquation<float> equation{
        .c = narrow.c, .c_error = {}, .basis = Basis::power, .lo = lo, .hi = hi, .epsilons = {}};
    solver.solve({&equation, 1}, {&roots, 1});
  } else if (form == Form::scalar) {
    const BasicScalarEquation<float> equation{&narrow, &KnownInFloat::jet, lo, hi, 0, 1};
    solver.solve({&equation, 1}, {&roots, 1});
  } else {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    BasicSystemEquation<float> equation;
    equation.self = &narrow;
    equation.unknowns = 2;
    equation.eval = &KnownInFloat::eval;
    equation.start = &KnownInFloat::start;
    equation.lo = {lo, -kFar, -kFar};
    equation.hi = {hi, kFar, kFar};
    equation.residual_scale = static_cast<float>(size_of_terms(known.c, known.reach()));
    equation.seed = 1;
    solver.solve({&equation, 1}, {&roots, 1});
  }
  return roots;
}

TEST(InFloat, EverySolverThatTakesFloatsFindsSimpleRootsToFloatAccuracy) {
  std::size_t cells = 0;
  for (const Cell& cell : all_cells()) {
    if (!cell.solver->takes(cell.form, Precision::binary32)) continue;
    ++cells;
    for (const Known& known : simple_equations()) {
      // Degree 4 and small integers: exact in float, and conditioned well enough for it.
      if (known.c.size() > 5 || !cell.is_for(known)) continue;
      const Roots roots = solve_in_float(*cell.make(), cell.form, known);
      EXPECT_EQ(roots.status, Status::ok) << cell.solver->name << " " << known.name;
      expect_orderly(known, roots);
      ASSERT_EQ(roots.list.size(), known.roots.size())
          << cell.solver->name << " " << to_string(cell.form) << " " << known.name;
      for (std::size_t i = 0; i < known.roots.size(); ++i) {
        EXPECT_NEAR(roots.list[i].x, known.roots[i].x, 1e-4 * known.reach()) << known.name;
        EXPECT_EQ(static_cast<double>(static_cast<float>(roots.list[i].x)), roots.list[i].x);
      }
    }
  }
  EXPECT_GT(cells, 0U);
}

// ------------------------------------------------------------------------------------------ polynomials only

class PolynomialCell : public testing::TestWithParam<Cell> {
 protected:
  static Roots ask(const std::vector<double>& c, double lo, double hi, Basis basis = Basis::power) {
    const PolynomialEquation equation{
        .c = c, .c_error = {}, .basis = basis, .lo = lo, .hi = hi, .epsilons = {}};
    Roots roots;
    GetParam().make()->solve({&equation, 1}, {&roots, 1});
    return roots;
  }
  static void expect_count(const Roots& roots, std::size_t count) {
    EXPECT_EQ(roots.status, Status::ok);
    EXPECT_EQ(roots.list.size(), count);
  }
};

std::vector<Cell> polynomial_cells() {
  std::vector<Cell> cells;
  for (const Cell& cell : all_cells()) {
    if (cell.form == Form::polynomial) cells.push_back(cell);
  }
  return cells;
}

TEST_P(PolynomialCell, TheZeroPolynomialIsCoincident) {
  for (const std::vector<double>& c : {std::vector<double>{0}, {0, 0, 0, 0}, {-0.0, 0, 0, 0, 0, 0, 0}}) {
    EXPECT_EQ(ask(c, 0, 1).status, Status::coincident);
    EXPECT_EQ(ask(c, 0, 1, Basis::bernstein).status, Status::coincident);
    EXPECT_EQ(ask(c, 0, 1, Basis::chebyshev).status, Status::coincident);
    EXPECT_TRUE(ask(c, 0, 1).list.empty());
  }
}

TEST_P(PolynomialCell, AConstantHasNoRoot) {
  for (const double value : {1.0, -3.0, 1e-300, 1e300}) {
    expect_count(ask({value}, -1, 1), 0);
    expect_count(ask({value, 0, 0, 0}, -1, 1), 0);
  }
  EXPECT_TRUE(ask({5e-324, 0, 0}, -1, 1).list.empty());
}

// The rounding of a change of basis may give the constant a cubic term, whose roots are not the constant's.
TEST_P(PolynomialCell, ABernsteinConstantHasNoRoot) {
  for (const double value : {1.0, -3.0, 1e-300, 1e300}) {
    expect_count(ask({value, value, value, value}, 0, 1, Basis::bernstein), 0);
    expect_count(ask({value, 0, 0, 0}, 0, 1, Basis::chebyshev), 0);
  }
}

TEST_P(PolynomialCell, LeadingZerosChangeNothing) {
  const Roots plain = ask({-1, 0, 4}, -1, 1);
  const Roots padded = ask({-1, 0, 4, 0, 0, 0}, -1, 1);
  ASSERT_EQ(plain.list.size(), 2U);
  ASSERT_EQ(padded.list.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(padded.list[i].x, plain.list[i].x, 1e-13);
}

TEST_P(PolynomialCell, WithoutAnIntervalAllRealRootsAreFound) {
  if (!GetParam().takes_degree(3)) {
    expect_count(ask({2, -3, 1}, -kInfinity, kInfinity), 2);
    return;
  }
  const Roots roots = ask({-6, 11, -6, 1}, -kInfinity, kInfinity);
  expect_count(roots, 3);
  for (std::size_t i = 0; i < roots.list.size(); ++i) {
    EXPECT_NEAR(roots.list[i].x, static_cast<double>(i + 1), 1e-11);
  }
  expect_count(ask({-6, 11, -6, 1}, 1.5, kInfinity), 2);
  expect_count(ask({-6, 11, -6, 1}, -kInfinity, 1.5), 1);
}

TEST_P(PolynomialCell, AnIntervalOfOnePointHoldsItsRootOrNone) {
  const Roots root = ask({-1, 2}, 0.5, 0.5);
  EXPECT_TRUE(root.status == Status::uncertain || root.list.size() == 1U);
  expect_count(ask({-1, 2}, 0.25, 0.25), 0);
}

TEST_P(PolynomialCell, AnEmptyIntervalHoldsNoRoot) { EXPECT_TRUE(ask({-1, 2}, 2, -2).list.empty()); }

TEST_P(PolynomialCell, MagnitudesDoNotMatter) {
  for (const int k : {-900, -300, 300, 900}) {
    const auto scaled = [k](double c) { return std::ldexp(c, k); };
    const Roots plain = ask({3, -7, 2}, -4, 4);
    const Roots roots = ask({scaled(3), scaled(-7), scaled(2)}, -4, 4);
    ASSERT_EQ(roots.list.size(), plain.list.size()) << k;
    for (std::size_t i = 0; i < plain.list.size(); ++i) EXPECT_EQ(roots.list[i].x, plain.list[i].x) << k;
  }
}

TEST_P(PolynomialCell, CoefficientsThatAreNotFiniteAreNeverAnsweredAsIfTheyWere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::vector<double>& c :
       {std::vector<double>{nan, 1}, {-1, nan}, {-1, kInfinity, 1}, {kInfinity, 1}}) {
    const Roots roots = ask(c, 0, 2);
    EXPECT_TRUE(roots.status != Status::ok) << c[0] << " " << c[1];
    for (const Root& root : roots.list) EXPECT_FALSE(root.certified);
  }
}

/// sum_j C(n,j) b_j t^j (1-t)^(n-j) with C(n,j) b_j given: exact doubles b_j after multiplying by the least
/// common multiple of the C(n,j) and dividing by what all have in common; empty if they do not fit.
std::optional<std::vector<double>> bernstein_doubles(const Integers& with_binomials) {
  const std::size_t n = with_binomials.size() - 1;
  std::vector<long long> binomial(n + 1, 1);
  for (std::size_t j = 1; j <= n; ++j) {
    binomial[j] = binomial[j - 1] * static_cast<long long>(n - j + 1) / static_cast<long long>(j);
  }
  long long common = 1;
  for (const long long b : binomial) common = std::lcm(common, b);
  std::vector<double> result;
  for (std::size_t j = 0; j <= n; ++j) {
    const Wide b = with_binomials[j] * (common / binomial[j]);
    result.push_back(static_cast<double>(b));
    if (static_cast<Wide>(result.back()) != b) return std::nullopt;
  }
  return result;
}

TEST_P(PolynomialCell, BernsteinEquationsOfEveryDegreeGiveTheirKnownRoots) {
  // The factor (t - k/8) is -k (1 - t) + (8 - k) t, up to 8.
  const std::array<int, 12> eighths{4, 1, 7, 2, 6, 12, 3, 5, 0, 8, -4, -8};
  Integers with_binomials{1};
  std::vector<double> inside;
  for (const int k : eighths) {
    with_binomials = product(with_binomials, {-k, 8 - k});
    if (k >= 0 && k <= 8) inside.push_back(k / 8.0);
    std::sort(inside.begin(), inside.end());
    if (!GetParam().takes_degree(static_cast<int>(with_binomials.size()) - 1)) break;
    const auto b = bernstein_doubles(with_binomials);
    if (!b) {
      EXPECT_GE(with_binomials.size(), 12U) << "only the highest degrees may not fit";
      continue;
    }
    for (const auto& [lo, length] : {std::pair{0.0, 1.0}, std::pair{-3.0, 16.0}}) {
      const Roots roots = ask(*b, lo, lo + length, Basis::bernstein);
      const std::string where = "degree " + std::to_string(b->size() - 1);
      EXPECT_EQ(roots.status, Status::ok) << where;
      ASSERT_EQ(roots.list.size(), inside.size()) << where;
      for (std::size_t i = 0; i < inside.size(); ++i) {
        EXPECT_NEAR(roots.list[i].x, lo + inside[i] * length, 1e-8 * length) << where;
        if (!roots.list[i].certified) continue;
        EXPECT_LE(std::fabs(roots.list[i].x - (lo + inside[i] * length)), roots.list[i].radius) << where;
      }
    }
  }
}

/// The product of two polynomials in the Chebyshev basis, times two: 2 T_i T_j = T_{i+j} + T_{|i-j|}.
Integers chebyshev_product(const Integers& a, const Integers& b) {
  Integers result(a.size() + b.size() - 1, 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      result[i + j] += a[i] * b[j];
      result[i > j ? i - j : j - i] += a[i] * b[j];
    }
  }
  return result;
}

bool are_doubles(const Integers& integers) {
  return std::all_of(integers.begin(), integers.end(),
                     [](Wide v) { return static_cast<Wide>(static_cast<double>(v)) == v; });
}

TEST_P(PolynomialCell, ChebyshevEquationsOfEveryDegreeGiveTheirKnownRoots) {
  const std::array<int, 12> eighths{4, -7, 2, -2, 6, 12, -5, 0, 8, -8, 3, -12};
  Integers c{1};
  std::vector<double> inside;
  for (const int k : eighths) {
    c = chebyshev_product(c, {-k, 8});
    if (std::abs(k) <= 8) inside.push_back(k / 8.0);
    std::sort(inside.begin(), inside.end());
    const int degree = static_cast<int>(c.size()) - 1;
    if (!GetParam().takes_degree(degree)) break;
    if (!are_doubles(c)) {
      EXPECT_GE(degree, 10) << "only the highest degrees may not fit";
      break;
    }
    for (const auto& [lo, length] : {std::pair{-1.0, 2.0}, std::pair{-3.0, 16.0}}) {
      const Roots roots = ask(exact_doubles(c), lo, lo + length, Basis::chebyshev);
      const std::string where = "degree " + std::to_string(degree);
      EXPECT_EQ(roots.status, Status::ok) << where;
      ASSERT_EQ(roots.list.size(), inside.size()) << where;
      for (std::size_t i = 0; i < inside.size(); ++i) {
        const double x = lo + 0.5 * (inside[i] + 1) * length;
        EXPECT_NEAR(roots.list[i].x, x, 1e-8 * length) << where;
        if (roots.list[i].certified) {
          EXPECT_LE(std::fabs(roots.list[i].x - x), roots.list[i].radius) << where;
        }
      }
    }
  }
}

TEST_P(PolynomialCell, ChebyshevEquationsBeyondTheDegreeLimitAreNotAnsweredWrongly) {
  // T_40 has forty roots.
  std::vector<double> c(41, 0.0);
  c.back() = 1;
  const Roots roots = ask(c, -1, 1, Basis::chebyshev);
  EXPECT_TRUE(roots.status != Status::ok || roots.list.size() == 40U);
}

TEST_P(PolynomialCell, CoefficientErrorsWidenWhatACertifiedSolverLeavesOpen) {
  if (!GetParam().claims().certified) GTEST_SKIP() << "claims no certificate";
  const std::vector<double> c{-1, 2};
  const std::vector<double> error{0x1p-20, 0};
  const PolynomialEquation equation{
      .c = c, .c_error = error, .basis = Basis::power, .lo = 0, .hi = 1, .epsilons = {}};
  Roots roots;
  GetParam().make()->solve({&equation, 1}, {&roots, 1});
  for (const Root& root : roots.list) {
    if (root.certified) {
      EXPECT_GE(root.radius, 0x1p-22) << "the root of -1 +- 2^-20 + 2 x is known to 2^-21 only";
    }
  }
  EXPECT_TRUE(!roots.list.empty() || roots.status == Status::uncertain);
}

INSTANTIATE_TEST_SUITE_P(Cells, PolynomialCell, testing::ValuesIn(polynomial_cells()),
                         [](const auto& cell) { return std::string(cell.param.solver->name); });

// ---------------------------------------------------------------------------------------- a geometric system

/// The line (x, 3/5) and the unit circle (cos a, sin a): x = -4/5 and 4/5.
void circle_eval(const void* /*self*/, const Vector& x, Vector& f, Matrix& jacobian) {
  f = {x[0] - std::cos(x[1]), 0.6 - std::sin(x[1]), x[2]};
  jacobian[0] = {1, std::sin(x[1]), 0};
  jacobian[1] = {0, -std::cos(x[1]), 0};
  jacobian[2] = {0, 0, 1};
}

bool circle_start(const void* /*self*/, Rng& rng, Vector& x) {
  x = {rng.uniform(-2, 2), rng.uniform(-3.1, 3.1), 0};
  return true;
}

class SystemCell : public testing::TestWithParam<Cell> {};

std::vector<Cell> system_cells() {
  std::vector<Cell> cells;
  for (const Cell& cell : all_cells()) {
    if (cell.form == Form::system) cells.push_back(cell);
  }
  return cells;
}

Roots circle_roots(const AnySolver& solver, int unknowns) {
  SystemEquation equation;
  equation.unknowns = unknowns;
  equation.eval = &circle_eval;
  equation.start = &circle_start;
  equation.lo = {-2, -kInfinity, -1};
  equation.hi = {2, kInfinity, 1};
  equation.period = {0, 2 * 3.141592653589793, 0};
  equation.max_roots = 2;
  equation.seed = 7;
  Roots roots;
  solver.solve({&equation, 1}, {&roots, 1});
  return roots;
}

void expect_circle_roots(const Roots& roots) {
  ASSERT_EQ(roots.list.size(), 2U);
  EXPECT_NEAR(roots.list[0].x, -0.8, 1e-12);
  EXPECT_NEAR(roots.list[1].x, 0.8, 1e-12);
  for (const Root& root : roots.list) EXPECT_NEAR(std::sin(root.others[0]), 0.6, 1e-12);
}

TEST_P(SystemCell, ALineMeetsACircleInTwoPointsWithTheirAngles) {
  expect_circle_roots(circle_roots(*GetParam().make(), 3));
}

TEST_P(SystemCell, TwoUnknownsAreEnoughForThat) { expect_circle_roots(circle_roots(*GetParam().make(), 2)); }

INSTANTIATE_TEST_SUITE_P(Cells, SystemCell, testing::ValuesIn(system_cells()),
                         [](const auto& cell) { return std::string(cell.param.solver->name); });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SystemCell);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PolynomialCell);

// -------------------------------------------------------------------------------- a solver of the user's own

/// Scans for sign changes on a grid and bisects: the fewest lines the concept allows.
struct SignScan {
  static SolverInfo info() {
    SolverInfo info;
    info.summary = "sign changes on a grid";
    info.source = "school";
    info.options = {{"cells", "64", "grid cells"}};
    info.forms = {Form::scalar};
    return info;
  }
  explicit SignScan(const Parameters& options) : cells(options.integer("cells", 64, 1, 1000000)) {}

  void solve(const ScalarEquation& f, Roots& roots) const {
    const double step = (f.hi - f.lo) / cells;
    for (int i = 0; i < cells; ++i) {
      double a = f.lo + i * step;
      double b = a + step;
      const bool below = f(a).f < 0;
      roots.counters.evaluations += 2;
      if (below == (f(b).f < 0)) continue;
      for (int k = 0; k < 60; ++k) ((f(0.5 * (a + b)).f < 0) == below ? a : b) = 0.5 * (a + b);
      roots.list.push_back({.x = 0.5 * (a + b), .others = {}, .radius = b - a});
    }
  }

  int cells;
};

static_assert(Solver<SignScan>);

TEST(OpenSolver, ASolverDefinedOutsideTheLibraryHasAnEntryLikeTheBuiltInOnes) {
  const SolverEntry entry = solver_entry<SignScan>("sign_scan");
  const Known known = of_fractions("a cubic function", {{-3, 2}, {1, 2}, {2, 1}}, -4, 4.5);
  const Roots roots = solve_form(*entry.make({}), Form::scalar, known);
  ASSERT_EQ(roots.list.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(roots.list[i].x, known.roots[i].x, 1e-12);
  Parameters misspelt;
  misspelt.set("cell", 3.0);
  EXPECT_THROW(entry.make(misspelt), std::invalid_argument);
  EXPECT_THROW(solve_form(*entry.make({}), Form::polynomial, known), std::logic_error);
}

TEST(OpenSolver, ItMeetsEverySurfaceThatOffersItsForm) {
  const SolverEntry entry = solver_entry<SignScan>("sign_scan");
  for (const SurfaceEntry& surface : surface_registry()) {
    if (surface.name != "teardrop") continue;
    SurfaceSpec spec;
    spec.type = "teardrop";
    spec.parameters.set("s", 1.0);
    Scene scene;
    scene.add(surface, spec, entry);
    const Ray ray{{-5, 1.5, 0}, {1, 0, 0}};
    Scene::Workspace work;
    HitBuffer hits;
    scene.intersect({&ray, 1}, Query::all, {}, work, hits);
    ASSERT_EQ(hits.l.size(), 2U);
    EXPECT_NEAR(hits.l[0], 3.125, 1e-12);
    EXPECT_NEAR(hits.l[1], 6.875, 1e-12);
  }
}

TEST(SolverRegistry, EverySolverSaysWhatItIs) {
  for (const SolverEntry& solver : solver_registry()) {
    EXPECT_FALSE(solver.info.summary.empty()) << solver.name;
    EXPECT_FALSE(solver.info.source.empty()) << solver.name;
    EXPECT_FALSE(solver.info.forms.empty()) << solver.name;
    for (const auto& option : solver.info.options) EXPECT_FALSE(option.meaning.empty()) << solver.name;
  }
}

TEST(SolverRegistry, UnknownNamesNameTheNearest) {
  const std::string known(solver_registry().front().name);
  try {
    find_solver(known.substr(1));
    FAIL() << "must throw";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(known), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace graze
