// Certified truth of flat figures and convex solids against a second engine on FLINT's rationals that states
// every question in another way: rays go to object space by Gauss-Jordan, triangles and tetrahedra are linear
// systems, a polygon's half-open rule is a point moved by a small rational, a solid's hits are the plane
// crossings that lie in all half-spaces, and the kind of a set of half-spaces is told from all its vertices.
#include <flint/fmpq.h>
#include <flint/fmpz.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <graze/experiments/truth.hpp>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "flint_numbers.hpp"
#include "questions.hpp"

namespace graze {
namespace {

using flint::Q;
using test::list;
using test::spec_of;
using test::table;
using Row = std::vector<Q>;

Row row(Vec3 v) { return {Q(v.x), Q(v.y), Q(v.z)}; }

Q dot(const Row& a, const Row& b) {
  Q sum;
  for (std::size_t i = 0; i < a.size(); ++i) sum = sum + a[i] * b[i];
  return sum;
}

Row along(const Row& o, const Q& l, const Row& d) {
  Row x = o;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = x[i] + l * d[i];
  return x;
}

Row minus(const Row& a, const Row& b) { return along(a, Q(-1), b); }

/// The solution of A x = b by Gauss-Jordan; none if A is singular.
std::optional<Row> solve(std::vector<Row> a, Row b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot < n && a[pivot][k].sign() == 0) ++pivot;
    if (pivot == n) return std::nullopt;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const Q f = a[i][k] / a[k][k];
      a[i] = along(a[i], Q(0) - f, a[k]);
      b[i] = b[i] - f * b[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) b[k] = b[k] / a[k][k];
  return b;
}

std::vector<Row> columns(const std::vector<Row>& c) {
  std::vector<Row> a(c[0].size(), Row(c.size()));
  for (std::size_t j = 0; j < c.size(); ++j)
    for (std::size_t i = 0; i < c[j].size(); ++i) a[i][j] = c[j][i];
  return a;
}

struct Line {
  Row o, d;
};

struct Found {
  Q l;
  unsigned multiplicity = 1;
  Row normal;  ///< in object space
  std::array<double, 2> params{};
};

/// None: coincident.
using Hits = std::optional<std::vector<Found>>;

Hits positive(const std::vector<Found>& found) {
  std::vector<Found> kept;
  for (const Found& f : found)
    if (f.l.sign() > 0) kept.push_back(f);
  return kept;
}

/// A surface, and the second engine's answer for a line in its object space.
struct Model {
  SurfaceSpec spec;
  std::function<Hits(const Line&)> hits;
};

std::vector<Row> rows(const std::vector<Vec3>& points) {
  std::vector<Row> result;
  for (const Vec3& p : points) result.push_back(row(p));
  return result;
}

Row cross(const Row& a, const Row& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Model plane_model(Vec3 a, double b, bool one_sided) {
  const Row n = row(a);
  const auto hits = [=](const Line& line) -> Hits {
    const Q speed = dot(n, line.d);
    if (speed.sign() > 0 && one_sided) return std::vector<Found>{};
    if (speed.sign() != 0) return positive({{(Q(b) - dot(n, line.o)) / speed, 1, n, {}}});
    if (dot(n, line.o) == Q(b) && !one_sided) return std::nullopt;
    return std::vector<Found>{};
  };
  return {spec_of("plane", {{"a", list(a)}, {"b", b}, {"one_sided", one_sided}}), hits};
}

/// Barycentric coordinates in the plane, both as linear functions of l.
Hits triangle_in_plane(const std::vector<Row>& v, const Row& n, const Line& line) {
  // x = v0 + u e1 + w e2 + 0 n at two points of the line gives u and w as functions of l.
  const auto a = columns({minus(v[1], v[0]), minus(v[2], v[0]), n});
  const Row at = *solve(a, minus(line.o, v[0]));
  const Row slope = *solve(a, line.d);
  if (at[2].sign() != 0 || slope[2].sign() != 0) return std::vector<Found>{};
  const std::array<Line, 3> weights{Line{{Q(1) - at[0] - at[1]}, {Q(0) - slope[0] - slope[1]}},
                                    Line{{at[0]}, {slope[0]}}, Line{{at[1]}, {slope[1]}}};
  std::optional<Q> lo;
  std::optional<Q> hi;
  for (const Line& w : weights) {
    if (w.d[0].sign() == 0) {
      if (w.o[0].sign() < 0) return std::vector<Found>{};
      continue;
    }
    const Q l = Q(0) - w.o[0] / w.d[0];
    if (w.d[0].sign() > 0 && (!lo || *lo < l)) lo = l;
    if (w.d[0].sign() < 0 && (!hi || l < *hi)) hi = l;
  }
  if (*hi < *lo || hi->sign() <= 0) return std::vector<Found>{};
  if (*lo < *hi) return std::nullopt;
  return std::vector<Found>{
      {*lo, 2, n, {(at[0] + *lo * slope[0]).value(), (at[1] + *lo * slope[1]).value()}}};
}

Model triangle_model(const std::vector<Vec3>& points) {
  const std::vector<Row> v = rows(points);
  const auto hits = [v](const Line& line) -> Hits {
    const Row n = cross(minus(v[1], v[0]), minus(v[2], v[0]));
    // u e1 + w e2 - l d = o - v0
    const auto x = solve(columns({minus(v[1], v[0]), minus(v[2], v[0]), minus({Q(0), Q(0), Q(0)}, line.d)}),
                         minus(line.o, v[0]));
    if (!x) return triangle_in_plane(v, n, line);
    const auto& u = *x;
    if (u[0].sign() < 0 || u[1].sign() < 0 || Q(1) < u[0] + u[1]) return std::vector<Found>{};
    return positive({{u[2], 1, n, {u[0].value(), u[1].value()}}});
  };
  return {spec_of("triangle", {{"vertices", table(points)}}), hits};
}

struct Flat {
  Q u, v;
};

/// The point (u, v) is inside the closed chain: crossings of the half line towards +v, no ties by choice of
/// the point.
bool encloses(const std::vector<Flat>& chain, const Flat& p) {
  bool odd = false;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Flat& a = chain[i];
    const Flat& b = chain[(i + 1) % chain.size()];
    if ((p.u < a.u) == (p.u < b.u)) continue;
    const Q v = a.v + (p.u - a.u) / (b.u - a.u) * (b.v - a.v);
    EXPECT_FALSE(v == p.v);
    if (p.v < v) odd = !odd;
  }
  return odd;
}

bool on_chain(const std::vector<Flat>& chain, const Flat& p) {
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Flat& a = chain[i];
    const Flat& b = chain[(i + 1) % chain.size()];
    const Q du = b.u - a.u;
    const Q dv = b.v - a.v;
    const Q t = ((p.u - a.u) * du + (p.v - a.v) * dv) / (du * du + dv * dv);
    if (t.sign() >= 0 && t <= Q(1) && a.u + t * du == p.u && a.v + t * dv == p.v) return true;
  }
  return false;
}

