#include <graze/experiments/peers/gsl.hpp>

#include <complex>
#include <memory>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_poly.h>

#include <graze/solvers/power_basis.hpp>

namespace graze {
namespace {

struct FreeWorkspace {
  void operator()(gsl_poly_complex_workspace* workspace) const { gsl_poly_complex_workspace_free(workspace); }
};
using Workspace = std::unique_ptr<gsl_poly_complex_workspace, FreeWorkspace>;

}  // namespace

SolverInfo Gsl::info() {
  SolverInfo info;
  info.summary = "gsl_poly_complex_solve, eigenvalues of the balanced companion matrix";
  info.source = "GNU Scientific Library 2.7";
  info.page = "experiments/peers/README.md";
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Gsl::Gsl(const Parameters& /*options*/) { gsl_set_error_handler_off(); }

void Gsl::solve(const PolynomialEquation& equation, Roots& roots) const {
  power_basis::solve(equation, roots, [](const power_basis::Problem<double>& problem, Roots& found) {
    const std::size_t size = problem.c.size();
    const Workspace workspace(gsl_poly_complex_workspace_alloc(size));
    power_basis::Scratch<double> memory(2 * (size - 1));
    const std::span<double> parts = memory.span();
    if (gsl_poly_complex_solve(problem.c.data(), size, workspace.get(), parts.data()) != GSL_SUCCESS) {
      found.status = Status::failed;
      return;
    }
    for (std::size_t i = 0; i + 1 < parts.size(); i += 2)
      add_if_real(problem, std::complex<double>(parts[i], parts[i + 1]), false, found);
  });
}

}  // namespace graze
