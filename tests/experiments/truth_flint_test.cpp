// Certified truth against a second engine that shares nothing with it: FLINT's rationals form the equation,
// FLINT factors it into irreducibles, Arb isolates and refines the roots. A tie is a divisibility of
// polynomials there.
#include <flint/fmpq.h>
#include <flint/fmpq_poly.h>
#include <flint/fmpz_poly.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <graze/experiments/truth.hpp>
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
using flint::times;
using flint::Triple;
using flint::triple;

/// Coefficients in FLINT's notation, their number first.
QPoly polynomial(const char* text) {
  QPoly p;
  fmpq_poly_set_str(p.get(), text);
  return p;
}

Q value_at(const QPoly& p, const Q& x) {
  Q r;
  fmpq_poly_evaluate_fmpq(const_cast<fmpq*>(r.get()), p.get(), x.get());
  return r;
}

QPoly slope(const QPoly& p) {
  QPoly r;
  fmpq_poly_derivative(r.get(), p.get());
  return r;
}

/// outer(inner(t)).
QPoly composed(const QPoly& outer, const QPoly& inner) {
  QPoly r;
  fmpq_poly_compose(r.get(), outer.get(), inner.get());
  return r;
}

QPoly integral(const QPoly& p) {
  QPoly r;
  fmpq_poly_integral(r.get(), p.get());
  return r;
}

/// p(t) by Horner.
Arb evaluate(const QPoly& p, const Arb& t) {
  Arb r;
  Q c;
  for (slong i = fmpq_poly_length(p.get()); i-- > 0;) {
    fmpq_poly_get_coeff_fmpq(const_cast<fmpq*>(c.get()), p.get(), i);
    r = r * t + Arb(c);
  }
  return r;
}

/// A root in [0, 1] with its irreducible polynomial.
struct Algebraic {
  Arb t;
  QPoly minimal;
  unsigned order = 0;

  [[nodiscard]] bool is_root_of(const QPoly& p) const {
    QPoly rest;
    fmpq_poly_rem(rest.get(), p.get(), minimal.get());
    return rest.is_zero();
  }
  [[nodiscard]] bool is(int end) const { return value_at(minimal, Q(end)).sign() == 0; }
  [[nodiscard]] int sign_of(const QPoly& p) const {
    if (is_root_of(p)) return 0;
    const int s = evaluate(p, t).sign();
    EXPECT_NE(s, 0) << "the second engine needs more bits";
    return s;
  }
};

std::vector<Algebraic> unit_roots(const QPoly& p) {
  std::vector<Algebraic> found;
  flint::for_each_real_root(p, [&](const fmpz_poly_struct* factor, unsigned order, arb_srcptr x) {
    Algebraic root;
    fmpq_poly_set_fmpz_poly(root.minimal.get(), factor);
    root.order = order;
    arb_set(root.t.get(), x);
    const bool at_end = fmpz_poly_degree(factor) == 1 && (root.is(0) || root.is(1));
    const bool inside = root.t.sign() > 0 && (Arb(Q(1)) - root.t).sign() > 0;
    if (at_end || inside) found.push_back(root);
  });
  return found;
}

struct Expected {
  Arb l;
  unsigned multiplicity;
  std::array<Arb, 3> normal;
  bool has_normal;
  double t;
};

struct Model {
  SurfaceSpec spec;
  std::vector<std::array<double, 2>> points;
  double unit = 1;  ///< the profile is exactly unit * points
};

/// De Casteljau with polynomials for points.
QPoly bezier(const std::vector<std::array<double, 2>>& points, std::size_t axis) {
  std::vector<QPoly> p;
  for (const auto& point : points) p.emplace_back(Q(point[axis]));
  const QPoly t = polynomial("2  0 1");
  const QPoly rest = polynomial("2  1 -1");
  for (std::size_t n = p.size(); n-- > 1;)
    for (std::size_t i = 0; i < n; ++i) p[i] = rest * p[i] + t * p[i + 1];
  return p[0];
}