// Far below every difference of the numbers that occur.
Q tiny() { return Q(0x1p-1000); }

/// In the plane (U, V) of the lines parallel to the ray, "V >= 0" and "U > 0" are the point (tiny, -tiny^2).
bool polygon_is_met(const std::vector<Row>& w, const Line& line) {
  const auto size = [&](std::size_t i) { return line.d[i].sign() < 0 ? Q(0) - line.d[i] : line.d[i]; };
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (size(k) < size(i)) k = i;
  const std::size_t i = (k + 1) % 3;
  const std::size_t j = (k + 2) % 3;
  std::vector<Flat> chain;
  for (const Row& vertex : w) {
    const Row x = minus(vertex, line.o);
    const Q l = x[k] / line.d[k];
    // Divided by |d_k|, which turns no sign.
    chain.push_back({x[i] - l * line.d[i], x[j] - l * line.d[j]});
  }
  return encloses(chain, {tiny(), Q(0) - tiny() * tiny()});
}

bool polygon_is_covered(const std::vector<Row>& w, const Row& n, const Line& line) {
  const auto size = [&](std::size_t i) { return n[i].sign() < 0 ? Q(0) - n[i] : n[i]; };
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (size(k) < size(i)) k = i;
  const auto flat = [k](const Row& x) { return Flat{x[(k + 1) % 3], x[(k + 2) % 3]}; };
  std::vector<Flat> chain;
  for (const Row& x : w) chain.push_back(flat(x));
  const Flat d = flat(line.d);
  std::vector<Q> ends{Q(0)};
  // Feet of all vertices and crossings with all edges' lines: more ends than needed do no harm.
  for (std::size_t i = 0; i < w.size(); ++i) {
    const Flat from = flat(minus(w[i], line.o));
    const Flat edge = flat(minus(w[(i + 1) % w.size()], w[i]));
    const Q determinant = d.u * edge.v - d.v * edge.u;
    if (determinant.sign() != 0) ends.push_back((from.u * edge.v - from.v * edge.u) / determinant);
    ends.push_back((from.u * d.u + from.v * d.v) / (d.u * d.u + d.v * d.v));
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i].sign() < 0 || ends[i] == ends[i + 1]) continue;
    const Flat p = flat(along(line.o, (ends[i] + ends[i + 1]) / Q(2), line.d));
    // Off the edges a small move changes nothing and avoids the ties.
    if (on_chain(chain, p) || encloses(chain, {p.u + tiny(), p.v + tiny() * tiny()})) return true;
  }
  return false;
}

