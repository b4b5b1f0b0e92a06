// A Chebyshev equation in the Bernstein basis of the same interval, for methods that prove what they say and
// know no Chebyshev basis of their own.
//
// solves    nothing: the copy has the same roots, and its c_error holds what the change of basis rounded
// needs     a usable equation in the Chebyshev basis, of degree up to kMaxChebyshevDegree
// returns   equation(), a view of the copy; without `exact`, which would be in the wrong basis
// error     bounds by chebyshev_to_bernstein
// cost      n^2/2 weighted sums; no allocation
// source    solvers/math/chebyshev.hpp
#pragma once

#include <array>

#include <graze/solvers/equation.hpp>
#include <graze/solvers/math/chebyshev.hpp>

namespace graze {

class BernsteinCopy {
 public:
  /// Whether the degree is within the limit.
  static bool suits(const PolynomialEquation& equation) { return equation.c.size() <= kMaxChebyshevSize; }

  explicit BernsteinCopy(const PolynomialEquation& equation) : equation_(equation) {
    const std::span<double> b(b_.data(), equation.c.size()), b_error(b_error_.data(), equation.c.size());
    chebyshev_to_bernstein(equation.c, equation.c_error, b, b_error);
    equation_.c = b;
    equation_.c_error = b_error;
    equation_.basis = Basis::bernstein;
    equation_.exact = {};
  }
  BernsteinCopy(const BernsteinCopy&) = delete;
  BernsteinCopy& operator=(const BernsteinCopy&) = delete;

  [[nodiscard]] const PolynomialEquation& equation() const { return equation_; }

 private:
  PolynomialEquation equation_;
  std::array<double, kMaxChebyshevSize> b_{}, b_error_{};
};

}  // namespace graze
