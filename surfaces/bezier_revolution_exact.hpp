// A Bezier profile and one ray in exact integers: the last tier of the certified ladder
// (surfaces/bezier_revolution.md, "Kernel").
//
// solves    d_y^2 R(t)^2 = |d_xz (Y(t) - o_y) + d_y o_xz|^2 in [0, 1], l = (Y(t) - o_y) / d_y; where d_y = 0,
//           Y(t) = o_y and then |o_xz + l d_xz|^2 = R(t)^2
// needs     finite control points, at least 2, of any degree; a ray of finite numbers, d != 0
// returns   every hit with l > 0, ascending, with its multiplicity, the sum over the sheets that pass there:
//           of a root of the equation, 2 for a touch; at an end of the profile on the axis 2 if the line
//           touches there, 1 if it passes inside. No value where the ray runs inside the surface
// error     none: l is a function of a root, known to any number of digits
// cost      measured by tests/experiments/bezier_revolution_exact_test.cpp; allocates
// source    document 003's surface with document 000's equation, as formulation `polynomial`; isolation as in
//           solvers/math/exact_polynomial.hpp; hits that meet in one point by resultants
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <graze/solvers/math/exact_polynomial.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// l = (c + f(p(t))) 2^e / a at a root t of a polynomial, where f is the identity or a square root of either
/// sign. Known by an enclosure that narrows as asked.
class BezierLength {
 public:
  enum class Form : std::uint8_t { value, root, minus_root };
  struct Formula {
    std::shared_ptr<const ExactPolynomial> p;
    BigInteger c, a;  ///< a > 0
    long e = 0;
    Form form = Form::value;
  };

  /// Needs: l > 0; p(t) > 0 where its root is taken.
  BezierLength(Formula formula, RealRoot t);

  [[nodiscard]] const RealRoot& t() const { return t_; }
  [[nodiscard]] const ExactPolynomial& p() const { return *formula_.p; }
  [[nodiscard]] Form form() const { return formula_.form; }
  /// 0 <= lo <= l <= hi.
  [[nodiscard]] const Dyadic& lo() const { return lo_; }
  [[nodiscard]] const Dyadic& hi() const { return hi_; }
  /// Makes hi - lo <= 2^-digits lo.
  void refine(long digits);
  /// -1, 0, 1: the sign of l - x, exactly.
  [[nodiscard]] int compare_with(const Dyadic& x) const;
  /// The double nearest to l, ties to even.
  double to_double();

 private:
  [[nodiscard]] DyadicBounds enclosure(long digits) const;

  Formula formula_;
  RealRoot t_;
  Dyadic lo_, hi_;
  bool is_known_ = false;
};

struct ExactBezierHit {
  BezierLength l;  ///< in units of |d|; l.t() is a place of the profile where it is
  std::uint32_t multiplicity = 1;
};

class ExactBezierRevolution {
 public:
  using Hits = std::optional<std::vector<ExactBezierHit>>;

  /// Control points (r, y).
  explicit ExactBezierRevolution(std::span<const std::array<double, 2>> control_points);
  [[nodiscard]] Hits hits(const Ray& ray) const;

 private:
  struct Line;
  [[nodiscard]] Hits climbing(const Line& line) const;
  [[nodiscard]] Hits horizontal(const Line& line) const;
  [[nodiscard]] Hits through_plane(const Line& line) const;
  [[nodiscard]] static Hits in_plane(const Line& line);

  ExactPolynomial r_, y_, r_squared_, y_squared_;  ///< in units of 2^unit_, and of its square
  long unit_ = 0;
  bool y_is_monotone_ = false;  ///< strictly, on [0, 1]
};

}  // namespace graze
