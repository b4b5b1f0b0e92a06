#include <graze/solvers/ceres_slices.hpp>

#include <cmath>
#include <optional>

#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <ceres/tiny_solver.h>

namespace graze {
namespace {

/// Both forms as residuals of N unknowns with a row-major Jacobian.
template <int N>
struct SystemResidual {
  static constexpr int kUnknowns = N;
  const SystemEquation& equation;

  void operator()(const double* x, double* f, Matrix* jacobian) const {
    Vector point{};
    Vector values{};
    Matrix rows{};
    std::copy_n(x, kUnknowns, point.begin());
    equation.eval(equation.self, point, values, rows);
    std::copy_n(values.begin(), kUnknowns, f);
    if (jacobian != nullptr) *jacobian = rows;
  }
};

struct ScalarResidual {
  static constexpr int kUnknowns = 1;
  const ScalarEquation& equation;

  /// Beyond the bounds, where a minimiser may try, f goes on along its tangent at the end.
  void operator()(const double* x, double* f, Matrix* jacobian) const {
    const double inside = std::clamp(x[0], equation.lo, equation.hi);
    const Jet jet = equation(inside);
    f[0] = jet.f + jet.df * (x[0] - inside);
    if (jacobian != nullptr) (*jacobian)[0][0] = jet.df;
  }
};

/// Ceres' view of a residual.
template <class Residual>
class Cost final : public ceres::SizedCostFunction<Residual::kUnknowns, Residual::kUnknowns> {
 public:
  Cost(const Residual& residual, Counters& counters) : residual_(residual), counters_(counters) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Matrix jacobian{};
    const bool wanted = jacobians != nullptr && jacobians[0] != nullptr;
    residual_(parameters[0], residuals, wanted ? &jacobian : nullptr);
    ++counters_.evaluations;
    if (!wanted) return true;
    constexpr auto kN = static_cast<std::size_t>(Residual::kUnknowns);
    for (std::size_t i = 0; i < kN; ++i) std::copy_n(jacobian[i].begin(), kN, jacobians[0] + i * kN);
    return true;
  }

 private:
  const Residual& residual_;
  Counters& counters_;
};

/// TinySolver's view: column-major Jacobian.
template <class Residual>
struct TinyCost {
  using Scalar = double;
  enum { NUM_RESIDUALS = Residual::kUnknowns, NUM_PARAMETERS = Residual::kUnknowns };
  const Residual& residual;
  Counters& counters;

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    Matrix rows{};
    residual(parameters, residuals, jacobian != nullptr ? &rows : nullptr);
    ++counters.evaluations;
    if (jacobian == nullptr) return true;
    constexpr auto kN = static_cast<std::size_t>(Residual::kUnknowns);
    for (std::size_t j = 0; j < kN; ++j) {
      for (std::size_t i = 0; i < kN; ++i) jacobian[j * kN + i] = rows[i][j];
    }
    return true;
  }
};

/// Iterate until nothing moves: the tolerances are Ceres' relative ones set below rounding, so that the
/// residual reaches the rounding level that slices::is_root asks for.
constexpr double kParameterTolerance = 1e-17;
constexpr double kNegligible = 1e-40;  // for gradient and cost, which are squares of the residual

ceres::Solver::Options solver_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = CeresSlices::kIterations;
  options.function_tolerance = kNegligible;
  options.gradient_tolerance = kNegligible;
  options.parameter_tolerance = kParameterTolerance;
  options.min_lm_diagonal = kNegligible;  // its default damps the last steps to a touching root, where J -> 0
  options.max_num_consecutive_invalid_steps = CeresSlices::kIterations;  // the iteration budget is the limit
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

/// Minimises from x with bounds; the problem is built once an equation.
template <class Residual>
class FullSolver {
 public:
  FullSolver(const Residual& residual, const double* lo, const double* hi, Counters& counters)
      : counters_(counters) {
    problem_.AddResidualBlock(new Cost<Residual>(residual, counters), nullptr, x_.data());
    for (int i = 0; i < Residual::kUnknowns; ++i) {
      if (std::isfinite(lo[i])) problem_.SetParameterLowerBound(x_.data(), i, lo[i]);
      if (std::isfinite(hi[i])) problem_.SetParameterUpperBound(x_.data(), i, hi[i]);
    }
  }
  void minimize(Vector& x) {
    x_ = x;
    ceres::Solver::Summary summary;
    ceres::Solve(options_, &problem_, &summary);
    counters_.iterations += static_cast<std::uint32_t>(summary.iterations.size());
    x = x_;
  }

