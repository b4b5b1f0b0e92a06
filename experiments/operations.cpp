#include "operations.hpp"

#include <graze/experiments/counted_kernel.hpp>
#include <graze/experiments/counted_solver.hpp>

#include "peers.hpp"

namespace graze {
namespace {

/// What the equations of one run took.
struct Meter {
  OperationTotals totals;
  bool is_complete = true;  ///< false: some equation was not counted
};

bool is_counted(const CountedSolver& solver, const PolynomialEquation& equation) {
  return equation.basis == Basis::power || solver.counts_any_basis();
}
template <class Equation>
bool is_counted(const CountedSolver& /*solver*/, const Equation& /*equation*/) {
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
  void solve(std::span<const IntervalEquation> e, std::span<Roots> r) const override { solve_all(e, r); }
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
      meter_.is_complete = meter_.is_complete && is_counted(*solver_, equations[i]);
      solver_->solve(equations[i], roots[i], meter_.totals.count);
      if constexpr (!std::is_same_v<Equation, PolynomialEquation>)
        meter_.totals.evaluations += roots[i].counters.evaluations;
    }
  }

  std::unique_ptr<CountedSolver> solver_;
  Meter& meter_;
};

/// The kernel of the cell, if any.
KernelEntry* kernel_of(SurfaceEntry& surface, std::string_view solver, std::string_view formulation) {
  for (KernelEntry& kernel : surface.kernels) {
    if (kernel.solver == solver && kernel.formulation == formulation) return &kernel;
  }
  return nullptr;
}

/// What is run in place of a cell.
struct CountedCell {
  SolverEntry solver;
  SurfaceEntry surface;

  /// Puts in what counts; false where nothing does.
  bool take(const SolverSpec& spec, std::string_view formulation, Meter& meter) {
    const Pairing pairing = pair_up(solver, surface, formulation, spec.precision);
    if (pairing.precision != Precision::binary64) return false;
    const std::string_view name = surface.formulations[pairing.formulation].name;
    if (KernelEntry* const kernel = kernel_of(surface, spec.name, name)) {
      const KernelEntry* const counted = find_counted_kernel(surface.name, spec.name, name);
      if (counted != nullptr) *kernel = *counted;
      return counted != nullptr;
    }
    const auto counted = make_counted_solver(spec.name, spec.options);
    if (counted == nullptr || !counted->takes(pairing.form)) return false;
    solver.make = [&meter, &spec](const Parameters& options) -> std::unique_ptr<AnySolver> {
      return std::make_unique<MeteredSolver>(make_counted_solver(spec.name, options), meter);
    };
    return true;
  }
};

}  // namespace

std::optional<OperationTotals> count_operations(const SurfaceSpec& surface, std::string_view formulation,
                                                const SolverSpec& solver, std::span<const Ray> rays,
                                                Query query) {
  if (rays.empty()) return std::nullopt;
  Meter meter;
  const SolverEntry& entry = find_solver_or_peer(solver.name);
  CountedCell cell{entry, seen_by(entry, find_surface(surface.type), query)};
  if (!cell.take(solver, formulation, meter)) return std::nullopt;
  Scene scene;
  scene.add(cell.surface, surface, cell.solver, {solver.options, std::string(formulation), solver.precision});
  Scene::Workspace work;
  HitBuffer hits;
  // Lanes count here; solvers in numbers that count do so by themselves.
  const CountingScope scope(meter.totals.count);
  scene.intersect(rays, query, {}, work, hits);
  if (!meter.is_complete) return std::nullopt;
  meter.totals.rays = rays.size();
  return meter.totals;
}

}  // namespace graze
