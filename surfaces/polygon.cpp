#include <graze/surfaces/polygon.hpp>

#include <numeric>

namespace graze {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument("vertices" + why); }

// ---------------------------------------------------------------------------------- the polygon in its plane

/// The vertices in the projection that drops one axis, and exact decisions about them.
class Outline {
 public:
  Outline(const PolygonData& data)
      : v_(data.vertices),
        i_((data.dropped + 1) % 3),
        j_((data.dropped + 2) % 3),
        exact_(planar::is_exact(data.bits * data.bits)) {}

  [[nodiscard]] std::size_t size() const { return v_.size(); }

  /// On which side of the line from a to b is c?
  [[nodiscard]] int side(std::size_t a, std::size_t b, std::size_t c) const {
    planar::Judge judge(exact_);
    return judge.sign([&](auto number) {
      using T = decltype(number);
      return (x<T>(b) - x<T>(a)) * (y<T>(c) - y<T>(a)) - (y<T>(b) - y<T>(a)) * (x<T>(c) - x<T>(a));
    });
  }
  /// The sign of (a - c).(b - c).
  [[nodiscard]] int angle(std::size_t a, std::size_t b, std::size_t c) const {
    planar::Judge judge(exact_);
    return judge.sign([&](auto number) {
      using T = decltype(number);
      return (x<T>(a) - x<T>(c)) * (x<T>(b) - x<T>(c)) + (y<T>(a) - y<T>(c)) * (y<T>(b) - y<T>(c));
    });
  }
  [[nodiscard]] bool same(std::size_t a, std::size_t b) const {
    return component(v_[a], i_) == component(v_[b], i_) && component(v_[a], j_) == component(v_[b], j_);
  }

  /// Do the closed edges from a to b and from c to d have a point in common?
  [[nodiscard]] bool meet(std::size_t a, std::size_t b, std::size_t c, std::size_t d) const {
    const int c_side = side(a, b, c), d_side = side(a, b, d);
    const int a_side = side(c, d, a), b_side = side(c, d, b);
    if (c_side * d_side < 0 && a_side * b_side < 0) return true;
    const auto between = [&](int at, std::size_t from, std::size_t to, std::size_t point) {
      return at == 0 && angle(from, to, point) <= 0;
    };
    return between(c_side, a, b, c) || between(d_side, a, b, d) || between(a_side, c, d, a) ||
           between(b_side, c, d, b);
  }

 private:
  template <class T>
  [[nodiscard]] T x(std::size_t i) const {
    return exactly<T>(component(v_[i], i_));
  }
  template <class T>
  [[nodiscard]] T y(std::size_t i) const {
    return exactly<T>(component(v_[i], j_));
  }

  std::span<const Vec3> v_;
  std::size_t i_, j_;
  bool exact_;
};

/// Are edges i < j at odds: do they meet elsewhere than at the vertex that neighbours share?
bool conflict(const Outline& outline, std::size_t i, std::size_t j) {
  const std::size_t n = outline.size();
  const std::size_t a = i, b = i + 1, c = j, d = (j + 1) % n;
  const auto folds_back = [&](std::size_t from, std::size_t corner, std::size_t to) {
    return outline.side(from, corner, to) == 0 && outline.angle(from, to, corner) > 0;
  };
  if (j == i + 1) return folds_back(a, b, d);
  if (i == 0 && j == n - 1) return folds_back(c, a, b);
  return outline.meet(a, b, c, d);
}

void check_edges(std::span<const Vec3> v) {
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (v[i] == v[(i + 1) % v.size()]) refuse(": edge " + std::to_string(i) + " has no length");
  }
}

/// Every vertex within 2^-46 of the polygon's size of its plane: what rounding coordinates may do to it, with
/// 2^7 ulps of room.
void check_planar(const PolygonData& data, double size) {
  constexpr double kTolerance = 0x1p-46;
  const Bits height = data.plane.n_bits * data.bits;
  planar::Judge judge(data.plane.exact && planar::is_exact(height * height));
  const auto base = data.vertices[0];
  for (std::size_t i = 1; i < data.vertices.size(); ++i) {
    const int beyond = judge.sign([&](auto number) {
      using T = decltype(number);
      const planar::Array3<T> n = data.plane.normal<T>();
      const T h = planar::inner(
          n, planar::difference(planar::exactly<T>(data.vertices[i]), planar::exactly<T>(base)));
      return h * h -
             exactly<T>(kTolerance * kTolerance) * exactly<T>(size) * exactly<T>(size) * planar::inner(n, n);
    });
    if (beyond > 0) refuse("[" + std::to_string(i) + "] is not in the polygon's plane");
  }
}

void check_simple(const Outline& outline) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (outline.same(i, (i + 1) % outline.size()))
      refuse(": edge " + std::to_string(i) + " has no length in the polygon's plane");
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    for (std::size_t j = i + 1; j < outline.size(); ++j) {
      if (conflict(outline, i, j)) {
        refuse(": edges " + std::to_string(i) + " and " + std::to_string(j) +
               " meet: the polygon intersects itself");
      }
    }
  }
}

}  // namespace