Model polygon_model(const std::vector<Vec3>& points) {
  const std::vector<Row> w = rows(points);
  Row n{Q(0), Q(0), Q(0)};
  for (std::size_t i = 0; i < w.size(); ++i) n = along(n, Q(1), cross(w[i], w[(i + 1) % w.size()]));
  const auto hits = [w, n](const Line& line) -> Hits {
    const Q speed = dot(n, line.d);
    const Q gap = dot(n, minus(w[0], line.o));
    if (speed.sign() == 0) {
      if (gap.sign() == 0 && polygon_is_covered(w, n, line)) return std::nullopt;
      return std::vector<Found>{};
    }
    if (!polygon_is_met(w, line)) return std::vector<Found>{};
    return positive({{gap / speed, 1, n, {}}});
  };
  return {spec_of("polygon", {{"vertices", table(points)}}), hits};
}

Model disk_model(Vec3 center, Vec3 normal, double radius) {
  const Row c = row(center);
  const Row n = row(normal);
  const Q squared = Q(radius) * Q(radius);
  const auto hits = [=](const Line& line) -> Hits {
    const Row from = minus(line.o, c);
    const Q speed = dot(n, line.d);
    if (speed.sign() != 0) {
      const Q l = Q(0) - dot(n, from) / speed;
      const Row x = along(from, l, line.d);
      if (squared < dot(x, x)) return std::vector<Found>{};
      return positive({{l, 1, n, {}}});
    }
    if (dot(n, from).sign() != 0) return std::vector<Found>{};
    const Q nearest = Q(0) - dot(from, line.d) / dot(line.d, line.d);
    const Row foot = along(from, nearest, line.d);
    if (squared == dot(foot, foot)) return positive({{nearest, 2, n, {}}});
    if (squared < dot(foot, foot)) return std::vector<Found>{};
    const bool from_inside = dot(from, from) < squared;
    if (nearest.sign() > 0 || from_inside) return std::nullopt;
    return std::vector<Found>{};
  };
  return {spec_of("disk", {{"center", list(center)}, {"normal", list(normal)}, {"radius", radius}}), hits};
}

struct HalfSpace {
  Row n;
  Q b;
};

/// Crossings with the planes that lie in all half-spaces.
Hits solid_hits(const std::vector<HalfSpace>& planes, const Line& line) {
  const auto value = [&](const HalfSpace& h, const Q& l) { return dot(h.n, along(line.o, l, line.d)) - h.b; };
  std::vector<Q> ends;
  for (const HalfSpace& h : planes) {
    if (dot(h.n, line.d).sign() == 0) continue;
    const Q l = (h.b - dot(h.n, line.o)) / dot(h.n, line.d);
    const bool in_all = std::all_of(planes.begin(), planes.end(),
                                    [&](const HalfSpace& other) { return value(other, l).sign() <= 0; });
    if (in_all) ends.push_back(l);
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  EXPECT_LE(ends.size(), 2U);
  if (ends.empty() || ends.back().sign() <= 0) return std::vector<Found>{};
  std::vector<Found> found;
  for (std::size_t side = 0; side < ends.size(); ++side) {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const int speed = dot(planes[i].n, line.d).sign();
      const bool passes = ends.size() == 1 ? speed != 0 : speed == (side == 0 ? -1 : 1);
      if (!passes || value(planes[i], ends[side]).sign() != 0) continue;
      const unsigned multiplicity = ends.size() == 1 ? 2 : 1;
      found.push_back({ends[side], multiplicity, planes[i].n, {static_cast<double>(i), 0}});
      break;
    }
  }
  if (ends.size() == 2) {
    const Q middle = (ends[0] + ends[1]) / Q(2);
    for (const HalfSpace& h : planes)
      if (value(h, middle).sign() == 0) return std::nullopt;
  }
  return positive(found);
}

