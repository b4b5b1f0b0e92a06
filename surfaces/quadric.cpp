#include <graze/surfaces/quadric.hpp>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>

namespace graze {
namespace {

using second_degree::Coefficient;
using second_degree::ExactInverse;
using second_degree::Triple;
using ExactMatrix = std::array<Triple<Expansion>, 3>;

constexpr std::array<std::size_t, 3> kAxes{0, 1, 2};
constexpr std::array<const char*, 10> kNames{"A", "B", "C", "D", "E", "F", "G", "H", "I", "J"};
enum Index : std::size_t { kA, kB, kC, kD, kE, kF, kG, kH, kI, kJ };
using Coefficients = std::array<double, 10>;

double largest(const Coefficients& c, std::initializer_list<Index> which) {
  double size = 0;
  for (const Index i : which) size = std::max(size, std::fabs(c[i]));
  return size;
}
double largest_quadratic(const Coefficients& c) { return largest(c, {kA, kB, kC, kE, kF, kH}); }
double largest_linear(const Coefficients& c) { return largest(c, {kD, kG, kI}); }

/// floor(k / 2).
int half_exponent(int k) { return k >= 0 ? k / 2 : -((1 - k) / 2); }

/// Exponent of the length scale: the larger of linear/quadratic and sqrt(constant/quadratic) part, or
/// constant/linear for a plane; 0 for a cone about the origin and its like, which have no scale.
int length_exponent(const Coefficients& c) {
  const double q = largest_quadratic(c), g = largest_linear(c), j = std::fabs(c[kJ]);
  if (q == 0) return g > 0 && j > 0 ? exponent_of(j) - exponent_of(g) : 0;
  std::optional<int> k;
  if (g > 0) k = exponent_of(g) - exponent_of(q);
  if (j > 0) {
    const int from_constant = half_exponent(exponent_of(j) - exponent_of(q));
    k = k ? std::max(*k, from_constant) : from_constant;
  }
  return k.value_or(0);
}

/// The same surface in units of 2^unit, its largest part of size 1: f(2^unit x) 2^-k, exactly.
Coefficients in_units(Coefficients c, int unit) {
  const double q = largest_quadratic(c), g = largest_linear(c);
  const int k = q > 0 ? exponent_of(q) + 2 * unit : g > 0 ? exponent_of(g) + unit : exponent_of(c[kJ]);
  for (const Index i : {kA, kB, kC, kE, kF, kH}) c[i] = scale_by_power(c[i], 2 * unit - k);
  for (const Index i : {kD, kG, kI}) c[i] = scale_by_power(c[i], unit - k);
  c[kJ] = scale_by_power(c[kJ], -k);
  return c;
}

ExactMatrix quadratic_part(const Coefficients& c) {
  const auto x = [&](Index i) { return Expansion(c[i]); };
  return {{{x(kA), x(kB), x(kC)}, {x(kB), x(kE), x(kF)}, {x(kC), x(kF), x(kH)}}};
}
Triple<Expansion> linear_part(const Coefficients& c) {
  return {Expansion(c[kD]), Expansion(c[kG]), Expansion(c[kI])};
}

// ------------------------------------------------------------------------------------------------- inertia

/// How many eigenvalues are positive and negative.
struct Inertia {
  int positive = 0, negative = 0;

  [[nodiscard]] int rank() const { return positive + negative; }
  [[nodiscard]] Inertia flipped() const { return {negative, positive}; }
  friend bool operator==(const Inertia&, const Inertia&) = default;
};

/// Changes of sign from one non-zero number to the next.
template <std::size_t N>
int sign_changes(const std::array<int, N>& signs) {
  int changes = 0, last = 0;
  for (const int s : signs) {
    if (s == 0) continue;
    if (last == -s) ++changes;
    last = s;
  }
  return changes;
}

/// Inertia of a symmetric matrix from the signs of its sums of principal minors e_1 ... e_n. The
/// characteristic polynomial x^n - e_1 x^(n-1) + e_2 x^(n-2) - ... has real roots only, so Descartes' rule
/// counts exactly.
template <std::size_t N>
Inertia inertia_of(const std::array<int, N>& minors) {
  std::array<int, N + 1> at_plus{1}, at_minus{1};
  for (std::size_t i = 0; i < N; ++i) {
    at_plus[i + 1] = i % 2 == 0 ? -minors[i] : minors[i];
    at_minus[i + 1] = minors[i];
  }
  return {sign_changes(at_plus), sign_changes(at_minus)};
}

/// What both matrices give: M, its adjugate and determinant, and the determinant of the 4x4 matrix.
struct Invariants {
  ExactMatrix m;
  Triple<Expansion> g;
  Expansion j;
  ExactInverse inverse;
  Triple<Expansion> adjugate_g;
  Expansion determinant4;

