#include <graze/solvers/halley.hpp>

#include <graze/solvers/from_starts.hpp>

namespace graze {
namespace {

struct Step {
  template <class T>
  T operator()(const from_starts::Local<T>& local) const {
    return from_starts::halley_step(local);
  }
};

}  // namespace

SolverInfo Halley::info() {
  SolverInfo info;
  info.summary = "Halley from equidistant starts, and with Maehly's suppression";
  info.source = "Halley 1694; Traub 1964, section 5.2; Maehly 1954";
  info.page = "solvers/halley.md";
  info.options = {{"starts", "32", "equidistant start values"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::scalar, Form::polynomial};
  return info;
}

Halley::Halley(const Parameters& options) : starts_(options.integer("starts", 32, 1, 1000000)) {}

template <class T>
void Halley::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  from_starts::solve_polynomial(equation, starts_, Step{}, roots);
}

template <class T>
void Halley::solve(const BasicScalarEquation<T>& equation, Roots& roots) const {
  from_starts::solve_scalar(equation, starts_, Step{}, roots);
}

template void Halley::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Halley::solve(const BasicPolynomialEquation<float>&, Roots&) const;
template void Halley::solve(const BasicScalarEquation<double>&, Roots&) const;
template void Halley::solve(const BasicScalarEquation<float>&, Roots&) const;

}  // namespace graze
