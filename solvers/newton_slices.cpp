#include <graze/solvers/newton_slices.hpp>

#include <cmath>

namespace graze {
namespace {

/// Newton from x until the residual stops shrinking; true if it is a root then.
template <class T>
bool iterate(const BasicSystemEquation<T>& equation, BasicVector<T> x, Root& root, Counters& counters) {
  const auto n = static_cast<std::size_t>(equation.unknowns);
  BasicVector<T> f{};
  BasicMatrix<T> jacobian{};
  T last = std::numeric_limits<T>::infinity();
  int worse = 0;
  for (int step = 0; step < NewtonSlices::kSteps; ++step) {
    equation.eval(equation.self, x, f, jacobian);
    ++counters.evaluations;
    const T residual = slices::max_norm(f, equation.unknowns);
    // At the rounding level a step that no longer helps ends the iteration; before it, a few may go uphill.
    worse = residual < last ? 0 : worse + 1;
    if (slices::is_root(equation, f) && (worse > 0 || residual == 0)) break;
    if (worse > 8 || !std::isfinite(residual)) return false;
    last = residual;
    BasicVector<T> move{};
    if (!slices::solve_linear(jacobian, f, equation.unknowns, move)) break;
    for (std::size_t i = 0; i < n; ++i)
      x[i] = slices::step_inside(x[i], -move[i], equation.lo[i], equation.hi[i]);
    ++counters.iterations;
  }
  if (!slices::is_root(equation, f)) return false;
  root = slices::root_of_system(equation, x, jacobian);
  return std::isfinite(root.x);
}

/// The top of f's parabola at x, where a touching root is.
template <class T>
T vertex(T x, const BasicJet<T>& jet, const BasicScalarEquation<T>& equation) {
  return std::clamp(x - jet.df / jet.ddf, equation.lo, equation.hi);
}

/// Newton in one unknown, kept in [lo, hi].
template <class T>
bool iterate(const BasicScalarEquation<T>& equation, T x, Root& root, Counters& counters) {
  BasicJet<T> jet = equation(x);
  ++counters.evaluations;
  for (int step = 0; step < NewtonSlices::kSteps; ++step) {
    if (jet.df == 0 || !std::isfinite(jet.f)) break;
    const T next = slices::step_inside(x, -jet.f / jet.df, equation.lo, equation.hi);
    if (next == x) break;
    const BasicJet<T> there = equation(next);
    ++counters.evaluations;
    ++counters.iterations;
    if (slices::is_root(x, jet) && std::fabs(there.f) >= std::fabs(jet.f)) break;
    x = next;
    jet = there;
  }
  if (!slices::is_root(x, jet)) return false;
  root = slices::root_of_scalar(x, jet);
  if (root.multiplicity == 2 && jet.ddf != 0) root.x = static_cast<double>(vertex(x, jet, equation));
  return std::isfinite(root.x);
}

}  // namespace

SolverInfo NewtonSlices::info() {
  SolverInfo info;
  info.summary = "Newton from random slices of the bounding cylinder";
  info.source = "document 003";
  info.page = "solvers/newton_slices.md";
  info.options = {{"tries", "30", "random starts"}, {"seed", "0", "changes every ray's starts"}};
  info.claims = {.finds_touching_roots = true, .certified = false, .deterministic = false};
  info.forms = {Form::system, Form::scalar};
  return info;
}

NewtonSlices::NewtonSlices(const Parameters& options)
    : tries_(options.integer("tries", slices::kDefaultTries, 1, 1000000)),
      seed_(static_cast<std::uint64_t>(options.integer("seed", 0, 0, 2000000000))) {}

template <class T>
void NewtonSlices::solve(const BasicSystemEquation<T>& equation, Roots& roots) const {
  slices::search<T>(
      hash_combine(equation.seed, seed_), tries_, equation.max_roots, roots,
      [&](Rng& rng, BasicVector<T>& x) { return equation.start(equation.self, rng, x); },
      [&](const BasicVector<T>& x, Root& root) { return iterate(equation, x, root, roots.counters); });
}

template <class T>
void NewtonSlices::solve(const BasicScalarEquation<T>& equation, Roots& roots) const {
  slices::search<T>(
      hash_combine(equation.seed, seed_), tries_, equation.max_roots, roots,
      [&](Rng& rng, BasicVector<T>& x) {
        x[0] =
            static_cast<T>(rng.uniform(static_cast<double>(equation.lo), static_cast<double>(equation.hi)));
        return true;
      },
      [&](const BasicVector<T>& x, Root& root) { return iterate(equation, x[0], root, roots.counters); });
}

template void NewtonSlices::solve(const BasicSystemEquation<double>&, Roots&) const;
template void NewtonSlices::solve(const BasicSystemEquation<float>&, Roots&) const;
template void NewtonSlices::solve(const BasicScalarEquation<double>&, Roots&) const;
template void NewtonSlices::solve(const BasicScalarEquation<float>&, Roots&) const;

}  // namespace graze