  explicit Invariants(const Coefficients& c)
      : m(quadratic_part(c)), g(linear_part(c)), j(Expansion(c[kJ])), inverse(m) {
    for (const std::size_t i : kAxes) {
      adjugate_g[i] =
          inverse.adjugate[i][0] * g[0] + inverse.adjugate[i][1] * g[1] + inverse.adjugate[i][2] * g[2];
    }
    determinant4 =
        j * inverse.determinant - (g[0] * adjugate_g[0] + g[1] * adjugate_g[1] + g[2] * adjugate_g[2]);
  }
  [[nodiscard]] Expansion trace() const { return m[0][0] + m[1][1] + m[2][2]; }
  /// Sum of the principal 2x2 minors of M.
  [[nodiscard]] Expansion second() const {
    return inverse.adjugate[0][0] + inverse.adjugate[1][1] + inverse.adjugate[2][2];
  }
  [[nodiscard]] Inertia inertia3() const {
    return inertia_of<3>({trace().sign(), second().sign(), inverse.determinant.sign()});
  }
  [[nodiscard]] Inertia inertia4() const {
    Expansion second4 = second() + trace() * j;
    for (const std::size_t i : kAxes) second4 -= g[i] * g[i];
    Expansion third4 = inverse.determinant;
    // Principal 3x3 minors with the last row: those of two axes i, k and the constant.
    for (const std::size_t i : kAxes) {
      const std::size_t k = (i + 1) % 3;
      third4 += exact_determinant(std::array<Triple<Expansion>, 3>{
          {{m[i][i], m[i][k], g[i]}, {m[k][i], m[k][k], g[k]}, {g[i], g[k], j}}});
    }
    return inertia_of<4>({(trace() + j).sign(), second4.sign(), third4.sign(), determinant4.sign()});
  }
};

struct Class {
  Inertia quadratic, all;
  std::string_view name;
};

/// Canonical classes, s f having at least as many positive as negative eigenvalues.
constexpr std::array<Class, 20> kClasses{{
    {{3, 0}, {3, 1}, "ellipsoid"},
    {{3, 0}, {4, 0}, "imaginary ellipsoid"},
    {{3, 0}, {3, 0}, "point"},
    {{2, 1}, {2, 2}, "one-sheet hyperboloid"},
    {{2, 1}, {3, 1}, "two-sheet hyperboloid"},
    {{2, 1}, {2, 1}, "cone"},
    {{2, 0}, {3, 1}, "elliptic paraboloid"},
    {{1, 1}, {2, 2}, "hyperbolic paraboloid"},
    {{2, 0}, {2, 1}, "elliptic cylinder"},
    {{2, 0}, {3, 0}, "imaginary elliptic cylinder"},
    {{2, 0}, {2, 0}, "line"},
    {{1, 1}, {2, 1}, "hyperbolic cylinder"},
    {{1, 1}, {1, 2}, "hyperbolic cylinder"},
    {{1, 1}, {1, 1}, "intersecting planes"},
    {{1, 0}, {2, 1}, "parabolic cylinder"},
    {{1, 0}, {1, 1}, "parallel planes"},
    {{1, 0}, {2, 0}, "imaginary parallel planes"},
    {{1, 0}, {1, 0}, "double plane"},
    {{0, 0}, {1, 1}, "plane"},
    {{0, 0}, {1, 0}, "empty"},
}};

std::string_view class_name(Inertia quadratic, Inertia all) {
  for (const Class& c : kClasses) {
    if (c.quadratic == quadratic && (c.all == all || (quadratic.rank() == 0 && c.all == all.flipped()))) {
      return c.name;
    }
  }
  return "";  // no symmetric matrix gives such a pair
}

// ---------------------------------------------------------------------------------------------------- axes

double dot3(const Vec3& a, const Vec3& b) { return dot(a, b); }

/// Eigenvectors of the quadratic part; eigenvalues beyond its exact rank, the smallest, are zero.
QuadricAxes principal_axes(const Coefficients& c, int rank) {
  Eigen::Matrix3d m;
  m << c[kA], c[kB], c[kC], c[kB], c[kE], c[kF], c[kC], c[kF], c[kH];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m);
  std::array<int, 3> order{0, 1, 2};
  const auto size = [&](int i) { return std::fabs(solver.eigenvalues()[i]); };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) > size(b); });
  QuadricAxes axes;
  for (const std::size_t i : kAxes) {
    const auto v = solver.eigenvectors().col(order[i]);
    axes.axis[i] = {v[0], v[1], v[2]};
    axes.eigenvalue[i] = static_cast<int>(i) < rank ? solver.eigenvalues()[order[i]] : 0;
  }
  return axes;
}

