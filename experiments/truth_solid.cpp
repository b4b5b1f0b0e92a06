// Truth for convex solids: box, tetrahedron and convex_polyhedron, all of them intersections of half-spaces.
//
// A ray needs the half-spaces alone; see truth_figure.hpp. That they enclose a solid, and its faces, from
// which distances are measured, are found once by cutting a cube.
#include <algorithm>
#include <array>
#include <graze/experiments/truth_figure.hpp>
#include <graze/experiments/truth_types.hpp>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace graze::truth {
namespace {

/// A point x / w, w > 0, without a common factor: its integers stay as small as the planes that make it
/// allow.
struct Corner {
  Vector x;
  Integer w;
};

Integer height_over(const Plane& plane, const Corner& c) { return inner(plane.n, c.x) - plane.b * c.w; }

/// The point of the segment a b in a plane that a is under and b is over.
Corner meet(const Corner& a, const Integer& under, const Corner& b, const Integer& over) {
  Corner c;
  for (std::size_t k = 0; k < 3; ++k) c.x[k] = over * a.x[k] - under * b.x[k];
  c.w = over * a.w - under * b.w;
  Integer common = c.w;
  for (const Integer& x : c.x) common = boost::multiprecision::gcd(common, x);
  for (Integer& x : c.x) x /= common;
  c.w /= common;
  return c;
}

/// A bounded convex solid as corners and sides, cut by one half-space after the other.
class Polytope {
 public:
  struct Side {
    std::optional<std::size_t> plane;  ///< none: a side of the cube it started from
    std::vector<std::size_t> corners;  ///< counterclockwise from outside
  };

  /// The cube |x_i| <= size.
  explicit Polytope(const Integer& size);
  /// False, and nothing is changed, if no interior is left.
  [[nodiscard]] bool cut(const Plane& plane, std::size_t index);
  /// The part in a half-space without interior: a convex polygon, a segment's or a point's corners, or none.
  [[nodiscard]] std::vector<Corner> contact(const Plane& plane) const;
  [[nodiscard]] const std::vector<Side>& sides() const { return sides_; }
  [[nodiscard]] const std::vector<Corner>& corners() const { return corners_; }

 private:
  std::vector<std::size_t> clipped(const std::vector<std::size_t>& cycle);
  [[nodiscard]] std::vector<std::size_t> section() const;
  std::size_t corner_between(std::size_t a, std::size_t b);
  void drop_unused_corners();

  std::vector<Corner> corners_;
  std::vector<Side> sides_;
  std::vector<Integer> heights_;  ///< of the corners over the plane of the cut
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> made_;
};

Polytope::Polytope(const Integer& size) {
  for (unsigned i = 0; i < 8; ++i) {
    const auto coordinate = [&](unsigned bit) { return (i & bit) != 0 ? size : Integer(-size); };
    corners_.push_back({{coordinate(1), coordinate(2), coordinate(4)}, Integer(1)});
  }
  for (const std::vector<std::size_t>& cycle : {std::vector<std::size_t>{0, 4, 6, 2},
                                                {1, 3, 7, 5},
                                                {0, 1, 5, 4},
                                                {2, 6, 7, 3},
                                                {0, 2, 3, 1},
                                                {4, 5, 7, 6}})
    sides_.push_back({std::nullopt, cycle});
}

std::size_t Polytope::corner_between(std::size_t a, std::size_t b) {
  if (sign(heights_[a]) > 0) std::swap(a, b);
  const auto [place, is_new] = made_.try_emplace({a, b}, corners_.size());
  if (is_new) {
    corners_.push_back(meet(corners_[a], heights_[a], corners_[b], heights_[b]));
    heights_.emplace_back(0);
  }
  return place->second;
}

std::vector<std::size_t> Polytope::clipped(const std::vector<std::size_t>& cycle) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const std::size_t a = cycle[i];
    const std::size_t b = cycle[(i + 1) % cycle.size()];
    if (sign(heights_[a]) <= 0) kept.push_back(a);
    if (sign(heights_[a]) * sign(heights_[b]) < 0) kept.push_back(corner_between(a, b));
  }
  return kept;
}

