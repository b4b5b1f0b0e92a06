#include <graze/experiments/peers/mpsolve.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <graze/solvers/power_basis.hpp>

// Last: its headers define macros such as isnan.
#include <gmp.h>
#include <mps/mps.h>

namespace graze {
namespace {

/// MPSolve's state for one equation, freed with it.
class Session {
 public:
  explicit Session(std::span<const double> c)
      : context_(mps_context_new()),
        polynomial_(mps_monomial_poly_new(context_, static_cast<long>(c.size()) - 1)) {
    for (std::size_t i = 0; i < c.size(); ++i) set_coefficient(static_cast<long>(i), c[i]);
    mps_context_set_output_prec(context_, std::numeric_limits<double>::digits);
    mps_context_set_output_goal(context_, MPS_OUTPUT_GOAL_APPROXIMATE);
    mps_context_set_input_poly(context_, MPS_POLYNOMIAL(polynomial_));
  }
  ~Session() {
    mps_polynomial_free(context_, MPS_POLYNOMIAL(polynomial_));
    mps_context_free(context_);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// False: the peer reports an error.
  [[nodiscard]] bool run() {
    mps_mpsolve(context_);
    return mps_context_has_errors(context_) == 0;
  }

  /// Visits every root as (real part, imaginary part, radius).
  template <class Visit>
  void visit_roots(std::size_t count, const Visit& visit) {
    const std::unique_ptr<cplx_t[]> roots = std::make_unique<cplx_t[]>(count);
    std::vector<double> radius(count);
    cplx_t* root_memory = roots.get();
    double* radius_memory = radius.data();
    mps_context_get_roots_d(context_, &root_memory, &radius_memory);
    for (std::size_t i = 0; i < count; ++i) visit(cplx_Re(roots[i]), cplx_Im(roots[i]), radius[i]);
  }

 private:
  /// As a rational number: a double is one, and nothing is rounded on the way.
  void set_coefficient(long i, double value) {
    mpq_t real, imaginary;
    mpq_init(real);
    mpq_init(imaginary);
    mpq_set_d(real, value);
    mps_monomial_poly_set_coefficient_q(context_, polynomial_, i, real, imaginary);
    mpq_clear(real);
    mpq_clear(imaginary);
  }

  mps_context* context_;
  mps_monomial_poly* polynomial_;
};

}  // namespace

SolverInfo Mpsolve::info() {
  SolverInfo info;
  info.summary = "MPSolve, multiprecision roots of the exact coefficients";
  info.source = "Bini, Robol, J. Comput. Appl. Math. 272 (2014); MPSolve 3.2.1";
  info.page = "experiments/peers/README.md";
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

Mpsolve::Mpsolve(const Parameters& /*options*/) {}

void Mpsolve::solve(const PolynomialEquation& equation, Roots& roots) const {
  power_basis::solve(equation, roots, [](const power_basis::Problem<double>& problem, Roots& found) {
    Session session(problem.c);
    if (!session.run()) {
      found.status = Status::failed;
      return;
    }
    session.visit_roots(problem.c.size() - 1, [&](double real, double imaginary, double radius) {
      if (std::fabs(imaginary) <= radius) add_real(problem, real, radius, 1, found);
    });
  });
}

}  // namespace graze
