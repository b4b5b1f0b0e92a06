#include <gtest/gtest.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <graze/solvers/math/interval.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/any_dimension.hpp>
#include <limits>
#include <vector>

namespace graze::nd {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Rng seeded(std::uint64_t offset) {
  std::printf("    seed %" PRIu64 "\n", kSeed + offset);
  return Rng(kSeed + offset);
}

template <std::size_t N>
Vector<N> random_vector(Rng& rng, double size) {
  Vector<N> v;
  for (double& x : v) x = rng.uniform(-size, size);
  return v;
}

template <std::size_t N>
Vector<N> axis(std::size_t i, double size) {
  Vector<N> v{};
  v[i] = size;
  return v;
}

template <std::size_t N>
Vector<N> scaled(Vector<N> v, int k) {
  for (double& x : v) x = std::ldexp(x, k);
  return v;
}

template <std::size_t N>
Matrix<N> diagonal(const Vector<N>& entries) {
  Matrix<N> m{};
  for (std::size_t i = 0; i < N; ++i) m[i][i] = entries[i];
  return m;
}

/// The same hits, each l times 2^k, to the last bit.
void expect_scaled(const Hits& a, const Hits& b, int k) {
  ASSERT_EQ(a.status, b.status);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(std::ldexp(a[i].l, k), b[i].l);
    ASSERT_EQ(a[i].multiplicity, b[i].multiplicity);
  }
}

/// |o + l d - c|^2 - r^2, exactly.
template <std::size_t N>
Expansion sphere_value(const Sphere<N>& s, const Vector<N>& o, const Vector<N>& d, double l) {
  Expansion sum = -(Expansion(s.radius()) * s.radius());
  for (std::size_t i = 0; i < N; ++i) {
    const Expansion x = Expansion(l) * d[i] + o[i] - s.center()[i];
    sum += x * x;
  }
  return sum;
}

/// The exact number of hits: from b^2 - ac, c and b of a l^2 + 2 b l + c.
template <std::size_t N>
std::size_t true_count(const Sphere<N>& s, const Vector<N>& o, const Vector<N>& d) {
  Expansion b;
  for (std::size_t i = 0; i < N; ++i) b += (Expansion(o[i]) - s.center()[i]) * d[i];
  const Expansion a = exact_dot(d, d), c = sphere_value(s, o, d, 0);
  const int discriminant = (b * b - a * c).sign();
  if (c.sign() < 0) return 1;
  if (discriminant < 0 || b.sign() >= 0) return 0;
  return c.is_zero() || discriminant == 0 ? 1 : 2;
}

/// Does the value change its sign, or vanish, between the neighbours of l?
template <std::size_t N>
bool is_within_an_ulp(const Sphere<N>& s, const Vector<N>& o, const Vector<N>& d, double l) {
  return sphere_value(s, o, d, next_below(l)).sign() * sphere_value(s, o, d, next_above(l)).sign() <= 0;
}

/// From o to a point at this distance from the centre, seen at a right angle; any direction where N = 1.
template <std::size_t N>
Vector<N> aimed_past(Rng& rng, const Sphere<N>& sphere, const Vector<N>& o, double distance) {
  Vector<N> to_center, side = random_vector<N>(rng, 1), d;
  for (std::size_t k = 0; k < N; ++k) to_center[k] = sphere.center()[k] - o[k];
  const double along = exact_dot(side, to_center).value() / exact_dot(to_center, to_center).value();
  for (std::size_t k = 0; k < N; ++k) side[k] -= N == 1 ? 0 : along * to_center[k];
  const double size = std::sqrt(exact_dot(side, side).value());
  for (std::size_t k = 0; k < N; ++k) d[k] = to_center[k] + distance * side[k] / size;
  return d;
}

template <class Dimension>
class AnyDimension : public testing::Test {};
template <std::size_t N>
using Size = std::integral_constant<std::size_t, N>;
using Dimensions = testing::Types<Size<1>, Size<2>, Size<3>, Size<4>, Size<8>>;
TYPED_TEST_SUITE(AnyDimension, Dimensions);

