#include <graze/surfaces/convex_polyhedron.hpp>

#include <bitset>
#include <string>
#include <utility>

namespace graze {
namespace {

/// Room for the planes that are added to a system of too few directions.
constexpr std::size_t kMostPlanes = ConvexPolyhedron::kMostHalfspaces + 4;
using PlaneSet = std::bitset<kMostPlanes>;

template <class T>
using Vector3 = std::array<T, 3>;

template <class T>
Vector3<T> vector_as(Vec3 v) {
  return {exactly<T>(v.x), exactly<T>(v.y), exactly<T>(v.z)};
}
template <class T>
T inner(const Vector3<T>& a, const Vector3<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Vector3<T> outer(const Vector3<T>& a, const Vector3<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// ------------------------------------------------------------------------------------------------- corners

/// A corner of the solid and all planes through it.
struct Corner {
  PlaneSet planes;
  Vec3 point;
};

/// The common point x / w of three planes by Cramer's rule.
template <class T>
struct Meeting {
  Vector3<T> x;
  T w;

  Meeting(const HalfspaceFace& p, const HalfspaceFace& q, const HalfspaceFace& r) {
    const auto a = vector_as<T>(p.n), b = vector_as<T>(q.n), c = vector_as<T>(r.n);
    const auto bc = outer(b, c), ca = outer(c, a), ab = outer(a, b);
    w = inner(a, bc);
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = exactly<T>(p.b) * bc[k] + exactly<T>(q.b) * ca[k] + exactly<T>(r.b) * ab[k];
    }
  }
  /// w times the height over a plane.
  [[nodiscard]] T height(const HalfspaceFace& plane) const {
    return inner(vector_as<T>(plane.n), x) - exactly<T>(plane.b) * w;
  }
};

/// Corners of the intersection of half-spaces, from all triples of planes, every decision exact.
class CornerSearch {
 public:
  explicit CornerSearch(std::span<const HalfspaceFace> planes) : planes_(planes) {
    for (std::size_t m = 0; m < planes.size(); ++m) order_.push_back(m);
    for (std::size_t i = 0; i < planes.size(); ++i) {
      for (std::size_t j = i + 1; j < planes.size(); ++j) {
        for (std::size_t k = j + 1; k < planes.size(); ++k) examine({i, j, k});
      }
    }
  }
  [[nodiscard]] const std::vector<Corner>& corners() const { return corners_; }
  /// Whether three of the normals are independent.
  [[nodiscard]] bool has_full_rank() const { return has_full_rank_; }

 private:
  using Triple = std::array<std::size_t, 3>;

  template <class T>
  [[nodiscard]] Meeting<T> meeting(const Triple& t) const {
    return {planes_[t[0]], planes_[t[1]], planes_[t[2]]};
  }

  void examine(const Triple& triple) {
    const Meeting<Interval> quick = meeting<Interval>(triple);
    const int side = exact_sign([&](auto number) { return meeting<decltype(number)>(triple).w; });
    if (side == 0) return;
    has_full_rank_ = true;
    if (is_surely_outside(quick, side) || is_known(triple)) return;
    std::optional<PlaneSet> planes = planes_through(quick, side, triple);
    if (planes) corners_.push_back({*planes, rounded(triple)});
  }

  /// Most triples meet outside of some plane, often of the one that excluded the triple before.
  bool is_surely_outside(const Meeting<Interval>& quick, int side) {
    for (std::size_t at = 0; at < order_.size(); ++at) {
      const Interval height = quick.height(planes_[order_[at]]);
      if (side > 0 ? height.lo > 0 : height.hi < 0) {
        std::swap(order_[at], order_[at / 2]);
        return true;
      }
    }
    return false;
  }
  [[nodiscard]] bool is_known(const Triple& triple) const {
    return std::any_of(corners_.begin(), corners_.end(), [&](const Corner& corner) {
      return std::all_of(triple.begin(), triple.end(), [&](std::size_t i) { return corner.planes.test(i); });
    });
  }
  /// Nothing when the point is outside of one.
  [[nodiscard]] std::optional<PlaneSet> planes_through(const Meeting<Interval>& quick, int side,
                                                       const Triple& triple) const {
    PlaneSet through;
    for (const std::size_t i : triple) through.set(i);
    std::optional<Meeting<Expansion>> exact;
    for (std::size_t m = 0; m < planes_.size(); ++m) {
      if (through.test(m)) continue;
      std::optional<int> height = sign_of(quick.height(planes_[m]));
      if (!height) {
        if (!exact) exact = meeting<Expansion>(triple);
        height = exact->height(planes_[m]).sign();
      }
      if (*height * side > 0) return std::nullopt;
      if (*height == 0) through.set(m);
    }
    return through;
  }
  [[nodiscard]] Vec3 rounded(const Triple& triple) const {
    const Meeting<Expansion> exact = meeting<Expansion>(triple);
    const double w = exact.w.value();
    return {exact.x[0].value() / w, exact.x[1].value() / w, exact.x[2].value() / w};
  }

  std::span<const HalfspaceFace> planes_;
  std::vector<std::size_t> order_;
  std::vector<Corner> corners_;
  bool has_full_rank_ = false;
};

// ------------------------------------------------------------------------------------------------ refusals

/// The largest set of axes whose coordinate planes, added to planes of rank below 3, make the rank 3.
std::vector<std::size_t> missing_axes(std::span<const HalfspaceFace> planes) {
  for (const HalfspaceFace& p : planes) {
    for (const HalfspaceFace& q : planes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto part = [&](auto number) {
          using T = decltype(number);
          return outer(vector_as<T>(p.n), vector_as<T>(q.n))[axis];
        };
        if (exact_sign(part) != 0) return {axis};
      }
    }
  }
  if (planes.empty()) return {0, 1, 2};
  const std::size_t kept = planes[0].n.x != 0 ? 0 : planes[0].n.y != 0 ? 1 : 2;
  return {(kept + 1) % 3, (kept + 2) % 3};
}

/// Whether half-spaces whose normals leave a direction free have a common point. Moving along such a
/// direction stays inside, so that a coordinate across it may be set to zero: then corners tell.
bool have_common_point(std::span<const HalfspaceFace> planes) {
  std::vector<HalfspaceFace> more(planes.begin(), planes.end());
  for (const std::size_t axis : missing_axes(planes)) {
    const Vec3 n{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
    more.push_back({n, 0});
    more.push_back({-n, 0});
  }
  return !CornerSearch(more).corners().empty();
}

/// Whether some direction v != 0 has n.v <= 0 for all normals (of rank 3): then it has an edge n_i x n_j.
bool has_free_direction(std::span<const HalfspaceFace> planes) {
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      int least = 0, greatest = 0;
      bool is_edge = false;
      for (const HalfspaceFace& plane : planes) {
        const int sign = exact_sign([&](auto number) {
          using T = decltype(number);
          return inner(vector_as<T>(plane.n), outer(vector_as<T>(planes[i].n), vector_as<T>(planes[j].n)));
        });
        least = std::min(least, sign);
        greatest = std::max(greatest, sign);
        is_edge = is_edge || sign != 0;
        if (least < 0 && greatest > 0) break;
      }
      // Parallel planes have no edge: all signs are zero, as they are for no other pair where the rank is 3.
      if (is_edge && (least == 0 || greatest == 0)) return true;
    }
  }
  return false;
}

/// Throws unless the half-spaces leave a bounded solid with interior.
std::vector<Corner> corners_of(std::span<const HalfspaceFace> planes) {
  const CornerSearch search(planes);
  const std::vector<Corner>& corners = search.corners();
  const bool is_empty = search.has_full_rank() ? corners.empty() : !have_common_point(planes);
  if (is_empty) throw std::invalid_argument("halfspaces have no common point: the solid is empty");
  if (!search.has_full_rank() || has_free_direction(planes)) {
    throw std::invalid_argument("halfspaces do not enclose the solid: it is unbounded");
  }
  // Without interior some plane holds the whole solid, and so all of its corners.
  PlaneSet common = corners[0].planes;
  for (const Corner& corner : corners) common &= corner.planes;
  if (common.any()) throw std::invalid_argument("halfspaces leave no interior: the solid is flat");
  return corners;
}

// --------------------------------------------------------------------------------------------------- shape

/// Two corners are the ends of an edge where two planes that are not parallel pass through both.
bool is_edge(const PlaneSet& common, std::span<const HalfspaceFace> planes) {
  if (common.count() < 2) return false;
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!common.test(i)) continue;
    if (!first) {
      first = i;
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto part = [&](auto number) {
        using T = decltype(number);
        return outer(vector_as<T>(planes[*first].n), vector_as<T>(planes[i].n))[k];
      };
      if (exact_sign(part) != 0) return true;
    }
  }
  return false;
}

