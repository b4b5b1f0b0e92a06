// Any surface that a polynomial in x, y, z describes: sum c x^i y^j z^k = 0 (document 004).
//
// surface       f(x, y, z) = sum of c x^i y^j z^k over terms = [[c,i,j,k],...]; terms of equal powers add
//               exactly
// needs         finite c; whole i, j, k >= 0; total degree 1 to 32 once equal terms are added
// parameters    none
// facts         at most `degree` hits of a ray that does not run inside the surface; may be unbounded
// source        document 004; see surfaces/implicit_polynomial.md
#pragma once

#include <array>
#include <span>
#include <tuple>
#include <vector>

#include <graze/surfaces/surface.hpp>

namespace graze {

struct ImplicitPolynomial;

/// f in local units: X = x 2^-unit, divided by a power of two so that the largest |c| lies in [1, 2).
class PolynomialTerms {
 public:
  static constexpr int kMaxDegree = 32;

  struct Term {
    double c = 0;
    std::array<int, 3> powers{};  ///< of x, y, z
  };

  PolynomialTerms() = default;
  /// Throws std::invalid_argument for rows [c,i,j,k] that are no such polynomial.
  explicit PolynomialTerms(std::span<const std::vector<double>> rows);

  [[nodiscard]] int degree() const { return degree_; }
  /// Exponent of the length scale L = max over lower degrees m of (max |c| of degree m / max |c| of the
  /// highest)^(1/(degree - m)), rounded down to a power of two; 0 for a homogeneous f, which has no scale.
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] bool is_homogeneous() const { return is_homogeneous_; }
  /// Descending in the powers; some may share theirs, where their sum is no double.
  [[nodiscard]] std::span<const Term> list() const { return terms_; }

 private:
  void localize();

  std::vector<Term> terms_;
  int degree_ = 0;
  int unit_ = 0;
  bool is_homogeneous_ = false;
};

/// f(p + delta d) about the recentred point, coefficients in double-double and rounded once; degree and
/// coincidence decided exactly.
struct ImplicitPolynomialRecentred {
  static FormulationInfo info();
  explicit ImplicitPolynomialRecentred(const ImplicitPolynomial& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  const PolynomialTerms* terms;
};

/// The textbook's f(o + l d) about the ray's own origin, in plain arithmetic.
struct ImplicitPolynomialPower {
  static FormulationInfo info();
  explicit ImplicitPolynomialPower(const ImplicitPolynomial& surface);
  void pose(const LocalRay& ray, EquationBlock& block) const;
  void lift(const LocalRay& ray, const Posed& posed, const Root& root, std::vector<LocalHit>& hits) const;

  const PolynomialTerms* terms;
};

struct ImplicitPolynomial {
  using Formulations = std::tuple<ImplicitPolynomialRecentred, ImplicitPolynomialPower>;

  static SurfaceInfo info();
  static Parameters scaled(const Parameters& parameters, double factor);
  explicit ImplicitPolynomial(const SurfaceSpec& spec);

  [[nodiscard]] int unit() const { return terms.unit(); }
  [[nodiscard]] double size() const;
  /// Unbounded: nothing is proved about where f vanishes.
  [[nodiscard]] static Bounds bounds() { return {}; }
  [[nodiscard]] bool clip(LocalRay& ray) const;
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  /// A crossing of one of kSampleLines seeded lines through the region about the origin, polished along the
  /// gradient. A surface that no line crosses (empty, or f a square) gives the point (L, 0, 0) instead.
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const { return marks_; }

  static constexpr int kSampleLines = 256;

  PolynomialTerms terms;

 private:
  Landmarks marks_;
  double near_ = 0;  ///< origins this near to the origin of space are not recentred: local units
};

}  // namespace graze