TYPED_TEST(AnyDimension, ASphereIsHitWhereItIs) {
  constexpr std::size_t N = TypeParam::value;
  const Sphere<N> sphere(axis<N>(0, 5), 2);
  const Hits outside = sphere.hits({}, axis<N>(0, 0.5));
  ASSERT_EQ(outside.size(), 2U);
  EXPECT_EQ(outside[0], (Hit{6, 1}));
  EXPECT_EQ(outside[1], (Hit{14, 1}));
  const Hits inside = sphere.hits(axis<N>(0, 4), axis<N>(0, -1));
  ASSERT_EQ(inside.size(), 1U);
  EXPECT_EQ(inside[0], (Hit{1, 1}));
  EXPECT_TRUE(sphere.hits({}, axis<N>(0, -1)).empty());
  // A ray that starts on the sphere does not hit it there.
  const Hits inward = sphere.hits(axis<N>(0, 3), axis<N>(0, 1));
  ASSERT_EQ(inward.size(), 1U);
  EXPECT_EQ(inward[0], (Hit{4, 1}));
  EXPECT_TRUE(sphere.hits(axis<N>(0, 3), axis<N>(0, -1)).empty());
}

TYPED_TEST(AnyDimension, CountsOfASphereAreExactAndHitsWithinAnUlp) {
  constexpr std::size_t N = TypeParam::value;
  Rng rng = seeded(N);
  std::array<int, 3> seen{};
  for (int i = 0; i < 3000; ++i) {
    const Sphere<N> sphere(random_vector<N>(rng, 3), std::exp2(rng.uniform(-10, 2)));
    const Vector<N> o = random_vector<N>(rng, std::exp2(rng.uniform(0, 30)));
    // Aimed past the centre at (1 + 2^-k) radii, k up to 60: from clear misses and hits to grazing rays.
    const double offset = std::exp2(rng.uniform(-60, 0)) * (rng.next() % 2 == 0 ? 1 : -1);
    const Vector<N> d = aimed_past(rng, sphere, o, (1 + offset) * sphere.radius());
    const Hits hits = sphere.hits(o, d);
    ASSERT_EQ(hits.status, Status::ok);
    ASSERT_EQ(hits.size(), true_count(sphere, o, d)) << i;
    ++seen[hits.size()];
    for (const Hit& hit : hits) ASSERT_TRUE(is_within_an_ulp(sphere, o, d, hit.l)) << i << " " << hit.l;
  }
  std::printf("    none %d, one %d, two %d\n", seen[0], seen[1], seen[2]);
  EXPECT_GT(seen[2], 500);
  EXPECT_GT(seen[0], N >= 2 ? 500 : -1);
}

TYPED_TEST(AnyDimension, ATangentRayTouchesASphereOnce) {
  constexpr std::size_t N = TypeParam::value;
  if constexpr (N >= 2) {
    Rng rng = seeded(20);
    for (int i = 0; i < 2000; ++i) {
      // Axis-parallel at the height r: a touch, whatever the bits of r, far away or near.
      const double r = std::exp2(rng.uniform(-20, 20)), x = -std::exp2(rng.uniform(-20, 40));
      Vector<N> o{};
      o[0] = x;
      o[N - 1] = r;
      const Vector<N> d = axis<N>(0, std::exp2(rng.uniform(-5, 5)));
      const Sphere<N> sphere({}, r);
      const Hits touch = sphere.hits(o, d);
      ASSERT_EQ(touch.size(), 1U);
      EXPECT_EQ(touch[0], (Hit{-x / d[0], 2}));
      // One ulp off, it misses or crosses (or, from within the short chord, leaves).
      o[N - 1] = next_above(r);
      EXPECT_TRUE(sphere.hits(o, d).empty());
      o[N - 1] = next_below(r);
      ASSERT_EQ(sphere.hits(o, d).size(), true_count(sphere, o, d));
      EXPECT_GE(sphere.hits(o, d).size(), 1U);
    }
  }
}

