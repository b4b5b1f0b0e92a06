#include <graze/surfaces/ellipsoid.hpp>

#include <cmath>

#include <graze/surfaces/sphere.hpp>

namespace graze {
namespace {

using second_degree::Coefficient;
using second_degree::ExactInverse;
using second_degree::Triple;
using ExactMatrix = std::array<Triple<Expansion>, 3>;

constexpr std::array<std::size_t, 3> kAxes{0, 1, 2};

/// floor(k / 2).
int half_exponent(int k) { return k >= 0 ? k / 2 : -((1 - k) / 2); }

/// P of the parameters in units of 2^unit, exactly; unit from its largest entry.
ExactMatrix shape_from_axes(const std::vector<double>& axes, int& unit) {
  for (const double a : axes) {
    if (a <= 0) throw std::invalid_argument("semi_axes must be positive");
  }
  unit = exponent_of(std::max({axes[0], axes[1], axes[2]}));
  ExactMatrix shape;
  for (const std::size_t i : kAxes) {
    const double a = scale_by_power(axes[i], -unit);
    shape[i][i] = Expansion(a) * a;
  }
  return shape;
}

ExactMatrix shape_from_matrix(const std::vector<std::vector<double>>& rows, int& unit) {
  if (rows.size() != 3) throw std::invalid_argument("P must have 3 rows of 3 numbers");
  double largest = 0;
  for (const std::size_t i : kAxes) {
    for (const std::size_t j : kAxes) {
      if (rows[i][j] != rows[j][i]) throw std::invalid_argument("P must be symmetric");
    }
    if (rows[i][i] <= 0) throw std::invalid_argument("P must be positive definite");
    largest = std::max(largest, rows[i][i]);
  }
  unit = half_exponent(exponent_of(largest));
  ExactMatrix shape;
  for (const std::size_t i : kAxes) {
    for (const std::size_t j : kAxes) shape[i][j] = Expansion(scale_by_power(rows[i][j], -2 * unit));
  }
  return shape;
}

ExactMatrix shape_of(const Parameters& parameters, int& unit) {
  if (parameters.has("P") == parameters.has("semi_axes")) {
    throw std::invalid_argument("P or semi_axes must be given, and not both");
  }
  if (parameters.has("semi_axes")) return shape_from_axes(parameters.list("semi_axes", 3), unit);
  return shape_from_matrix(parameters.table("P", 3), unit);
}

}  // namespace

// -------------------------------------------------------------------------------------------- formulations

EllipsoidVertex::EllipsoidVertex(const Ellipsoid& surface) : form(surface.form) {}

FormulationInfo EllipsoidVertex::info() {
  return {"vertex",
          "m.adj(P) m = det P along the ray, from the vertex of the quadratic, or from an origin close by",
          "graze (surfaces/ellipsoid.md)",
          {Form::polynomial, Form::scalar, Form::interval},
          2};
}

EllipsoidAlgebraic::EllipsoidAlgebraic(const Ellipsoid& surface) : centre(surface.form.centre) {
  const auto& p = surface.p;
  for (const std::size_t i : kAxes) {
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (const std::size_t j : kAxes) {
      const std::size_t j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      plain[j][i] = p[i1][j1] * p[i2][j2] - p[i1][j2] * p[i2][j1];
      enclosed[i][j] = surface.form.m[i][j].as<Interval>() / -surface.form.j.as<Interval>();
    }
  }
  const double determinant = p[0][0] * plain[0][0] + p[0][1] * plain[1][0] + p[0][2] * plain[2][0];
  for (auto& row : plain) {
    for (double& entry : row) entry /= determinant;
  }
}

FormulationInfo EllipsoidAlgebraic::info() {
  return {"algebraic",
          "d.P^-1 d l^2 + 2 d.P^-1 m l + m.P^-1 m - 1 about the origin, in plain arithmetic",
          "document 002",
          {Form::polynomial, Form::scalar, Form::interval},
          2};
}

void EllipsoidAlgebraic::pose(const LocalRay& ray, EquationBlock& block) const {
  second_degree::pose_about_origin(block, ray, [&](auto number) {
    using T = decltype(number);
    const std::array<T, 3> d{exactly<T>(ray.d.x), exactly<T>(ray.d.y), exactly<T>(ray.d.z)};
    const std::array<T, 3> m{exactly<T>(ray.o.x) - exactly<T>(centre.x),
                             exactly<T>(ray.o.y) - exactly<T>(centre.y),
                             exactly<T>(ray.o.z) - exactly<T>(centre.z)};
    const auto product = [&](const std::array<T, 3>& a, const std::array<T, 3>& b) {
      T sum{};
      for (const std::size_t i : kAxes) {
        for (const std::size_t j : kAxes) sum = sum + a[i] * inverse<T>(i, j) * b[j];
      }
      return sum;
    };
    return std::array<T, 3>{product(m, m) - exactly<T>(1), exactly<T>(2) * product(d, m), product(d, d)};
  });
}

void EllipsoidAlgebraic::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                              std::vector<LocalHit>& hits) const {
  second_degree::lift_from_origin(ray, root, hits);
}

