#include <graze/experiments/peers/eigen_polynomialsolver.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include <unsupported/Eigen/Polynomials>

namespace graze {
namespace {

template <class T>
using PeerSolver = Eigen::PolynomialSolver<T, Eigen::Dynamic>;

/// Eigen iterates on whatever it is given: a matrix that is not finite is kept from it.
template <class T>
bool has_finite_ratios(power_basis::Coefficients<T> c) {
  return std::all_of(c.begin(), c.end(), [&](T one) { return std::isfinite(one / c.back()); });
}

/// The roots that Eigen itself calls real: those whose imaginary part is below its default threshold.
template <class T>
void add_by_eigens_rule(const PeerSolver<T>& peer, const power_basis::Problem<T>& problem, Roots& found) {
  std::vector<T> real;
  peer.realRoots(real);
  for (const T x : real) power_basis::add_real(problem, x, T{0}, 1, found);
}

}  // namespace

SolverInfo EigenPolynomialsolver::info() {
  SolverInfo info;
  info.summary = "Eigen's PolynomialSolver, eigenvalues of the companion matrix";
  info.source = "Eigen 3.4, unsupported/Eigen/Polynomials";
  info.page = "experiments/peers/README.md";
  info.options = {{"own_rule", "false", "which roots are real: by Eigen's threshold 1e-12 on |Im|"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = true};
  info.forms = {Form::polynomial};
  return info;
}

EigenPolynomialsolver::EigenPolynomialsolver(const Parameters& options)
    : own_rule_(options.flag("own_rule", false)) {}

template <class T>
void EigenPolynomialsolver::solve(const BasicPolynomialEquation<T>& equation, Roots& roots) const {
  power_basis::solve(equation, roots, [this](const power_basis::Problem<T>& problem, Roots& found) {
    if (!has_finite_ratios(problem.c)) {
      found.status = Status::failed;
      return;
    }
    const auto size = static_cast<Eigen::Index>(problem.c.size());
    const Eigen::Matrix<T, Eigen::Dynamic, 1> c =
        Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(problem.c.data(), size);
    const PeerSolver<T> peer(c);
    if (!peer.roots().allFinite()) {
      found.status = Status::failed;
    } else if (own_rule_) {
      add_by_eigens_rule(peer, problem, found);
    } else {
      for (const std::complex<T>& root : peer.roots()) add_if_real(problem, root, false, found);
    }
  });
}

template void EigenPolynomialsolver::solve(const BasicPolynomialEquation<double>&, Roots&) const;
template void EigenPolynomialsolver::solve(const BasicPolynomialEquation<float>&, Roots&) const;

}  // namespace graze