Model box_model(Vec3 lo, Vec3 hi) {
  std::vector<HalfSpace> planes;
  for (std::size_t k = 0; k < 3; ++k) {
    Row n{Q(0), Q(0), Q(0)};
    n[k] = Q(-1);
    planes.push_back({n, Q(0) - row(lo)[k]});
    n[k] = Q(1);
    planes.push_back({n, row(hi)[k]});
  }
  return {spec_of("box", {{"min", list(lo)}, {"max", list(hi)}}),
          [planes](const Line& line) { return solid_hits(planes, line); }};
}

Model tetrahedron_model(const std::vector<Vec3>& points) {
  // The weight of vertex i is the linear function that is 1 there and 0 at the others.
  std::vector<Row> a;
  for (const Vec3& p : points) a.push_back({Q(p.x), Q(p.y), Q(p.z), Q(1)});
  std::vector<HalfSpace> planes;
  for (std::size_t i = 0; i < 4; ++i) {
    Row one(4);
    one[i] = Q(1);
    const Row weight = *solve(a, one);
    planes.push_back({{Q(0) - weight[0], Q(0) - weight[1], Q(0) - weight[2]}, weight[3]});
  }
  return {spec_of("tetrahedron", {{"vertices", table(points)}}),
          [planes](const Line& line) { return solid_hits(planes, line); }};
}

Model polyhedron_model(const std::vector<std::vector<double>>& halfspaces) {
  std::vector<HalfSpace> planes;
  for (const auto& h : halfspaces) planes.push_back({row({h[0], h[1], h[2]}), Q(h[3])});
  return {spec_of("convex_polyhedron", {{"halfspaces", halfspaces}}),
          [planes](const Line& line) { return solid_hits(planes, line); }};
}

// ---- Comparison ----

void expect_length(const truth::Real& real, const Q& l) {
  EXPECT_TRUE(Q(real.lo) <= l && l <= Q(real.hi)) << real.lo << " " << real.hi << " " << l.value();
  EXPECT_TRUE(Q(real.decimal) == Q(real.lo) || Q(real.decimal) == Q(real.hi));
  const Q rest = l - Q(real.head) - Q(real.tail);
  EXPECT_TRUE(rest * rest <= Q(0x1p-210) * l * l);
}

double unit_part(const Row& n, std::size_t i) {
  const double size = std::sqrt((n[i] * n[i] / dot(n, n)).value());
  return n[i].sign() < 0 ? -size : size;
}

class Comparison {
 public:
  explicit Comparison(Model model) : model_(std::move(model)) {}

  void place(const Placement& placement) { model_.spec.placement = placement; }

  void add(const Ray& ray) {
    if (!surface_) surface_ = truth::make_surface(model_.spec);
    const auto& [translate, matrix] = model_.spec.placement;
    const std::vector<Row> m{row(matrix[0]), row(matrix[1]), row(matrix[2])};
    const Line line{*solve(m, minus(row(ray.o), row(translate))), *solve(m, row(ray.d))};
    const Hits wanted = model_.hits(line);
    const truth::Answer answer = surface_->all(ray, {});
    ++rays;
    ASSERT_EQ(answer.status, wanted ? Status::ok : Status::coincident);
    if (!wanted) {
      ++coincident;
      return;
    }
    ASSERT_EQ(answer.hits.size(), wanted->size());
    for (std::size_t i = 0; i < wanted->size(); ++i) expect_hit(answer.hits[i], (*wanted)[i], ray);
  }

  void summary(const char* kind) const {
    std::printf("%s: %d rays, %d hits, %d of them touch, %d coincident\n", kind, rays, hits, touches,
                coincident);
  }

