#include <graze/solvers/faithful.hpp>

#include <algorithm>

#include <graze/solvers/exact_roots.hpp>

namespace graze {
namespace {

constexpr std::uint32_t kExact = 3;  ///< as Counters::tier reports it

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
  info.places = true;
  return info;
}

Faithful::Faithful(const Parameters& options) : certified_(options) {}

void Faithful::solve(const PolynomialEquation& equation, Roots& roots) const {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
    return;
  }
  roots.counters.tier = kExact;
  if (solve_exactly(equation, roots)) return;
  certified_.solve(equation, roots);
  doubt_digits(roots);
}

void Faithful::solve(const IntervalEquation& equation, Roots& roots) const {
  certified_.solve(equation, roots);
  doubt_digits(roots);
}

}  // namespace graze
