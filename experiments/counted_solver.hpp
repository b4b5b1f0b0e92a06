// Solvers whose operations are counted: their own sources once more, for numbers that count.
//
// solves    an equation as the solver of that name does, and adds to `count` what it took
// needs     an equation in double: a polynomial in the power basis, form scalar or form system. The counting
//           component compiles each solver's source under a second name (experiments/CMakeLists.txt), for a
//           number type that counts; where its `solve` is no template over that (certified, faithful,
//           descartes, interval_bisection, interval_newton), with double itself one that does
//           (counted_ladder.hpp): in any basis, and in form interval
// returns   the same roots, bit for bit, with the same counters
// error     none: every operation on a number that depends on the equation is counted. Left out are, of
//           templates, operations on constants alone, to which a root belongs that was filed in double and is
//           taken up again (3 to 7 for 100 counted ones, measured on quartics), and what a solver does in
//           double whatever its number type (a bound of all roots, filing and merging of roots); of ladders
//           nothing but integers; and the evaluations of f or F of a scalar equation, an inclusion or a
//           system, which are the surface's: Counters::evaluations says how many
// cost      1.6 to 6 times the time of the solver (measured on quartics); memory for the coefficients
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <graze/solvers/math/counting.hpp>
#include <graze/solvers/solver.hpp>

namespace graze {

/// A solver with its type erased, counting.
class CountedSolver {
 public:
  virtual ~CountedSolver() = default;
  [[nodiscard]] virtual bool takes(Form form) const = 0;
  /// `roots` comes cleared. Throws std::logic_error for a form that `takes` denies.
  virtual void solve(const PolynomialEquation& equation, Roots& roots, OperationCount& count) const = 0;
  virtual void solve(const ScalarEquation& equation, Roots& roots, OperationCount& count) const = 0;
  virtual void solve(const SystemEquation& equation, Roots& roots, OperationCount& count) const = 0;
  virtual void solve(const IntervalEquation& equation, Roots& roots, OperationCount& count) const = 0;
  /// Whether what other bases than the power basis take is counted too.
  [[nodiscard]] virtual bool counts_any_basis() const { return false; }
};

struct CountedSolverEntry {
  std::string_view name;
  std::unique_ptr<CountedSolver> (*make)(const Parameters& options) = nullptr;
};

/// The counted form of every solver of the registry, in its order; generated.
const std::vector<CountedSolverEntry>& counted_solver_registry();

/// The counted form of a solver that is no template over its number (counted_ladder.hpp).
std::unique_ptr<CountedSolver> make_counted_ladder(std::string_view name, const Parameters& options);

/// The solver, counting; null where its name has none (peers).
std::unique_ptr<CountedSolver> make_counted_solver(std::string_view name, const Parameters& options);

// ---------------------------------------------------------------------- equations in numbers that count

namespace counted {

using Number = Counted<double>;

inline std::vector<Number> numbers(std::span<const double> values, OperationCount& count) {
  std::vector<Number> result;
  result.reserve(values.size());
  for (const double value : values) result.emplace_back(value, &count);
  return result;
}

template <std::size_t N>
std::array<Number, N> numbers(const std::array<double, N>& values, OperationCount& count) {
  std::array<Number, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = {values[i], &count};
  return result;
}

template <std::size_t N>
std::array<double, N> values(const std::array<Number, N>& numbers) {
  std::array<double, N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i] = numbers[i].value();
  return result;
}

/// An equation whose function is evaluated in double, uncounted.
template <class Equation>
struct Original {
  const Equation& equation;
  OperationCount& count;
};

inline BasicScalarEquation<Number> equation_in_numbers(const Original<ScalarEquation>& original) {
  const auto eval = [](const void* self, Number x) {
    const auto& [equation, count] = *static_cast<const Original<ScalarEquation>*>(self);
    const Jet jet = equation(x.value());
    return BasicJet<Number>{{jet.f, &count}, {jet.df, &count}, {jet.ddf, &count}, {jet.f_error, &count}};
  };
  const auto& [equation, count] = original;
  return {&original, eval, {equation.lo, &count}, {equation.hi, &count}, equation.max_roots, equation.seed};
}

inline BasicSystemEquation<Number> equation_in_numbers(const Original<SystemEquation>& original) {
  const auto& [equation, count] = original;
  BasicSystemEquation<Number> result;
  result.self = &original;
  result.unknowns = equation.unknowns;
  result.eval = [](const void* self, const BasicVector<Number>& x, BasicVector<Number>& f,
                   BasicMatrix<Number>& jacobian) {
    const auto& [system, operations] = *static_cast<const Original<SystemEquation>*>(self);
    Vector value{};
    Matrix slopes{};
    system.eval(system.self, values(x), value, slopes);
    f = numbers(value, operations);
    for (std::size_t i = 0; i < slopes.size(); ++i) jacobian[i] = numbers(slopes[i], operations);
  };
  result.start = [](const void* self, Rng& rng, BasicVector<Number>& x) {
    const auto& [system, operations] = *static_cast<const Original<SystemEquation>*>(self);
    Vector start = values(x);
    const bool is_start = system.start(system.self, rng, start);
    x = numbers(start, operations);
    return is_start;
  };
  result.lo = numbers(equation.lo, count);
  result.hi = numbers(equation.hi, count);
  result.period = numbers(equation.period, count);
  result.residual_scale = {equation.residual_scale, &count};
  result.max_roots = equation.max_roots;
  result.seed = equation.seed;
  return result;
}

/// Whether S solves this form in numbers that count.
template <class S>
constexpr bool takes(Form form) {
  switch (form) {
    case Form::polynomial:
      return Solves<S, BasicPolynomialEquation<Number>>;
    case Form::scalar:
      return Solves<S, BasicScalarEquation<Number>>;
    case Form::system:
      return Solves<S, BasicSystemEquation<Number>>;
    case Form::interval:
      return false;
  }
  return false;
}

[[noreturn]] inline void refuse() {
  throw std::logic_error("graze: this solver's operations are not counted in this form");
}

}  // namespace counted