  int rays = 0;
  int hits = 0;
  int touches = 0;
  int coincident = 0;

 private:
  void expect_hit(const truth::Hit& hit, const Found& wanted, const Ray& ray) {
    ++hits;
    if (wanted.multiplicity > 1) ++touches;
    expect_length(hit.l, wanted.l);
    EXPECT_EQ(hit.multiplicity, wanted.multiplicity);
    EXPECT_NEAR(hit.params[0], wanted.params[0], 2.3e-16);
    EXPECT_NEAR(hit.params[1], wanted.params[1], 2.3e-16);
    const auto& [translate, matrix] = model_.spec.placement;
    const Row n = *solve(columns({row(matrix[0]), row(matrix[1]), row(matrix[2])}), wanted.normal);
    EXPECT_NEAR(hit.normal.x, unit_part(n, 0), 4e-16);
    EXPECT_NEAR(hit.normal.y, unit_part(n, 1), 4e-16);
    EXPECT_NEAR(hit.normal.z, unit_part(n, 2), 4e-16);
    const Row d = row(ray.d);
    const double cosine = std::sqrt((dot(n, d) * dot(n, d) / (dot(n, n) * dot(d, d))).value());
    EXPECT_NEAR(hit.cosine, cosine, 4e-16 * cosine);
    const Row x = along(row(ray.o), wanted.l, d);
    const double eps = 0x1p-52;
    EXPECT_NEAR(hit.point.x, x[0].value(), eps * std::fabs(hit.point.x));
    EXPECT_NEAR(hit.point.y, x[1].value(), eps * std::fabs(hit.point.y));
    EXPECT_NEAR(hit.point.z, x[2].value(), eps * std::fabs(hit.point.z));
  }

  Model model_;
  std::unique_ptr<truth::Surface> surface_;
};

/// Rays by kind: at a point of the figure's skeleton in small steps, along the skeleton, or anywhere.
class Rays {
 public:
  Rays(std::vector<Vec3> skeleton, std::uint64_t seed) : skeleton_(std::move(skeleton)), random_(seed) {}

  Ray next() {
    const unsigned kind = static_cast<unsigned>(random_() % 6);
    const Vec3 a = pick();
    const Vec3 b = pick();
    // Sums of few bits are exact, so these rays hit edges, vertices and planes exactly.
    const Vec3 target = kind % 2 == 0 ? a : 0.5 * (a + b);
    Vec3 d{small(), small(), small()};
    if (kind == 2 || kind == 3) d = b - a;
    if (kind == 4) d = {1 + part(), part(), part()};
    if (kind == 5) d = {part(), part(), part()};
    if (max_abs(d) == 0) d = {0, 0, 1};
    const double back = static_cast<double>(random_() % 4) - (random_() % 5 == 0 ? 1.5 : 0);
    return {target - back * d, d};
  }

 private:
  Vec3 pick() { return skeleton_[random_() % skeleton_.size()]; }
  double small() { return static_cast<double>(random_() % 9) / 4 - 1; }
  double part() { return std::uniform_real_distribution<double>(-1, 1)(random_); }

  std::vector<Vec3> skeleton_;
  std::mt19937_64 random_;
};

const Placement kPlaced{{0.3, -1.7, 2.1}, {Vec3{0.1, 2, 0.3}, Vec3{-1, 0.25, 0.7}, Vec3{0.2, 0.9, -1.1}}};
const Placement kSimple{{1, -2, 0.5}, {Vec3{0, 2, 0}, Vec3{1, 0, 0.5}, Vec3{0, 0.25, -1}}};

void compare(const char* kind, const Model& model, const std::vector<Vec3>& skeleton, int rays) {
  Comparison plain(model);
  Rays source(skeleton, 31);
  for (int i = 0; i < rays && !testing::Test::HasFatalFailure(); ++i) plain.add(source.next());
  plain.summary(kind);
  EXPECT_GT(plain.hits, rays / 8) << kind;
  // Placed: rays move along exactly where the placement has few bits, and approximately where not.
  for (const Placement& placement : {kSimple, kPlaced}) {
    Comparison placed(model);
    placed.place(placement);
    for (int i = 0; i < rays / 2 && !testing::Test::HasFatalFailure(); ++i) {
      const Ray ray = source.next();
      placed.add({placement.matrix * ray.o + placement.translate, placement.matrix * ray.d});
    }
    placed.summary("  placed");
    EXPECT_GT(placed.hits, rays / 20) << kind;
  }
}

