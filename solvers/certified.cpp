#include <graze/solvers/certified.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include <graze/solvers/exact_roots.hpp>
#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/math/quadratic.hpp>
#include <graze/solvers/math/scaling.hpp>

namespace graze {
namespace {

/// As Counters::tier reports them.
enum Tier : std::uint32_t { kDouble = 1, kExact = 3 };  // 2: double-double, as descartes.cpp reports it

double error_of(const PolynomialEquation& equation, std::size_t i) {
  return equation.c_error.empty() ? 0 : equation.c_error[i];
}

/// 4 ac = b^2 decides; Kahan's discriminant of the half coefficient is within 2u of b^2 - ac for coefficients
/// as given (solvers/closed_form.md), and their errors move it by no more than `data`.
bool discriminant_is_certain(const PolynomialEquation& equation) {
  const double a = equation.c[2], b = equation.c[1] / 2, c = equation.c[0];
  const double ea = error_of(equation, 2), eb = error_of(equation, 1) / 2, ec = error_of(equation, 0);
  if (ea == 0 && eb == 0 && ec == 0) return true;
  const double product = a * c;
  const double discriminant = std::fma(b, b, -product) + std::fma(-a, c, product);
  const double data = eb * (2 * std::fabs(b) + eb) + ea * std::fabs(c) + ec * (std::fabs(a) + ea);
  constexpr double kSlack = 1 + 0x1p-40;  // the roundings of the bound itself
  return std::isfinite(discriminant) && std::fabs(discriminant) > 0x1p-900 &&
         std::fabs(discriminant) > kSlack * data && std::fabs(a) > ea;
}

/// |x - root| for a root of the formula: its own rounding, and what the coefficients' errors leave open.
double radius_of(const PolynomialEquation& equation, std::size_t size, double x, bool is_double) {
  constexpr double kFormula = 4 * 0x1p-52;  // 4 ulps (solvers/closed_form.md)
  double sum = 0, slope = 0;
  for (std::size_t i = size; i-- > 0;) {
    sum = sum * std::fabs(x) + error_of(equation, i);
    if (i > 0) slope = slope * x + static_cast<double>(i) * equation.c[i];
  }
  // Twice: |p'| shrinks by no more than half within a radius that is a quarter of the roots' distance
  // (solve_by_formula sees to that), or where it is known to half (degree 1).
  return kFormula * std::fabs(x) + (is_double || sum == 0 ? 0 : 2 * sum / std::fabs(slope));
}

/// Degree 1 or 2 by formula; false where it proves nothing.
bool solve_by_formula(const PolynomialEquation& equation, std::size_t size, Roots& roots) {
  std::array<double, 2> x{};
  int count = 1;
  if (size == 2) {
    if (!(std::fabs(equation.c[1]) > 2 * error_of(equation, 1))) return false;
    x[0] = -equation.c[0] / equation.c[1];
  } else {
    if (!discriminant_is_certain(equation)) return false;
    count = scaled_quadratic(equation.c[2], equation.c[1] / 2, equation.c[0], x);
  }
  ++roots.counters.evaluations;  // of the formula
  const bool is_double = size == 3 && count == 1;
  if (count == 2 && x[1] < x[0]) std::swap(x[0], x[1]);
  for (int i = 0; i < count; ++i) {
    const double root = x[static_cast<std::size_t>(i)];
    const double radius = radius_of(equation, size, root, is_double);
    if (!std::isfinite(root) || !std::isfinite(radius)) return false;
    const bool outside = root + radius < equation.lo || root - radius > equation.hi;
    const bool inside = root - radius >= equation.lo && root + radius <= equation.hi;
    if (!outside && !inside) return false;
    if (count == 2 && !(x[0] + 2 * radius < x[1] - 2 * radius)) return false;
    if (outside) continue;
    roots.list.push_back(
        {.x = root, .others = {}, .radius = radius, .multiplicity = is_double ? 2U : 1U, .certified = true});
  }
  return true;
}

/// Whether a proved root may lie on either side of l = 0, or anywhere in a wide part of the ray: the count of
/// hits hangs on it.
bool leaves_doubt(const Root& root, double origin) {
  constexpr double kLocated = 0x1p-24;  // well within what GroupModel::in_doubt lets pass
  const double size = std::fabs(origin) + std::fabs(root.x);
  if (root.radius == 0 && root.x == -origin) return false;
  const double reach = root.radius + 0x1p-52 * size;
  return std::fabs(origin + root.x) <= 2 * reach || !(root.radius <= kLocated * (1 + size));
}

/// The count is proved; is that of the hits, where the equation's exact coefficients could tell?
bool is_settled(const PolynomialEquation& equation, const Roots& roots) {
  if (roots.status == Status::uncertain) return false;
  if (equation.exact.get == nullptr) return true;
  return std::none_of(roots.list.begin(), roots.list.end(),
                      [&](const Root& root) { return leaves_doubt(root, equation.exact.origin); });
}

/// Whether l is known to within 3.5 units of 2^-52 |l|, its own rounding included: half a unit less than
/// promised.
bool is_sharp(const PolynomialEquation& equation, const Root& root) {
  return root.placed || root.radius <= 3 * 0x1p-52 * std::fabs(equation.exact.origin + root.x);
}

/// Gives roots that their enclosure leaves open by more than a few ulps of l their digits, from double-double
/// where it may be used. False where one stays open, or two get one l, and exact coefficients could tell.
bool sharpen(const PolynomialEquation& equation, bool in_double_double, Roots& roots) {
  if (equation.exact.near.empty() || equation.basis != Basis::power) return true;
  return place_each(equation, roots.list, [&](Root& root) {
    return is_sharp(equation, root) || (in_double_double && place_root(equation, root));
  });
}

/// The option that the tiers' own methods share.
Parameters budget_of(const Parameters& options) {
  Parameters own;
  if (options.has("budget")) own.set("budget", options.number("budget"));
  return own;
}

}  // namespace

SolverInfo Certified::info() {
  SolverInfo info;
  info.summary = "the right number of roots, proved: double, then exact arithmetic";
  info.source = "graze (solvers/certified.md)";
  info.page = "solvers/certified.md";
  info.options = {{"budget", "20000", "evaluations of the first tier"},
                  {"double_double", "true", "whether tier 2 is used; false: to measure what it saves"},
                  {"instruction_set", "best", "of the surfaces' kernels: best, baseline, avx2, avx512"}};
  info.claims = {.finds_touching_roots = true, .certified = true, .deterministic = true};
  info.forms = {Form::polynomial, Form::interval};
  info.trusts_surface = true;
  info.digits = Digits::near;
  return info;
}

InstructionSet Certified::instruction_set(const Parameters& options) {
  const std::string name = options.word("instruction_set", "best");
  const InstructionSet best = best_instruction_set();
  if (name == "best") return best;
  for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    if (name != to_string(set)) continue;
    if (set <= best) return set;
    throw std::invalid_argument("option 'instruction_set': this processor has no " + name);
  }
  throw std::invalid_argument("option 'instruction_set' must be best, baseline, avx2 or avx512, not '" +
                              name + "'");
}

