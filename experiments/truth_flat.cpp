// Truth for flat figures: plane, triangle, polygon and disk.
//
// The ray's point on the figure's plane is in the figure or not by signs of integers; see truth_figure.hpp.
#include <algorithm>
#include <array>
#include <graze/experiments/truth_figure.hpp>
#include <graze/experiments/truth_types.hpp>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace graze::truth {
namespace {

using truth::operator-;  // NOLINT(misc-unused-using-decls): the check does not see operators
using truth::cross;
using truth::inner;

/// The axis of the largest |a_k|, the smallest such index.
std::size_t largest_axis(const Vector& a) {
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (abs(a[i]) > abs(a[k])) k = i;
  return k;
}

QuadPoint transformed(const Mat3& m, const QuadPoint& v) {
  return {inner(to_quads(m[0]), v), inner(to_quads(m[1]), v), inner(to_quads(m[2]), v)};
}

Vec3 read_center(const Parameters& parameters) {
  return parameters.has("center") ? read_vector(parameters, "center") : Vec3{};
}

// ---- Plane ----

class PlaneFigure final : public Figure {
 public:
  PlaneFigure(const SurfaceSpec& spec, const HalfSpace& stated, bool one_sided) : one_sided_(one_sided) {
    const Planes planes = world_planes(spec.placement, {stated});
    e_ = planes.e;
    const Plane& plane = planes.list[0];
    facets_.push_back(make_facet(plane));
    unit_ = unit(plane.n);
    // The plane's own point nearest to zero, b n / |n|^2.
    const Quad level = to_quad(plane.b, inner(plane.n, plane.n), e_);
    long e = 0;
    for (std::size_t i = 0; i < 3; ++i) foot_[i] = leading(plane.n[i], e) * ldexp(level, static_cast<int>(e));
  }

  [[nodiscard]] double distance(Vec3 point) const override {
    return static_cast<double>(abs(inner(minus(to_quads(point), foot_), unit_)));
  }

 protected:
  [[nodiscard]] Contacts find(const Question& q) const override {
    const auto [gap, speed] = cross_plane(facets_[0].plane, q);
    if (one_sided_ && sign(speed) >= 0) return std::vector<Contact>{};
    if (sign(speed) != 0) return in_front({fraction(gap, speed)});
    if (sign(gap) == 0) return std::nullopt;
    return std::vector<Contact>{};
  }

 private:
  bool one_sided_;
  QuadPoint unit_, foot_;
};

// ---- Triangle ----

class Triangle final : public Figure {
 public:
  Triangle(const SurfaceSpec& spec, const std::vector<Vec3>& vertices);
  [[nodiscard]] double distance(Vec3 point) const override {
    return static_cast<double>(patch_->distance(to_quads(point)));
  }

 protected:
  [[nodiscard]] Contacts find(const Question& q) const override;

 private:
  [[nodiscard]] Contacts in_plane(const Question& q) const;

  std::array<Vector, 3> vertices_;
  std::vector<Facet> sides_;  ///< half-spaces that cut the triangle out of its plane
  std::optional<Patch> patch_;
};

Triangle::Triangle(const SurfaceSpec& spec, const std::vector<Vec3>& vertices) {
  const Points object = exact_points(vertices);
  const Vector n = cross(object.at[1] - object.at[0], object.at[2] - object.at[0]);
  if (is_zero(n)) throw std::invalid_argument("vertices lie on one line: the triangle is degenerate");
  const Transform transform = prepare(spec.placement);
  const Points world = world_points(spec.placement, object);
  e_ = world.e;
  for (std::size_t i = 0; i < 3; ++i) vertices_[i] = world.at[i];
  const Vector normal = world_normal(transform, n);
  facets_.push_back(make_facet(reduced({normal, inner(normal, vertices_[0])})));
  std::vector<QuadPoint> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector& a = vertices_[i];
    Vector side = cross(vertices_[(i + 1) % 3] - a, normal);
    if (inner(side, vertices_[(i + 2) % 3] - a) > 0) side = negated(side);
    sides_.push_back(make_facet(reduced({side, inner(side, a)})));
    corners.push_back(to_quads(a, Integer(1), e_));
  }
  patch_.emplace(corners, unit(normal));
}

