#include <algorithm>
#include <graze/experiments/truth_figure.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace graze::truth {
namespace {

// Enough for a quotient or a root of a quotient to be within 2^-60 ulp of a double.
constexpr mpfr_prec_t kBits = 128;

/// `figure`: the exponent of the figure's integers.
Question ask(const Ray& ray, long figure) {
  CommonExponent origin;
  origin.see(ray.o);
  CommonExponent direction;
  direction.see(ray.d);
  Question q;
  const bool from_zero = max_abs(ray.o) == 0;
  q.e_of_x = from_zero ? figure : std::min(origin.e(), figure);
  if (!from_zero) q.o = shifted(origin(ray.o), origin.e() - q.e_of_x);
  q.d = direction(ray.d);
  q.grow = figure - q.e_of_x;
  q.e = q.e_of_x - direction.e();
  return q;
}

Number length_of(const Fraction& l, long e) {
  return rational_length(e >= 0 ? Rational(shifted(l.top, e), l.bottom)
                                : Rational(l.top, shifted(l.bottom, -e)));
}

/// From p to the segment a b.
Quad edge_distance(const QuadPoint& p, const QuadPoint& a, const QuadPoint& b) {
  const QuadPoint edge = minus(b, a);
  const Quad t = std::clamp<Quad>(inner(minus(p, a), edge) / inner(edge, edge), 0, 1);
  return length(minus(plus(a, t, edge), p));
}

}  // namespace