constexpr int kRays = 400;

TEST(TruthFlatFlint, Planes) {
  const std::vector<Vec3> skeleton{{1, 1, 1}, {3, 0, 0}, {0, 0, 3}, {0, 3, 0}, {1, 2, 0}, {0, 0, 0}};
  compare("plane", plane_model({1, 1, 1}, 3, false), skeleton, kRays);
  compare("one-sided plane", plane_model({1, 1, 1}, 3, true), skeleton, kRays);
  compare("crooked plane", plane_model({0.1, -1.1, 0.7}, 1e-3, false), skeleton, kRays);
}

TEST(TruthFlatFlint, Triangles) {
  const std::vector<Vec3> right{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const std::vector<Vec3> tilted{{1, 2, 3}, {4, -1, 2.5}, {-2, 0.5, 1}};
  const std::vector<Vec3> crooked{{0.1, 0.2, 0.3}, {1.7, -0.4, 0.9}, {0.2, 1.1, -0.6}};
  compare("triangle", triangle_model(right), right, kRays);
  compare("tilted triangle", triangle_model(tilted), tilted, kRays);
  compare("crooked triangle", triangle_model(crooked), crooked, kRays);
}

TEST(TruthFlatFlint, Polygons) {
  const std::vector<Vec3> arrow{{0, 0, 1}, {4, 0, 1}, {4, 4, 1}, {2, 1, 1}, {0, 4, 1}};
  const std::vector<Vec3> comb{{0, 0, 0},   {6, 0, 3}, {6, 3, 6},   {5, 1, 3.5}, {4, 3, 5},
                               {3, 1, 2.5}, {2, 3, 4}, {1, 1, 1.5}, {0, 3, 3}};
  const std::vector<Vec3> rounded{{0.1, 0.2, 0.3}, {1.1, 0.2, 0.6}, {1.1, 1.2, 1.3}, {0.1, 1.2, 1.0}};
  compare("arrow", polygon_model(arrow), arrow, kRays);
  compare("comb", polygon_model(comb), comb, kRays);
  compare("rounded square", polygon_model(rounded), rounded, kRays);
}

TEST(TruthFlatFlint, Disks) {
  const std::vector<Vec3> rim{{5, 0, 0}, {3, 4, 0},   {-4, 3, 0}, {0, -5, 0},
                              {0, 0, 0}, {-3, -4, 0}, {5, 5, 0}};
  compare("disk", disk_model({0, 0, 0}, {0, 0, 1}, 5), rim, kRays);
  compare("crooked disk", disk_model({0.1, 0.2, 0.3}, {0.3, -0.2, 1}, 4.3), rim, kRays);
}

std::vector<Vec3> corners(Vec3 lo, Vec3 hi) {
  std::vector<Vec3> result;
  for (unsigned i = 0; i < 8; ++i)
    result.push_back({(i & 1U) != 0 ? hi.x : lo.x, (i & 2U) != 0 ? hi.y : lo.y, (i & 4U) != 0 ? hi.z : lo.z});
  return result;
}

TEST(TruthFlatFlint, Boxes) {
  compare("box", box_model({-1, 0, 2}, {3, 4, 5}), corners({-1, 0, 2}, {3, 4, 5}), kRays);
  compare("crooked box", box_model({-0.1, 0.2, 0.3}, {0.7, 1.4, 0.9}),
          corners({-0.1, 0.2, 0.3}, {0.7, 1.4, 0.9}), kRays);
}

TEST(TruthFlatFlint, Tetrahedra) {
  const std::vector<Vec3> exercise{{1, 0, 0}, {-1, 0, -1}, {-1, 0, 1}, {0, 1, 0}};
  const std::vector<Vec3> crooked{{0.1, 0.2, 0.3}, {1.7, -0.4, 0.9}, {0.2, 1.1, -0.6}, {-1.3, 0.1, 0.7}};
  compare("tetrahedron", tetrahedron_model(exercise), exercise, kRays);
  compare("crooked tetrahedron", tetrahedron_model(crooked), crooked, kRays);
}

TEST(TruthFlatFlint, Polyhedra) {
  const std::vector<std::vector<double>> octahedron{
      {1, 1, 1, 2},   {1, 1, -1, 2},   {1, -1, 1, 2}, {1, -1, -1, 2}, {-1, 1, 1, 2}, {-1, 1, -1, 2},
      {-1, -1, 1, 2}, {-1, -1, -1, 2}, {1, 0, 0, 2},  {1, 1, 0, 2},   {0, 1, 0, 9}};
  const std::vector<Vec3> tips{{2, 0, 0}, {-2, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 2}, {0, 0, -2}};
  compare("octahedron", polyhedron_model(octahedron), tips, kRays);
  std::mt19937_64 random(41);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> many;
  for (int i = 0; i < 20; ++i) many.push_back({normal(random), normal(random), normal(random), 1.5});
  compare("twenty half-spaces", polyhedron_model(many), tips, kRays);
}

// ---- Kinds of half-spaces ----

/// "empty", "flat", "unbounded" or "" for a solid, from all vertices and extreme directions; none where the
/// normals do not span space.
std::optional<std::string> kind_of(const std::vector<HalfSpace>& planes) {
  const auto in_all = [&](const Row& x, const Q& unit) {
    return std::all_of(planes.begin(), planes.end(),
                       [&](const HalfSpace& h) { return dot(h.n, x) <= unit * h.b; });
  };
  Row middle{Q(0), Q(0), Q(0)};
  Q weight;
  bool spans = false;
  bool unbounded = false;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Row edge = cross(planes[i].n, planes[j].n);
      if (dot(edge, edge).sign() == 0) continue;
      for (const int side : {1, -1}) {
        const Row direction = along({Q(0), Q(0), Q(0)}, Q(side), edge);
        if (!in_all(direction, Q(0))) continue;
        unbounded = true;
        middle = along(middle, Q(1), direction);
      }
      for (std::size_t k = 0; k < j; ++k) {
        const auto vertex =
            solve({planes[i].n, planes[j].n, planes[k].n}, {planes[i].b, planes[j].b, planes[k].b});
        spans = spans || vertex;
        if (!vertex || !in_all(*vertex, Q(1))) continue;
        middle = along(middle, Q(1), *vertex);
        weight = weight + Q(1);
      }
    }
  }
  if (!spans) return std::nullopt;
  if (weight.sign() == 0) return "empty";
  for (const HalfSpace& h : planes)
    if (dot(h.n, middle) == weight * h.b) return "flat";
  return unbounded ? "unbounded" : "";
}

