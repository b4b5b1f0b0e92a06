// Certified truth of the algebraic surfaces against a second engine: FLINT's rationals form the equation from
// another statement of each surface, FLINT factors it into irreducibles, Arb isolates the roots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <graze/experiments/truth.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "flint_numbers.hpp"

namespace graze {
namespace {

using flint::Arb;
using flint::kBits;
using flint::Q;
using flint::QPoly;
using flint::Rows;
using flint::Triple;
using List = std::vector<double>;
using Table = std::vector<std::vector<double>>;
using Line = std::array<QPoly, 3>;  ///< the ray's coordinates as polynomials in l
using Point = std::array<Arb, 3>;

/// A surface as the second engine states it, in object space.
struct Statement {
  SurfaceSpec spec;
  std::function<QPoly(const Line&)> equation;
  std::function<Point(const Point&)> normal;  ///< along the gradient
  bool has_angles = false;
  std::array<double, 3> center{};
  double tube = 0;
  double size = 1;
  int reach = 1000;  ///< bits between the magnitudes of extreme rays; Arb's root finder stalls on more
};

QPoly constant(double c) { return QPoly(Q(c)); }
Arb arb(double c) { return Arb(Q(c)); }

QPoly square(const QPoly& p) { return p * p; }

Statement sphere(double r, const List& c) {
  Statement s;
  s.spec.type = "sphere";
  s.spec.parameters.set("radius", r);
  s.spec.parameters.set("center", c);
  s.equation = [=](const Line& x) {
    return square(x[0] - constant(c[0])) + square(x[1] - constant(c[1])) + square(x[2] - constant(c[2])) -
           square(constant(r));
  };
  s.normal = [=](const Point& x) { return Point{x[0] - arb(c[0]), x[1] - arb(c[1]), x[2] - arb(c[2])}; };
  s.has_angles = true;
  s.center = {c[0], c[1], c[2]};
  s.size = r;
  return s;
}

/// By the inverse of P, found by elimination.
Statement ellipsoid(const Table& p, const List& c) {
  Statement s;
  s.spec.type = "ellipsoid";
  s.spec.parameters.set("P", p);
  s.spec.parameters.set("center", c);
  Rows rows;
  for (std::size_t i = 0; i < 3; ++i) rows[i] = {Q(p[i][0]), Q(p[i][1]), Q(p[i][2])};
  const Rows shape = flint::inverse(rows);
  s.equation = [=](const Line& x) {
    QPoly sum = constant(-1);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        sum = sum + shape[i][j] * ((x[i] - constant(c[i])) * (x[j] - constant(c[j])));
    return sum;
  };
  s.normal = [=](const Point& x) {
    Point n;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) n[i] = n[i] + Arb(shape[i][j]) * (x[j] - arb(c[j]));
    return n;
  };
  s.has_angles = true;
  s.center = {c[0], c[1], c[2]};
  s.size = std::sqrt(std::max({p[0][0], p[1][1], p[2][2]}));
  return s;
}

/// Semi-axes: the sum of (x_i / a_i)^2.
Statement stretched(const List& a) {
  Statement s;
  s.spec.type = "ellipsoid";
  s.spec.parameters.set("semi_axes", a);
  s.equation = [=](const Line& x) {
    QPoly sum = constant(-1);
    for (std::size_t i = 0; i < 3; ++i) sum = sum + square((Q(1) / Q(a[i])) * x[i]);
    return sum;
  };
  s.normal = [=](const Point& x) {
    Point n;
    for (std::size_t i = 0; i < 3; ++i) n[i] = x[i] / (arb(a[i]) * arb(a[i]));
    return n;
  };
  s.has_angles = true;
  s.size = std::max({a[0], a[1], a[2]});
  return s;
}

/// X^T Q X in homogeneous coordinates; `side` as the definition's eigenvalues ask.
Statement quadric(const List& v, int side) {
  Statement s;
  s.spec.type = "quadric";
  const char* const names = "ABCDEFGHIJ";
  for (std::size_t i = 0; i < 10; ++i)
    if (v[i] != 0) s.spec.parameters.set(std::string(1, names[i]), v[i]);
  const std::array<std::array<double, 4>, 4> m{{{v[0], v[1], v[2], v[3]},
                                                {v[1], v[4], v[5], v[6]},
                                                {v[2], v[5], v[7], v[8]},
                                                {v[3], v[6], v[8], v[9]}}};
  s.equation = [=](const Line& x) {
    const std::array<QPoly, 4> h{x[0], x[1], x[2], constant(1)};
    QPoly sum;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) sum = sum + constant(m[i][j]) * h[i] * h[j];
    return sum;
  };
  s.normal = [=](const Point& x) {
    Point n;
    for (std::size_t i = 0; i < 3; ++i) {
      n[i] = arb(m[i][3]);
      for (std::size_t j = 0; j < 3; ++j) n[i] = n[i] + arb(m[i][j]) * x[j];
      n[i] = arb(side) * n[i];
    }
    return n;
  };
  return s;
}

