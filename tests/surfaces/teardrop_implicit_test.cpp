// The teardrop's implicit sextic: one polynomial in three bases, its coefficients, and its mirrored sheets.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <graze/solvers/math/bernstein.hpp>
#include <graze/solvers/math/big_integer.hpp>
#include <graze/surfaces/teardrop.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr std::array<const char*, 3> kFormulations{"implicit_sextic", "implicit_sextic_bernstein",
                                                   "implicit_sextic_chebyshev"};

class TeardropImplicit : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_surface("teardrop")) GTEST_SKIP() << "this build has no teardrop";
    certified_ = solver_named("certified");
    if (certified_ == nullptr) GTEST_SKIP() << "this build lacks the certified solver";
  }
  /// What every basis answers to one ray.
  void expect_hits(const Ray& ray, const std::vector<double>& l,
                   const std::vector<std::uint32_t>& multiplicity, double tolerance = 1e-14) const {
    for (const char* formulation : kFormulations) {
      const Answer answer = ask(scene_of(teardrop(1), *certified_, formulation), {&ray, 1})[0];
      EXPECT_EQ(answer.status, Status::ok) << formulation;
      ASSERT_EQ(answer.l.size(), l.size()) << formulation;
      for (std::size_t i = 0; i < l.size(); ++i)
        EXPECT_NEAR(answer.l[i], l[i], tolerance * l[i]) << formulation;
      EXPECT_EQ(answer.multiplicity, multiplicity) << formulation;
    }
  }
  const SolverEntry* certified_ = nullptr;
};

TEST_F(TeardropImplicit, AHorizontalRayMeetsItsCircleTwice) {
  expect_hits({{-5, 1.5, 0}, {1, 0, 0}}, {3.125, 6.875}, {1, 1});
  expect_hits({{1.875, 1.5, -5}, {0, 0, 1}}, {5}, {2});
}

// Low down the sheets are close to each other: the power basis gives away five digits there, the Chebyshev
// basis one.
TEST_F(TeardropImplicit, TheOtherSheetIsRefusedWhereItLiesInsideTheBounds) {
  // t = 1/16: R = 3/16 (15/16)(33/16), and 3 t (2 - t^2 + t) for the other one.
  const double y = 6.0 / 256, r = 3.0 / 16 * (15.0 / 16) * (33.0 / 16);
  const double other = 3.0 / 16 * (2 - 1.0 / 256 + 1.0 / 16);
  ASSERT_LT(other, TeardropProfile::kWidest);
  expect_hits({{-5, y, 0}, {1, 0, 0}}, {5 - r, 5 + r}, {1, 1}, 1e-10);
}

TEST_F(TeardropImplicit, PolesCountOnceWhereTheLinePassesInsideAndTwiceWhereItTouches) {
  expect_hits({{0, -1, 0}, {0, 1, 0}}, {1, 7}, {1, 1});
  expect_hits({{-5, 0, 0}, {1, 0, 0}}, {5}, {2});
  expect_hits({{-5, 6, 0}, {1, 0, 0}}, {5}, {2});
  // Along y = 6 - x / 2, beside the cone of slope 4/3: touches; y = 6 - 2 x enters there.
  expect_hits({{-4, 8, 0}, {2, -1, 0}}, {2}, {2});
}

TEST_F(TeardropImplicit, ARayThatStartsOnTheSurfaceDoesNotHitThere) {
  expect_hits({{-1.875, 1.5, 0}, {1, 0, 0}}, {3.75}, {1});
  expect_hits({{-1.875, 1.5, 0}, {-1, 0, 0}}, {}, {});
  expect_hits({{0, 0, 0}, {0, 1, 0}}, {6}, {1});
}

/// The one equation that a formulation poses for a ray, with error bounds.
template <Basis kBasis>
struct Posing {
  EquationBlock block;
  LocalRay ray;

  explicit Posing(const SurfaceSpec& spec, const Ray& world) {
    const Teardrop surface(spec);
    ray = to_unit(world, surface.unit());
    block.reset(Form::polynomial, Precision::binary64, true);
    block.begin_ray(0);
    if (!surface.clip(ray)) return;
    formulation = std::make_unique<TeardropImplicitSextic<kBasis>>(surface);
    formulation->pose(ray, block);
  }
  [[nodiscard]] bool has_equation() const { return !block.of<PolynomialEquation>().empty(); }
  [[nodiscard]] const PolynomialEquation& equation() const { return block.of<PolynomialEquation>()[0]; }
  [[nodiscard]] std::vector<Dyadic> exact() const {
    std::vector<Dyadic> c(equation().c.size());
    equation().exact.get(equation().exact.self, c);
    return c;
  }
  void expect_bounds() const {
    const std::vector<Dyadic> c = exact();
    for (std::size_t i = 0; i < c.size(); ++i) {
      EXPECT_LE(abs(c[i] - Dyadic(equation().c[i])), Dyadic(equation().c_error[i])) << i;
      EXPECT_LE(equation().c_error[i], 0x1p-50 * std::fabs(equation().c[i]) + 0x1p-80) << "a sharp bound";
    }
  }