Contacts Triangle::find(const Question& q) const {
  const auto [gap, speed] = cross_plane(facets_[0].plane, q);
  if (sign(speed) == 0) return sign(gap) == 0 ? in_plane(q) : std::vector<Contact>{};
  const Fraction l = fraction(gap, speed);
  if (sign(l.top) <= 0) return std::vector<Contact>{};
  // Weights of the vertices: volumes that the ray spans with the opposite edges.
  std::array<Vector, 3> from;
  for (std::size_t i = 0; i < 3; ++i) from[i] = shifted(vertices_[i], q.grow) - q.o;
  std::array<Integer, 3> weight;
  for (std::size_t i = 0; i < 3; ++i) weight[i] = inner(q.d, cross(from[(i + 1) % 3], from[(i + 2) % 3]));
  const Integer whole = weight[0] + weight[1] + weight[2];
  for (const Integer& w : weight)
    if (sign(w) * sign(whole) < 0) return std::vector<Contact>{};
  return in_front({l, 1, 0, {quotient(weight[1], whole, 0), quotient(weight[2], whole, 0)}});
}

Contacts Triangle::in_plane(const Question& q) const {
  const Passage passage = pass(sides_, q);
  if (passage.empty || sign(passage.out->top) <= 0) return std::vector<Contact>{};
  if (compare(*passage.in, *passage.out) < 0) return std::nullopt;
  // A line that meets the triangle in one point passes one of its vertices.
  std::size_t at = 0;
  while (!is_zero(cross(shifted(vertices_[at], q.grow) - q.o, q.d))) ++at;
  return in_front({*passage.in, 2, 0, {at == 1 ? 1.0 : 0.0, at == 2 ? 1.0 : 0.0}});
}

// ---- Polygon ----

using Planar = std::array<Integer, 2>;

Planar operator-(const Planar& a, const Planar& b) { return {a[0] - b[0], a[1] - b[1]}; }
Integer inner(const Planar& a, const Planar& b) { return a[0] * b[0] + a[1] * b[1]; }
Integer cross(const Planar& a, const Planar& b) { return a[0] * b[1] - a[1] * b[0]; }
Planar dropped(const Vector& v, std::size_t axis) { return {v[(axis + 1) % 3], v[(axis + 2) % 3]}; }

class Polygon final : public Figure {
 public:
  Polygon(const SurfaceSpec& spec, const std::vector<Vec3>& vertices);
  [[nodiscard]] double distance(Vec3 point) const override {
    return static_cast<double>(patch_->distance(to_quads(point)));
  }

 protected:
  [[nodiscard]] Contacts find(const Question& q) const override;

 private:
  [[nodiscard]] bool is_met(const Vector& o, const Vector& d, long grow) const;
  [[nodiscard]] bool is_along(const Vector& o, const Vector& d, long grow) const;

  Matrix adjugate_;
  bool identity_ = true;
  std::vector<Vector> vertices_;  ///< object space, stretched so that it is the adjugate times world space
  std::size_t drop_ = 0;          ///< the largest axis of the object's normal
  std::optional<Patch> patch_;
};

/// The sum over the edges of (v_i - v_0) x (v_{i+1} - v_0) (Newell).
Vector newell_normal(const std::vector<Vector>& v) {
  Vector n;
  for (std::size_t i = 1; i + 1 < v.size(); ++i) {
    const Vector part = cross(v[i] - v[0], v[i + 1] - v[0]);
    for (std::size_t k = 0; k < 3; ++k) n[k] += part[k];
  }
  return n;
}

Integer largest_extent(const std::vector<Vector>& v) {
  Integer extent = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [lo, hi] = std::minmax_element(v.begin(), v.end(),
                                              [k](const Vector& a, const Vector& b) { return a[k] < b[k]; });
    extent = std::max<Integer>(extent, (*hi)[k] - (*lo)[k]);
  }
  return extent;
}

void check_planar(const std::vector<Vector>& v, const Vector& n) {
  // The tolerance allows for vertices that were rounded, some 2^7 ulp of the polygon's size.
  constexpr long kTolerance = 46;
  const Integer extent = largest_extent(v);
  const Integer bound = extent * extent * inner(n, n);
  for (std::size_t i = 1; i < v.size(); ++i) {
    const Integer height = inner(n, v[i] - v[0]);
    if (shifted(Integer(height * height), 2 * kTolerance) > bound)
      throw std::invalid_argument("vertices[" + std::to_string(i) + "] is not in the polygon's plane");
  }
}

std::string no_length(std::size_t edge) {
  return "vertices: edge " + std::to_string(edge) + " has no length";
}

/// Side of c on the line from a to b.
int side(const Planar& a, const Planar& b, const Planar& c) { return sign(cross(b - a, c - a)); }

