#include "operations.hpp"

#include <algorithm>

#include <graze/experiments/counted_solver.hpp>

#include "peers.hpp"

namespace graze {
namespace {

/// What the equations of one run took.
struct Meter {
  OperationTotals totals;
  bool is_complete = true;  ///< false: some equation was not counted
};

bool is_counted(const PolynomialEquation& equation) { return equation.basis == Basis::power; }
template <class Equation>
bool is_counted(const Equation& /*equation*/) {
  return true;
}

/// Stands in for the solver in a scene: the same answers, and the meter runs.
class MeteredSolver final : public AnySolver {
 public:
  MeteredSolver(std::unique_ptr<CountedSolver> solver, Meter& meter)
      : solver_(std::move(solver)), meter_(meter) {}

  [[nodiscard]] bool takes(Form form, Precision precision) const override {
    return precision == Precision::binary64 && solver_->takes(form);
  }
  void solve(std::span<const PolynomialEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const ScalarEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const SystemEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
  void solve(std::span<const IntervalEquation> /*e*/, std::span<Roots> /*r*/) const override { refuse(); }
  void solve(std::span<const BasicPolynomialEquation<float>> /*e*/, std::span<Roots> /*r*/) const override {
    refuse();
  }
  void solve(std::span<const BasicScalarEquation<float>> /*e*/, std::span<Roots> /*r*/) const override {
    refuse();
  }
  void solve(std::span<const BasicSystemEquation<float>> /*e*/, std::span<Roots> /*r*/) const override {
    refuse();
  }

 private:
  [[noreturn]] static void refuse() { throw std::logic_error("graze: form and arithmetic are not counted"); }

  template <class Equation>
  void solve_all(std::span<const Equation> equations, std::span<Roots> roots) const {
    for (std::size_t i = 0; i < equations.size(); ++i) {
      roots[i].clear();
      meter_.is_complete = meter_.is_complete && is_counted(equations[i]);
      solver_->solve(equations[i], roots[i], meter_.totals.count);
      if constexpr (!std::is_same_v<Equation, PolynomialEquation>)
        meter_.totals.evaluations += roots[i].counters.evaluations;
    }
  }

  std::unique_ptr<CountedSolver> solver_;
  Meter& meter_;
};

bool has_kernel(const SurfaceEntry& surface, std::string_view solver, std::string_view formulation) {
  return std::any_of(surface.kernels.begin(), surface.kernels.end(), [&](const KernelEntry& kernel) {
    return kernel.solver == solver && kernel.formulation == formulation;
  });
}

}  // namespace

std::optional<OperationTotals> count_operations(const SurfaceSpec& surface, std::string_view formulation,
                                                const SolverSpec& solver, std::span<const Ray> rays,
                                                Query query) {
  const auto counted = make_counted_solver(solver.name, solver.options);
  if (counted == nullptr || rays.empty()) return std::nullopt;
  SolverEntry entry = find_solver_or_peer(solver.name);
  const SurfaceEntry seen = seen_by(entry, find_surface(surface.type), query);
  const Pairing pairing = pair_up(entry, seen, formulation, solver.precision);
  const std::string_view name = seen.formulations[pairing.formulation].name;
  if (pairing.precision != Precision::binary64 || !counted->takes(pairing.form) ||
      has_kernel(seen, solver.name, name))
    return std::nullopt;

  Meter meter;
  entry.make = [&meter, &solver](const Parameters& options) -> std::unique_ptr<AnySolver> {
    return std::make_unique<MeteredSolver>(make_counted_solver(solver.name, options), meter);
  };
  Scene scene;
  scene.add(seen, surface, entry, {solver.options, std::string(formulation), solver.precision});
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, query, {}, work, hits);
  if (!meter.is_complete) return std::nullopt;
  meter.totals.rays = rays.size();
  return meter.totals;
}

}  // namespace graze
