// The one interface behind which root finders are interchangeable.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/parameters.hpp>
#include <graze/solvers/roots.hpp>

namespace graze {

/// What a method says of itself. `claims` are what the contract tests hold it to.
struct SolverInfo {
  std::string_view summary;
  std::string_view source;  ///< citation
  std::string_view page;    ///< path of the page beside its code
  struct Option {
    std::string_view name, fallback, meaning;
  };
  std::vector<Option> options;
  struct Claims {
    /// Sees a root of even multiplicity. Not in form interval: inclusions cannot tell a touch from a miss.
    bool finds_touching_roots = false;
    bool certified = false;     ///< status ok means: the roots, all of them and no other, proved
    bool deterministic = true;  ///< no random start values
  } claims;
  /// Forms it takes, best first: where a surface offers several formulations and the user names none,
  /// the first form that the surface offers is used.
  std::vector<Form> forms;
  /// Takes the surface's first formulation that it can, in whatever form, instead of its own best form.
  bool trusts_surface = false;
  Digits digits = Digits::rounded;  ///< that it asks of polynomial equations
  int max_degree = 0;               ///< of the polynomials it takes; 0: any. Above it the answer is `failed`
};

/// A solver is a plain struct, built once from its options, that solves one equation of a form it takes:
///   void solve(const PolynomialEquation&, Roots&) const;   // and / or the other forms, and / or in float
/// `Roots` comes cleared. The call neither throws nor allocates beyond the answer's own memory (exceptions
/// are said in the method's header), and is safe to make from many threads.
template <class S, class Equation>
concept Solves = requires(const S& solver, const Equation& equation, Roots& roots) {
  { solver.solve(equation, roots) } -> std::same_as<void>;
};

template <class S>
concept Solver = std::constructible_from<S, const Parameters&> && requires {
  { S::info() } -> std::same_as<SolverInfo>;
} &&(Solves<S, PolynomialEquation> || Solves<S, ScalarEquation> || Solves<S, IntervalEquation> ||
     Solves<S, SystemEquation>);

/// Whether S takes equations of this form in this arithmetic.
template <class S>
constexpr bool solver_takes(Form form, Precision precision) {
  const bool wide = precision == Precision::binary64;
  switch (form) {
    case Form::polynomial:
      return wide ? Solves<S, PolynomialEquation> : Solves<S, BasicPolynomialEquation<float>>;
    case Form::scalar:
      return wide ? Solves<S, ScalarEquation> : Solves<S, BasicScalarEquation<float>>;
    case Form::interval:
      return wide && Solves<S, IntervalEquation>;
    case Form::system:
      return wide ? Solves<S, SystemEquation> : Solves<S, BasicSystemEquation<float>>;
  }
  return false;
}

/// A solver with its type erased: one virtual call a batch of equations, never one an equation.
class AnySolver {
 public:
  virtual ~AnySolver() = default;
  [[nodiscard]] virtual bool takes(Form form, Precision precision = Precision::binary64) const = 0;
  /// Solves equations[i] into roots[i], which is cleared first. Throws std::logic_error for a form that
  /// `takes` denies: the caller asks first.
  virtual void solve(std::span<const PolynomialEquation> equations, std::span<Roots> roots) const = 0;
  virtual void solve(std::span<const ScalarEquation> equations, std::span<Roots> roots) const = 0;
  virtual void solve(std::span<const IntervalEquation> equations, std::span<Roots> roots) const = 0;
  virtual void solve(std::span<const SystemEquation> equations, std::span<Roots> roots) const = 0;
  virtual void solve(std::span<const BasicPolynomialEquation<float>> equations,
                     std::span<Roots> roots) const = 0;
  virtual void solve(std::span<const BasicScalarEquation<float>> equations, std::span<Roots> roots) const = 0;
  virtual void solve(std::span<const BasicSystemEquation<float>> equations, std::span<Roots> roots) const = 0;
};

template <Solver S>
class SolverModel final : public AnySolver {
 public:
  explicit SolverModel(const Parameters& options) : solver_(options) {}

  [[nodiscard]] bool takes(Form form, Precision precision) const override {
    return solver_takes<S>(form, precision);
  }
  void solve(std::span<const PolynomialEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const ScalarEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const IntervalEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const SystemEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const BasicPolynomialEquation<float>> e, std::span<Roots> r) const override {
    solve_all(e, r);
  }
  void solve(std::span<const BasicScalarEquation<float>> e, std::span<Roots> r) const override {
    solve_all(e, r);
  }
  void solve(std::span<const BasicSystemEquation<float>> e, std::span<Roots> r) const override {
    solve_all(e, r);
  }

 private:
  template <class Equation>
  void solve_all(std::span<const Equation> equations, std::span<Roots> roots) const {
    if constexpr (Solves<S, Equation>) {
      for (std::size_t i = 0; i < equations.size(); ++i) {
        roots[i].clear();
        solver_.solve(equations[i], roots[i]);
      }
    } else {
      throw std::logic_error("graze: this solver does not take this form");
    }
  }

  S solver_;
};

/// One line of the generated registry.
struct SolverEntry {
  std::string_view name;
  SolverInfo info;
  bool (*takes)(Form, Precision) = nullptr;
  std::function<std::unique_ptr<AnySolver>(const Parameters&)> make;
};

/// The entry of method S under `name`. Building a solver throws std::invalid_argument for a bad option.
template <Solver S>
SolverEntry solver_entry(std::string_view name) {
  return {name, S::info(), &solver_takes<S>, [name](const Parameters& options) -> std::unique_ptr<AnySolver> {
            std::vector<std::string_view> known;
            for (const auto& option : S::info().options) known.push_back(option.name);
            options.expect_only(known, name);
            return std::make_unique<SolverModel<S>>(options);
          }};
}

}  // namespace graze