/// (q - R^2 - r^2)^2 = 4 R^2 (r^2 - y^2), q = |x|^2: the other form of the quartic.
Statement torus(double major, double minor) {
  Statement s;
  s.spec.type = "torus";
  s.spec.parameters.set("R", major);
  s.spec.parameters.set("r", minor);
  s.equation = [=](const Line& x) {
    const QPoly q = square(x[0]) + square(x[1]) + square(x[2]);
    const QPoly r2 = square(constant(minor));
    const QPoly big = square(constant(major));
    return square(q - big - r2) - constant(4) * big * (r2 - square(x[1]));
  };
  s.normal = [=](const Point& x) {
    // With k / (2 R) = +-hypot(x, z): from the tube's centre line, on the outer and the inner sheet.
    const Arb q = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    const Arb k = q + arb(major) * arb(major) - arb(minor) * arb(minor);
    const Arb along = k / (arb(2) * arb(major));
    return Point{(along - arb(major)) * x[0], along * x[1], (along - arb(major)) * x[2]};
  };
  s.has_angles = true;
  s.tube = major;
  s.size = major + minor;
  return s;
}

Arb power(const Arb& x, int n) {
  Arb r = arb(1);
  for (int i = 0; i < n; ++i) r = r * x;
  return r;
}

Statement implicit(const Table& terms) {
  Statement s;
  s.spec.type = "implicit_polynomial";
  s.reach = 60;
  s.spec.parameters.set("terms", terms);
  s.equation = [=](const Line& x) {
    QPoly sum;
    for (const auto& term : terms) {
      QPoly product = constant(term[0]);
      for (std::size_t i = 0; i < 3; ++i) {
        QPoly factor;
        fmpq_poly_pow(factor.get(), x[i].get(), static_cast<ulong>(term[i + 1]));
        product = product * factor;
      }
      sum = sum + product;
    }
    return sum;
  };
  s.normal = [=](const Point& x) {
    Point n;
    for (const auto& term : terms) {
      for (std::size_t i = 0; i < 3; ++i) {
        if (term[i + 1] == 0) continue;
        Arb product = arb(term[0]) * arb(term[i + 1]);
        for (std::size_t j = 0; j < 3; ++j)
          product = product * power(x[j], static_cast<int>(term[j + 1]) - (i == j ? 1 : 0));
        n[i] = n[i] + product;
      }
    }
    return n;
  };
  return s;
}

struct Expected {
  Arb l;
  unsigned multiplicity = 1;
};

/// Positive roots of p in ascending order; irreducible factors share none.
std::vector<Expected> positive_roots(const QPoly& p) {
  std::vector<Expected> found;
  flint::for_each_real_root(p, [&](const fmpz_poly_struct* /*factor*/, unsigned order, arb_srcptr x) {
    Expected root;
    root.multiplicity = order;
    arb_set(root.l.get(), x);
    if (root.l.sign() > 0) found.push_back(root);
  });
  std::sort(found.begin(), found.end(),
            [](const Expected& a, const Expected& b) { return arb_lt(a.l.get(), b.l.get()) != 0; });
  return found;
}

struct Tally {
  std::size_t rays = 0, hits = 0, touches = 0, singular = 0, coincident = 0;
  double worst_normal = 0, worst_cosine = 0, worst_angle = 0, worst_point = 0;

