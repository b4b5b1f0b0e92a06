#include <graze/surfaces/spec.hpp>

#include <stdexcept>
#include <vector>

#include <graze/solvers/math/double_double.hpp>

namespace graze {
namespace {

/// Adds `term` to a non-overlapping expansion (Shewchuk 1997, GROW-EXPANSION), dropping zero parts.
void grow(std::vector<double>& expansion, double term) {
  std::vector<double> next;
  for (const double part : expansion) {
    const DoubleDouble sum = two_sum(term, part);
    if (sum.lo != 0) next.push_back(sum.lo);
    term = sum.hi;
  }
  if (term != 0) next.push_back(term);
  expansion = std::move(next);
}

/// expansion * factor as an expansion.
std::vector<double> times(const std::vector<double>& expansion, double factor) {
  std::vector<double> product;
  for (const double part : expansion) {
    const DoubleDouble exact = two_prod(part, factor);
    grow(product, exact.lo);
    grow(product, exact.hi);
  }
  return product;
}

/// Rows scaled by powers of two to a largest entry in [1, 2): changes no verdict and keeps products in range.
Mat3 scaled_rows(Mat3 m) {
  for (Vec3& row : m) {
    const double size = max_abs(row);
    if (size == 0) continue;
    const int k = -std::ilogb(size);
    row = {std::scalbn(row.x, k), std::scalbn(row.y, k), std::scalbn(row.z, k)};
  }
  return m;
}

/// Whether the determinant is exactly zero, by expansions: no rounding. (Entries more than 2^-500 below
/// their row's largest would underflow in the products; such a matrix counts by its remaining entries.)
bool is_singular(const Mat3& matrix) {
  const Mat3 m = scaled_rows(matrix);
  std::vector<double> determinant;
  const auto add_product = [&](double a, double b, double c) {
    for (const double part : times(times({a}, b), c)) grow(determinant, part);
  };
  add_product(m[0].x, m[1].y, m[2].z);
  add_product(m[0].y, m[1].z, m[2].x);
  add_product(m[0].z, m[1].x, m[2].y);
  add_product(-m[0].z, m[1].y, m[2].x);
  add_product(-m[0].x, m[1].z, m[2].y);
  add_product(-m[0].y, m[1].x, m[2].z);
  return determinant.empty();
}

}  // namespace

void check_placement(const Placement& placement) {
  if (!is_finite(placement.translate)) throw std::invalid_argument("translate is not finite");
  for (const Vec3& row : placement.matrix) {
    if (!is_finite(row)) throw std::invalid_argument("matrix is not finite");
  }
  if (is_singular(placement.matrix)) {
    throw std::invalid_argument("matrix is singular: its determinant is zero, so it has no inverse");
  }
}

void override_eps(const SurfaceSpec& spec, std::span<const std::string_view> names, std::span<double> eps) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto given = spec.eps.find(std::string(names[i]));
    if (given != spec.eps.end()) eps[i] = given->second;
  }
}

}  // namespace graze
