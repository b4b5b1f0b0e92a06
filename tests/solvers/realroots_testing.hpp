// What the tests of the methods that isolate real roots share: solving, the published hard inputs, and how
// far from a root of a nearby polynomial an answer is.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/solvers/parameters.hpp>
#include <graze/solvers/roots.hpp>

namespace graze::realroots {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// All real roots, or those of [lo, hi].
template <class S, class T = double>
Roots solve(const S& solver, const std::vector<T>& c, double lo = -kInfinity, double hi = kInfinity,
            Basis basis = Basis::power) {
  BasicPolynomialEquation<T> equation;
  equation.c = c;
  equation.basis = basis;
  equation.lo = static_cast<T>(lo);
  equation.hi = static_cast<T>(hi);
  Roots roots;
  solver.solve(equation, roots);
  return roots;
}

struct HardPolynomial {
  std::string origin;
  std::vector<double> c;
  std::vector<double> roots;
};

/// The quoted words of the list or the word that follows "key": in one line of JSON.
inline std::vector<std::string> words_after(const std::string& line, const std::string& key) {
  std::size_t at = line.find("\"" + key + "\":");
  if (at == std::string::npos) throw std::runtime_error("no " + key + " in a line of the hard polynomials");
  at += key.size() + 3;
  const std::size_t first = line.find_first_not_of(' ', at);
  const std::size_t end = line[first] == '[' ? line.find(']', at) : line.find('"', first + 1) + 1;
  std::vector<std::string> words;
  for (std::size_t open = line.find('"', at); open < end;) {
    const std::size_t close = line.find('"', open + 1);
    words.push_back(line.substr(open + 1, close - open - 1));
    open = line.find('"', close + 1);
  }
  return words;
}

inline std::vector<HardPolynomial> hard_polynomials() {
  std::ifstream file(std::string(GRAZE_TEST_DATA) + "/polynomials_hard.jsonl");
  std::vector<HardPolynomial> all;
  for (std::string line; std::getline(file, line);) {
    const auto numbers = [&](const std::string& key) {
      std::vector<double> result;
      for (const std::string& word : words_after(line, key))
        result.push_back(std::strtod(word.c_str(), nullptr));
      return result;
    };
    all.push_back({words_after(line, "origin").front(), numbers("c"), numbers("roots")});
  }
  return all;
}

/// p(x), p'(x) and sum |c_i x^i| in long double.
struct Wide {
  long double value = 0, derivative = 0, size = 0;
};
inline Wide evaluate_wide(const std::vector<double>& c, double at) {
  const auto x = static_cast<long double>(at);
  Wide p;
  for (std::size_t i = c.size(); i-- > 0;) {
    p.derivative = p.derivative * x + p.value;
    p.value = p.value * x + static_cast<long double>(c[i]);
    p.size = p.size * std::fabs(x) + std::fabs(static_cast<long double>(c[i]));
  }
  return p;
}

/// |p(x)| in units of n u sum |c_i x^i|: how far the coefficients are from a polynomial with the root x.
inline double backward_error(const std::vector<double>& c, double x) {
  const Wide p = evaluate_wide(c, x);
  return static_cast<double>(std::fabs(p.value) / p.size) / (static_cast<double>(c.size() - 1) * 0x1p-53);
}

/// A relative change of n u of every coefficient moves the simple root x by so much.
inline double condition_unit(const std::vector<double>& c, double x) {
  const Wide p = evaluate_wide(c, x);
  return static_cast<double>(c.size() - 1) * 0x1p-53 * static_cast<double>(p.size / std::fabs(p.derivative));
}

/// Largest error of an answer in condition units; infinite where it has another number of roots.
inline double worst_error(const HardPolynomial& p, const Roots& roots) {
  if (roots.list.size() != p.roots.size()) return kInfinity;
  double worst = 0;
  for (std::size_t i = 0; i < p.roots.size(); ++i) {
    const double x = p.roots[i];
    // The stored root itself is rounded to a double.
    const double unit = condition_unit(p.c, x) + 0x1p-53 * std::fabs(x);
    worst = std::max(worst, std::fabs(roots.list[i].x - x) / unit);
  }
  return worst;
}

inline std::size_t multiplicities(const Roots& roots) {
  std::size_t sum = 0;
  for (const Root& root : roots.list) sum += root.multiplicity;
  return sum;
}

inline bool is_one_of(const std::string& origin, const std::vector<std::string>& beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](const std::string& b) { return origin.compare(0, b.size(), b) == 0; });
}

inline std::vector<double> random_coefficients(Rng& rng, int degree, double lo = -1) {
  std::vector<double> c;
  for (int k = 0; k <= degree; ++k) c.push_back(rng.uniform(lo, 1));
  return c;
}

inline int sign_changes_on_a_grid(const std::vector<double>& c, double lo, double hi, int cells) {
  int count = 0;
  for (int i = 0; i < cells; ++i) {
    const double a = lo + (hi - lo) * i / cells, b = lo + (hi - lo) * (i + 1) / cells;
    count += (evaluate_wide(c, a).value < 0) != (evaluate_wide(c, b).value < 0) ? 1 : 0;
  }
  return count;
}

/// The same answer bit for bit for p 2^k, and x 2^-m with c_i 2^(i m).
template <class S>
bool scales_exactly(const S& solver, const std::vector<double>& c, int k, int m) {
  std::vector<double> scaled;
  for (std::size_t i = 0; i < c.size(); ++i) scaled.push_back(std::ldexp(c[i], k + static_cast<int>(i) * m));
  const Roots plain = solve(solver, c), other = solve(solver, scaled);
  if (plain.list.size() != other.list.size() || plain.status != other.status) return false;
  for (std::size_t i = 0; i < plain.list.size(); ++i)
    if (std::ldexp(other.list[i].x, m) != plain.list[i].x) return false;
  return true;
}

}  // namespace graze::realroots