  void print(const char* name) const {
    std::printf(
        "%s: %zu rays, %zu hits (%zu touches, %zu singular), %zu coincident; worst normal %.3g, cosine %.3g, "
        "angle %.3g, point %.3g ulp\n",
        name, rays, hits, touches, singular, coincident, worst_normal, worst_cosine, worst_angle,
        worst_point);
  }
};

double ulps(double a, double b) {
  if (a == b) return 0;
  const double ulp = std::nextafter(std::fabs(b), HUGE_VAL) - std::fabs(b);
  return std::fabs(a - b) / ulp;
}

/// Zero where the ball cannot tell it from zero.
Arb settled(const Arb& a) { return a.sign() == 0 ? Arb() : a; }

class Judge {
 public:
  explicit Judge(Statement s) : s_(std::move(s)), surface_(truth::make_surface(s_.spec)) {
    Rows m;
    for (std::size_t i = 0; i < 3; ++i) m[i] = flint::triple(s_.spec.placement.matrix[i]);
    inverse_ = flint::inverse(m);
  }

  [[nodiscard]] const Statement& statement() const { return s_; }
  [[nodiscard]] const truth::Surface& surface() const { return *surface_; }

  void compare(const Ray& ray, Tally& tally) const {
    const Triple o = flint::triple(ray.o);
    const Triple t = flint::triple(s_.spec.placement.translate);
    const Triple from = flint::times(inverse_, {o[0] - t[0], o[1] - t[1], o[2] - t[2]});
    const Triple d = flint::times(inverse_, flint::triple(ray.d));
    Line line;
    for (std::size_t i = 0; i < 3; ++i) {
      fmpq_poly_set_coeff_fmpq(line[i].get(), 0, from[i].get());
      fmpq_poly_set_coeff_fmpq(line[i].get(), 1, d[i].get());
    }
    const QPoly equation = s_.equation(line);
    const truth::Answer answer = surface_->all(ray, {});
    ++tally.rays;
    if (equation.is_zero()) {
      ++tally.coincident;
      ASSERT_EQ(answer.status, Status::coincident);
      return;
    }
    ASSERT_EQ(answer.status, Status::ok) << answer.why;
    const std::vector<Expected> expected = positive_roots(equation);
    ASSERT_EQ(answer.hits.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Arb& l = expected[i].l;
      const Point x{Arb(from[0]) + l * Arb(d[0]), Arb(from[1]) + l * Arb(d[1]), Arb(from[2]) + l * Arb(d[2])};
      check_length(answer.hits[i], expected[i], tally);
      check_point(answer.hits[i], ray, l, tally);
      check_normal(answer.hits[i], ray, x, tally);
      check_angles(answer.hits[i], x, tally);
    }
  }

 private:
  static void check_length(const truth::Hit& hit, const Expected& expected, Tally& tally) {
    ++tally.hits;
    tally.touches += hit.tangent ? 1 : 0;
    ASSERT_EQ(hit.multiplicity, expected.multiplicity);
    flint::check_real(hit.l, expected.l);
  }

  static void check_point(const truth::Hit& hit, const Ray& ray, const Arb& l, Tally& tally) {
    const auto check = [&](double given, double o, double d) {
      const double wanted = settled(arb(o) + l * arb(d)).value();
      tally.worst_point = std::max(tally.worst_point, ulps(given, wanted));
      ASSERT_LE(ulps(given, wanted), 1);
    };
    check(hit.point.x, ray.o.x, ray.d.x);
    check(hit.point.y, ray.o.y, ray.d.y);
    check(hit.point.z, ray.o.z, ray.d.z);
  }