TYPED_TEST(AnyDimension, APythagoreanTangentTouchesOnce) {
  constexpr std::size_t N = TypeParam::value;
  if constexpr (N >= 2) {
    // Touches |x| = 5 at (3, 4) in direction (4, -3); centre and ray are moved by exact numbers.
    Vector<N> o{}, d{}, c{};
    c[0] = 0x1p40;
    c[1] = -0.125;
    d[0] = 4;
    d[1] = -3;
    o[0] = c[0] + 3 - 4 * 1024.0;
    o[1] = c[1] + 4 + 3 * 1024.0;
    const Hits touch = Sphere<N>(c, 5).hits(o, d);
    ASSERT_EQ(touch.size(), 1U);
    EXPECT_EQ(touch[0], (Hit{1024, 2}));
    // Behind the origin, or starting at the point of contact: nothing.
    EXPECT_TRUE(Sphere<N>(c, 5).hits(o, {-4, 3}).empty());
    Vector<N> contact{};
    contact[0] = c[0] + 3;
    contact[1] = c[1] + 4;
    EXPECT_TRUE(Sphere<N>(c, 5).hits(contact, d).empty());
  }
}

TYPED_TEST(AnyDimension, APlaneIsHitWhereTheCorrectedFormulaSays) {
  constexpr std::size_t N = TypeParam::value;
  // x_1 = 3 from the origin in direction 2 e_1: l = (b - a.o)/(a.d) = 1.5, in front of the ray.
  const Plane<N> plane(axis<N>(0, 1), 3);
  const Hits hit = plane.hits({}, axis<N>(0, 2));
  ASSERT_EQ(hit.size(), 1U);
  EXPECT_EQ(hit[0], (Hit{1.5, 1}));
  EXPECT_TRUE(plane.hits({}, axis<N>(0, -2)).empty());
  EXPECT_TRUE(plane.hits(axis<N>(0, 3), axis<N>(0, 1)).empty()) << "starts on it";
  if constexpr (N >= 2) {
    const Hits parallel = plane.hits({}, axis<N>(N - 1, 1));
    EXPECT_TRUE(parallel.empty() && parallel.status == Status::ok);
    EXPECT_EQ(plane.hits(axis<N>(0, 3), axis<N>(N - 1, 1)).status, Status::coincident);
    EXPECT_EQ(Plane<N>(axis<N>(0, 1), 0).hits({}, axis<N>(N - 1, 1)).status, Status::coincident);
  }
}

TYPED_TEST(AnyDimension, PlanesAreWithinAnUlpAndParallelismIsExact) {
  constexpr std::size_t N = TypeParam::value;
  Rng rng = seeded(40 + N);
  for (int i = 0; i < 3000; ++i) {
    const Vector<N> a = random_vector<N>(rng, 1), o = random_vector<N>(rng, 100);
    const double b = rng.uniform(-1, 1);
    Vector<N> d = random_vector<N>(rng, 1);
    // Nearly parallel: what rounding leaves of a.d decides.
    if (N >= 2 && i % 2 == 0) {
      Vector<N> rest = d;
      rest[0] = 0;
      d[0] = -exact_dot(a, rest).value() / a[0];
    }
    const Expansion above = b - exact_dot(a, o), slope = exact_dot(a, d);
    const Hits hits = Plane<N>(a, b).hits(o, d);
    ASSERT_EQ(hits.status, Status::ok);
    ASSERT_EQ(hits.size(), above.sign() * slope.sign() > 0 ? 1U : 0U);
    if (hits.empty()) continue;
    const auto value = [&](double l) { return (slope * l - above).sign(); };
    ASSERT_LE(value(next_below(hits[0].l)) * value(next_above(hits[0].l)), 0);
  }
}

TYPED_TEST(AnyDimension, AnEllipsoidWithEqualAxesIsTheSphere) {
  constexpr std::size_t N = TypeParam::value;
  Rng rng = seeded(60 + N);
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector<N> center = random_vector<N>(rng, 3), o = random_vector<N>(rng, 20);
    const double r = std::ldexp(std::floor(rng.uniform(8, 16)), -3);
    Vector<N> squares;
    squares.fill(r * r);
    const Ellipsoid<N> ellipsoid(center, diagonal<N>(squares));
    Vector<N> d = random_vector<N>(rng, 1);
    for (std::size_t k = 0; k < N; ++k) d[k] += center[k] - o[k];
    const Hits a = ellipsoid.hits(o, d), b = Sphere<N>(center, r).hits(o, d);
    ASSERT_EQ(a.status, Status::ok);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k].l, b[k].l, ulp(b[k].l));
    compared += static_cast<int>(a.size());
  }
  EXPECT_GT(compared, 1000);
}