// ---- Exact numbers ----

Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector negated(const Vector& a) { return {-a[0], -a[1], -a[2]}; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector shifted(const Vector& a, long k) {
  if (k == 0) return a;
  return {shifted(a[0], k), shifted(a[1], k), shifted(a[2], k)};
}

Fraction fraction(const Integer& top, const Integer& bottom) {
  return sign(bottom) < 0 ? Fraction{-top, -bottom} : Fraction{top, bottom};
}

int compare(const Fraction& a, const Fraction& b) { return sign(a.top * b.bottom - b.top * a.bottom); }

double quotient(const Integer& top, const Integer& bottom, long e) {
  return times_power_of_two(Interval::of(top, kBits) / Interval::of(bottom, kBits), e).middle();
}

// ---- From doubles to integers ----

Points exact_points(const std::vector<Vec3>& points) {
  CommonExponent common;
  for (const Vec3& p : points) common.see(p);
  Points result;
  result.e = common.e();
  for (const Vec3& p : points) result.at.push_back(common(p));
  return result;
}

Points world_points(const Placement& placement, const Points& object) {
  const Points matrix = exact_points({placement.matrix[0], placement.matrix[1], placement.matrix[2]});
  const Points offset = exact_points({placement.translate});
  const bool moved = !is_zero(offset.at[0]);
  Points world;
  world.e = object.e + matrix.e;
  if (moved) world.e = std::min(world.e, offset.e);
  const Vector t = moved ? shifted(offset.at[0], offset.e - world.e) : Vector{};
  for (const Vector& x : object.at) {
    Vector y;
    for (std::size_t i = 0; i < 3; ++i)
      y[i] = shifted(inner(matrix.at[i], x), object.e + matrix.e - world.e) + t[i];
    world.at.push_back(std::move(y));
  }
  return world;
}

Vector world_normal(const Transform& transform, const Vector& n) {
  const Matrix& m = transform.adjugate;
  Vector world;
  for (std::size_t i = 0; i < 3; ++i) world[i] = m[0][i] * n[0] + m[1][i] * n[1] + m[2][i] * n[2];
  return world;
}

Plane reduced(Plane plane) {
  Integer common = abs(plane.b);
  for (const Integer& c : plane.n) common = boost::multiprecision::gcd(common, c);
  if (sign(common) == 0 || common == 1) return plane;
  for (Integer& c : plane.n) c /= common;
  plane.b /= common;
  return plane;
}

/// n.x = b of the object is (M^-T n).x = b + (M^-T n).T of the world; with M^-1 = adjugate / det 2^-e.
Planes world_planes(const Placement& placement, const std::vector<HalfSpace>& object) {
  const Transform transform = prepare(placement);
  const Points offset = exact_points({placement.translate});
  const bool moved = !is_zero(offset.at[0]);
  struct Level {
    Vector n;
    Integer b;
    long e;
  };
  std::vector<Level> levels;
  long least = std::numeric_limits<long>::max();
  if (moved) least = offset.e;
  for (const auto& [n, b] : object) {
    const Points normal = exact_points({n});
    const Dyadic level = exact(b);
    const long e = level.e + transform.e - normal.e;
    levels.push_back({world_normal(transform, normal.at[0]), Integer(level.m) * transform.det, e});
    if (level.m != 0) least = std::min(least, e);
  }
  // A figure of planes through zero alone has no size, and any exponent will do.
  if (least == std::numeric_limits<long>::max()) least = 0;
  Planes world;
  world.e = least;
  for (const auto& [n, b, e] : levels) {
    Integer sum = sign(b) == 0 ? b : shifted(b, e - least);
    if (moved) sum += shifted(inner(n, offset.at[0]), offset.e - least);
    world.list.push_back(reduced({n, sum}));
  }
  return world;
}

std::vector<Vec3> read_points(const Parameters& parameters, const std::string& name) {
  std::vector<Vec3> points;
  for (const auto& row : parameters.table(name, 3)) points.push_back({row[0], row[1], row[2]});
  return points;
}

Vec3 read_vector(const Parameters& parameters, const std::string& name) {
  const std::vector<double> list = parameters.list(name, 3);
  return {list[0], list[1], list[2]};
}

void expect_count(const std::vector<Vec3>& vertices, std::size_t count) {
  if (vertices.size() != count)
    throw std::invalid_argument("vertices must hold " + std::to_string(count) + " points");
}

// ---- A ray and a figure ----

Crossing cross_plane(const Plane& plane, const Question& q) {
  return {shifted(plane.b, q.grow) - inner(plane.n, q.o), inner(plane.n, q.d)};
}

Facet make_facet(const Plane& plane) {
  const Interval length = sqrt(Interval::of(inner(plane.n, plane.n), kBits));
  const auto part = [&](std::size_t i) { return (Interval::of(plane.n[i], kBits) / length).middle(); };
  return {plane, {part(0), part(1), part(2)}, length};
}

Passage pass(const std::vector<Facet>& facets, const Question& q) {
  Passage passage;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const auto [gap, speed] = cross_plane(facets[i].plane, q);
    if (sign(speed) == 0) {
      passage.along = passage.along || sign(gap) == 0;
      passage.empty = passage.empty || sign(gap) < 0;
    } else {
      const bool enters = sign(speed) < 0;
      std::optional<Fraction>& end = enters ? passage.in : passage.out;
      const Fraction l = fraction(gap, speed);
      if (!end || compare(l, *end) * (enters ? 1 : -1) > 0) {
        end = l;
        (enters ? passage.first_in : passage.first_out) = i;
        if (passage.in && passage.out && compare(*passage.in, *passage.out) > 0) passage.empty = true;
      }
    }
    if (passage.empty) return passage;
  }
  return passage;
}

Contacts in_front(Contact contact) {
  std::vector<Contact> contacts;
  if (sign(contact.l.top) > 0) contacts.push_back(std::move(contact));
  return contacts;
}

Hit Figure::hit(const Question& q, const Contact& contact, int digits) const {
  Hit hit;
  Number l = length_of(contact.l, q.e);
  hit.l = to_real(l, digits);
  hit.multiplicity = contact.multiplicity;
  hit.tangent = contact.multiplicity >= 2;
  hit.params = contact.params;
  const Integer& top = contact.l.top;
  const Integer& bottom = contact.l.bottom;
  const auto coordinate = [&](std::size_t i) {
    return quotient(q.o[i] * bottom + q.d[i] * top, bottom, q.e_of_x);
  };
  hit.point = {coordinate(0), coordinate(1), coordinate(2)};
  const Facet& facet = facets_[contact.facet];
  hit.normal = facet.normal;
  const Interval along = Interval::of(Integer(abs(inner(facet.plane.n, q.d))), kBits);
  hit.cosine = (along / (facet.length * sqrt(Interval::of(inner(q.d, q.d), kBits)))).middle();
  return hit;
}