bool Polytope::cut(const Plane& plane, std::size_t index) {
  heights_.clear();
  made_.clear();
  for (const Corner& c : corners_) heights_.push_back(height_over(plane, c));
  const auto is_at = [](int side) { return [side](const Integer& h) { return sign(h) == side; }; };
  if (std::none_of(heights_.begin(), heights_.end(), is_at(-1))) return false;
  if (std::none_of(heights_.begin(), heights_.end(), is_at(1))) return true;
  std::vector<Side> kept;
  for (const Side& side : sides_) {
    std::vector<std::size_t> cycle = clipped(side.corners);
    if (cycle.size() >= 3) kept.push_back({side.plane, std::move(cycle)});
  }
  sides_ = std::move(kept);
  sides_.push_back({index, section()});
  drop_unused_corners();
  return true;
}

/// The cycle in the plane of the cut. It passes the edges that the sides have there in the other direction.
std::vector<std::size_t> Polytope::section() const {
  std::map<std::size_t, std::size_t> next;
  for (const Side& side : sides_) {
    for (std::size_t i = 0; i < side.corners.size(); ++i) {
      const std::size_t a = side.corners[i];
      const std::size_t b = side.corners[(i + 1) % side.corners.size()];
      if (sign(heights_[a]) == 0 && sign(heights_[b]) == 0) next[b] = a;
    }
  }
  std::vector<std::size_t> cycle;
  const std::size_t start = next.begin()->first;
  for (std::size_t at = start; cycle.empty() || at != start; at = next.at(at)) cycle.push_back(at);
  return cycle;
}

void Polytope::drop_unused_corners() {
  std::map<std::size_t, std::size_t> renamed;
  std::vector<Corner> used;
  for (Side& side : sides_) {
    for (std::size_t& c : side.corners) {
      const auto [place, is_new] = renamed.try_emplace(c, used.size());
      if (is_new) used.push_back(corners_[c]);
      c = place->second;
    }
  }
  corners_ = std::move(used);
}

std::vector<Corner> Polytope::contact(const Plane& plane) const {
  const auto touches = [&](std::size_t c) { return sign(height_over(plane, corners_[c])) == 0; };
  // The largest part of one side's cycle that touches is the whole contact.
  std::vector<Corner> most;
  for (const Side& side : sides_) {
    std::vector<Corner> here;
    for (const std::size_t c : side.corners)
      if (touches(c)) here.push_back(corners_[c]);
    if (here.size() > most.size()) most = std::move(here);
  }
  return most;
}

/// A convex polygon, segment or point clipped by a half-space.
std::vector<Corner> clipped(const std::vector<Corner>& cycle, const Plane& plane) {
  std::vector<Corner> kept;
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    const Corner& a = cycle[i];
    const Corner& b = cycle[(i + 1) % cycle.size()];
    const Integer at_a = height_over(plane, a);
    const Integer at_b = height_over(plane, b);
    if (sign(at_a) <= 0) kept.push_back(a);
    if (sign(at_a) * sign(at_b) < 0)
      kept.push_back(sign(at_a) < 0 ? meet(a, at_a, b, at_b) : meet(b, at_b, a, at_a));
  }
  return kept;
}

/// Coordinates of every basic solution of the planes are smaller: a numerator of Cramer's rule has six
/// products of two normals' parts and one right side, a denominator is 1 at least.
Integer cube_around(const std::vector<Plane>& planes) {
  long normal = 0;
  long level = 0;
  for (const Plane& plane : planes) {
    for (const Integer& c : plane.n) normal = std::max(normal, bits(c));
    level = std::max(level, bits(plane.b));
  }
  return shifted(Integer(1), 2 * normal + level + 4);
}

/// Throws unless the half-spaces leave a bounded solid with interior.
Polytope intersect(const std::vector<Plane>& planes) {
  Polytope solid(cube_around(planes));
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (solid.cut(planes[i], i)) continue;
    std::vector<Corner> left = solid.contact(planes[i]);
    for (std::size_t j = i + 1; j < planes.size(); ++j) left = clipped(left, planes[j]);
    throw std::invalid_argument(left.empty() ? "halfspaces have no common point: the solid is empty"
                                             : "halfspaces leave no interior: the solid is flat");
  }
  for (const Polytope::Side& side : solid.sides())
    if (!side.plane) throw std::invalid_argument("halfspaces do not enclose the solid: it is unbounded");
  return solid;
}

class Solid final : public Figure {
 public:
  explicit Solid(const Planes& planes);
  [[nodiscard]] double distance(Vec3 point) const override;

 protected:
  [[nodiscard]] Contacts find(const Question& q) const override;

 private:
  std::vector<Patch> patches_;
};