TYPED_TEST(AnyDimension, AnEllipsoidIsTheImageOfTheUnitSphere) {
  constexpr std::size_t N = TypeParam::value;
  Rng rng = seeded(80 + N);
  double worst = 0, condition = 0;
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    // Small whole numbers, a dominant diagonal: A, A A^T and A o are exact.
    Matrix<N> map, P{};
    for (std::size_t r = 0; r < N; ++r)
      for (std::size_t c = 0; c < N; ++c)
        map[r][c] = std::floor(rng.uniform(-2, 3)) + (r == c ? 4.0 * static_cast<double>(N) : 0);
    for (std::size_t r = 0; r < N; ++r)
      for (std::size_t c = 0; c < N; ++c) P[r][c] = exact_dot(map[r], map[c]).value();
    Vector<N> o, d, center, image_o, image_d;
    for (std::size_t k = 0; k < N; ++k) {
      o[k] = std::floor(rng.uniform(-1024, 1024)) / 64;
      d[k] = std::floor(rng.uniform(-64, 64)) / 64 - o[k];
      center[k] = std::floor(rng.uniform(-1024, 1024)) / 64;
    }
    if (o == Vector<N>{} || d == Vector<N>{}) continue;
    for (std::size_t k = 0; k < N; ++k) {
      image_o[k] = exact_dot(map[k], o).value() + center[k];
      image_d[k] = exact_dot(map[k], d).value();
    }
    const Ellipsoid<N> ellipsoid(center, P);
    condition = std::max(condition, ellipsoid.condition());
    const Hits a = ellipsoid.hits(image_o, image_d), b = Sphere<N>({}, 1).hits(o, d);
    if (a.status == Status::uncertain) continue;  // a touch, or an origin on the surface
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      worst = std::max(worst, std::fabs(a[k].l - b[k].l) / ulp(b[k].l));
      ++compared;
    }
  }
  std::printf("    %d hits, worst %.2g ulp, condition up to %.3g\n", compared, worst, condition);
  EXPECT_LE(worst, 1);
  EXPECT_GT(compared, N < 8 ? 100 : 0);
}

TYPED_TEST(AnyDimension, AnEllipsoidIsUncertainWhereItTouches) {
  constexpr std::size_t N = TypeParam::value;
  if constexpr (N >= 2) {
    Vector<N> squares;
    squares.fill(4);
    squares[0] = 9;
    const Ellipsoid<N> ellipsoid({}, diagonal<N>(squares));
    Vector<N> o = axis<N>(N - 1, 2);
    o[0] = -7;
    const Hits touch = ellipsoid.hits(o, axis<N>(0, 1));
    EXPECT_TRUE(touch.empty() && touch.status == Status::uncertain);
    o[N - 1] = next_below(2);
    EXPECT_EQ(ellipsoid.hits(o, axis<N>(0, 1)).size(), 2U);
    o[N - 1] = next_above(2);
    EXPECT_EQ(ellipsoid.hits(o, axis<N>(0, 1)), Hits());
    // From a point of the surface inward the far hit is certain, the one at l = 0 is not.
    const Hits inward = ellipsoid.hits(axis<N>(0, -3), axis<N>(0, 1));
    EXPECT_EQ(inward.status, Status::uncertain);
    ASSERT_EQ(inward.size(), 1U);
    EXPECT_EQ(inward[0], (Hit{6, 1}));
  }
}

/// v^T adj(P) w for a 2x2 P: det P times v^T P^-1 w, exactly.
Expansion adjugate_form(const Matrix<2>& P, const std::array<Expansion, 2>& v,
                        const std::array<Expansion, 2>& w) {
  return v[0] * w[0] * P[1][1] - (v[0] * w[1] + v[1] * w[0]) * P[0][1] + v[1] * w[1] * P[0][0];
}

/// The exact number of hits of an ellipse, from its equation times det P.
std::size_t true_count(const Ellipsoid<2>& ellipse, const Vector<2>& o, const Vector<2>& d) {
  const Matrix<2>& P = ellipse.matrix();
  const std::array<Expansion, 2> e{Expansion(d[0]), Expansion(d[1])};
  const std::array<Expansion, 2> m{Expansion(o[0]) - ellipse.center()[0],
                                   Expansion(o[1]) - ellipse.center()[1]};
  const Expansion a = adjugate_form(P, e, e), b = adjugate_form(P, m, e);
  const Expansion c = adjugate_form(P, m, m) - exact_determinant(P);
  if (c.sign() < 0) return 1;
  const int discriminant = (b * b - a * c).sign();
  if (discriminant < 0 || b.sign() >= 0) return 0;
  return c.is_zero() || discriminant == 0 ? 1 : 2;
}