TEST(TruthFlatFlint, HalfSpacesAreEmptyFlatUnboundedOrASolid) {
  std::mt19937_64 random(51);
  std::map<std::string, int> seen;
  for (int trial = 0; trial < 3000; ++trial) {
    const std::size_t n = 4 + random() % 5;
    const auto whole = [&](int radius) {
      return static_cast<double>(static_cast<int>(random() % static_cast<unsigned>(2 * radius + 1)) - radius);
    };
    std::vector<std::vector<double>> rows;
    std::vector<HalfSpace> planes;
    while (rows.size() < n) {
      const Vec3 normal{whole(2), whole(2), whole(2)};
      if (max_abs(normal) == 0) continue;
      rows.push_back({normal.x, normal.y, normal.z, std::max(whole(2), whole(2))});
      planes.push_back({row(normal), Q(rows.back()[3])});
    }
    const auto wanted = kind_of(planes);
    std::string message;
    try {
      static_cast<void>(truth::make_surface(spec_of("convex_polyhedron", {{"halfspaces", rows}})));
    } catch (const std::invalid_argument& error) {
      message = error.what();
    }
    if (!wanted) {
      EXPECT_NE(message, "");
      continue;
    }
    ++seen[*wanted];
    if (wanted->empty()) {
      EXPECT_EQ(message, "");
    } else {
      EXPECT_NE(message.find(*wanted), std::string::npos) << *wanted << ": " << message;
    }
  }
  for (const auto& [kind, count] : seen)
    std::printf("%s: %d\n", kind.empty() ? "solid" : kind.c_str(), count);
  for (const char* kind : {"", "empty", "flat", "unbounded"}) EXPECT_GT(seen[kind], 20) << kind;
}

}  // namespace
}  // namespace graze
