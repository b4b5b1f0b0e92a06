// What a solver returns: roots with what is known about them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace graze {

/// What an answer is worth. "No root" is `ok` with an empty list, never a NaN or a sentinel.
enum class Status : std::uint8_t {
  ok,          ///< the list is the solver's answer
  uncertain,   ///< the solver knows that it cannot decide; the list holds what it could prove
  failed,      ///< no convergence within the budget; the list holds what was found
  coincident,  ///< the equation vanishes everywhere: the ray runs inside the surface
  invalid,     ///< the input is not a question: not finite, zero direction, ...
};

/// "ok", "uncertain", ...
std::string_view to_string(Status status);

/// Work done for one equation.
struct Counters {
  std::uint32_t evaluations = 0;  ///< of the equation, with or without its derivative
  std::uint32_t iterations = 0;   ///< steps of the method: Newton steps, bisections, QR sweeps
  std::uint32_t starts = 0;       ///< start values tried, for methods that have them
  std::uint32_t tests = 0;        ///< of a surface's parts before any equation: planes, slabs, edges
  std::uint32_t tier = 0;         ///< of a ladder, the highest that was needed (certified.md)

  Counters& operator+=(const Counters& other) {
    evaluations += other.evaluations;
    iterations += other.iterations;
    starts += other.starts;
    tests += other.tests;
    tier = std::max(tier, other.tier);
    return *this;
  }
};

/// One distinct real root.
struct Root {
  double x = 0;                    ///< the root; the first unknown where there are several
  std::array<double, 2> others{};  ///< the further unknowns of a system, in its order
  double radius = 0;  ///< |x - root| <= radius: proved if `certified`, else the solver's estimate
  std::uint32_t multiplicity = 1;  ///< as far as the solver can tell; 2 = touches
  bool certified = false;          ///< [x - radius, x + radius] was proved to hold exactly this root
  /// What x leaves of the root's place l: `placed` proves that fl(origin + x + tail), with the origin of
  /// ExactCoefficients, is within 1 ulp of l and on its side of zero. 0 from solvers that place nothing.
  double tail = 0;
  bool placed = false;
  int side = 0;  ///< the sign of l - fl(origin + x + tail), if `placed`
};

/// A root found in the arithmetic of T, nothing proved.
template <class T>
Root found_root(T x, T radius, std::uint32_t multiplicity, std::array<T, 2> others = {}) {
  return {.x = static_cast<double>(x),
          .others = {static_cast<double>(others[0]), static_cast<double>(others[1])},
          .radius = static_cast<double>(radius),
          .multiplicity = multiplicity};
}

/// The answer to one equation: roots in ascending order of x.
struct Roots {
  std::vector<Root> list;
  Status status = Status::ok;
  Counters counters;

  /// Empties the answer and keeps the memory, so that solving in a loop does not allocate.
  void clear() {
    list.clear();
    status = Status::ok;
    counters = {};
  }
};

}  // namespace graze