  void check_normal(const truth::Hit& hit, const Ray& ray, const Point& x, Tally& tally) const {
    const Point n = s_.normal(x);
    const Point d{arb(ray.d.x), arb(ray.d.y), arb(ray.d.z)};
    const bool singular = n[0].sign() == 0 && n[1].sign() == 0 && n[2].sign() == 0;
    Point world;
    for (std::size_t i = 0; i < 3; ++i) {
      world[i] = Arb(inverse_[0][i]) * n[0] + Arb(inverse_[1][i]) * n[1] + Arb(inverse_[2][i]) * n[2];
      if (singular) world[i] = Arb() - d[i];
    }
    const Arb length = sqrt(world[0] * world[0] + world[1] * world[1] + world[2] * world[2]);
    for (auto& c : world) c = c / length;
    const double error =
        std::max({std::fabs(hit.normal.x - world[0].value()), std::fabs(hit.normal.y - world[1].value()),
                  std::fabs(hit.normal.z - world[2].value())});
    tally.worst_normal = std::max(tally.worst_normal, error);
    ASSERT_LE(error, 0x1p-53);
    if (singular) ++tally.singular;
    if (singular) {
      ASSERT_EQ(hit.cosine, 1);
      return;
    }
    const Arb along = settled(world[0] * d[0] + world[1] * d[1] + world[2] * d[2]);
    const double cosine = std::fabs((along / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])).value());
    ASSERT_EQ(hit.tangent, along.sign() == 0);
    tally.worst_cosine = std::max(tally.worst_cosine, ulps(hit.cosine, cosine));
    ASSERT_LE(ulps(hit.cosine, cosine), 1);
  }

  void check_angles(const truth::Hit& hit, const Point& at, Tally& tally) const {
    if (!s_.has_angles) {
      ASSERT_EQ(hit.params, (std::array<double, 2>{}));
      return;
    }
    Point x;
    for (std::size_t i = 0; i < 3; ++i) x[i] = settled(at[i] - arb(s_.center[i]));
    const Arb rho = settled(sqrt(x[0] * x[0] + x[2] * x[2]) - arb(s_.tube));
    Arb theta;
    Arb phi;
    arb_atan2(theta.get(), x[2].get(), x[0].get(), kBits);
    arb_atan2(phi.get(), x[1].get(), rho.get(), kBits);
    // atan2 is good to an ulp, and so is each of its arguments.
    for (const double error : {ulps(hit.params[0], theta.value()), ulps(hit.params[1], phi.value())}) {
      tally.worst_angle = std::max(tally.worst_angle, error);
      ASSERT_LE(error, 3);
    }
  }

  Statement s_;
  std::unique_ptr<truth::Surface> surface_;
  Rows inverse_;
};

/// Rays of every hard kind around a surface of the given size.
class Rays {
 public:
  Rays(std::uint64_t seed, const Judge& judge) : random_(seed), judge_(judge) {}

  static constexpr int kKinds = 13;
  Ray next(int kind) {
    const Ray ray = around_origin(kind);
    if (kind >= 6 && kind <= 8) return ray;
    const auto& [x, y, z] = judge_.statement().center;
    const Placement& placement = judge_.statement().spec.placement;
    return {placement.matrix * (ray.o + Vec3{x, y, z}) + placement.translate, placement.matrix * ray.d};
  }