double value_at(const Coefficients& c, Vec3 x) {
  const Vec3 mx{c[kA] * x.x + c[kB] * x.y + c[kC] * x.z, c[kB] * x.x + c[kE] * x.y + c[kF] * x.z,
                c[kC] * x.x + c[kF] * x.y + c[kH] * x.z};
  return dot3(x, mx) + 2 * (c[kD] * x.x + c[kG] * x.y + c[kI] * x.z) + c[kJ];
}

/// Centre, or vertex, and a length along each axis at which the surface is found around it.
void find_centre(const Coefficients& c, bool has_vertex, bool is_singular, QuadricAxes& axes) {
  const Vec3 g{c[kD], c[kG], c[kI]};
  Vec3 rest = g;  // the part of g along axes without curvature
  axes.centre = {};
  for (const std::size_t i : kAxes) {
    if (axes.eigenvalue[i] == 0) continue;
    const double along = dot3(axes.axis[i], g);
    axes.centre = axes.centre - (along / axes.eigenvalue[i]) * axes.axis[i];
    rest = rest - along * axes.axis[i];
  }
  double level = value_at(c, axes.centre);
  const double slope = norm(rest);
  const double strongest = std::fabs(axes.eigenvalue[0]);
  if (has_vertex) axes.centre = axes.centre - (0.5 * level / (slope * slope)) * rest;
  double length = 1;
  if (has_vertex && strongest > 0) {
    length = slope / strongest;
    level = 2 * slope * length;
  } else if (has_vertex) {
    length = level != 0 ? std::fabs(level) / slope : 1;
  } else if (is_singular || level == 0) {
    level = strongest;
  }
  for (const std::size_t i : kAxes) {
    const double lambda = std::fabs(axes.eigenvalue[i]);
    axes.extent[i] = lambda > 0 ? std::sqrt(std::fabs(level) / lambda) : length;
    if (!has_vertex && lambda > 0) length = std::max(i == 0 ? 0 : length, axes.extent[i]);
  }
}

/// An end of an enclosure, times 2^unit.
double lowest(const Interval& x, int unit) { return scale_by_power(x.lo, unit); }
double highest(const Interval& x, int unit) { return scale_by_power(x.hi, unit); }

Interval enclosed(const Expansion& x) { return Coefficient(x).as<Interval>(); }

/// The box of an ellipsoid (or point): centre -adj(M) g / det M, half extents squared -det4 adj(M)_ii /
/// det^2.
Bounds box_of(const Invariants& q, int unit) {
  std::array<Interval, 3> side;
  const Interval det = enclosed(q.inverse.determinant);
  for (const std::size_t i : kAxes) {
    const Interval middle = -enclosed(q.adjugate_g[i]) / det;
    const Interval half = sqrt(-enclosed(q.determinant4) * enclosed(q.inverse.adjugate[i][i]) / sqr(det));
    side[i] = {(middle - half).lo, (middle + half).hi};
  }
  return {{lowest(side[0], unit), lowest(side[1], unit), lowest(side[2], unit)},
          {highest(side[0], unit), highest(side[1], unit), highest(side[2], unit)}};
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// A surface whose only points, if any, are singular: no line found at random meets it.
bool is_thin(std::string_view variety) {
  return is_one_of(variety, {"imaginary ellipsoid", "point", "imaginary elliptic cylinder", "line",
                             "imaginary parallel planes", "double plane", "empty"});
}

}  // namespace

// -------------------------------------------------------------------------------------------- formulations

QuadricVertex::QuadricVertex(const Quadric& surface) : form(surface.form) {}

FormulationInfo QuadricVertex::info() {
  return {"vertex",
          "A l^2 + 2 B l + C from the vertex -B/A, or from the origin where the roots lie far apart",
          "graze (surfaces/quadric.md)",
          {Form::polynomial, Form::scalar, Form::interval},
          2};
}

