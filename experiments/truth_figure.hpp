// What planes, flat figures and convex solids share: world-space integers, the ray among them, planes and
// half-spaces that it passes, hits, and distances.
//
// A placed plane or vertex is a plane or vertex of the world whose numbers are integers times one power of
// two, found once. l is then a quotient of two integers, so there is nothing to isolate or to refine.
#pragma once

#include <array>
#include <cstdint>
#include <graze/experiments/truth_distance.hpp>
#include <graze/experiments/truth_frame.hpp>
#include <graze/experiments/truth_number.hpp>
#include <optional>
#include <string>
#include <vector>

namespace graze::truth {

// ---- Exact numbers ----

Vector operator-(const Vector& a, const Vector& b);
Vector negated(const Vector& a);
Vector cross(const Vector& a, const Vector& b);
/// a 2^k for k >= 0.
Vector shifted(const Vector& a, long k);

/// top / bottom, bottom > 0.
struct Fraction {
  Integer top, bottom;
};

/// top / bottom with either sign of bottom, which is not zero.
Fraction fraction(const Integer& top, const Integer& bottom);
/// Sign of a - b.
int compare(const Fraction& a, const Fraction& b);
/// top / bottom 2^e, the nearest double but for ties and their close neighbours.
double quotient(const Integer& top, const Integer& bottom, long e);

// ---- From doubles to integers ----

/// Integer vectors times 2^e.
struct Points {
  std::vector<Vector> at;
  long e = 0;
};

Points exact_points(const std::vector<Vec3>& points);
/// M x + T for points of the object.
Points world_points(const Placement& placement, const Points& object);
/// M^-T n, of any length.
Vector world_normal(const Transform& transform, const Vector& n);

/// n.x = b, or the half-space n.x <= b, for x in units of the figure.
struct Plane {
  Vector n;
  Integer b;
};

/// Without the common factor of its four numbers.
Plane reduced(Plane plane);

/// n.x <= b as the user states it.
struct HalfSpace {
  Vec3 n;
  double b = 0;
};

/// Planes for x in units of 2^e.
struct Planes {
  std::vector<Plane> list;
  long e = 0;
};

/// Half-spaces of the object in the world. Throws std::invalid_argument as `prepare` does.
Planes world_planes(const Placement& placement, const std::vector<HalfSpace>& object);

std::vector<Vec3> read_points(const Parameters& parameters, const std::string& name);
Vec3 read_vector(const Parameters& parameters, const std::string& name);
/// Throws std::invalid_argument unless there are so many vertices.
void expect_count(const std::vector<Vec3>& vertices, std::size_t count);

// ---- A ray and a figure ----

/// One ray in the integers of a figure: x = (o + l' d) 2^e_of_x, l = l' 2^e.
struct Question {
  Vector o, d;
  long grow = 0;  ///< numbers of the figure times 2^grow are in the units of o
  long e = 0;     ///< of l
  long e_of_x = 0;
};

/// b - n.o and n.d: the ray meets the plane at their quotient.
struct Crossing {
  Integer gap, speed;
};

Crossing cross_plane(const Plane& plane, const Question& q);

/// A plane of a figure and what every hit on it needs.
struct Facet {
  Plane plane;
  Vec3 normal;
  Interval length;  ///< |n|
};

Facet make_facet(const Plane& plane);

/// Where a line is inside all of some half-spaces: from `in` to `out`, where it has them.
struct Passage {
  std::optional<Fraction> in, out;
  std::size_t first_in = 0, first_out = 0;  ///< the smallest index of the planes that attain them
  bool empty = false;
  bool along = false;  ///< the line lies in one of the planes
};

Passage pass(const std::vector<Facet>& facets, const Question& q);

/// A hit before it is put into doubles.
struct Contact {
  Fraction l;
  std::uint32_t multiplicity = 1;
  std::size_t facet = 0;
  std::array<double, 2> params{};
};

/// None: the ray runs inside the surface.
using Contacts = std::optional<std::vector<Contact>>;

/// The only contact there is, if it is in front of the origin.
Contacts in_front(Contact contact);

/// What the figures have in common: from a ray to contacts to hits.
class Figure : public Surface {
 public:
  [[nodiscard]] Answer all(const Ray& ray, const Options& options) const final;

 protected:
  /// Contacts with l > 0 in ascending order.
  [[nodiscard]] virtual Contacts find(const Question& q) const = 0;

  std::vector<Facet> facets_;
  long e_ = 0;  ///< exponent of the figure's integers

 private:
  [[nodiscard]] Hit hit(const Question& q, const Contact& contact, int digits) const;
};

// ---- Distances ----

using QuadPoint = std::array<Quad, 3>;

Quad inner(const QuadPoint& a, const QuadPoint& b);
/// a + k b.
QuadPoint plus(const QuadPoint& a, const Quad& k, const QuadPoint& b);
QuadPoint minus(const QuadPoint& a, const QuadPoint& b);
Quad length(const QuadPoint& a);

/// The leading bits of a, and in e where they belong.
Quad leading(Integer a, long& e);
/// top / bottom 2^e.
Quad to_quad(const Integer& top, const Integer& bottom, long e);
QuadPoint to_quads(Vec3 v);
/// v / bottom 2^e.
QuadPoint to_quads(const Vector& v, const Integer& bottom, long e);
/// n / |n|, found without overflow.
QuadPoint unit(const Vector& n);

/// A polygon in its plane, for distances.
class Patch {
 public:
  Patch(std::vector<QuadPoint> corners, const QuadPoint& unit_normal);
  /// Over the plane: the distance is at least that.
  [[nodiscard]] Quad height(const QuadPoint& p) const;
  [[nodiscard]] Quad distance(const QuadPoint& p) const;

 private:
  [[nodiscard]] bool holds(const QuadPoint& foot) const;

  std::vector<QuadPoint> corners_;
  QuadPoint normal_;
  std::size_t drop_ = 0;  ///< the largest axis of the normal
};

}  // namespace graze::truth