 private:
  /// In object space about the centre; those made from hits in world space.
  Ray around_origin(int kind) {
    const double size = judge_.statement().size;
    const int reach = judge_.statement().reach;
    switch (kind) {
      case 0:
        return towards(vector(5 * size), vector(size));
      case 1:
        return {vector(0.3 * size), vector(1)};
      case 2:
        return {size * whole(), whole_direction()};
      case 3:
        return {size * whole(), axis()};
      case 4:
        return towards(vector(1e8 * size), vector(size));
      case 5:
        return {{wild(), wild(), wild()}, {wild(), wild(), wild()}};
      case 6:
        return nearly_tangent(0);
      case 7:
        return nearly_tangent(std::ldexp(size, -static_cast<int>(5 + random_() % 50)));
      case 8:
        return {point(), vector(1)};
      case 9:
        return {Vec3{0, 0, 0} - 2.0 * whole_direction(), whole_direction()};
      case 10:
        return {vector(2 * size), {std::ldexp(u(), -reach - 10), u(), std::ldexp(1.0, -reach - 74)}};
      case 11:
        return touching_box(size);
      default:
        return towards(size * whole(), Vec3{0, 0, 0});
    }
  }
  double u() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 vector(double size) { return {size * u(), size * u(), size * u()}; }
  double quarter() { return static_cast<double>(random_() % 17) / 4 - 2; }
  Vec3 whole() { return {quarter(), quarter(), quarter()}; }
  Vec3 whole_direction() {
    const Vec3 d = whole();
    return max_abs(d) == 0 ? Vec3{0, 0, 1} : d;
  }
  Vec3 axis() {
    const std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}};
    return axes[random_() % 3];
  }
  static Ray towards(Vec3 o, Vec3 target) {
    return max_abs(target - o) == 0 ? Ray{o, {1, 0, 0}} : Ray{o, target - o};
  }
  /// Along an axis, in a plane that bounds the surface's cube: often an exact tangent.
  Ray touching_box(double size) {
    const std::size_t along = random_() % 3;
    std::array<double, 3> o{};
    std::array<double, 3> d{};
    o[(along + 1) % 3] = random_() % 2 == 0 ? size : -size;
    o[along] = -4 * size;
    d[along] = 1;
    return {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}};
  }
  double wild() {
    const double size = std::exp2(judge_.statement().reach / 3 * u() * u());
    return (u() < 0 ? -size : size) * judge_.statement().size;
  }
  /// A hit of some ray, rounded, with its normal.
  truth::Hit some_hit() {
    for (int i = 0; i < 100; ++i) {
      const auto answer = judge_.surface().all(next(0), {});
      if (!answer.hits.empty()) return answer.hits[random_() % answer.hits.size()];
    }
    return {};
  }
  Vec3 point() { return some_hit().point; }
  Ray nearly_tangent(double offset) {
    const truth::Hit hit = some_hit();
    const Vec3 d = cross(hit.normal, vector(1));
    return {hit.point + offset * hit.normal - 3.0 * d, max_abs(d) == 0 ? Vec3{1, 0, 0} : d};
  }

  std::mt19937_64 random_;
  const Judge& judge_;
};

Placement some_placement(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto u = [&] { return std::uniform_real_distribution<double>(-2, 2)(random); };
  Placement placement;
  placement.translate = {u(), u(), u()};
  for (Vec3& row : placement.matrix) row = {u(), u(), u()};
  return placement;
}

/// Each statement where it is, and under a random placement.
void sweep(const char* name, const std::vector<Statement>& statements, int rays_a_kind) {
  Tally tally;
  std::uint64_t seed = 0;
  for (Statement statement : statements) {
    for (const bool placed : {false, true}) {
      if (placed) statement.spec.placement = some_placement(++seed);
      const Judge judge(statement);
      Rays rays(++seed, judge);
      for (int kind = 0; kind < Rays::kKinds; ++kind) {
        for (int i = 0; i < rays_a_kind; ++i) {
          const Ray ray = rays.next(kind);
          judge.compare(ray, tally);
          if (::testing::Test::HasFatalFailure()) {
            ADD_FAILURE() << name << ", statement seed " << seed << ", kind " << kind << ", ray " << i;
            std::printf("o %a %a %a d %a %a %a\n", ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z);
            return;
          }
        }
      }
    }
  }
  tally.print(name);
}

TEST(TruthAlgebraicFlint, SpheresAgree) {
  sweep("spheres", {sphere(1, {0, 0, 0}), sphere(0.3, {1, -2, 0.5}), sphere(1e-3, {0.1, 0.2, 0.3})}, 12);
}

TEST(TruthAlgebraicFlint, EllipsoidsAgree) {
  sweep("ellipsoids",
        {stretched({1, 2, 0.5}), stretched({1, 1e-3, 0.1}),
         ellipsoid({{2, 1, 0}, {1, 1, 0}, {0, 0, 1}}, {0, 0, 0}),
         ellipsoid({{1.1, 0.3, -0.2}, {0.3, 0.7, 0.1}, {-0.2, 0.1, 2.3}}, {0.1, 0.5, -1}),
         ellipsoid({{1, 1, 0}, {1, 1 + 0x1p-40, 0}, {0, 0, 1}}, {1, 0, 0})},
        4);
}

