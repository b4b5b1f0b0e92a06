// Solvers that are no templates over their number, counted: their own sources compiled once more with double
// a number that counts (counted_sources.hpp). Such a source knows the program's types by other names, so what
// passes between the two is here in plain numbers.
//
// solves    what the solver of that name does, and adds to the count of the open CountingScope what it took
// needs     a polynomial in any basis, or inclusions
// returns   the same, bit for bit, with the same counters
// error     none: every operation on doubles at run time is counted, in doubles, double-doubles and
//           intervals; integers are none. Exact coefficients of a surface are not brought over: where a
//           ladder would ask for them, the count ends and the plain solver gives the answer
// cost      3 to 10 times the time of the solver (quartics, measured); allocates
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <graze/solvers/math/counting.hpp>

namespace graze {

/// What an equation is asked on, and how finely (solvers/equation.hpp).
struct LadderRange {
  double lo = 0, hi = 0;
  std::vector<double> region_ends, region_eps;
  double grazing_eps = 0, shallow = 0;
};
/// A polynomial equation.
struct LadderPolynomial {
  LadderRange range;
  std::span<const double> c, c_error;
  int basis = 0;
  bool has_exact = false;  ///< integers could be had: their tier gets zeros for them, and its answer is void
  double origin = 0;
  std::vector<double> near;  ///< heads, tails and bounds of the errors, in turn
};

/// An equation by inclusions: f over [lo, hi], whose own operations are not counted.
struct LadderInclusions {
  using Enclose = void (*)(const void* self, double& lo, double& hi);
  LadderRange range;
  const void* self = nullptr;
  Enclose value = nullptr, derivative = nullptr;
};

/// Roots (solvers/roots.hpp).
struct LadderRoot {
  double x = 0, radius = 0, tail = 0;
  std::uint32_t multiplicity = 1;
  bool certified = false, placed = false;
  int side = 0;
};
struct LadderAnswer {
  std::vector<LadderRoot> roots;
  int status = 0;
  std::uint32_t evaluations = 0, iterations = 0, tier = 0;
};

using LadderOption = std::pair<std::string, std::variant<double, bool, std::string>>;

class Ladder {
 public:
  virtual ~Ladder() = default;
  [[nodiscard]] virtual bool takes_polynomials() const = 0;
  [[nodiscard]] virtual bool takes_inclusions() const = 0;
  /// Add what they do to the count of the open CountingScope.
  [[nodiscard]] virtual LadderAnswer solve(const LadderPolynomial& equation) const = 0;
  [[nodiscard]] virtual LadderAnswer solve(const LadderInclusions& equation) const = 0;
};

/// certified, faithful, descartes, interval_bisection, interval_newton; null for other names.
std::unique_ptr<Ladder> make_ladder(std::string_view name, std::span<const LadderOption> options);

}  // namespace graze
