// tests/data/polynomials_hard.jsonl, and how far from a root of a nearby polynomial an answer is.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <graze/solvers/math/polynomial.hpp>
#include <graze/solvers/roots.hpp>

namespace graze {

/// p(x), p'(x) and sum |c_i x^i| in long double.
struct WideValue {
  long double value = 0, derivative = 0, size = 0;
};
inline WideValue evaluate_wide(const std::vector<double>& c, long double x) {
  WideValue p;
  for (std::size_t i = c.size(); i-- > 0;) {
    p.derivative = p.derivative * x + p.value;
    p.value = p.value * x + static_cast<long double>(c[i]);
    p.size = p.size * std::fabs(x) + std::fabs(static_cast<long double>(c[i]));
  }
  return p;
}

struct HardPolynomial {
  std::string origin;
  std::vector<double> c;
  std::vector<double> roots;            ///< the published 40 digits, rounded
  std::vector<long double> wide_roots;  ///< the same in long double

  /// What a relative change of every coefficient by n u moves root x by, to first order.
  [[nodiscard]] double condition_radius(double x) const {
    const WideValue p = evaluate_wide(c, static_cast<long double>(x));
    if (p.size == 0) return 0;  // a root at 0 stays where it is
    const double n = static_cast<double>(c.size()) - 1;
    return n * 0x1p-53 * static_cast<double>(p.size / std::fabs(p.derivative));
  }
};

/// The quoted strings of the list that follows "key": in a line of JSON.
inline std::vector<std::string> quoted_after(const std::string& line, const std::string& key) {
  const std::size_t start = line.find("\"" + key + "\":");
  if (start == std::string::npos) throw std::runtime_error("no " + key + " in: " + line);
  const std::size_t colon = start + key.size() + 3;
  const std::size_t first = line.find_first_not_of(' ', colon);
  const std::size_t end = line[first] == '[' ? line.find(']', first) : line.find(',', first);
  std::vector<std::string> strings;
  for (std::size_t open = line.find('"', first); open < end; open = line.find('"', open + 1)) {
    const std::size_t close = line.find('"', open + 1);
    strings.push_back(line.substr(open + 1, close - open - 1));
    open = close;
  }
  return strings;
}

/// Whether the origin begins like one of those.
inline bool is_one_of(const std::string& origin, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](const std::string& beginning) { return origin.rfind(beginning, 0) == 0; });
}

/// Whether doubles cannot tell the real roots: within a few n u of the coefficients lies a polynomial with
/// others. Methods that prove nothing may list those.
inline bool is_hidden(const HardPolynomial& hard) {
  return is_one_of(
      hard.origin,
      {"Wilkinson 1963, degree 20", "cluster 1 +- 2^-26", "cluster 1, 1 +- 2^-16",
       "Flocke, Algorithm 954 (2015), cubic of roots -1, 1e14",
       "Flocke, Algorithm 954 (2015), cubic of roots 1, 1e7 +- i", "Jenkins, Traub 1975, TOMS 1(1), p5",
       "Jenkins, Traub 1975, TOMS 1(1), p6", "Orellana, De Michele 2020, Algorithm 1010, case 16",
       "Orellana, De Michele 2020, Algorithm 1010, case 19",
       "Orellana, De Michele 2020, Algorithm 1010, case 20",
       "Orellana, De Michele 2020, Algorithm 1010, case 21", "Zeng 2004, TOMS 30(2), after Uhlig: (x-a^4)"});
}

inline std::vector<HardPolynomial> hard_polynomials() {
  std::ifstream file(std::string(GRAZE_TEST_DATA) + "/polynomials_hard.jsonl");
  std::vector<HardPolynomial> all;
  for (std::string line; std::getline(file, line);) {
    HardPolynomial hard;
    hard.origin = quoted_after(line, "origin").at(0);
    for (const std::string& c : quoted_after(line, "c")) hard.c.push_back(std::strtod(c.c_str(), nullptr));
    for (const std::string& x : quoted_after(line, "roots")) {
      hard.roots.push_back(std::strtod(x.c_str(), nullptr));
      hard.wide_roots.push_back(std::strtold(x.c_str(), nullptr));
    }
    all.push_back(hard);
  }
  if (all.size() < 80) throw std::runtime_error("tests/data/polynomials_hard.jsonl is not what it was");
  return all;
}

/// |p(x)| in units of n u sum |c_i x^i|: how far the coefficients are from a polynomial with the root x.
inline double backward_error(const std::vector<double>& c, double x) {
  const WideValue p = evaluate_wide(c, static_cast<long double>(x));
  return static_cast<double>(std::fabs(p.value) / p.size) / (static_cast<double>(c.size() - 1) * 0x1p-53);
}

/// Holds every root to be one of a polynomial whose coefficients are within `factor` n u.
inline void expect_nearby_roots(const HardPolynomial& hard, const Roots& roots, double factor) {
  for (const Root& root : roots.list)
    EXPECT_LE(backward_error(hard.c, root.x), factor) << hard.origin << " " << root.x;
}

/// How many of the true roots are listed within `factor` times what n u in the coefficients does to them,
/// plus 4 ulps; prints the misses.
inline std::size_t count_right(const HardPolynomial& hard, const Roots& roots, double factor) {
  std::size_t right = 0;
  for (const double x : hard.roots) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Root& root : roots.list) nearest = std::min(nearest, std::fabs(root.x - x));
    const double allowed = factor * hard.condition_radius(x) + 0x1p-50 * std::fabs(x);
    if (nearest <= allowed) {
      ++right;
    } else {
      std::printf("%s: root %.17g: nearest %.3g away, allowed %.3g\n", hard.origin.c_str(), x, nearest,
                  allowed);
    }
  }
  return right;
}

}  // namespace graze
