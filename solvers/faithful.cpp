#include <graze/solvers/faithful.hpp>

#include <algorithm>
#include <optional>

#include <graze/solvers/exact_roots.hpp>

namespace graze {
namespace {

/// As Counters::tier reports them.
enum Tier : std::uint32_t { kDoubleDouble = 2, kExact = 3 };

/// Proved roots whose digits are not proved are no answer.
void doubt_digits(Roots& roots) {
  const auto is_placed = [](const Root& root) { return root.placed || root.radius == 0; };
  if (roots.status == Status::ok && !std::all_of(roots.list.begin(), roots.list.end(), is_placed))
    roots.status = Status::uncertain;
}

}  // namespace

SolverInfo Faithful::info() {
  SolverInfo info = Certified::info();
  info.summary = "every root, its l within 1 ulp: certified, then the digits of the exact root";
  info.source = "graze (solvers/faithful.md)";
  info.page = "solvers/faithful.md";
  info.digits = Digits::placed;
  return info;
}

Faithful::Faithful(const Parameters& options) : certified_(options) {}

void Faithful::solve(const PolynomialEquation& equation, Roots& roots) const {
  certified_.solve(equation, roots);
  if (roots.status == Status::invalid || roots.status == Status::coincident) return;
  if (roots.counters.tier == kExact || (roots.status == Status::ok && roots.list.empty())) return;
  const auto place = [&](Root& root) { return place_root(equation, root); };
  if (roots.status == Status::ok && place_each(equation, roots.list, place)) {
    roots.counters.tier = kDoubleDouble;
    return;
  }
  const std::optional<ExactPolynomial> exact = exact_polynomial(equation);
  if (!exact) return doubt_digits(roots);
  roots.list.clear();
  roots.counters.tier = kExact;
  add_exact_roots(*exact, equation, roots);
}

void Faithful::solve(const IntervalEquation& equation, Roots& roots) const {
  certified_.solve(equation, roots);
  doubt_digits(roots);
}

}  // namespace graze