  std::unique_ptr<TeardropImplicitSextic<kBasis>> formulation;
};

Dyadic power_value(const std::vector<Dyadic>& c, const Dyadic& x) {
  Dyadic y;
  for (std::size_t i = c.size(); i-- > 0;) y = y * x + c[i];
  return y;
}

TEST_F(TeardropImplicit, CoefficientsLieWithinTheirBoundsAndAllBasesHoldOnePolynomial) {
  std::size_t compared = 0;
  for (const double s : {1.0, 1.7}) {
    const SurfaceSpec spec = teardrop(s);
    for (const Ray& world : mixed_rays(*find_surface("teardrop").make(spec), 40, kSeed)) {
      const Posing<Basis::power> power(spec, world);
      if (!power.has_equation()) continue;
      const Posing<Basis::bernstein> bernstein(spec, world);
      const Posing<Basis::chebyshev> chebyshev(spec, world);
      power.expect_bounds();
      bernstein.expect_bounds();
      chebyshev.expect_bounds();
      const std::vector<Dyadic> c = power.exact(), b = bernstein.exact(), t = chebyshev.exact();
      ASSERT_EQ(b.size(), 7U);
      ASSERT_EQ(t.size(), c.size());
      const Dyadic lo(power.equation().lo), hi(power.equation().hi);
      // Bernstein coefficients carry the factor 60.
      EXPECT_EQ(b[0], Dyadic(60.0) * power_value(c, lo));
      EXPECT_EQ(b[6], Dyadic(60.0) * power_value(c, hi));
      Dyadic middle, at_middle, at_hi;
      for (std::size_t i = 0; i < 7; ++i) middle += Dyadic(binomial(6, static_cast<int>(i)) * 0x1p-6) * b[i];
      EXPECT_EQ(middle, Dyadic(60.0) * power_value(c, Dyadic(0.5) * (lo + hi)));
      for (std::size_t i = 0; i < t.size(); ++i) {
        at_hi += t[i];
        if (i % 2 == 0) at_middle += i % 4 == 0 ? t[i] : -t[i];
      }
      EXPECT_EQ(at_hi, power_value(c, hi));
      EXPECT_EQ(at_middle, power_value(c, Dyadic(0.5) * (lo + hi)));
      ++compared;
    }
  }
  EXPECT_GT(compared, 100U);
}

TEST_F(TeardropImplicit, CertifiedAnswersAreThoseOfTheKernel) {
  for (const double s : {1.0, 1.7}) {
    const SurfaceSpec spec = teardrop(s);
    const auto rays = mixed_rays(*find_surface("teardrop").make(spec), 300, kSeed + 1);
    const auto expected = ask(scene_of(spec, *certified_, "along_ray"), rays);
    for (const char* formulation : kFormulations) {
      const auto answers = ask(scene_of(spec, *certified_, formulation), rays);
      std::size_t uncertain = 0, hits = 0;
      double worst = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        if (answers[i].status != Status::ok) ++uncertain;
        if (answers[i].status != Status::ok || expected[i].status != Status::ok) continue;
        ASSERT_EQ(answers[i].l.size(), expected[i].l.size()) << formulation << " ray " << i;
        EXPECT_EQ(answers[i].multiplicity, expected[i].multiplicity);
        for (std::size_t k = 0; k < answers[i].l.size(); ++k, ++hits)
          worst = std::max(worst, std::fabs(answers[i].l[k] - expected[i].l[k]) / expected[i].l[k]);
      }
      std::printf("s = %g %s: %zu hits, worst relative difference %.3g, %zu of %zu uncertain\n", s,
                  formulation, hits, worst, uncertain, rays.size());
      EXPECT_GT(hits, rays.size() / 2);
      EXPECT_LE(worst, 1e-7);
      EXPECT_LE(uncertain, rays.size() / 100);
    }
  }
}

}  // namespace
}  // namespace graze::test
