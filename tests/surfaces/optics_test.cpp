#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <graze/solvers/math/double_double.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/optics.hpp>
#include <numbers>

namespace graze {
namespace {

constexpr double kU = 0x1p-53;
constexpr std::uint64_t kSeed = 20261122;
constexpr int kCases = 100'000;

Rng seeded(std::uint64_t offset) {
  std::printf("    seed %" PRIu64 "\n", kSeed + offset);
  return Rng(kSeed + offset);
}

Vec3 random_unit(Rng& rng) {
  for (;;) {
    const Vec3 v{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const double square = dot(v, v);
    if (square > 0.01 && square < 1) return normalized(v);
  }
}

/// |v| - 1, in double-double: twice the bits of what is judged.
double length_error(Vec3 v) {
  return (sqrt(two_prod(v.x, v.x) + two_prod(v.y, v.y) + two_prod(v.z, v.z)) - 1.0).hi;
}

/// |a x b| in double-double.
DoubleDouble sine_between(Vec3 a, Vec3 b) {
  const DoubleDouble x = two_prod(a.y, b.z) - two_prod(a.z, b.y);
  const DoubleDouble y = two_prod(a.z, b.x) - two_prod(a.x, b.z);
  const DoubleDouble z = two_prod(a.x, b.y) - two_prod(a.y, b.x);
  return sqrt(x * x + y * y + z * z);
}

/// A light direction on the side of n; its angle from normal or from grazing is log-uniform.
Vec3 light_about(Rng& rng, Vec3 n) {
  const Vec3 tangent = normalized(cross(n, random_unit(rng)));
  const double small = std::exp2(rng.uniform(-40, 0));
  const Vec3 l = rng.next() % 2 == 0 ? n + small * tangent : small * n + tangent;
  return normalized(l);
}

struct Worst {
  explicit Worst(const char* name) : what(name) {}
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  ~Worst() { std::printf("    worst %s: %.3g\n", what, value); }
  void note(double error) { value = std::max(value, std::fabs(error)); }
  const char* what;
  double value = 0;
};

TEST(Optics, ReflectionIsUnitCoplanarAndAtTheSameAngle) {
  Rng rng = seeded(0);
  Worst length("| |R| - 1 | / kUnitError"), angle("(N,R) - (N,L), in u"),
      plane("distance from the plane, in u");
  for (int i = 0; i < kCases; ++i) {
    const Vec3 n = random_unit(rng), l = light_about(rng, n), r = reflect(l, n);
    length.note(length_error(r) / kUnitError);
    angle.note((dot(n, r) - dot(n, l)) / kU);
    plane.note(dot(r, cross(n, l)) / kU);
  }
  EXPECT_LE(length.value, 1);
  EXPECT_LE(angle.value, 20);
  EXPECT_LE(plane.value, 20);
}

TEST(Optics, ReflectingTwiceGivesTheLightBack) {
  Rng rng = seeded(1);
  Worst back("|reflect(reflect(L)) - L|, in u");
  for (int i = 0; i < kCases; ++i) {
    const Vec3 n = random_unit(rng), l = light_about(rng, n);
    back.note(norm(reflect(reflect(l, n), n) - l) / kU);
  }
  EXPECT_LE(back.value, 40);
  EXPECT_EQ(reflect({0, 1, 0}, {0, 1, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(reflect({1, 0, 0}, {0, 1, 0}), (Vec3{-1, 0, 0}));
}

TEST(Optics, RefractionObeysSnellFromNormalToGrazingIncidence) {
  Rng rng = seeded(2);
  Worst length("| |T| - 1 | / (kUnitError max(1, eta))"), snell("(sin T - eta sin L) / max(1, eta), in u");
  Worst plane("distance from the plane, in u");
  int refracted = 0;
  for (int i = 0; i < kCases; ++i) {
    const Vec3 n = random_unit(rng), l = light_about(rng, n);
    const double eta = std::exp2(rng.uniform(-1.5, 1.5));
    const DoubleDouble sine = sine_between(n, l);
    const std::optional<Vec3> t = refract(l, n, eta);
    if (!t) continue;
    ++refracted;
    ASSERT_LT(dot(*t, n), 0);
    length.note(length_error(*t) / (kUnitError * std::max(1.0, eta)));
    snell.note((sine_between(n, *t) - eta * sine).hi / (kU * std::max(1.0, eta)));
    plane.note(dot(*t, cross(n, l)) / kU);
  }
  EXPECT_GT(refracted, kCases / 2);
  EXPECT_LE(length.value, 1);
  EXPECT_LE(plane.value, 20);
  EXPECT_LE(snell.value, 8);
}

TEST(Optics, NormalIncidenceGoesStraightThrough) {
  for (const double eta : {0.5, 1 / 1.33, 1.52})
    EXPECT_EQ(refract({0, 0, 1}, {0, 0, 1}, eta), (Vec3{0, 0, -1}));
  // 30 degrees into a medium twice as dense, by hand: sin T = 1/4.
  const auto t = refract({0.5, std::sqrt(3) / 2, 0}, {0, 1, 0}, 0.5);
  ASSERT_TRUE(t);
  EXPECT_NEAR(t->x, -0.25, 4 * kU);
  EXPECT_NEAR(t->y, -std::sqrt(15) / 4, 4 * kU);
}

TEST(Optics, RefractionThereAndBackIsTheLight) {
  Rng rng = seeded(3);
  Worst back("|refract(refract(L)) - L| cos L, in u");
  for (int i = 0; i < kCases; ++i) {
    const Vec3 n = random_unit(rng), l = light_about(rng, n);
    const double eta = std::exp2(rng.uniform(-1.5, 0));
    const std::optional<Vec3> t = refract(l, n, eta);
    ASSERT_TRUE(t) << "into a denser medium light always goes";
    // The way back: the light is where the ray went, the normal is turned, the indices swap.
    const Vec3 light = *t, inner = facing_normal(n, light);
    ASSERT_EQ(inner, -n);
    const std::optional<Vec3> again = refract(light, inner, 1 / eta);
    // Grazing light comes back at the critical angle, where the way back is ill-conditioned, or missing.
    const double cosine = dot(n, l);
    if (cosine < 0x1p-20) continue;
    ASSERT_TRUE(again);
    back.note(norm(*again - l) * cosine / kU);
  }
  EXPECT_LE(back.value, 60);
}

TEST(Optics, TotalInternalReflectionIsExactlyWhereEtaSinExceedsOne) {
  Rng rng = seeded(4);
  int total = 0, near = 0;
  for (int i = 0; i < kCases; ++i) {
    const Vec3 n = random_unit(rng), tangent = normalized(cross(n, random_unit(rng)));
    const double eta = std::exp2(rng.uniform(0.05, 3));
    // Around the critical angle at all distances.
    const double offset = std::exp2(rng.uniform(-52, -3)) * (rng.next() % 2 == 0 ? 1 : -1);
    const double sine = std::min(1.0, (1 + offset) / eta);
    const Vec3 l = normalized(sine * tangent + std::sqrt((1 - sine) * (1 + sine)) * n);
    const double excess = (eta * sine_between(n, l) - 1.0).hi;
    if (std::fabs(excess) < 8 * kU) {
      ++near;
      continue;
    }
    ASSERT_EQ(refract(l, n, eta).has_value(), excess < 0) << excess;
    total += excess > 0 ? 1 : 0;
  }
  std::printf("    %d total reflections, %d too near to judge\n", total, near);
  EXPECT_GT(total, kCases / 4);
  EXPECT_LT(near, kCases / 10);
  // On the boundary itself the refracted light runs along the surface.
  EXPECT_EQ(refract({1, 0, 0}, {0, 1, 0}, 1.0), (Vec3{-1, 0, 0}));
  EXPECT_FALSE(refract({1, 0, 0}, {0, 1, 0}, 1.0 + 0x1p-50));
}

TEST(Optics, TheHalfVectorIsUnitAndHalfway) {
  Rng rng = seeded(5);
  Worst length("| |H| - 1 | / kUnitError");
  for (int i = 0; i < kCases; ++i) {
    const Vec3 l = random_unit(rng), e = random_unit(rng);
    const std::optional<Vec3> h = half_vector(l, e);
    ASSERT_TRUE(h);
    length.note(length_error(*h) / kUnitError);
    ASSERT_NEAR(dot(*h, l), dot(*h, e), 16 * kU / norm(l + e));
  }
  EXPECT_LE(length.value, 1);
  EXPECT_FALSE(half_vector({0.6, 0.8, 0}, {-0.6, -0.8, 0}));
  EXPECT_EQ(half_vector({0, 1, 0}, {0, 1, 0}), (Vec3{0, 1, 0}));
}

/// Document 001: "the picture differs". Light at 45 degrees; the eye 30 degrees off the mirror direction.
TEST(Optics, PhongAndBlinnDifferUntilTheExponentIsFourfold) {
  const double degree = std::numbers::pi / 180;
  const Vec3 n{0, 1, 0}, l{std::sin(45 * degree), std::cos(45 * degree), 0};
  const Vec3 e{-std::sin(15 * degree), std::cos(15 * degree), 0};
  const Vec3 r = reflect(l, n), h = *half_vector(l, e);
  EXPECT_NEAR(phong_term(r, e, 10), 0.2373046875, 1e-13);  // (3/4)^5
  EXPECT_NEAR(blinn_term(h, n, 10), 0.7070299, 1e-7);      // ((2 + sqrt 3)/4)^5
  EXPECT_NEAR(blinn_term(h, n, 40), std::pow((2 + std::sqrt(3)) / 4, 20), 1e-13);
  EXPECT_NEAR(blinn_term(h, n, 40), phong_term(r, e, 10), 0.013);
  EXPECT_EQ(phong_term(r, -r, 10), 0);
  EXPECT_LE(phong_term(r, r, 1e6), 1);
}

TEST(Optics, ForSmallAnglesBlinnNeedsFourTimesPhongsExponent) {
  const Vec3 n{0, 1, 0}, l = normalized({1, 2, 0}), r = reflect(l, n);
  for (const double angle : {0.2, 0.1, 0.05, 0.025}) {
    // The eye, turned by `angle` from r in the plane of incidence: H then turns by half of it.
    const Vec3 e{r.x * std::cos(angle) - r.y * std::sin(angle), r.x * std::sin(angle) + r.y * std::cos(angle),
                 0};
    const Vec3 h = *half_vector(l, e);
    const double ratio = std::log(phong_term(r, e, 1)) / std::log(blinn_term(h, n, 1));
    // ln cos x / ln cos (x/2) = 4 (1 + x^2/8 + O(x^4)).
    EXPECT_NEAR(ratio, 4 * (1 + angle * angle / 8), angle * angle * angle * angle);
    std::printf("    angle %.3f: ratio of exponents %.5f\n", angle, ratio);
  }
}

}  // namespace
}  // namespace graze