QuadricAlgebraic::QuadricAlgebraic(const Quadric& surface) : coefficients(surface.coefficients) {}

FormulationInfo QuadricAlgebraic::info() {
  return {"algebraic",
          "a l^2 + b l + c about the origin, in plain arithmetic",
          "document 001",
          {Form::polynomial, Form::scalar, Form::interval},
          2};
}

template <class T>
std::array<T, 3> QuadricAlgebraic::along(const LocalRay& ray) const {
  const auto k = [&](Index i) { return exactly<T>(coefficients[i]); };
  const auto [x0, y0, z0] = origin_as<T>(ray);
  const auto [xd, yd, zd] = direction_as<T>(ray);
  const T two = exactly<T>(2);
  const T a = k(kA) * xd * xd + k(kE) * yd * yd + k(kH) * zd * zd +
              two * (k(kB) * xd * yd + k(kC) * xd * zd + k(kF) * yd * zd);
  const T b = two * (k(kA) * x0 * xd + k(kE) * y0 * yd + k(kH) * z0 * zd + k(kB) * (x0 * yd + xd * y0) +
                     k(kC) * (x0 * zd + xd * z0) + k(kF) * (y0 * zd + yd * z0) + k(kD) * xd + k(kG) * yd +
                     k(kI) * zd);
  const T c =
      k(kA) * x0 * x0 + k(kE) * y0 * y0 + k(kH) * z0 * z0 +
      two * (k(kB) * x0 * y0 + k(kC) * x0 * z0 + k(kF) * y0 * z0 + k(kD) * x0 + k(kG) * y0 + k(kI) * z0) +
      k(kJ);
  return {c, b, a};
}

void QuadricAlgebraic::pose(const LocalRay& ray, EquationBlock& block) const {
  // The document's first step: a = 0 leaves the linear equation b t + c = 0.
  bool is_linear = false, is_constant = false, is_zero = false, may_be_zero = false;
  with_coefficients(
      block, [&](auto number) { return along<decltype(number)>(ray); },
      [&](auto c) {
        using T = std::remove_const_t<typename decltype(c)::value_type>;
        is_linear = c[2] == T{};
        is_constant = is_linear && c[1] == T{};
        is_zero = is_constant && c[0] == T{};
        if constexpr (std::is_same_v<T, Interval>) may_be_zero = is_constant && contains_zero(c[0]);
      });
  if (is_zero) return block.settle(Status::coincident);
  if (may_be_zero) return block.settle(Status::uncertain);
  if (is_constant) return;
  if (is_linear) {
    return second_degree::pose_about_origin(block, ray, [&](auto number) {
      const auto q = along<decltype(number)>(ray);
      return std::array{q[0], q[1]};
    });
  }
  second_degree::pose_about_origin(block, ray, [&](auto number) { return along<decltype(number)>(ray); });
}

void QuadricAlgebraic::lift(const LocalRay& ray, const Posed& /*posed*/, const Root& root,
                            std::vector<LocalHit>& hits) const {
  second_degree::lift_from_origin(ray, root, hits);
}

// ------------------------------------------------------------------------------------------------- quadric

SurfaceInfo Quadric::info() {
  SurfaceInfo info;
  info.summary = "A x^2 + E y^2 + H z^2 + 2B xy + 2C xz + 2F yz + 2D x + 2G y + 2I z + J = 0";
  info.source = "document 001";
  info.page = "surfaces/quadric.md";
  info.parameters = {kNames.begin(), kNames.end()};
  for (const Class& c : kClasses) {
    if (info.varieties.empty() || info.varieties.back() != c.name) info.varieties.push_back(c.name);
  }
  return info;
}

Parameters Quadric::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"D"}, Length{"G"}, Length{"I"}, Length{"J", 2}};
  return scale_lengths(parameters, kLengths, factor);
}