/// The second engine: hits of a ray on a profile whose Y is not constant; false when coincident.
class SecondEngine {
 public:
  explicit SecondEngine(const Model& model)
      : r_(Q(model.unit) * bezier(model.points, 0)),
        y_(Q(model.unit) * bezier(model.points, 1)),
        placement_(model.spec.placement) {
    const Q volume = value_at(integral(r_ * r_ * slope(y_)), Q(1));
    orientation_ = volume.sign() < 0 ? -1 : 1;
    const Mat3& m = placement_.matrix;
    inverse_ = flint::inverse({triple(m[0]), triple(m[1]), triple(m[2])});
  }

  bool solve(const Ray& ray, std::vector<Expected>& hits) const {
    const Triple o = triple(ray.o);
    const Triple shift = triple(placement_.translate);
    const Triple from = times(inverse_, {o[0] - shift[0], o[1] - shift[1], o[2] - shift[2]});
    const Triple d = times(inverse_, triple(ray.d));
    const bool ok = d[1].sign() != 0 ? climbing(from, d, hits) : horizontal(from, d, hits);
    join(hits);
    return ok;
  }

 private:
  bool climbing(const Triple& o, const Triple& d, std::vector<Expected>& hits) const {
    // The ray's own points at height Y(t): l(t) is a polynomial.
    const QPoly l = (Q(1) / d[1]) * (y_ - QPoly(o[1]));
    const QPoly x = QPoly(o[0]) + d[0] * l;
    const QPoly z = QPoly(o[2]) + d[2] * l;
    const QPoly e = r_ * r_ - x * x - z * z;
    if (e.is_zero()) return false;
    for (const Algebraic& root : unit_roots(e)) {
      if (root.sign_of(l) <= 0) continue;
      unsigned multiplicity = root.order;
      if (root.is_root_of(r_) && (root.is(0) || root.is(1))) multiplicity = beside(e, root) > 0 ? 1 : 2;
      add(hits, evaluate(l, root.t), multiplicity, root, o, d);
    }
    return true;
  }

  static int beside(const QPoly& e, const Algebraic& root) {
    const QPoly inward = root.is(0) ? e : composed(e, polynomial("2  1 -1"));
    Q c;
    for (slong i = 0;; ++i) {
      fmpq_poly_get_coeff_fmpq(const_cast<fmpq*>(c.get()), inward.get(), i);
      if (c.sign() != 0) return c.sign();
    }
  }

  bool horizontal(const Triple& o, const Triple& d, std::vector<Expected>& hits) const {
    // |o + l d|^2 = w in the plane: with l = foot + h, h^2 = (w - nearest) / a.
    const Q a = d[0] * d[0] + d[2] * d[2];
    const Q foot = Q(0) - (o[0] * d[0] + o[2] * d[2]) / a;
    const Q nx = o[0] + foot * d[0];
    const Q nz = o[2] + foot * d[2];
    const QPoly w = r_ * r_;
    const QPoly h2 = (Q(1) / a) * (w - QPoly(nx * nx + nz * nz));
    const QPoly at_origin = h2 - QPoly(foot * foot);
    for (const Algebraic& root : unit_roots(y_ - QPoly(o[1]))) {
      const int s = root.sign_of(h2);
      if (s < 0) continue;
      const bool pole = root.is_root_of(r_) && (root.is(0) || root.is(1));
      if (s == 0) {
        if (foot.sign() > 0) add(hits, Arb(foot), pole ? 2 : 2 * root.order, root, o, d);
        continue;
      }
      const Arb h = sqrt(evaluate(h2, root.t));
      const int outside = -root.sign_of(at_origin);
      if (foot.sign() > 0 && outside > 0) add(hits, Arb(foot) - h, root.order, root, o, d);
      if (foot.sign() > 0 || outside < 0) add(hits, Arb(foot) + h, root.order, root, o, d);
    }
    return true;
  }