/// The corners of a face in the order of its boundary: by angle about their middle, seen along the normal.
std::vector<std::size_t> cycle_of(std::size_t face, Vec3 n, const std::vector<Corner>& corners) {
  std::vector<std::size_t> cycle;
  Vec3 middle;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (corners[c].planes.test(face)) cycle.push_back(c);
  }
  for (const std::size_t c : cycle)
    middle = middle + (1.0 / static_cast<double>(cycle.size())) * corners[c].point;
  const double size = max_abs(n);
  const auto angle = [&](std::size_t c) {
    const Vec3 v = corners[c].point - middle;
    if (std::fabs(n.x) == size) return std::atan2(v.z, v.y);
    return std::fabs(n.y) == size ? std::atan2(v.x, v.z) : std::atan2(v.y, v.x);
  };
  std::sort(cycle.begin(), cycle.end(), [&](std::size_t a, std::size_t b) { return angle(a) < angle(b); });
  return cycle;
}

/// The shape of planes in units of 2^unit, in object space.
convex::Shape shape_of(std::span<const HalfspaceFace> planes, int unit) {
  const std::vector<Corner> corners = corners_of(planes);
  convex::Shape shape;
  for (const Corner& corner : corners) {
    shape.vertices.push_back(scale_by_power(corner.point, unit));
    if (!is_finite(shape.vertices.back())) {
      throw std::invalid_argument("halfspaces meet in a corner beyond the range of doubles");
    }
  }
  for (std::size_t a = 0; a < corners.size(); ++a) {
    for (std::size_t b = a + 1; b < corners.size(); ++b) {
      if (is_edge(corners[a].planes & corners[b].planes, planes)) shape.edges.push_back({a, b});
    }
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    shape.normals.push_back(normalized(planes[i].n));
    const std::vector<std::size_t> cycle = cycle_of(i, planes[i].n, corners);
    for (std::size_t k = 2; k < cycle.size(); ++k) {
      shape.triangles.push_back({static_cast<std::uint32_t>(i), {cycle[0], cycle[k - 1], cycle[k]}});
    }
  }
  return shape;
}

