#include <graze/surfaces/triangle.hpp>

namespace graze {
namespace {

/// Edges and origin as document 002 has them, rounded to T.
template <class T>
struct Document {
  planar::Array3<T> d, e1, e2, from;

  Document(const TriangleData& data, const LocalRay& ray)
      : d(planar::exactly<T>(ray.d)),
        e1(edge(data, 1)),
        e2(edge(data, 2)),
        from(planar::difference(planar::exactly<T>(ray.o), planar::exactly<T>(data.vertices[0]))) {}
  [[nodiscard]] T determinant() const { return planar::inner(planar::outer(d, e2), e1); }

 private:
  static planar::Array3<T> edge(const TriangleData& data, std::size_t i) {
    return planar::difference(planar::exactly<T>(data.vertices[i]), planar::exactly<T>(data.vertices[0]));
  }
};

}  // namespace

// --------------------------------------------------------------------------------------------------- exact

TriangleExact::TriangleExact(const Triangle& surface) : data(surface.data) {}

FormulationInfo TriangleExact::info() {
  return {"exact",
          "n.(p - v0) + (n.d) delta = 0; inside by exact signs of det(d, v_i - o, v_j - o)",
          "graze (surfaces/triangle.md)",
          {Form::polynomial, Form::scalar, Form::interval},
          1};
}

void TriangleExact::pose(const LocalRay& ray, EquationBlock& block) const {
  planar::pose_exact(
      block, ray, data.plane, data.holds(ray),
      [&](planar::Judge& judge) {
        block.spend(3);
        return is_inside(ray, judge);
      },
      [&](planar::Judge& judge) {
        block.spend(3);
        const auto found = planar::within_polygon(data.vertices, ray, data.dropped, judge);
        using Kind = planar::WithinPolygon::Kind;
        if (judge.undecided() || found.kind == Kind::outside) return;
        if (found.kind == Kind::coincident) return block.settle(Status::coincident);
        const auto vertex = static_cast<std::uint32_t>(found.vertex);
        planar::pose_touch(block, ray, data.vertices[found.vertex], vertex, judge);
      });
}

bool TriangleExact::is_inside(const LocalRay& ray, planar::Judge& judge) const {
  bool positive = false, negative = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const int side = judge.sign([&](auto number) { return data.weight<decltype(number)>(ray, i); });
    positive = positive || side > 0;
    negative = negative || side < 0;
    if (positive && negative) return false;
  }
  return true;
}

void TriangleExact::lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
                         std::vector<LocalHit>& hits) const {
  planar::lift_exact(posed, root, hits);
}

// --------------------------------------------------------------------------------------------- barycentric

TriangleBarycentric::TriangleBarycentric(const Triangle& surface) : data(surface.data) {}

FormulationInfo TriangleBarycentric::info() {
  return {"barycentric",
          "t, u, v as quotients of triple products, u >= 0, v >= 0, u + v <= 1",
          "document 002; Moeller, Trumbore 1997",
          {Form::polynomial, Form::scalar, Form::interval},
          1,
          true};
}

void TriangleBarycentric::pose(const LocalRay& ray, EquationBlock& block) const {
  planar::pose_plain(block, ray, ray.seed(), [&](auto number) {
    using T = decltype(number);
    const Document<T> triangle(data, ray);
    const T volume = planar::inner(planar::outer(triangle.from, triangle.e1), triangle.e2);
    return std::array<T, 2>{-volume, triangle.determinant()};
  });
}

void TriangleBarycentric::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                               std::vector<LocalHit>& hits) const {
  planar::lift_plain(ray, posed, root, hits, [&](auto number) {
    using T = decltype(number);
    const Document<T> triangle(data, ray);
    const T determinant = triangle.determinant();
    const T u = planar::inner(planar::outer(triangle.d, triangle.e2), triangle.from) / determinant;
    const T v = planar::inner(planar::outer(triangle.from, triangle.e1), triangle.d) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1;
  });
}

// -------------------------------------------------------------------------------------------------- system

namespace {

/// p + delta d - (v0 + u e1 + v e2) = 0 in (delta, u, v).
struct TriangleEquations {
  std::array<Vec3, 3> vertices;
  LocalRay ray;

  template <class T>
  static void eval(const void* self, const BasicVector<T>& x, BasicVector<T>& f, BasicMatrix<T>& jacobian) {
    const auto& system = *static_cast<const TriangleEquations*>(self);
    const auto p = system.ray.template point_at<T>(x[0]);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = [&](std::size_t i) { return static_cast<T>(component(system.vertices[i], k)); };
      const T e1 = at(1) - at(0), e2 = at(2) - at(0);
      f[k] = p[k] - at(0) - x[1] * e1 - x[2] * e2;
      jacobian[k] = {static_cast<T>(component(system.ray.d, k)), -e1, -e2};
    }
  }