Solid::Solid(const Planes& planes) {
  e_ = planes.e;
  for (const Plane& plane : planes.list) facets_.push_back(make_facet(plane));
  const Polytope solid = intersect(planes.list);
  for (const Polytope::Side& side : solid.sides()) {
    std::vector<QuadPoint> corners;
    for (const std::size_t c : side.corners)
      corners.push_back(to_quads(solid.corners()[c].x, solid.corners()[c].w, e_));
    patches_.emplace_back(std::move(corners), unit(planes.list[*side.plane].n));
  }
}

Contacts Solid::find(const Question& q) const {
  const Passage passage = pass(facets_, q);
  if (passage.empty || sign(passage.out->top) <= 0) return std::vector<Contact>{};
  const auto at = [](const Fraction& l, std::uint32_t multiplicity, std::size_t face) {
    return Contact{l, multiplicity, face, {static_cast<double>(face), 0}};
  };
  if (compare(*passage.in, *passage.out) == 0)
    return in_front(at(*passage.in, 2, std::min(passage.first_in, passage.first_out)));
  if (passage.along) return std::nullopt;
  std::vector<Contact> contacts;
  if (sign(passage.in->top) > 0) contacts.push_back(at(*passage.in, 1, passage.first_in));
  contacts.push_back(at(*passage.out, 1, passage.first_out));
  return contacts;
}

double Solid::distance(Vec3 point) const {
  const QuadPoint p = to_quads(point);
  Quad best = std::numeric_limits<double>::infinity();
  for (const Patch& patch : patches_)
    if (abs(patch.height(p)) < best) best = std::min<Quad>(best, patch.distance(p));
  return static_cast<double>(best);
}

}  // namespace

std::unique_ptr<Surface> make_box(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 2> kNames{"min", "max"};
  spec.parameters.expect_only(kNames, "box");
  const Vec3 min = read_vector(spec.parameters, "min");
  const Vec3 max = read_vector(spec.parameters, "max");
  if (min.x > max.x || min.y > max.y || min.z > max.z)
    throw std::invalid_argument("min must be below max in every coordinate: the box is empty");
  if (min.x == max.x || min.y == max.y || min.z == max.z)
    throw std::invalid_argument("min must be below max in every coordinate: the box is flat");
  return std::make_unique<Solid>(world_planes(spec.placement, {{{-1, 0, 0}, -min.x},
                                                               {{1, 0, 0}, max.x},
                                                               {{0, -1, 0}, -min.y},
                                                               {{0, 1, 0}, max.y},
                                                               {{0, 0, -1}, -min.z},
                                                               {{0, 0, 1}, max.z}}));
}

std::unique_ptr<Surface> make_tetrahedron(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"vertices"};
  spec.parameters.expect_only(kNames, "tetrahedron");
  const std::vector<Vec3> vertices = read_points(spec.parameters, "vertices");
  expect_count(vertices, 4);
  static_cast<void>(prepare(spec.placement));
  const Points world = world_points(spec.placement, exact_points(vertices));
  Planes planes;
  planes.e = world.e;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector& a = world.at[(i + 1) % 4];
    Vector n = cross(world.at[(i + 2) % 4] - a, world.at[(i + 3) % 4] - a);
    const int side = sign(inner(n, world.at[i] - a));
    if (side == 0) throw std::invalid_argument("vertices lie in one plane: the tetrahedron is flat");
    if (side > 0) n = negated(n);
    planes.list.push_back(reduced({n, inner(n, a)}));
  }
  return std::make_unique<Solid>(planes);
}

std::unique_ptr<Surface> make_convex_polyhedron(const SurfaceSpec& spec) {
  constexpr std::array<std::string_view, 1> kNames{"halfspaces"};
  // Cutting 256 half-spaces takes a fraction of a second.
  constexpr std::size_t kMost = 256;
  spec.parameters.expect_only(kNames, "convex_polyhedron");
  std::vector<HalfSpace> halfspaces;
  for (const auto& row : spec.parameters.table("halfspaces", 4)) {
    const Vec3 n{row[0], row[1], row[2]};
    if (max_abs(n) == 0)
      throw std::invalid_argument("halfspaces[" + std::to_string(halfspaces.size()) +
                                  "] has a normal of zero");
    halfspaces.push_back({n, row[3]});
  }
  if (halfspaces.size() > kMost)
    throw std::invalid_argument("halfspaces must hold at most " + std::to_string(kMost) + " rows");
  return std::make_unique<Solid>(world_planes(spec.placement, halfspaces));
}

}  // namespace graze::truth