Answer Figure::all(const Ray& ray, const Options& options) const {
  if (std::optional<Answer> invalid = refusal(ray)) return *std::move(invalid);
  const Question q = ask(ray, e_);
  const Contacts contacts = find(q);
  if (!contacts) return coincident_answer();
  Answer answer;
  for (const Contact& contact : *contacts)
    answer.hits.push_back(hit(q, contact, std::max(options.digits, 17)));
  return answer;
}

// ---- Distances ----

Quad inner(const QuadPoint& a, const QuadPoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
QuadPoint plus(const QuadPoint& a, const Quad& k, const QuadPoint& b) {
  return {a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]};
}
QuadPoint minus(const QuadPoint& a, const QuadPoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Quad length(const QuadPoint& a) { return sqrt(inner(a, a)); }
QuadPoint to_quads(Vec3 v) { return {v.x, v.y, v.z}; }

Quad leading(Integer a, long& e) {
  constexpr long kKept = 120;
  const long extra = bits(a) - kKept;
  e = std::max(extra, 0L);
  if (extra > 0) a >>= static_cast<unsigned long>(extra);
  return Quad(a);
}

Quad to_quad(const Integer& top, const Integer& bottom, long e) {
  long e_top = 0;
  long e_bottom = 0;
  const Quad a = leading(top, e_top);
  const Quad b = leading(bottom, e_bottom);
  return ldexp(Quad(a / b), static_cast<int>(e + e_top - e_bottom));
}

QuadPoint to_quads(const Vector& v, const Integer& bottom, long e) {
  return {to_quad(v[0], bottom, e), to_quad(v[1], bottom, e), to_quad(v[2], bottom, e)};
}

QuadPoint unit(const Vector& n) {
  const long size = std::max({bits(n[0]), bits(n[1]), bits(n[2])});
  const QuadPoint v = to_quads(n, Integer(1), -size);
  const Quad norm = length(v);
  return {v[0] / norm, v[1] / norm, v[2] / norm};
}

Patch::Patch(std::vector<QuadPoint> corners, const QuadPoint& unit_normal)
    : corners_(std::move(corners)), normal_(unit_normal) {
  for (std::size_t i = 1; i < 3; ++i)
    if (abs(normal_[i]) > abs(normal_[drop_])) drop_ = i;
}

Quad Patch::height(const QuadPoint& p) const { return inner(minus(p, corners_[0]), normal_); }

Quad Patch::distance(const QuadPoint& p) const {
  const Quad height = this->height(p);
  if (holds(plus(p, -height, normal_))) return abs(height);
  Quad best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners_.size(); ++i)
    best = std::min<Quad>(best, edge_distance(p, corners_[i], corners_[(i + 1) % corners_.size()]));
  return best;
}

/// By the even-odd rule in the projection that drops the normal's largest axis. Which way an edge counts
/// does not matter: both distances agree there.
bool Patch::holds(const QuadPoint& foot) const {
  const std::size_t i = (drop_ + 1) % 3;
  const std::size_t j = (drop_ + 2) % 3;
  bool odd = false;
  for (std::size_t k = 0; k < corners_.size(); ++k) {
    const QuadPoint& a = corners_[k];
    const QuadPoint& b = corners_[(k + 1) % corners_.size()];
    if ((a[j] > foot[j]) == (b[j] > foot[j])) continue;
    const Quad reach = (b[i] - a[i]) * (foot[j] - a[j]) - (foot[i] - a[i]) * (b[j] - a[j]);
    if ((reach > 0) == (b[j] > a[j])) odd = !odd;
  }
  return odd;
}

}  // namespace graze::truth