  /// Any point of the triangle, and where the ray passes nearest to it.
  template <class T>
  static bool start(const void* self, Rng& rng, BasicVector<T>& x) {
    const auto& system = *static_cast<const TriangleEquations*>(self);
    const double u = rng.uniform();
    const double v = (1 - u) * rng.uniform();
    const auto& [a, b, c] = system.vertices;
    const Vec3 target = a + u * (b - a) + v * (c - a);
    const Vec3& d = system.ray.d;
    const double delta = dot(target - system.ray.p, d) / dot(d, d);
    x = {static_cast<T>(std::clamp(delta, system.ray.lo, system.ray.hi)), static_cast<T>(u),
         static_cast<T>(v)};
    return true;
  }

  template <class T>
  [[nodiscard]] BasicSystemEquation<T> equation() const {
    BasicSystemEquation<T> equation;
    equation.self = this;
    equation.unknowns = 3;
    equation.eval = &TriangleEquations::template eval<T>;
    equation.start = &TriangleEquations::template start<T>;
    equation.lo = {detail::lower_end<T>(ray.lo), 0, 0};
    equation.hi = {detail::upper_end<T>(ray.hi), 1, 1};
    double size = max_abs(ray.p);
    for (const Vec3& v : vertices) size = std::max(size, max_abs(v));
    equation.residual_scale = static_cast<T>(size);
    equation.max_roots = 1;
    equation.seed = ray.seed();
    return equation;
  }
};

}  // namespace

TriangleSystem::TriangleSystem(const Triangle& surface) : data(surface.data) {}

FormulationInfo TriangleSystem::info() {
  return {"system",
          "o + l d = v0 + u (v1 - v0) + v (v2 - v0): three equations in (l, u, v), recentred",
          "document 002",
          {Form::system},
          1};
}

void TriangleSystem::pose(const LocalRay& ray, EquationBlock& block) const {
  if (!planar::is_usable(ray) || !std::isfinite(ray.hi)) return block.settle(Status::failed);
  const auto* const self = block.arena().make(TriangleEquations{data.vertices, ray});
  if (block.precision() == Precision::binary32) {
    block.pose(self->equation<float>());
  } else {
    block.pose(self->equation<double>());
  }
}

void TriangleSystem::lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
                          std::vector<LocalHit>& hits) const {
  if (root.others[0] + root.others[1] <= 1) hits.push_back({.multiplicity = 1, .delta = root.x});
}

// ------------------------------------------------------------------------------------------------ triangle

SurfaceInfo Triangle::info() {
  SurfaceInfo info;
  info.summary = "the closed triangle with three vertices";
  info.source = "documents 001 and 002";
  info.page = "surfaces/triangle.md";
  info.parameters = {"vertices"};
  info.params = {"u", "v"};
  return info;
}

Parameters Triangle::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"vertices"}};
  return scale_lengths(parameters, kLengths, factor);
}

Triangle::Triangle(const SurfaceSpec& spec) {
  const std::vector<Vec3> given = planar::vertices_of(spec);
  if (given.size() != 3) throw std::invalid_argument("vertices must be three points: this is a triangle");
  std::copy(given.begin(), given.end(), vertices_.begin());
  size_ = planar::extent_of(vertices_);
  if (size_ == 0) throw std::invalid_argument("vertices are one point: the triangle is degenerate");
  unit_ = exponent_of(size_);
  for (std::size_t i = 0; i < 3; ++i) data.vertices[i] = scale_by_power(vertices_[i], -unit_);
  data.bits = planar::bits_of(data.vertices);
  data.plane = planar::plane_of(data.vertices);
  if (planar::is_degenerate(data.plane))
    throw std::invalid_argument("vertices lie on one line: the triangle is degenerate");
  normal_ = data.plane.unit_normal();
  data.dropped = planar::largest_axis(normal_);
  ball_ = planar::ball_about(data.vertices);
}

LocalPoint Triangle::describe(const LocalRay& ray, const LocalHit& hit) const {
  if (hit.multiplicity == 2) return {normal_, {hit.t == 1 ? 1.0 : 0.0, hit.t == 2 ? 1.0 : 0.0}};
  const planar::Judge judge(data.plane.holds(ray) && data.holds(ray));
  std::array<double, 3> weight{};
  for (std::size_t i = 0; i < 3; ++i) {
    weight[i] =
        std::fabs(mid(judge.enclosure([&](auto number) { return data.weight<decltype(number)>(ray, i); })));
  }
  const double whole = weight[0] + weight[1] + weight[2];
  if (!(whole > 0 && std::isfinite(whole))) return {normal_, {}};
  return {normal_, {weight[1] / whole, weight[2] / whole}};
}

}  // namespace graze