Certified::Certified(const Parameters& options)
    : double_double_(options.flag("double_double", true)),
      variations_(budget_of(options)),
      inclusions_(budget_of(options)) {
  static_cast<void>(instruction_set(options));
}

void Certified::solve(const PolynomialEquation& equation, Roots& roots) const {
  if (!is_usable(equation)) {
    roots.status = Status::invalid;
    return;
  }
  roots.counters.tier = kDouble;
  const std::size_t size = static_cast<std::size_t>(effective_degree(equation.c)) + 1;  // -1: none
  // A leading zero that is known with an error only leaves the degree open.
  const bool is_degree = effective_degree(equation.c_error) < static_cast<int>(size);
  const bool is_short = equation.basis == Basis::power && is_degree && (size == 2 || size == 3);
  if (!(is_short && solve_by_formula(equation, size, roots))) {
    roots.list.clear();
    solve_by_signs(equation, roots);
    roots.counters.tier = std::max<std::uint32_t>(roots.counters.tier, kDouble);
  }
  if (is_settled(equation, roots) && sharpen(equation, double_double_, roots)) return;
  const std::optional<ExactPolynomial> exact = exact_polynomial(equation);
  if (!exact) return;
  roots.list.clear();
  roots.counters.tier = kExact;
  add_exact_roots(*exact, equation, roots);
}

/// By variations of sign; by inclusions where there are too many coefficients for that. Chebyshev equations
/// of too high a degree fail in either.
void Certified::solve_by_signs(const PolynomialEquation& equation, Roots& roots) const {
  if (equation.c.size() <= kMaxBernsteinSize) {
    PolynomialEquation signs = equation;
    if (!double_double_) signs.exact.near = {};
    variations_.solve(signs, roots);
  } else {
    inclusions_.solve(equation, roots);
  }
}

void Certified::solve(const IntervalEquation& equation, Roots& roots) const {
  inclusions_.solve(equation, roots);
  roots.counters.tier = kDouble;
}

}  // namespace graze