TEST(AnyDimensionEllipse, SkewedAndGrazedTheCountIsRightOrUncertain) {
  Rng rng = seeded(120);
  std::array<int, 3> seen{};
  int uncertain = 0;
  for (int i = 0; i < 20'000; ++i) {
    // Correlation up to 1 - 2^-40, widths up to 2^20 apart; aimed past the edge at 2^-70 ... 1 of the width.
    const double wide = std::exp2(rng.uniform(0, 20)), skew = 1 - std::exp2(rng.uniform(-40, 0));
    const Matrix<2> P{{{wide * wide, skew * wide}, {skew * wide, 1}}};
    const Vector<2> center = random_vector<2>(rng, 4), d = random_vector<2>(rng, 1);
    const Vector<2> n{-d[1], d[0]};
    const double n2 = n[0] * n[0] + n[1] * n[1];
    const double support =
        std::sqrt(n[0] * (P[0][0] * n[0] + 2 * P[0][1] * n[1]) + P[1][1] * n[1] * n[1]) / n2;
    const double offset = 1 + std::exp2(rng.uniform(-70, 0)) * (rng.next() % 2 == 0 ? 1 : -1);
    const double back = std::exp2(rng.uniform(-5, 30));
    const Vector<2> o{center[0] + offset * support * n[0] - back * d[0],
                      center[1] + offset * support * n[1] - back * d[1]};
    const Ellipsoid<2> ellipse(center, P);
    const Hits hits = ellipse.hits(o, d);
    if (hits.status == Status::uncertain) {
      ++uncertain;
      ASSERT_LE(hits.size(), true_count(ellipse, o, d));
      continue;
    }
    ASSERT_EQ(hits.size(), true_count(ellipse, o, d)) << i << " condition " << ellipse.condition();
    ++seen[hits.size()];
  }
  std::printf("    none %d, one %d, two %d, uncertain %d\n", seen[0], seen[1], seen[2], uncertain);
  EXPECT_GT(std::min(seen[0], seen[2]), 2000);
  EXPECT_LT(uncertain, 4000);
}

TYPED_TEST(AnyDimension, ScalingByAPowerOfTwoChangesNoBit) {
  constexpr std::size_t N = TypeParam::value;
  Rng rng = seeded(100 + N);
  for (int i = 0; i < 500; ++i) {
    const Vector<N> center = random_vector<N>(rng, 3), o = random_vector<N>(rng, 20),
                    a = random_vector<N>(rng, 1);
    Vector<N> d = random_vector<N>(rng, 3), squares = random_vector<N>(rng, 4);
    for (std::size_t k = 0; k < N; ++k) d[k] += center[k] - o[k];
    for (double& square : squares) square = 1 + std::fabs(square);
    Matrix<N> P = diagonal<N>(squares);
    if constexpr (N >= 2) P[0][1] = P[1][0] = 0.5;
    const double r = rng.uniform(1, 2), b = rng.uniform(-3, 3);
    const Hits sphere = Sphere<N>(center, r).hits(o, d), plane = Plane<N>(a, b).hits(o, d);
    const Hits ellipsoid = Ellipsoid<N>(center, P).hits(o, d);
    for (const int k : {-400, -37, 1, 300}) {
      Matrix<N> Q = P;
      for (auto& row : Q) row = scaled<N>(row, 2 * k);
      const Vector<N> far = scaled<N>(o, k), c = scaled<N>(center, k);
      expect_scaled(sphere, Sphere<N>(c, std::ldexp(r, k)).hits(far, scaled<N>(d, k)), 0);
      expect_scaled(sphere, Sphere<N>(c, std::ldexp(r, k)).hits(far, d), k);
      expect_scaled(plane, Plane<N>(scaled<N>(a, -2 * k), std::ldexp(b, -k)).hits(far, scaled<N>(d, 5)),
                    k - 5);
      expect_scaled(ellipsoid, Ellipsoid<N>(c, Q).hits(far, scaled<N>(d, -k)), 2 * k);
    }
  }
}