/// c is on the line through a and b: between them, ends included?
bool between(const Planar& a, const Planar& b, const Planar& c) { return inner(a - c, b - c) <= 0; }

/// Closed segments have a point in common.
bool meet(const Planar& a, const Planar& b, const Planar& c, const Planar& d) {
  const int c_side = side(a, b, c);
  const int d_side = side(a, b, d);
  const int a_side = side(c, d, a);
  const int b_side = side(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && between(a, b, c)) || (d_side == 0 && between(a, b, d)) ||
         (a_side == 0 && between(c, d, a)) || (b_side == 0 && between(c, d, b));
}

/// Boxes of the segments a b and c d are apart.
bool apart(const Planar& a, const Planar& b, const Planar& c, const Planar& d) {
  for (std::size_t k = 0; k < 2; ++k)
    if (std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k]))
      return true;
  return false;
}

/// Edges i < j of a closed chain have more in common than neighbours must.
bool conflict(const std::vector<Planar>& p, std::size_t i, std::size_t j) {
  const std::size_t n = p.size();
  const auto folds_back = [](const Planar& a, const Planar& b, const Planar& c) {
    return side(a, b, c) == 0 && inner(a - b, c - b) > 0;
  };
  const Planar& a = p[i];
  const Planar& b = p[i + 1];
  const Planar& c = p[j];
  const Planar& d = p[(j + 1) % n];
  if (j == i + 1) return folds_back(a, b, d);
  if (i == 0 && j == n - 1) return folds_back(c, a, b);
  return !apart(a, b, c, d) && meet(a, b, c, d);
}

void check_simple(const std::vector<Planar>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    if (p[i] == p[(i + 1) % n]) throw std::invalid_argument(no_length(i));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      if (conflict(p, i, j))
        throw std::invalid_argument("vertices: edges " + std::to_string(i) + " and " + std::to_string(j) +
                                    " meet: the polygon intersects itself");
    }
  }
}

/// The normal of a polygon that is one: planar, simple, with an area.
Vector checked_normal(const std::vector<Vector>& v) {
  for (std::size_t i = 0; i < v.size(); ++i)
    if (v[i] == v[(i + 1) % v.size()]) throw std::invalid_argument(no_length(i));
  const Vector n = newell_normal(v);
  if (is_zero(n)) throw std::invalid_argument("vertices enclose no area: the polygon is degenerate");
  check_planar(v, n);
  std::vector<Planar> flat;
  for (const Vector& x : v) flat.push_back(dropped(x, largest_axis(n)));
  check_simple(flat);
  return n;
}

/// Distances are from the polygon in the reference plane: vertices move to it along the dropped axis.
Patch reference_patch(const Placement& placement, const Points& object, const Vector& n,
                      const Vector& normal) {
  const std::size_t drop = largest_axis(n);
  std::vector<QuadPoint> corners;
  for (const Vector& v : object.at) {
    QuadPoint x = to_quads(v, Integer(1), object.e);
    x[drop] -= to_quad(inner(n, v - object.at[0]), n[drop], object.e);
    corners.push_back(plus(transformed(placement.matrix, x), 1, to_quads(placement.translate)));
  }
  return {std::move(corners), unit(normal)};
}

Polygon::Polygon(const SurfaceSpec& spec, const std::vector<Vec3>& vertices) {
  const Points object = exact_points(vertices);
  const Vector n = checked_normal(object.at);
  drop_ = largest_axis(n);
  const Transform transform = prepare(spec.placement);
  const Points world = world_points(spec.placement, object);
  e_ = world.e;
  const Vector normal = world_normal(transform, n);
  facets_.push_back(make_facet(reduced({normal, inner(normal, world.at[0])})));
  identity_ = transform.identity;
  adjugate_ = transform.adjugate;
  for (const Vector& w : world.at) vertices_.push_back(identity_ ? w : truth::apply(adjugate_, w));
  patch_.emplace(reference_patch(spec.placement, object, n, normal));
}

Contacts Polygon::find(const Question& q) const {
  const auto [gap, speed] = cross_plane(facets_[0].plane, q);
  const Fraction l = fraction(gap, speed);
  if (sign(speed) == 0 ? sign(gap) != 0 : sign(l.top) <= 0) return std::vector<Contact>{};
  const Vector o = identity_ ? q.o : truth::apply(adjugate_, q.o);
  const Vector d = identity_ ? q.d : truth::apply(adjugate_, q.d);
  if (sign(speed) == 0) return is_along(o, d, q.grow) ? Contacts{} : std::vector<Contact>{};
  return is_met(o, d, q.grow) ? in_front({l}) : std::vector<Contact>{};
}

