#include <graze/solvers/newton.hpp>

#include <graze/solvers/from_starts.hpp>

namespace graze {
namespace {

struct Step {
  template <class T>
  T operator()(const from_starts::Local<T>& local) const {
    return from_starts::newton_step(local);
  }
};

}  // namespace

SolverInfo Newton::info() {
  SolverInfo info;
  info.summary = "Newton from equidistant starts, and with Maehly's suppression";
  info.source = "Maehly, Z. angew. Math. Phys. 5 (1954)";
  info.page = "solvers/newton.md";
  info.options = {{"starts", "32", "equidistant start values"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::scalar, Form::polynomial};
  return info;
}

Newton::Newton(const Parameters& options) : starts_(options.integer("starts", 32, 1, 1000000)) {}

template <class T>
void Newton::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  from_starts::solve_polynomial(equation, starts_, Step{}, roots);
}

template <class T>
void Newton::solve(const BasicScalarEquation<T>& equation, Roots& roots) const {
  from_starts::solve_scalar(equation, starts_, Step{}, roots);
}

template void Newton::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void Newton::solve(const BasicPolynomialEquation<float>&, Roots&) const;
template void Newton::solve(const BasicScalarEquation<double>&, Roots&) const;
template void Newton::solve(const BasicScalarEquation<float>&, Roots&) const;

}  // namespace graze