 private:
  ceres::Solver::Options options_ = solver_options();
  ceres::Problem problem_;
  Vector x_{};
  Counters& counters_;
};

/// Minimises from x without bounds; the caller clamps and judges.
template <class Residual>
void minimize_tiny(const Residual& residual, Vector& x, Counters& counters) {
  using Function = TinyCost<Residual>;
  const Function function{residual, counters};
  ceres::TinySolver<Function> solver;
  solver.options.max_num_iterations = CeresSlices::kIterations;
  solver.options.gradient_tolerance = kNegligible;
  solver.options.parameter_tolerance = kParameterTolerance;
  solver.options.function_tolerance = kNegligible;
  solver.options.cost_threshold = 0;
  Eigen::Matrix<double, Residual::kUnknowns, 1> parameters;
  std::copy_n(x.begin(), Residual::kUnknowns, parameters.data());
  solver.Solve(function, &parameters);
  counters.iterations += static_cast<std::uint32_t>(solver.summary.iterations);
  std::copy_n(parameters.data(), Residual::kUnknowns, x.begin());
}

/// One local search from x: full or tiny.
template <class Residual>
class Minimizer {
 public:
  Minimizer(bool tiny, const Residual& residual, const double* lo, const double* hi, Counters& counters)
      : residual_(residual), counters_(counters) {
    if (!tiny) full_.emplace(residual, lo, hi, counters);
  }
  void operator()(Vector& x) {
    if (full_) {
      full_->minimize(x);
    } else {
      minimize_tiny(residual_, x, counters_);
    }
  }

 private:
  const Residual& residual_;
  Counters& counters_;
  std::optional<FullSolver<Residual>> full_;
};

}  // namespace

SolverInfo CeresSlices::info() {
  SolverInfo info;
  info.summary = "Ceres (Levenberg-Marquardt) from random slices of the bounding cylinder";
  info.source = "document 003; Ceres Solver 2.1";
  info.page = "solvers/ceres_slices.md";
  info.options = {{"tries", "30", "random starts"},
                  {"seed", "0", "changes every ray's starts"},
                  {"tiny", "false", "use ceres::TinySolver: no bounds, no allocation, much faster"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = false};
  info.forms = {Form::system, Form::scalar};
  return info;
}

CeresSlices::CeresSlices(const Parameters& options)
    : tries_(options.integer("tries", slices::kDefaultTries, 1, 1000000)),
      seed_(static_cast<std::uint64_t>(options.integer("seed", 0, 0, 2000000000))),
      tiny_(options.flag("tiny", false)) {}

template <int N>
void CeresSlices::solve_system(const SystemEquation& equation, Roots& roots) const {
  const SystemResidual<N> residual{equation};
  Minimizer<SystemResidual<N>> minimize(tiny_, residual, equation.lo.data(), equation.hi.data(),
                                        roots.counters);
  slices::search<double>(
      hash_combine(equation.seed, seed_), tries_, equation.max_roots, roots,
      [&](Rng& rng, Vector& x) { return equation.start(equation.self, rng, x); },
      [&](Vector x, Root& root) {
        minimize(x);
        slices::clamp(equation, x);
        Vector f{};
        Matrix jacobian{};
        equation.eval(equation.self, x, f, jacobian);
        root = slices::root_of_system(equation, x, jacobian);
        return slices::is_root(equation, f);
      });
}

void CeresSlices::solve(const SystemEquation& equation, Roots& roots) const {
  static_assert(kMaxUnknowns == 3);
  switch (equation.unknowns) {
    case 1:
      return solve_system<1>(equation, roots);
    case 2:
      return solve_system<2>(equation, roots);
    case 3:
      return solve_system<3>(equation, roots);
    default:
      roots.status = Status::invalid;
  }
}

void CeresSlices::solve(const ScalarEquation& equation, Roots& roots) const {
  const ScalarResidual residual{equation};
  Minimizer<ScalarResidual> minimize(tiny_, residual, &equation.lo, &equation.hi, roots.counters);
  slices::search<double>(
      hash_combine(equation.seed, seed_), tries_, equation.max_roots, roots,
      [&](Rng& rng, Vector& x) {
        x[0] = rng.uniform(equation.lo, equation.hi);
        return true;
      },
      [&](Vector x, Root& root) {
        minimize(x);
        const double inside = std::clamp(x[0], equation.lo, equation.hi);
        const Jet jet = equation(inside);
        root = slices::root_of_scalar(inside, jet);
        return slices::is_root(inside, jet);
      });
}

}  // namespace graze