/// The half-open even-odd rule in the plane (U, V) in which the line is the point 0.
bool Polygon::is_met(const Vector& o, const Vector& d, long grow) const {
  const std::size_t k = largest_axis(d);
  const std::size_t i = (k + 1) % 3;
  const std::size_t j = (k + 2) % 3;
  const Integer dk = abs(d[k]);
  const Integer di = sign(d[k]) > 0 ? d[i] : Integer(-d[i]);
  const Integer dj = sign(d[k]) > 0 ? d[j] : Integer(-d[j]);
  const auto in_ray_space = [&](const Vector& w) {
    const Vector x = shifted(w, grow) - o;
    return Planar{x[i] * dk - x[k] * di, x[j] * dk - x[k] * dj};
  };
  bool odd = false;
  Planar a = in_ray_space(vertices_.back());
  for (const Vector& w : vertices_) {
    Planar b = in_ray_space(w);
    if ((sign(a[1]) >= 0) != (sign(b[1]) >= 0) && sign(cross(a, b)) == sign(Integer(b[1] - a[1]))) odd = !odd;
    std::swap(a, b);
  }
  return odd;
}

/// For a line in the reference plane: some segment of positive length of the ray is in the closed polygon.
bool Polygon::is_along(const Vector& o, const Vector& d, long grow) const {
  const Planar from = dropped(o, drop_);
  const Planar along = dropped(d, drop_);
  struct Edge {
    int a_side, b_side;
    Rational a, b;  ///< where it is on the line: both ends if it lies in it, else both are the crossing
  };
  std::vector<Edge> edges;
  std::set<Rational> ends{Rational(0)};
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Planar a = dropped(shifted(vertices_[i], grow), drop_) - from;
    const Planar b = dropped(shifted(vertices_[(i + 1) % vertices_.size()], grow), drop_) - from;
    const Integer a_off = cross(along, a);
    const Integer b_off = cross(along, b);
    Edge edge{sign(a_off), sign(b_off), Rational(inner(along, a)), Rational(inner(along, b))};
    if (edge.a_side * edge.b_side > 0) continue;
    if (edge.a_side != edge.b_side)
      edge.a = edge.b = (edge.b * Rational(a_off) - edge.a * Rational(b_off)) / Rational(a_off - b_off);
    ends.insert(edge.a);
    ends.insert(edge.b);
    edges.push_back(std::move(edge));
  }
  // Between two neighbouring ends the line is inside, outside or on an edge throughout.
  for (auto lo = ends.find(Rational(0)); std::next(lo) != ends.end(); ++lo) {
    const auto hi = std::next(lo);
    bool odd = false;
    for (const Edge& edge : edges) {
      if (edge.a_side == 0 && edge.b_side == 0 && std::min(edge.a, edge.b) <= *lo &&
          *hi <= std::max(edge.a, edge.b))
        return true;
      if ((edge.a_side >= 0) != (edge.b_side >= 0) && edge.a >= *hi) odd = !odd;
    }
    if (odd) return true;
  }
  return false;
}

// ---- Disk ----

class Disk final : public Figure {
 public:
  Disk(const SurfaceSpec& spec, Vec3 center, Vec3 normal, double radius);
  [[nodiscard]] double distance(Vec3 point) const override;

 protected:
  [[nodiscard]] Contacts find(const Question& q) const override;

 private:
  [[nodiscard]] Contacts in_plane(const Vector& from, const Vector& d, const Integer& squared) const;

  Placement placement_;
  Matrix adjugate_;
  Vector center_;           ///< adjugate times the center in world space
  Integer squared_radius_;  ///< in the same, stretched, object space
  QuadPoint world_center_, unit_, object_unit_;
  std::array<QuadPoint, 3> inverse_;
  Quad radius_;
};

