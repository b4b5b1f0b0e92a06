// What the tests of the methods that find all complex roots share: the published hard inputs, polynomials
// from their roots, and errors measured in long double.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/power_basis.hpp>
#include <graze/solvers/solver.hpp>
#include <solvers/hard_polynomials.hpp>

namespace graze::complex_cases {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far a relative change of every coefficient by kBackward n u moves the simple root x, and two ulps.
inline long double attainable(const std::vector<double>& c, long double x) {
  const WideValue p = evaluate_wide(c, x);
  const double units = power_basis::kBackward * static_cast<double>(c.size() - 1) * 0x1p-53;
  return static_cast<long double>(units) * p.size / std::fabs(p.derivative) + 0x1p-51L * std::fabs(x);
}

/// Every true root is listed within what is attainable and nothing else is; "" or what is wrong.
inline std::string difference(const HardPolynomial& hard, const Roots& roots) {
  if (roots.status != Status::ok) return "status " + std::string(to_string(roots.status));
  if (roots.list.size() != hard.wide_roots.size()) {
    return std::to_string(roots.list.size()) + " roots instead of " + std::to_string(hard.wide_roots.size());
  }
  for (std::size_t i = 0; i < hard.wide_roots.size(); ++i) {
    const long double error = std::fabs(static_cast<long double>(roots.list[i].x) - hard.wide_roots[i]);
    if (error > attainable(hard.c, hard.wide_roots[i])) {
      return "root " + std::to_string(i) + " is off by " + std::to_string(static_cast<double>(error));
    }
  }
  return {};
}

template <class S>
Roots solve(const std::vector<double>& c, const Parameters& options = {}, double lo = -kInfinity,
            double hi = kInfinity) {
  PolynomialEquation equation;
  equation.c = c;
  equation.lo = lo;
  equation.hi = hi;
  Roots roots;
  S(options).solve(equation, roots);
  return roots;
}

/// A hard case that a method may miss: how its origin begins, how many roots it lists then, and why.
struct Excused {
  std::string origin;
  std::size_t listed;
  std::string reason;
};

/// Every hard case is right, or is excused, goes wrong in the way it is excused for, and in no other; or its
/// roots are hidden, and those listed are as good.
template <class S>
void expect_hard_cases(const std::vector<Excused>& excused, const Parameters& options = {}) {
  const std::vector<HardPolynomial> cases = hard_polynomials();
  ASSERT_GE(cases.size(), 21U);
  std::size_t used = 0;
  for (const HardPolynomial& hard : cases) {
    const Roots roots = solve<S>(hard.c, options);
    const std::string wrong = difference(hard, roots);
    const auto found = std::find_if(excused.begin(), excused.end(), [&](const Excused& e) {
      return hard.origin.compare(0, e.origin.size(), e.origin) == 0;
    });
    // Its powers leave the doubles, and a method may say so.
    const bool is_extreme = is_one_of(hard.origin, {"Orellana, De Michele 2020, Algorithm 1010, case 22"});
    if (is_extreme && roots.status == Status::failed) continue;
    if (found == excused.end() && is_hidden(hard)) {
      EXPECT_EQ(roots.status, Status::ok) << hard.origin;
      EXPECT_GE(roots.list.size(), hard.roots.empty() ? 0U : 1U) << hard.origin;
      expect_nearby_roots(hard, roots, power_basis::kBackward);
      continue;
    }
    if (found == excused.end()) {
      EXPECT_EQ(wrong, "") << hard.origin;
      continue;
    }
    ++used;
    EXPECT_NE(wrong, "") << hard.origin << " needs no excuse: " << found->reason;
    EXPECT_EQ(roots.status, Status::ok) << hard.origin;
    EXPECT_EQ(roots.list.size(), found->listed) << hard.origin << ": " << found->reason;
  }
  EXPECT_EQ(used, excused.size()) << "an excuse names no case";
}

/// prod (x - r), rounded to double coefficient by coefficient from long double.
inline std::vector<double> with_roots(const std::vector<double>& roots, std::vector<long double> c = {1}) {
  for (const double r : roots) {
    c.insert(c.begin(), 0);
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= static_cast<long double>(r) * c[i + 1];
  }
  return {c.begin(), c.end()};
}

/// Largest backward error of the roots listed for random polynomials of degree 1 to 12, coefficients uniform
/// in [-1, 1].
template <class S>
double worst_backward_error(const Parameters& options = {}) {
  constexpr std::uint64_t kSeed = 20261122;
  Rng rng(kSeed);
  double worst = 0;
  std::size_t count = 0;
  for (int i = 0; i < 3000; ++i) {
    const int degree = 1 + static_cast<int>(rng.uniform() * 12);
    std::vector<double> c;
    for (int k = 0; k <= degree; ++k) c.push_back(rng.uniform(-1, 1));
    const Roots roots = solve<S>(c, options);
    EXPECT_EQ(roots.status, Status::ok) << i;
    // An odd degree has an odd number of real roots, an even one an even number.
    std::size_t real = 0;
    for (const Root& root : roots.list) {
      worst = std::max(worst, backward_error(c, root.x));
      real += root.multiplicity;
    }
    EXPECT_EQ(real % 2, c.size() % 2 == 0 ? 1U : 0U) << i;
    count += real;
  }
  std::printf("seed %llu: %zu roots, worst backward error %.3g n u\n", static_cast<unsigned long long>(kSeed),
              count, worst);
  EXPECT_GT(count, 3000U);
  return worst;
}

/// Coefficients times 2^power, x times 2^shift.
inline std::vector<double> scaled(std::vector<double> c, int power, int shift) {
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = std::ldexp(c[i], power - static_cast<int>(i) * shift);
  return c;
}

/// Powers of two, in p and in x, change no bit of the answer but its exponents.
template <class S>
void expect_scaling_is_exact(const Parameters& options = {}) {
  Rng rng(20261123);
  for (int i = 0; i < 300; ++i) {
    const int degree = 1 + static_cast<int>(rng.uniform() * 8);
    std::vector<double> c;
    for (int k = 0; k <= degree; ++k) c.push_back(rng.uniform(-1, 1));
    const Roots plain = solve<S>(c, options);
    for (const auto& [power, shift] :
         {std::pair{900, 0}, std::pair{-900, 0}, std::pair{0, 1}, std::pair{0, -1}, std::pair{100, 50}}) {
      const Roots roots = solve<S>(scaled(c, power, shift), options);
      ASSERT_EQ(roots.list.size(), plain.list.size()) << i;
      EXPECT_EQ(roots.status, plain.status) << i;
      for (std::size_t k = 0; k < plain.list.size(); ++k) {
        EXPECT_EQ(roots.list[k].x, std::ldexp(plain.list[k].x, shift)) << i << " " << power << " " << shift;
        EXPECT_EQ(roots.list[k].multiplicity, plain.list[k].multiplicity) << i;
      }
    }
  }
}

}  // namespace graze::complex_cases