  void add(std::vector<Expected>& hits, const Arb& l, unsigned multiplicity, const Algebraic& root,
           const Triple& o, const Triple& d) const {
    Expected hit{l, multiplicity, {}, false, root.t.value()};
    hit.has_normal = !root.is_root_of(r_) && !(root.is_root_of(slope(r_)) && root.is_root_of(slope(y_)));
    if (hit.has_normal) {
      // In the half plane (|R|, y) it is (Y', -|R|'): times |R|, that is (Y' x, -R R', Y' z).
      const Arb up = evaluate(slope(y_), root.t);
      const Arb side{Q(orientation_)};
      const std::array<Arb, 3> n{side * up * (Arb(o[0]) + l * Arb(d[0])),
                                 Arb(Q(-orientation_)) * evaluate(r_, root.t) * evaluate(slope(r_), root.t),
                                 side * up * (Arb(o[2]) + l * Arb(d[2]))};
      std::array<Arb, 3> world;
      for (std::size_t i = 0; i < 3; ++i)
        world[i] = Arb(inverse_[0][i]) * n[0] + Arb(inverse_[1][i]) * n[1] + Arb(inverse_[2][i]) * n[2];
      const Arb length = sqrt(world[0] * world[0] + world[1] * world[1] + world[2] * world[2]);
      for (std::size_t i = 0; i < 3; ++i) hit.normal[i] = world[i] / length;
    }
    hits.push_back(hit);
  }
  static void join(std::vector<Expected>& hits) {
    std::sort(hits.begin(), hits.end(), [](const Expected& a, const Expected& b) {
      if (arb_overlaps(a.l.get(), b.l.get()) != 0) return a.t < b.t;
      return arb_lt(a.l.get(), b.l.get()) != 0;
    });
    for (std::size_t i = 0; i + 1 < hits.size();) {
      if (arb_overlaps(hits[i].l.get(), hits[i + 1].l.get()) == 0) {
        ++i;
        continue;
      }
      hits[i].multiplicity += hits[i + 1].multiplicity;
      hits.erase(hits.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  }

  QPoly r_, y_;
  Placement placement_;
  Rows inverse_;
  int orientation_ = 1;
};

struct Tally {
  std::size_t rays = 0, hits = 0, touches = 0, coincident = 0;
  double worst_normal = 0;
};

void compare(const truth::Surface& surface, const SecondEngine& engine, const Ray& ray, Tally& tally) {
  std::vector<Expected> expected;
  const bool ok = engine.solve(ray, expected);
  const truth::Answer answer = surface.all(ray, {});
  ++tally.rays;
  if (!ok) {
    ++tally.coincident;
    if (answer.status == Status::coincident) return;
    EXPECT_TRUE(answer.hits.empty());
    return;
  }
  ASSERT_EQ(answer.status, Status::ok) << answer.why;
  ASSERT_EQ(answer.hits.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const truth::Hit& hit = answer.hits[i];
    ++tally.hits;
    tally.touches += hit.tangent ? 1 : 0;
    ASSERT_EQ(hit.multiplicity, expected[i].multiplicity);
    flint::check_real(hit.l, expected[i].l);
    ASSERT_DOUBLE_EQ(hit.params[0], expected[i].t);
    if (!expected[i].has_normal) continue;
    const double error_n = std::max({std::fabs(hit.normal.x - expected[i].normal[0].value()),
                                     std::fabs(hit.normal.y - expected[i].normal[1].value()),
                                     std::fabs(hit.normal.z - expected[i].normal[2].value())});
    tally.worst_normal = std::max(tally.worst_normal, error_n);
    ASSERT_LE(error_n, 4 * 0x1p-53);
  }
}

/// Rays of every hard kind around a profile of the given size.
class Rays {
 public:
  Rays(std::uint64_t seed, Model model) : random_(seed), model_(std::move(model)) {
    for (auto& p : model_.points) p = {model_.unit * p[0], model_.unit * p[1]};
  }

  static constexpr int kKinds = 15;
  Ray next(int kind) {
    const double size = 3 * scale();
    switch (kind) {
      case 0:
        return towards(direction(5 * size), {size * u(), size * (1 + u()), size * u()});
      case 1:
        return {{0.05 * size * u(), 0.5 * size, 0.05 * size * u()}, direction(1)};
      case 2:
        return exactly_tangent(0);
      case 3:
        return exactly_tangent(std::ldexp(scale(), -static_cast<int>(10 + index(45))));
      case 4:
        return flat(towards(direction(3 * size), {0.5 * size * u(), size * (0.1 + 0.9 * (u() + 1)), 0}));
      case 5:
        return horizontal(size * (u() + 1));
      case 6:
        return horizontal(height(std::ldexp(static_cast<double>(index(9)), -3)));
      case 7:
        return {{size, height(1), 0}, {-1, 0.25 * std::floor(4 * u()), 0}};
      case 8:
        return {{size, height(0), 0}, {-1, 0.25 * std::floor(4 * u()), 0}};
      case 9:
        return {{0, 4 * size * u(), 0}, {0, u() < 0 ? 1.0 : -0.5, 0}};
      case 10:
        return towards(direction(1e8 * size), {0.4 * size * u(), size * (1 + u()), 0.4 * size * u()});
      case 11:
        return on_surface();
      case 12:
        return parallel_to_axis(size);
      case 13:
        return {{wild(), wild(), wild()}, {wild(), wild(), wild()}};
      default:
        return towards(direction(size), {0, height(u() < 0 ? 0 : 1), 0});
    }
  }

 private:
  double u() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  unsigned index(unsigned n) { return static_cast<unsigned>(random_() % n); }
  [[nodiscard]] double scale() const {
    double size = 0;
    for (const auto& p : model_.points) size = std::max({size, std::fabs(p[0]), std::fabs(p[1])});
    return size / 6;
  }
  Vec3 direction(double length) {
    std::normal_distribution<double> normal;
    const Vec3 v{normal(random_), normal(random_), normal(random_)};
    return (length / norm(v)) * v;
  }
  static Ray towards(Vec3 o, Vec3 target) { return {o, target - o}; }
  Ray flat(Ray ray) {
    ray.d.y = std::pow(10, -9 + 7 * u()) * norm(ray.d) * (u() < 0 ? -1 : 1);
    return ray;
  }
  [[nodiscard]] std::vector<double> column(std::size_t axis) const {
    std::vector<double> p;
    for (const auto& point : model_.points) p.push_back(point[axis]);
    return p;
  }
  [[nodiscard]] double slope(double t, std::size_t axis) const {
    std::vector<double> p = column(axis);
    const auto n = static_cast<double>(p.size() - 1);
    for (std::size_t i = 0; i + 1 < p.size(); ++i) p[i] = n * (p[i + 1] - p[i]);
    p.pop_back();
    return casteljau(std::move(p), t);
  }
  [[nodiscard]] double casteljau(double t, std::size_t axis) const { return casteljau(column(axis), t); }
  static double casteljau(std::vector<double> p, double t) {
    for (std::size_t n = p.size(); n-- > 1;)
      for (std::size_t i = 0; i < n; ++i) p[i] = (1 - t) * p[i] + t * p[i + 1];
    return p[0];
  }
  [[nodiscard]] double height(double t) const { return casteljau(t, 1); }
  Ray horizontal(double y) {
    const double size = 3 * scale();
    if (index(3) == 0) return {{-size, y, 0}, {1, 0, 0}};
    return {{-size, y, 0.5 * size * u()}, {1, 0, 0.2 * u()}};
  }
  /// Through a profile point at a dyadic t, along a tangent direction: exact while the numbers are short.
  Ray exactly_tangent(double offset) {
    const double t = std::ldexp(static_cast<double>(1 + index(15)), -4);
    const double r = casteljau(t, 0);
    const double slope_r = slope(t, 0);
    const double slope_y = slope(t, 1);
    const double along = static_cast<double>(index(3));
    const double around = static_cast<double>(1 + index(2));
    const Vec3 d{along * slope_r, along * slope_y, around * scale()};
    return {Vec3{r + offset, height(t), 0} - 4.0 * d, d};
  }
  double wild() { return std::pow(10, 100 * u() * u()) * (u() < 0 ? -scale() : scale()); }
  Ray on_surface() {
    const double t = std::ldexp(static_cast<double>(index(17)), -4);
    return {{casteljau(t, 0), height(t), 0}, direction(1)};
  }
  Ray parallel_to_axis(double size) {
    const double t = std::ldexp(static_cast<double>(index(17)), -4);
    return {{index(2) == 0 ? casteljau(t, 0) : size * u(), -size, 0}, {0, 1, 0}};
  }

  std::mt19937_64 random_;
  Model model_;
};

Model teardrop(double s) {
  Model model;
  model.spec.type = "teardrop";
  model.spec.parameters.set("s", s);
  model.points = {{0, 0}, {2, 0}, {3, 2}, {0, 6}};
  model.unit = s;
  return model;
}

Model profile(std::vector<std::array<double, 2>> points) {
  Model model;
  model.spec.type = "bezier_revolution";
  std::vector<std::vector<double>> table;
  for (const auto& p : points) table.push_back({p[0], p[1]});
  model.spec.parameters.set("control_points", table);
  model.points = std::move(points);
  return model;
}

/// Carries the object's rays into the world where that is exact or nearly so.
Ray placed(const Ray& ray, const Placement& placement) {
  return {placement.matrix * ray.o + placement.translate, placement.matrix * ray.d};
}

void sweep(const Model& model, std::uint64_t seed, int rays_a_kind, Tally& tally) {
  const auto surface = truth::make_surface(model.spec);
  const SecondEngine engine(model);
  Rays rays(seed, model);
  for (int kind = 0; kind < Rays::kKinds; ++kind) {
    for (int i = 0; i < rays_a_kind; ++i) {
      const Ray ray = placed(rays.next(kind), model.spec.placement);
      char text[400];
      std::snprintf(text, sizeof text, "seed %llu kind %d ray %d: o=(%a,%a,%a) d=(%a,%a,%a)",
                    static_cast<unsigned long long>(seed), kind, i, ray.o.x, ray.o.y, ray.o.z, ray.d.x,
                    ray.d.y, ray.d.z);
      SCOPED_TRACE(text);
      compare(*surface, engine, ray, tally);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

void print(const char* what, const Tally& tally) {
  std::printf("%s: %zu rays, %zu hits (%zu touches), %zu coincident; worst normal %.2g\n", what, tally.rays,
              tally.hits, tally.touches, tally.coincident, tally.worst_normal);
}

TEST(TruthFlint, TeardropAgreesOnEveryHardFamily) {
  Tally tally;
  sweep(teardrop(1), 1, 60, tally);
  sweep(teardrop(0.7), 2, 20, tally);
  print("teardrop", tally);
  EXPECT_GE(tally.rays, 1000U);
  EXPECT_GE(tally.touches, 60U);
}

TEST(TruthFlint, TeardropAgreesAtScales) {
  Tally tally;
  sweep(teardrop(0x1p40), 3, 8, tally);
  sweep(teardrop(0x1p-40), 4, 8, tally);
  sweep(teardrop(0x1.23456789abcdep-3), 5, 8, tally);
  print("scales", tally);
}

TEST(TruthFlint, TransformedTeardropAgrees) {
  Tally tally;
  const std::vector<Mat3> matrices{{Vec3{2, 0, 0}, Vec3{0, 2, 0}, Vec3{0, 0, 2}},
                                   {Vec3{1, 0.5, 0}, Vec3{0, 1, 0.25}, Vec3{0, 0, 1}},
                                   {Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}},
                                   {Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, -3}},
                                   {Vec3{0.3, 0.1, -0.7}, Vec3{1.1, 0.2, 0.9}, Vec3{-0.4, 1.3, 0.6}}};
  std::uint64_t seed = 10;
  for (const Mat3& matrix : matrices) {
    Model model = teardrop(1);
    model.spec.placement = {{1, -2, 0.1}, matrix};
    sweep(model, seed++, 8, tally);
  }
  print("transforms", tally);
}

TEST(TruthFlint, RandomProfilesOfDegreeOneToEightAgree) {
  Tally tally;
  std::mt19937_64 random(7);
  for (std::size_t n = 1; n <= 8; ++n) {
    for (int i = 0; i < 4; ++i) {
      // Odd profiles have short integers, where cusps, closed curves and ties are frequent.
      std::uniform_real_distribution<double> real(-6, 6);
      std::vector<std::array<double, 2>> points;
      for (std::size_t k = 0; k <= n; ++k) {
        std::array<double, 2> p{std::fabs(real(random)), real(random)};
        if (i % 2 == 1) p = {std::trunc(p[0] - (i == 3 ? 2 : 0)), std::trunc(p[1])};
        points.push_back(p);
      }
      if (i % 2 == 1 && n > 1) points.back() = points.front();
      bool flat = true;
      for (const auto& p : points) flat = flat && p[1] == points[0][1];
      if (flat) points.back()[1] += 1;
      sweep(profile(points), 100 * n + static_cast<std::uint64_t>(i), 3, tally);
    }
  }
  print("profiles", tally);
}

TEST(TruthFlint, NamedProfilesAgree) {
  Tally tally;
  const std::vector<std::vector<std::array<double, 2>>> profiles{
      {{0, 0}, {1, 1}},                           // cone
      {{1, 0}, {1, 4}},                           // cylinder
      {{1, 0}, {-1, 2}},                          // double cone
      {{1, 0}, {4, 4}, {-1, 4}, {2, 0}},          // loop
      {{1, 0}, {3, 3}, {0, 3}, {2, 0}},           // cusp
      {{0, 0}, {4, 0}, {4, 6}, {0, 6}},           // smooth closed body
      {{0, 0}, {2, 1}, {0, 2}},                   // lens with cone points
      {{1, 0}, {2, 4}, {1, 0}},                   // there and back: every point twice
      {{1, 0}, {2, 4}, {-2, 4}, {-1, 0}},         // the same with R changing its sign
      {{2, 0}, {2, 4}, {0, 0}, {4, 0}, {2, 4}},   // self-touching
      {{1, 0}, {3, 0}, {3, 2}, {1, 2}, {1, 0}}};  // ring
  std::uint64_t seed = 1000;
  for (const auto& points : profiles) sweep(profile(points), seed++, 6, tally);
  print("named profiles", tally);
}

/// Distinct real roots with multiplicity of a polynomial with double coefficients, counted by FLINT.
TEST(TruthFlint, RealRootsOfPolynomialsAgreeInNumberAndMultiplicity) {
  std::mt19937_64 random(11);
  std::size_t compared = 0;
  for (int i = 0; i < 300; ++i) {
    // Products of small integer polynomials, so that multiplicities and rational roots are frequent.
    QPoly p(Q(1.0));
    const unsigned factors = 1 + static_cast<unsigned>(random() % 4);
    for (unsigned j = 0; j < factors; ++j) {
      QPoly f;
      const unsigned n = 1 + static_cast<unsigned>(random() % 4);
      for (unsigned k = 0; k <= n; ++k)
        fmpq_poly_set_coeff_si(f.get(), k, static_cast<slong>(random() % 15) - 7);
      if (f.is_zero()) continue;
      p = p * f;
      if (random() % 3 == 0) p = p * f;
    }
    fmpz_poly_t z;
    fmpz_poly_init(z);
    fmpq_poly_get_numerator(z, p.get());
    std::vector<double> c;
    for (slong k = 0; k < fmpz_poly_length(z); ++k) {
      fmpz* const coefficient = fmpz_poly_get_coeff_ptr(z, k);
      c.push_back(fmpz_get_d(coefficient));
    }
    fmpz_poly_factor_t squares;
    fmpz_poly_factor_init(squares);
    fmpz_poly_factor_squarefree(squares, z);
    std::vector<slong> expected(32, 0);
    for (slong k = 0; k < squares->num; ++k)
      expected[static_cast<std::size_t>(squares->exp[k])] += fmpz_poly_num_real_roots(squares->p + k);
    fmpz_poly_factor_clear(squares);
    fmpz_poly_clear(z);
    const auto answer = truth::real_roots(c, std::nullopt);
    ASSERT_EQ(answer.status, Status::ok);
    for (const auto& root : answer.roots) --expected[root.multiplicity];
    for (const slong rest : expected) ASSERT_EQ(rest, 0) << "polynomial " << i;
    ++compared;
  }
  std::printf("%zu polynomials\n", compared);
}

}  // namespace
}  // namespace graze