TYPED_TEST(AnyDimension, ExtremeNumbersAreRightOrUncertainNeverWrong) {
  constexpr std::size_t N = TypeParam::value;
  const auto big = [](std::size_t i) { return axis<N>(i, 1e300); };
  const Hits far = Sphere<N>({}, 1e-300).hits(axis<N>(0, -1e300), axis<N>(0, 1e300));
  EXPECT_TRUE(far.status == Status::uncertain || far.size() == 2);
  const Hits center = Sphere<N>(big(0), 1e-10).hits(big(0), axis<N>(0, 1));
  EXPECT_TRUE(center.status == Status::uncertain || center.size() == 1);
  Vector<N> widths;
  widths.fill(1);
  const Hits middle = Ellipsoid<N>(big(0), diagonal<N>(widths)).hits(big(0), axis<N>(0, 1));
  ASSERT_EQ(middle.size(), 1U);
  EXPECT_EQ(middle[0], (Hit{1, 1}));
  widths.fill(1e300);
  const Hits apart =
      Ellipsoid<N>(axis<N>(0, 1.7e308), diagonal<N>(widths)).hits(axis<N>(0, -1.7e308), big(0));
  EXPECT_TRUE(apart.status == Status::uncertain || apart.size() == 2);
  const Hits tiny = Sphere<N>({}, 0x1p-1074).hits(axis<N>(0, -0x1p-1072), axis<N>(0, 0x1p-1074));
  ASSERT_EQ(tiny.size(), 2U);
  EXPECT_EQ(tiny[0], (Hit{3, 1}));
  EXPECT_EQ(tiny[1], (Hit{5, 1}));
  if constexpr (N >= 2) {
    // a.d = 1e-400: not zero, though no double is it.
    Vector<N> slope = axis<N>(0, 1e-200), along = axis<N>(0, 1e-200);
    slope[1] = 1;
    along[N - 1] += N == 2 ? 0 : 1;
    EXPECT_NE(Plane<N>(slope, 0).hits({}, along).status, Status::coincident);
  }
}

TYPED_TEST(AnyDimension, WhatIsNoSurfaceIsRefusedAndWhatIsNoRayIsInvalid) {
  constexpr std::size_t N = TypeParam::value;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double radius : {0.0, -1.0, nan, kInfinity})
    EXPECT_THROW(Sphere<N>({}, radius), std::invalid_argument);
  EXPECT_THROW(Sphere<N>(axis<N>(0, nan), 1), std::invalid_argument);
  EXPECT_THROW(Plane<N>({}, 1), std::invalid_argument);
  EXPECT_THROW(Plane<N>(axis<N>(0, 1), nan), std::invalid_argument);
  Vector<N> ones;
  ones.fill(1);
  Matrix<N> P = diagonal<N>(ones);
  P[N - 1][N - 1] = N == 1 ? -1 : 0;
  EXPECT_THROW(Ellipsoid<N>({}, P), std::invalid_argument);
  if constexpr (N >= 2) {
    P = diagonal<N>(ones);
    P[0][1] = 0.5;
    EXPECT_THROW(Ellipsoid<N>({}, P), std::invalid_argument) << "not symmetric";
    P[1][0] = P[0][1] = 1;
    EXPECT_THROW(Ellipsoid<N>({}, P), std::invalid_argument) << "singular";
    P[1][0] = P[0][1] = 1 - 0x1p-53;
    EXPECT_NO_THROW(Ellipsoid<N>({}, P)) << "definite by one bit";
    EXPECT_GT(Ellipsoid<N>({}, P).condition(), 0x1p53);
  }
  for (const auto& [o, d] : {std::pair{Vector<N>{}, Vector<N>{}}, std::pair{Vector<N>{}, axis<N>(0, nan)},
                             std::pair{axis<N>(0, kInfinity), axis<N>(0, 1)}}) {
    EXPECT_EQ(Sphere<N>({}, 1).hits(o, d).status, Status::invalid);
    EXPECT_EQ(Plane<N>(ones, 1).hits(o, d).status, Status::invalid);
    EXPECT_EQ(Ellipsoid<N>({}, diagonal<N>(ones)).hits(o, d).status, Status::invalid);
  }
}

}  // namespace
}  // namespace graze::nd