TEST(TruthAlgebraicFlint, QuadricsOfEveryClassAgree) {
  //                A  B  C  D  E  F  G  H  I  J
  sweep("quadrics",
        {quadric({1, 0, 0, 0, 1, 0, 0, 1, 0, -1}, 1),     // ellipsoid
         quadric({-1, 0, 0, 0, -2, 0, 0, -1, 0, 1}, -1),  // ellipsoid, negated
         quadric({1, 0, 0, 0, 1, 0, 0, 1, 0, 1}, 1),      // imaginary
         quadric({1, 0, 0, 0, 1, 0, 0, 1, 0, 0}, 1),      // point
         quadric({1, 0, 0, 0, -1, 0, 0, 1, 0, -1}, 1),    // one sheet
         quadric({1, 0, 0, 0, -1, 0, 0, 1, 0, 1}, 1),     // two sheets
         quadric({-1, 0, 0, 0, 1, 0, 0, -1, 0, 0}, -1),   // cone, negated
         quadric({1, 0, 0, 0, 0, 0, -0.5, 1, 0, 0}, 1),   // elliptic paraboloid
         quadric({1, 0, 0, 0, 0, 0, -0.5, -1, 0, 0}, 1),  // hyperbolic paraboloid
         quadric({1, 0, 0, 0, 0, 0, 0, 2, 0, -1}, 1),     // elliptic cylinder
         quadric({1, 0, 0, 0, 0, 0, 0, 2, 0, 0}, 1),      // line
         quadric({1, 0, 0, 0, -1, 0, 0, 0, 0, 1}, 1),     // hyperbolic cylinder
         quadric({0, 0.5, 0, 0, 0, 0, 0, 0, 0, 0}, 1),    // intersecting planes
         quadric({1, 0, 0, 0, 0, 0, 0.5, 0, 0, 0}, 1),    // parabolic cylinder
         quadric({1, 0, 0, 0, 0, 0, 0, 0, 0, -1}, 1),     // parallel planes
         quadric({-1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, -1),    // double plane
         quadric({0, 0, 0, 1, 0, 0, 2, 0, 3, 0.5}, 1),    // plane
         quadric({0, 0, 0, 0, 0, 0, 0, 0, 0, 2}, 1),      // empty
         quadric({0.3, -0.7, 0.2, 0.1, 1.1, 0.9, -0.4, -0.6, 0.8, -0.35}, 1)},
        2);
}

TEST(TruthAlgebraicFlint, ToriOfEveryKindAgree) {
  sweep("tori", {torus(1, 0.25), torus(1, 1), torus(1, 2), torus(0.7, 0.1), torus(1, 1e-6)}, 4);
}

TEST(TruthAlgebraicFlint, ImplicitPolynomialsAgree) {
  std::mt19937_64 random(1);
  const auto dense = [&](int n, bool whole) {
    Table terms;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        for (int k = 0; i + j + k <= n; ++k)
          terms.push_back({whole ? static_cast<double>(random() % 5) - 2
                                 : std::uniform_real_distribution<double>(-1, 1)(random),
                           static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
    terms.push_back({1, static_cast<double>(n), 0, 0});
    return implicit(terms);
  };
  sweep("implicit polynomials",
        {implicit({{1, 1, 1, 1}}),                                             // three planes
         implicit({{1, 2, 0, 1}, {-1, 0, 2, 0}}),                              // Whitney's umbrella
         implicit({{1, 3, 0, 0}, {-1, 0, 2, 0}}),                              // cuspidal edge
         implicit({{1, 4, 0, 0}, {1, 0, 4, 0}, {1, 0, 0, 4}, {-1, 0, 0, 0}}),  // quartic cube
         implicit({{1, 2, 2, 0}, {1, 0, 2, 2}, {1, 2, 0, 2}, {-1, 1, 1, 1}}),  // Steiner's surface
         implicit({{1, 4, 0, 0}, {-2, 2, 0, 0}, {1, 0, 0, 0}, {1, 0, 2, 0}, {1, 0, 0, 2}}),  // double points
         dense(3, true), dense(4, false), dense(5, true), dense(6, false)},
        2);
}

}  // namespace
}  // namespace graze