/// Half-spaces as given, with normals scaled by powers of two to a largest entry in [1, 2).
struct Rows {
  std::vector<Vec3> n;
  std::vector<double> b;
  std::vector<int> exponent;  ///< row i was divided by 2^exponent[i]; b is not yet

  explicit Rows(const Parameters& parameters) {
    const std::vector<std::vector<double>> table = parameters.table("halfspaces", 4);
    if (table.size() > ConvexPolyhedron::kMostHalfspaces) {
      throw std::invalid_argument("halfspaces must hold at most " +
                                  std::to_string(ConvexPolyhedron::kMostHalfspaces) + " rows");
    }
    for (const auto& row : table) {
      const Vec3 normal{row[0], row[1], row[2]};
      if (max_abs(normal) == 0) {
        throw std::invalid_argument("halfspaces[" + std::to_string(n.size()) + "] has a normal of zero");
      }
      exponent.push_back(exponent_of(max_abs(normal)));
      n.push_back(scale_by_power(normal, -exponent.back()));
      b.push_back(row[3]);
    }
  }
  /// The power of two of the farthest plane's distance.
  [[nodiscard]] int farthest() const {
    std::optional<int> most;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (b[i] == 0) continue;
      const int own = exponent_of(b[i]) - exponent[i];
      most = most ? std::max(*most, own) : own;
    }
    return most.value_or(0);
  }
  /// In units of 2^unit.
  [[nodiscard]] std::vector<HalfspaceFace> planes(int unit) const {
    std::vector<HalfspaceFace> list;
    for (std::size_t i = 0; i < n.size(); ++i) {
      list.push_back({n[i], scale_by_power(b[i], -exponent[i] - unit)});
    }
    return list;
  }
};

}  // namespace

SurfaceInfo ConvexPolyhedron::info() {
  SurfaceInfo info;
  info.summary = "the boundary of a bounded intersection of half-spaces";
  info.source = "document 004";
  info.page = "surfaces/convex_polyhedron.md";
  info.parameters = {"halfspaces"};
  info.params = {"face", ""};
  return info;
}

Parameters ConvexPolyhedron::scaled(const Parameters& parameters, double factor) {
  // Normals are directions; only the distances are lengths.
  std::vector<std::vector<double>> rows = parameters.table("halfspaces", 4);
  for (auto& row : rows) row[3] *= factor;
  Parameters moved = parameters;
  moved.set("halfspaces", rows);
  return moved;
}

ConvexPolyhedron::ConvexPolyhedron(const SurfaceSpec& spec) {
  const Rows rows(spec.parameters);
  const int first_unit = rows.farthest();
  shape = shape_of(rows.planes(first_unit), first_unit);
  measure();
  faces = rows.planes(unit());
  for (const HalfspaceFace& face : faces) {
    grain.normal = grain.normal | Bits(face.n);
    grain.offset = grain.offset | Bits(face.b);
  }
}

template struct convex::Exact<ConvexPolyhedron>;
template struct convex::Plain<ConvexPolyhedron>;

static_assert(SurfaceType<ConvexPolyhedron>);

}  // namespace graze