// ----------------------------------------------------------------------------------------------- ellipsoid

SurfaceInfo Ellipsoid::info() {
  SurfaceInfo info;
  info.summary = "(x - center)^T P^-1 (x - center) = 1";
  info.source = "document 002";
  info.page = "surfaces/ellipsoid.md";
  info.parameters = {"center", "P", "semi_axes"};
  info.params = {"theta", "phi"};
  return info;
}

Parameters Ellipsoid::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"center"}, Length{"semi_axes"}, Length{"P", 2}};
  return scale_lengths(parameters, kLengths, factor);
}

Ellipsoid::Ellipsoid(const SurfaceSpec& spec) : centre_(vec3(spec.parameters, "center", {})) {
  const ExactMatrix shape = shape_of(spec.parameters, unit_);
  const ExactInverse inverse(shape);
  // Sylvester: all leading minors are positive.
  if (inverse.adjugate[2][2].sign() <= 0 || inverse.determinant.sign() <= 0) {
    throw std::invalid_argument(spec.parameters.has("P") ? "P must be positive definite"
                                                         : "semi_axes differ by more than double can hold");
  }
  for (const std::size_t i : kAxes) {
    for (const std::size_t j : kAxes) {
      form.m[i][j] = Coefficient(inverse.adjugate[i][j]);
      p[i][j] = shape[i][j].value();
    }
  }
  form.j = Coefficient(-inverse.determinant);
  form.centre = scale_by_power(centre_, -unit_);
  half_ = {std::sqrt(p[0][0]), std::sqrt(p[1][1]), std::sqrt(p[2][2])};
  // The largest semi-axis is at most the root of the trace; the margin covers the roundings.
  reach_ = norm(half_) * (1 + 0x1p-40);
}

Bounds Ellipsoid::bounds() const { return box_about(centre_, scale_by_power(half_, unit_)); }

LocalPoint Ellipsoid::describe(const LocalRay& ray, const LocalHit& hit) const {
  const Vec3 slope = slope_at(form, second_degree::point_on<DoubleDouble>(ray, hit.delta));
  return {normalized(slope), sphere_parameters(second_degree::seen_from(form.centre, ray, hit.delta))};
}

SurfaceSample Ellipsoid::sample(double u, double v) const {
  // P = L L^T (Cholesky) maps the unit sphere onto the ellipsoid.
  const Vec3 w = second_degree::on_unit_sphere(u, v);
  const double l00 = std::sqrt(p[0][0]), l10 = p[1][0] / l00, l20 = p[2][0] / l00;
  const double l11 = std::sqrt(std::max(0.0, p[1][1] - l10 * l10));
  const double l21 = l11 > 0 ? (p[2][1] - l20 * l10) / l11 : 0;
  const double l22 = std::sqrt(std::max(0.0, p[2][2] - l20 * l20 - l21 * l21));
  const Vec3 start = form.centre + Vec3{l00 * w.x, l10 * w.x + l11 * w.y, l20 * w.x + l21 * w.y + l22 * w.z};
  const Vec3 x = polished(form, start);
  const Vec3 slope = slope_at(form, {x.x, x.y, x.z});
  return {scale_by_power(x, unit_), normalized(slope)};
}

Landmarks Ellipsoid::landmarks() const {
  Landmarks marks;
  marks.centre = centre_;
  marks.half = scale_by_power(half_, unit_);
  const bool upright = p[0][1] == 0 && p[1][2] == 0;
  if (upright) marks.poles = {centre_ - Vec3{0, marks.half.y, 0}, centre_ + Vec3{0, marks.half.y, 0}};
  marks.has_axis = upright && p[0][2] == 0 && p[0][0] == p[2][2] && centre_.x == 0 && centre_.z == 0;
  return marks;
}

}  // namespace graze