template <Solver S>
class CountedModel final : public CountedSolver {
 public:
  explicit CountedModel(const Parameters& options) : solver_(options) {}

  [[nodiscard]] bool takes(Form form) const override { return counted::takes<S>(form); }

  void solve(const PolynomialEquation& equation, Roots& roots, OperationCount& count) const override {
    if constexpr (counted::takes<S>(Form::polynomial)) {
      const auto c = counted::numbers(equation.c, count), c_error = counted::numbers(equation.c_error, count);
      BasicPolynomialEquation<counted::Number> same;
      same.c = c;
      same.c_error = c_error;
      same.basis = equation.basis;
      same.lo = {equation.lo, &count};
      same.hi = {equation.hi, &count};
      same.epsilons = equation.epsilons;
      same.exact = equation.exact;
      solver_.solve(same, roots);
    } else {
      counted::refuse();
    }
  }
  void solve(const ScalarEquation& equation, Roots& roots, OperationCount& count) const override {
    solve_original<Form::scalar>(equation, roots, count);
  }
  void solve(const SystemEquation& equation, Roots& roots, OperationCount& count) const override {
    solve_original<Form::system>(equation, roots, count);
  }
  void solve(const IntervalEquation& /*equation*/, Roots& /*roots*/,
             OperationCount& /*count*/) const override {
    counted::refuse();
  }

 private:
  template <Form kForm, class Equation>
  void solve_original(const Equation& equation, Roots& roots, OperationCount& count) const {
    if constexpr (counted::takes<S>(kForm)) {
      const counted::Original<Equation> original{equation, count};
      solver_.solve(counted::equation_in_numbers(original), roots);
    } else {
      counted::refuse();
    }
  }

  S solver_;
};

}  // namespace graze