Disk::Disk(const SurfaceSpec& spec, Vec3 center, Vec3 normal, double radius) : placement_(spec.placement) {
  const Transform transform = prepare(spec.placement);
  const Points object = exact_points({center});
  const Points world = world_points(spec.placement, object);
  const Dyadic size = exact(radius);
  // The adjugate stretches object space by det 2^e.
  const long e_radius = size.e + transform.e;
  const bool at_zero = is_zero(world.at[0]);
  e_ = at_zero ? e_radius : std::min(world.e, e_radius);
  const Vector middle = at_zero ? Vector{} : shifted(world.at[0], world.e - e_);
  adjugate_ = transform.adjugate;
  center_ = truth::apply(adjugate_, middle);
  const Integer stretched = shifted(Integer(size.m * transform.det), e_radius - e_);
  squared_radius_ = stretched * stretched;
  const Vector object_normal = exact_points({normal}).at[0];
  const Vector n = world_normal(transform, object_normal);
  facets_.push_back(make_facet(reduced({n, inner(n, middle)})));

  world_center_ = to_quads(middle, Integer(1), e_);
  unit_ = unit(n);
  object_unit_ = unit(object_normal);
  radius_ = radius;
  for (std::size_t i = 0; i < 3; ++i) inverse_[i] = to_quads(adjugate_[i], transform.det, -transform.e);
}

Contacts Disk::find(const Question& q) const {
  const auto [gap, speed] = cross_plane(facets_[0].plane, q);
  const Vector d = truth::apply(adjugate_, q.d);
  const Vector from = truth::apply(adjugate_, q.o) - shifted(center_, q.grow);
  const Integer squared = shifted(squared_radius_, 2 * q.grow);
  if (sign(speed) == 0) return sign(gap) == 0 ? in_plane(from, d, squared) : std::vector<Contact>{};
  const Fraction l = fraction(gap, speed);
  if (sign(l.top) <= 0) return std::vector<Contact>{};
  Integer reach = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Integer x = from[i] * l.bottom + d[i] * l.top;
    reach += x * x;
  }
  return reach <= squared * l.bottom * l.bottom ? in_front({l}) : std::vector<Contact>{};
}

/// a l'^2 + 2 b l' + c <= 0 is the part of the line in the disk.
Contacts Disk::in_plane(const Vector& from, const Vector& d, const Integer& squared) const {
  const Integer a = inner(d, d);
  const Integer b = inner(from, d);
  const Integer c = inner(from, from) - squared;
  const int discriminant = sign(Integer(b * b - a * c));
  if (discriminant == 0) return in_front({{-b, a}, 2});
  if (discriminant > 0 && (sign(b) < 0 || sign(c) < 0)) return std::nullopt;
  return std::vector<Contact>{};
}

double Disk::distance(Vec3 point) const {
  const QuadPoint p = minus(to_quads(point), world_center_);
  const Quad height = inner(p, unit_);
  const QuadPoint foot = plus(p, -height, unit_);
  QuadPoint x{inner(inverse_[0], foot), inner(inverse_[1], foot), inner(inverse_[2], foot)};
  const Quad reach = length(x);
  if (reach <= radius_) return static_cast<double>(abs(height));
  // Outside: the rim's point that is nearest in object space.
  for (Quad& c : x) c *= radius_ / reach;
  return static_cast<double>(length(minus(transformed(placement_.matrix, x), p)));
}

}  // namespace

std::unique_ptr<Surface> make_plane(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 3> kNames{"a", "b", "one_sided"};
  spec.parameters.expect_only(kNames, "plane");
  const Vec3 a = read_vector(spec.parameters, "a");
  if (max_abs(a) == 0) throw std::invalid_argument("a must not be zero");
  return std::make_unique<PlaneFigure>(spec, HalfSpace{a, spec.parameters.number("b")},
                                       spec.parameters.flag("one_sided", false));
}

std::unique_ptr<Surface> make_triangle(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"vertices"};
  spec.parameters.expect_only(kNames, "triangle");
  const std::vector<Vec3> vertices = read_points(spec.parameters, "vertices");
  expect_count(vertices, 3);
  return std::make_unique<Triangle>(spec, vertices);
}

std::unique_ptr<Surface> make_polygon(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"vertices"};
  spec.parameters.expect_only(kNames, "polygon");
  const std::vector<Vec3> vertices = read_points(spec.parameters, "vertices");
  if (vertices.size() < 3) throw std::invalid_argument("vertices must hold at least 3 points");
  return std::make_unique<Polygon>(spec, vertices);
}

std::unique_ptr<Surface> make_disk(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 3> kNames{"center", "normal", "radius"};
  spec.parameters.expect_only(kNames, "disk");
  const Vec3 normal = read_vector(spec.parameters, "normal");
  if (max_abs(normal) == 0) throw std::invalid_argument("normal must not be zero");
  const double radius = spec.parameters.number("radius");
  if (radius <= 0) throw std::invalid_argument("radius must be positive");
  return std::make_unique<Disk>(spec, read_center(spec.parameters), normal, radius);
}

}  // namespace graze::truth