// --------------------------------------------------------------------------------------------------- exact

PolygonExact::PolygonExact(const Polygon& surface) : data(&surface.data) {}

FormulationInfo PolygonExact::info() {
  return {"exact",
          "N.(p - v0) + (N.d) delta = 0; inside by half-open even-odd in ray space, in exact signs",
          "graze (surfaces/polygon.md)",
          {Form::polynomial, Form::scalar, Form::interval},
          1};
}

void PolygonExact::pose(const LocalRay& ray, EquationBlock& block) const {
  const Bits x = data->bits | planar::bits_of(ray.o);
  const bool exact = planar::is_exact(x * x * (x | planar::bits_of(ray.d)));
  const auto edges = static_cast<std::uint32_t>(data->vertices.size());
  planar::pose_exact(
      block, ray, data->plane, exact,
      [&](planar::Judge& judge) {
        block.spend(edges);
        return is_inside(ray, judge);
      },
      [&](planar::Judge& judge) {
        block.spend(edges);
        const auto found = planar::within_polygon(data->vertices, ray, data->dropped, judge);
        const bool coincident = found.kind == planar::WithinPolygon::Kind::coincident;
        if (coincident && !judge.undecided()) block.settle(Status::coincident);
      });
}

/// Along the ray the vertices are points (U, V) of a plane, U = (w_i - o_i) d_k - (w_k - o_k) d_i and V with
/// j for i, k the largest axis of d, both times the sign of d_k; the ray is (0, 0). An edge counts if it
/// leaves the half plane V >= 0, or enters it, at U > 0. There U_a V_b - V_a U_b = d_k det(d, a - o, b - o).
bool PolygonExact::is_inside(const LocalRay& ray, planar::Judge& judge) const {
  const std::size_t k = planar::largest_axis(ray.d), j = (k + 2) % 3;
  const int facing = component(ray.d, k) > 0 ? 1 : -1;
  const auto is_above = [&](Vec3 w) {
    return facing * judge.sign([&](auto number) {
      using T = decltype(number);
      const planar::Array3<T> p = planar::point_of_line<T>(ray), d = direction_as<T>(ray);
      const planar::Array3<T> from = planar::difference(planar::exactly<T>(w), p);
      return from[j] * d[k] - from[k] * d[j];
    }) >= 0;
  };
  const auto turn = [&](Vec3 a, Vec3 b) {
    return facing * judge.sign([&](auto number) {
      using T = decltype(number);
      const planar::Array3<T> p = planar::point_of_line<T>(ray);
      return planar::volume(direction_as<T>(ray), planar::difference(planar::exactly<T>(a), p),
                            planar::difference(planar::exactly<T>(b), p));
    });
  };
  bool odd = false;
  Vec3 a = data->vertices.back();
  bool a_above = is_above(a);
  for (const Vec3& b : data->vertices) {
    const bool b_above = is_above(b);
    if (a_above != b_above && turn(a, b) == (b_above ? 1 : -1)) odd = !odd;
    a = b;
    a_above = b_above;
  }
  return odd;
}

void PolygonExact::lift(const LocalRay& /*ray*/, const Posed& posed, const Root& root,
                        std::vector<LocalHit>& hits) const {
  planar::lift_exact(posed, root, hits);
}

// ------------------------------------------------------------------------------------------------- even_odd

PolygonEvenOdd::PolygonEvenOdd(const Polygon& surface) : data(&surface.data) {}

FormulationInfo PolygonEvenOdd::info() {
  return {"even_odd",
          "t = N.(v0 - o) / (N.d), then even-odd about the point, dominant coordinate dropped",
          "document 001",
          {Form::polynomial, Form::scalar, Form::interval},
          1,
          true};
}

void PolygonEvenOdd::pose(const LocalRay& ray, EquationBlock& block) const {
  planar::pose_plain(block, ray, ray.seed(), [&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> n = data->plane.normal<T>();
    const planar::Array3<T> from =
        planar::difference(planar::exactly<T>(ray.o), planar::exactly<T>(data->vertices[0]));
    return std::array<T, 2>{planar::inner(n, from), planar::inner(n, planar::exactly<T>(ray.d))};
  });
}

