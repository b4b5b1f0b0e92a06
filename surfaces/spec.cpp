#include <graze/surfaces/spec.hpp>

#include <array>
#include <stdexcept>
#include <vector>

#include <graze/solvers/math/expansion.hpp>

namespace graze {
namespace {

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

/// Whether the determinant is exactly zero: no rounding. Rows, then columns are scaled first, so that what
/// counts is not the units of the axes. (Entries still more than 2^-300 below the others could underflow in
/// products of three; such a matrix counts by its remaining entries.)
bool is_singular(const Mat3& matrix) {
  const Mat3 m = scaled_rows(transpose(scaled_rows(matrix)));
  const std::array<std::array<double, 3>, 3> rows{
      {{m[0].x, m[0].y, m[0].z}, {m[1].x, m[1].y, m[1].z}, {m[2].x, m[2].y, m[2].z}}};
  return exact_determinant(rows).is_zero();
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

namespace {

void scale(ParameterValue& value, double factor) {
  const auto scale_any = [factor](auto& v, const auto& self) -> void {
    using T = std::decay_t<decltype(v)>;
    if constexpr (std::is_same_v<T, double>) {
      v *= factor;
    } else if constexpr (!std::is_same_v<T, std::string> && !std::is_same_v<T, bool>) {
      for (auto& entry : v) self(entry, self);
    }
  };
  std::visit([&](auto& v) { scale_any(v, scale_any); }, value);
}

}  // namespace

Parameters scale_lengths(Parameters parameters, std::span<const Length> lengths, double factor) {
  for (const Length& length : lengths) {
    const std::string name(length.name);
    if (!parameters.has(name)) continue;
    ParameterValue value = parameters.values().at(name);
    for (int i = 0; i < length.power; ++i) scale(value, factor);
    parameters.set(name, std::move(value));
  }
  return parameters;
}

Vec3 vec3(const Parameters& parameters, const std::string& name) {
  const std::vector<double> v = parameters.list(name, 3);
  return {v[0], v[1], v[2]};
}

Vec3 vec3(const Parameters& parameters, const std::string& name, Vec3 fallback) {
  return parameters.has(name) ? vec3(parameters, name) : fallback;
}

void override_eps(const SurfaceSpec& spec, std::span<const std::string_view> names, std::span<double> eps) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto given = spec.eps.find(std::string(names[i]));
    if (given != spec.eps.end()) eps[i] = given->second;
  }
}

}  // namespace graze