Quadric::Quadric(const SurfaceSpec& spec) {
  Coefficients given{};
  for (std::size_t i = 0; i < kNames.size(); ++i) given[i] = spec.parameters.number(kNames[i], 0);
  if (largest_quadratic(given) == 0 && largest_linear(given) == 0 && given[kJ] == 0) {
    throw std::invalid_argument("A to J of a quadric must not all be zero");
  }
  unit_ = length_exponent(given);
  coefficients = in_units(given, unit_);

  const int parts = (largest_quadratic(given) > 0) + (largest_linear(given) > 0) + (given[kJ] != 0);
  is_homogeneous_ = parts == 1;

  const Invariants q(coefficients);
  Inertia quadratic = q.inertia3(), all = q.inertia4();
  if (quadratic.negative > quadratic.positive) {
    orientation_ = -1;
    quadratic = quadratic.flipped();
    all = all.flipped();
  }
  variety_ = class_name(quadratic, all);

  for (const std::size_t i : kAxes) {
    for (const std::size_t k : kAxes) form.m[i][k] = Coefficient(q.m[i][k]);
    form.g[i] = Coefficient(q.g[i]);
  }
  form.j = Coefficient(q.j);

  axes_ = principal_axes(coefficients, quadratic.rank());
  // A 4x4 matrix of rank 2 above that of its 3x3 part: the gradient has a part along an axis without
  // curvature.
  const bool has_vertex = all.rank() == quadratic.rank() + 2;
  find_centre(coefficients, has_vertex, all.rank() == quadratic.rank(), axes_);
  if (is_one_of(variety_, {"ellipsoid", "point"})) {
    bounds_ = box_of(q, unit_);
    const Vec3 corner = scale_by_power(bounds_.hi - bounds_.lo, -unit_);
    // Half the diagonal would do if the centre were exact; the whole one leaves room for its rounding.
    reach_ = norm(corner);
  }
}

/// A cone about the origin and its like have no length of their own: the ray's origin gives the unit, so that
/// here too scaling a scene by a power of two changes no bit.
void Quadric::measure_by_origin(LocalRay& ray) {
  if (max_abs(ray.o) == 0) return;
  const int k = exponent_of(max_abs(ray.o));
  ray.o = scale_by_power(ray.o, -k);
  ray.p = ray.o;
  ray.l_exponent += k;
  ray.unit += k;
  ray.is_exact = ray.is_exact && is_same_scaled(ray.o, ray.unit, ray.world.o);
}

double Quadric::size() const {
  return scale_by_power(std::max({axes_.extent[0], axes_.extent[1], axes_.extent[2]}), unit_);
}

bool Quadric::clip(LocalRay& ray) const {
  if (is_homogeneous_) measure_by_origin(ray);
  if (reach_ > 0) return second_degree::clip_ball(form, axes_.centre, reach_, ray);
  if (!second_degree::choose_frame(form, ray)) return false;
  ray.lo = -ray.centre;
  ray.hi = std::numeric_limits<double>::infinity();
  return true;
}

/// The gradient vanishes exactly where the ray touches, at -B/A: A (M p + g) = B M d in every coordinate.
bool Quadric::touches_singular_point(const LocalRay& ray) const {
  const auto p = second_degree::point_on<Expansion>(ray);
  const auto d = second_degree::direction_of<Expansion>(ray);
  const Triple<Expansion> slope = form.slope(p), turn = form.times(d), q = form.along(p, d);
  for (const std::size_t i : kAxes) {
    if (!(q[2] * slope[i] - q[1] * turn[i]).is_zero()) return false;
  }
  return true;
}

LocalPoint Quadric::describe(const LocalRay& ray, const LocalHit& hit) const {
  if (hit.multiplicity > 1 && touches_singular_point(ray)) return {-normalized(ray.d), {}, true};
  const Vec3 slope = slope_at(form, second_degree::point_on<DoubleDouble>(ray, hit.delta));
  if (max_abs(slope) == 0) return {-normalized(ray.d), {}, true};
  return {normalized(orientation_ * slope), {}};
}

SurfaceSample Quadric::sample(double u, double v) const {
  Rng rng(hash_combine(hash_combine(0, u), v));
  const auto somewhere = [&](double reach) {
    Vec3 x;
    for (const std::size_t i : kAxes) x = x + (reach * rng.uniform(-1, 1) * axes_.extent[i]) * axes_.axis[i];
    return x;
  };
  if (is_thin(variety_)) {
    // Any point of it (of an empty one: its centre), which moves along the axes without curvature only.
    Vec3 x = axes_.centre;
    for (const std::size_t i : kAxes) {
      if (axes_.eigenvalue[i] == 0 && variety_ != "empty")
        x = x + (2 * u - 1) * axes_.extent[i] * axes_.axis[i];
    }
    return {in_object_space(x), orientation_ * axes_.axis[0]};
  }
  // Lines through the middle, scaled by the extents, meet it often; the nearer root is a point of it.
  constexpr int kTries = 200;
  for (int i = 0; i < kTries; ++i) {
    const Vec3 start = axes_.centre + somewhere(1.5), direction = somewhere(1);
    const auto q = form.along<double>({start.x, start.y, start.z}, {direction.x, direction.y, direction.z});
    const double discriminant = q[1] * q[1] - q[2] * q[0];
    if (!(discriminant > 0x1p-20 * q[1] * q[1])) continue;
    const double t = -q[0] / (q[1] + std::copysign(std::sqrt(discriminant), q[1]));
    if (!(std::fabs(t) < 4)) continue;
    const Vec3 x = polished(form, start + t * direction);
    const Vec3 slope = slope_at(form, {x.x, x.y, x.z});
    return {in_object_space(x), normalized(orientation_ * slope)};
  }
  return {in_object_space(axes_.centre), axes_.axis[0]};
}