void PolygonEvenOdd::lift(const LocalRay& ray, const Posed& posed, const Root& root,
                          std::vector<LocalHit>& hits) const {
  planar::lift_plain(ray, posed, root, hits, [&](auto number) {
    using T = decltype(number);
    const planar::Array3<T> x = planar::plain_point<T>(ray, root.x);
    const std::size_t i = (data->dropped + 1) % 3, j = (data->dropped + 2) % 3;
    const auto at = [&](Vec3 w, std::size_t axis) { return static_cast<T>(component(w, axis)) - x[axis]; };
    bool odd = false;
    Vec3 a = data->vertices.back();
    for (const Vec3& b : data->vertices) {
      const T ua = at(a, i), va = at(a, j), ub = at(b, i), vb = at(b, j);
      a = b;
      if ((va < 0) == (vb < 0)) continue;
      if ((ua > 0 && ub > 0) || ((ua > 0 || ub > 0) && ua - va * (ub - ua) / (vb - va) > 0)) odd = !odd;
    }
    return odd;
  });
}

// ------------------------------------------------------------------------------------------------- polygon

SurfaceInfo Polygon::info() {
  SurfaceInfo info;
  info.summary = "a simple planar polygon by the even-odd rule";
  info.source = "document 001";
  info.page = "surfaces/polygon.md";
  info.parameters = {"vertices"};
  return info;
}

Parameters Polygon::scaled(const Parameters& parameters, double factor) {
  constexpr std::array kLengths{Length{"vertices"}};
  return scale_lengths(parameters, kLengths, factor);
}

Polygon::Polygon(const SurfaceSpec& spec) : vertices_(planar::vertices_of(spec)) {
  if (vertices_.size() < 3) refuse(" must be at least three points");
  check_edges(vertices_);
  size_ = planar::extent_of(vertices_);
  unit_ = exponent_of(size_);
  for (const Vec3& v : vertices_) data.vertices.push_back(scale_by_power(v, -unit_));
  data.bits = planar::bits_of(data.vertices);
  data.plane = planar::plane_of(data.vertices);
  if (planar::is_degenerate(data.plane)) refuse(" enclose no area: the polygon is degenerate");
  normal_ = data.plane.unit_normal();
  data.dropped = planar::largest_axis(normal_);
  check_planar(data, scale_by_power(size_, -unit_));
  check_simple(Outline(data));
  ball_ = planar::ball_about(data.vertices);
  cut_into_ears();
}

Bounds Polygon::bounds() const {
  // Hits lie on the reference plane, up to the tolerance of planarity from the vertices: four times that.
  const Bounds box = planar::box_of(vertices_);
  const Vec3 wide{0x1p-44 * size_, 0x1p-44 * size_, 0x1p-44 * size_};
  const Bounds rounded = box_about(0.5 * box.lo + 0.5 * box.hi, 0.5 * box.hi - 0.5 * box.lo + wide);
  return hull(box, rounded);
}

/// Cuts off triangles with no vertex inside, until one is left: raw material for samples.
void Polygon::cut_into_ears() {
  const Outline outline(data);
  const int turn = component(normal_, data.dropped) > 0 ? 1 : -1;
  std::vector<std::size_t> left(vertices_.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  double area = 0;
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const auto& v = data.vertices;
    area += norm(cross(v[b] - v[a], v[c] - v[a]));
    ears_.push_back({{a, b, c}, area});
  };
  const auto is_ear = [&](std::size_t i) {
    const std::size_t a = left[(i + left.size() - 1) % left.size()], b = left[i],
                      c = left[(i + 1) % left.size()];
    if (outline.side(a, b, c) * turn <= 0) return false;
    return std::none_of(left.begin(), left.end(), [&](std::size_t p) {
      return p != a && p != b && p != c && outline.side(a, b, p) * turn >= 0 &&
             outline.side(b, c, p) * turn >= 0 && outline.side(c, a, p) * turn >= 0;
    });
  };
  const auto is_straight = [&](std::size_t i) {
    const std::size_t n = left.size();
    return outline.side(left[(i + n - 1) % n], left[i], left[(i + 1) % n]) == 0;
  };
  while (left.size() >= 3) {
    std::size_t i = 0;
    while (i < left.size() && !is_ear(i) && !is_straight(i)) ++i;
    if (i == left.size()) break;  // numbers beyond exact decisions: what is cut so far will do
    const std::size_t n = left.size();
    if (!is_straight(i)) add(left[(i + n - 1) % n], left[i], left[(i + 1) % n]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (ears_.empty()) add(0, 1, 2);
  for (Ear& ear : ears_) ear.end /= area;
}

SurfaceSample Polygon::sample(double u, double v) const {
  auto ear = std::find_if(ears_.begin(), ears_.end(), [&](const Ear& e) { return u < e.end; });
  if (ear == ears_.end()) --ear;
  const double begin = ear == ears_.begin() ? 0 : std::prev(ear)->end;
  const double share = ear->end > begin ? std::clamp((u - begin) / (ear->end - begin), 0.0, 1.0) : 0;
  const auto [a, b, c] = ear->corners;
  const Vec3 point = planar::sample_triangle(vertices_[a], vertices_[b], vertices_[c], share, v);
  // From the vertices' plane to the reference plane.
  return {point - dot(point - vertices_[0], normal_) * normal_, normal_};
}

}  // namespace graze