Landmarks Quadric::landmarks() const {
  Landmarks marks;
  marks.centre = in_object_space(axes_.centre);
  const double length = std::max({axes_.extent[0], axes_.extent[1], axes_.extent[2]});
  marks.half = in_object_space({length, length, length});
  if (reach_ > 0) marks.half = 0.5 * (bounds_.hi - bounds_.lo);
  if (is_one_of(variety_, {"cone", "point"}))
    marks.singular.emplace_back(marks.centre, Landmarks::Singular::apex);
  if (is_one_of(variety_, {"intersecting planes", "line", "double plane"}))
    marks.singular.emplace_back(marks.centre, Landmarks::Singular::crossing);
  add_directions(marks);
  const Coefficients& c = coefficients;
  marks.has_axis = c[kB] == 0 && c[kC] == 0 && c[kF] == 0 && c[kD] == 0 && c[kI] == 0 && c[kA] == c[kH];
  const double discriminant = c[kG] * c[kG] - c[kE] * c[kJ];
  if (marks.has_axis && c[kE] != 0 && discriminant >= 0) {
    for (const double side : {-1.0, 1.0}) {
      const double y = (-c[kG] + side * std::sqrt(discriminant)) / c[kE];
      if (std::isfinite(y)) marks.poles.push_back(in_object_space({0, y, 0}));
    }
  } else if (marks.has_axis && c[kE] == 0 && c[kG] != 0) {
    marks.poles.push_back(in_object_space({0, -0.5 * c[kJ] / c[kG], 0}));
  }
  return marks;
}

void Quadric::add_directions(Landmarks& marks) const {
  const bool is_paraboloid = is_one_of(variety_, {"elliptic paraboloid", "hyperbolic paraboloid"});
  std::array<Vec3, 3> scaled_axis;  // of unit size by the quadratic part
  for (const std::size_t i : kAxes) {
    const double lambda = std::fabs(axes_.eigenvalue[i]);
    if (lambda > 0) {
      scaled_axis[i] = (1 / std::sqrt(lambda)) * axes_.axis[i];
    } else {
      (is_paraboloid ? marks.asymptotes : marks.parallels).push_back(axes_.axis[i]);
    }
  }
  // d = p + n with A(p) = 1 and A(n) = -1: the asymptotic cone, or pair of planes.
  std::vector<Vec3> positive, negative;
  for (const std::size_t i : kAxes) {
    if (axes_.eigenvalue[i] > 0) positive.push_back(scaled_axis[i]);
    if (axes_.eigenvalue[i] < 0) negative.push_back(scaled_axis[i]);
  }
  const auto& many = positive.size() >= negative.size() ? positive : negative;
  const auto& one = positive.size() >= negative.size() ? negative : positive;
  if (one.empty()) return;
  const std::size_t first = marks.asymptotes.size();
  for (int i = 0; i < 8; ++i) {
    const double angle = std::numbers::pi * i / 4;
    Vec3 d = one[0] + std::cos(angle) * many[0];
    if (many.size() > 1)
      d = d + std::sin(angle) * many[1];
    else if (i % 4 != 0)
      continue;
    marks.asymptotes.push_back(normalized(d));
  }
  // On ruled surfaces these are the directions of generators as well.
  if (is_one_of(variety_,
                {"cone", "one-sheet hyperboloid", "hyperbolic paraboloid", "intersecting planes"})) {
    for (std::size_t i = first; i < marks.asymptotes.size(); ++i)
      marks.parallels.push_back(marks.asymptotes[i]);
  }
}

}  // namespace graze
