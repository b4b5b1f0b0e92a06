// Sphere, ellipsoid and quadric: rays worked out by hand, the three against one another, the classes of
// quadrics, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
using List = std::vector<double>;

SurfaceSpec sphere(double radius, const List& centre = {0, 0, 0}) {
  return with_numbers("sphere", {{"radius", radius}, {"center", centre}});
}
SurfaceSpec quadric(const std::map<std::string, ParameterValue>& values) {
  return with_numbers("quadric", values);
}
SurfaceSpec cone() { return quadric({{"A", 1.0}, {"E", -1.0}, {"H", 1.0}}); }
SurfaceSpec one_sheet() { return quadric({{"A", 1.0}, {"E", -1.0}, {"H", 1.0}, {"J", -1.0}}); }

class QuadraticFamily : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"sphere", "ellipsoid", "quadric"}) {
      if (!has_surface(name)) GTEST_SKIP() << "this build has no " << name;
    }
    if (solver_named("closed_form") == nullptr) GTEST_SKIP() << "this build has no closed_form";
  }
  static std::vector<Answer> answers(const SurfaceSpec& spec, std::span<const Ray> rays,
                                     const std::string& formulation = "") {
    return ask(closed_form_scene(spec, formulation), rays);
  }
  static Answer answer(const SurfaceSpec& spec, const Ray& ray) { return answers(spec, {&ray, 1}).front(); }
  static std::unique_ptr<AnySurface> surface(const SurfaceSpec& spec) {
    return find_surface(spec.type).make(spec);
  }
};

void expect_near(Vec3 a, Vec3 b, double tolerance = 4 * kEpsilon) { EXPECT_LE(norm(a - b), tolerance); }

// ------------------------------------------------------------------------------------------- worked by hand

TEST_F(QuadraticFamily, ARayBesideTheUnitSphereTouchesAtOneAndMissesAnUlpFurtherOut) {
  const std::array<SurfaceSpec, 3> balls{sphere(1), with_numbers("ellipsoid", {{"semi_axes", List{1, 1, 1}}}),
                                         quadric({{"A", 1.0}, {"E", 1.0}, {"H", 1.0}, {"J", -1.0}})};
  for (const SurfaceSpec& ball : balls) {
    const Answer touch = answer(ball, {{1, -5, 0}, {0, 1, 0}});
    ASSERT_EQ(touch.l.size(), 1U) << ball.type;
    EXPECT_EQ(touch.l[0], 5);
    EXPECT_EQ(touch.multiplicity[0], 2U);
    expect_near(touch.normal[0], {1, 0, 0});
    EXPECT_TRUE(answer(ball, {{1 + 0x1p-52, -5, 0}, {0, 1, 0}}).l.empty()) << ball.type;
    const Answer inside = answer(ball, {{1 - 0x1p-53, -5, 0}, {0, 1, 0}});
    ASSERT_EQ(inside.l.size(), 2U) << ball.type;
    // Half chord sqrt(2^-52 - 2^-106) = 2^-26 (1 - 2^-55).
    EXPECT_NEAR(inside.l[1] - inside.l[0], 0x1p-25, 0x1p-50);
  }
}

TEST_F(QuadraticFamily, TwoHitsCloserThanTheSpacingOfDoublesStayTwo) {
  // Half chord 2^-26 at l = 2^40, where doubles are 2^-12 apart.
  const Answer far = answer(sphere(1), {{1 - 0x1p-53, -0x1p40, 0}, {0, 1, 0}});
  ASSERT_EQ(far.l.size(), 2U);
  EXPECT_LE(std::fabs(far.l[0] - 0x1p40), 0x1p-12);
  EXPECT_LE(std::fabs(far.l[1] - 0x1p40), 0x1p-12);
}

TEST_F(QuadraticFamily, ARayThatStartsOnTheSurfaceDoesNotHitAtZero) {
  const Answer inward = answer(sphere(2, {1, 2, 3}), {{1, 2, 1}, {0, 0, 0.5}});
  ASSERT_EQ(inward.l.size(), 1U);
  EXPECT_EQ(inward.l[0], 8);
  EXPECT_TRUE(answer(sphere(2, {1, 2, 3}), {{1, 2, 1}, {0, 0, -1}}).l.empty());
  EXPECT_TRUE(answer(sphere(2, {1, 2, 3}), {{1, 2, 1}, {1, 1, 0}}).l.empty()) << "tangent there";
}

TEST_F(QuadraticFamily, ParametersAreLongitudeAndLatitude) {
  const Answer a = answer(sphere(1, {1, 0, 0}), {{1, 0, -5}, {0, 0, 1}});
  ASSERT_EQ(a.l.size(), 2U);
  EXPECT_NEAR(a.params[0][0], -std::numbers::pi / 2, kEpsilon);
  EXPECT_NEAR(a.params[0][1], 0, kEpsilon);
  const Answer pole = answer(sphere(1), {{0, 5, 0}, {0, -1, 0}});
  EXPECT_EQ(pole.params[0][0], 0);
  EXPECT_NEAR(pole.params[0][1], std::numbers::pi / 2, kEpsilon);
}

TEST_F(QuadraticFamily, TheApexOfAConeIsATouchWhoseNormalFacesTheRay) {
  const Answer apex = answer(cone(), {{3, 1, 2}, {-3, -1, -2}});
  ASSERT_EQ(apex.l.size(), 1U);
  EXPECT_EQ(apex.l[0], 1);
  EXPECT_EQ(apex.multiplicity[0], 2U);
  expect_near(apex.normal[0], normalized({3, 1, 2}));
}

TEST_F(QuadraticFamily, GeneratorsAreCoincident) {
  EXPECT_EQ(answer(cone(), {{0, 0, 0}, {3, 5, 4}}).status, Status::coincident);
  EXPECT_EQ(answer(cone(), {{3, 5, 4}, {-3, -5, -4}}).status, Status::coincident);
  EXPECT_EQ(answer(one_sheet(), {{1, 7, 7}, {0, 1, 1}}).status, Status::coincident);
  EXPECT_EQ(answer(one_sheet(), {{1, 7, std::nextafter(7.0, 8.0)}, {0, 1, 1}}).status, Status::ok);
  const SurfaceSpec saddle = quadric({{"B", 0.5}, {"I", -0.5}});  // z = x y
  EXPECT_EQ(answer(saddle, {{2, -7, -14}, {0, 1, 2}}).status, Status::coincident);
  EXPECT_EQ(answer(quadric({{"A", 1.0}, {"J", -4.0}}), {{2, 1, 1}, {0, 3, 1}}).status, Status::coincident);
}

TEST_F(QuadraticFamily, AnAsymptoticRayHasOneHit) {
  // On z = x y the ray (l, 3, 1): 3 l = 1.
  const Answer saddle = answer(quadric({{"B", 0.5}, {"I", -0.5}}), {{0, 3, 1}, {1, 0, 0}});
  ASSERT_EQ(saddle.l.size(), 1U);
  EXPECT_NEAR(saddle.l[0], 1.0 / 3, kEpsilon);
  EXPECT_EQ(saddle.multiplicity[0], 1U);
  // Along the axis of y = x^2 + z^2.
  const Answer bowl = answer(quadric({{"A", 1.0}, {"H", 1.0}, {"G", -0.5}}), {{1, -3, 2}, {0, 2, 0}});
  ASSERT_EQ(bowl.l.size(), 1U);
  EXPECT_EQ(bowl.l[0], 4);
}

TEST_F(QuadraticFamily, NormalsPointOutwardWhateverTheSignOfTheEquation) {
  const Ray ray{{-5, 0.25, 0.5}, {1, 0, 0}};
  const Answer plus = answer(quadric({{"A", 1.0}, {"E", 2.0}, {"H", 3.0}, {"J", -4.0}}), ray);
  const Answer minus = answer(quadric({{"A", -1.0}, {"E", -2.0}, {"H", -3.0}, {"J", 4.0}}), ray);
  ASSERT_EQ(plus.l.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) expect_near(plus.normal[i], minus.normal[i]);
  EXPECT_LT(plus.normal[0].x, 0);
  EXPECT_GT(plus.normal[1].x, 0);
}

// --------------------------------------------------------------------------------------- one against another

Ray far_ray(const AnySurface& surface, Rng& rng) {
  const SurfaceSample sample = surface.sample(rng.uniform(), rng.uniform());
  const Vec3 d = random_direction(rng);
  const double offset = std::pow(10.0, rng.uniform(-8, 0));
  return {sample.point + offset * sample.normal - std::pow(10.0, rng.uniform(1, 10)) * d, d};
}

TEST_F(QuadraticFamily, ASphereStatedFourWaysIsOneSphere) {
  const double r = 1.75;
  const Vec3 c{2, -3, 0.5};
  const List centre{c.x, c.y, c.z};
  const std::array<SurfaceSpec, 4> ways{
      sphere(r, centre), with_numbers("ellipsoid", {{"semi_axes", List{r, r, r}}, {"center", centre}}),
      with_numbers("ellipsoid",
                   {{"P", Table{{r * r, 0, 0}, {0, r * r, 0}, {0, 0, r * r}}}, {"center", centre}}),
      quadric({{"A", 1.0},
               {"E", 1.0},
               {"H", 1.0},
               {"D", -c.x},
               {"G", -c.y},
               {"I", -c.z},
               {"J", dot(c, c) - r * r}})};
  const auto any = surface(ways[0]);
  constexpr std::uint64_t kSeed = 20261122;
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  Rng rng(kSeed);
  std::vector<Ray> rays = mixed_rays(*any, 500, kSeed);
  for (int i = 0; i < 1000; ++i) rays.push_back(far_ray(*any, rng));
  const std::vector<Answer> reference = answers(ways[0], rays);
  double worst = 0;
  std::size_t hits = 0;
  for (std::size_t way = 1; way < ways.size(); ++way) {
    const std::vector<Answer> other = answers(ways[way], rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      ASSERT_EQ(other[i].multiplicity, reference[i].multiplicity) << "way " << way << " ray " << i;
      for (std::size_t k = 0; k < reference[i].l.size(); ++k) {
        const double cosine = std::fabs(dot(reference[i].normal[k], normalized(rays[i].d)));
        const double unit = kEpsilon * (reference[i].l[k] + r / (norm(rays[i].d) * cosine));
        worst = std::max(worst, std::fabs(other[i].l[k] - reference[i].l[k]) / unit);
        ++hits;
      }
    }
  }
  std::printf("%zu hits, worst difference %.2g condition units\n", hits, worst);
  EXPECT_GT(hits, 3000U);
  EXPECT_LE(worst, 4);
}

TEST_F(QuadraticFamily, TheTextbookFormulationsAgreeOnBenignRays) {
  for (const char* type : {"sphere", "ellipsoid", "quadric"}) {
    for (const SurfaceSpec& spec : examples(type)) {
      const auto any = surface(spec);
      const std::vector<Ray> rays = camera_rays(*any, 500, 7);
      const std::vector<Answer> best = answers(spec, rays);
      for (const FormulationInfo& formulation : find_surface(type).formulations) {
        if (formulation.forms.front() != Form::polynomial) continue;
        const std::vector<Answer> other = answers(spec, rays, std::string(formulation.name));
        for (std::size_t i = 0; i < rays.size(); ++i) {
          ASSERT_EQ(other[i].l.size(), best[i].l.size()) << type << " " << formulation.name << " ray " << i;
          for (std::size_t k = 0; k < best[i].l.size(); ++k) {
            const double cosine = std::fabs(dot(best[i].normal[k], rays[i].d));
            // The textbook's own rounding: 1e3 eps of the scene, seen at the angle of the hit.
            const double tolerance = 1e3 * kEpsilon * (best[i].l[k] + any->size() / cosine);
            EXPECT_NEAR(other[i].l[k], best[i].l[k], tolerance) << type << " " << formulation.name;
          }
        }
      }
    }
  }
}

// ------------------------------------------------------------------------------------------------- surfaces

TEST_F(QuadraticFamily, QuadricsKnowTheirCanonicalClass) {
  struct Known {
    std::string_view name;
    std::map<std::string, ParameterValue> values;
  };
  const std::vector<Known> classes{
      {"ellipsoid", {{"A", 1.0}, {"E", 2.0}, {"H", 3.0}, {"J", -1.0}}},
      {"ellipsoid", {{"A", -1.0}, {"E", -2.0}, {"H", -3.0}, {"D", 5.0}, {"J", -24.75}}},
      {"imaginary ellipsoid", {{"A", 1.0}, {"E", 2.0}, {"H", 3.0}, {"J", 1.0}}},
      {"point", {{"A", 1.0}, {"E", 2.0}, {"H", 3.0}, {"D", -1.0}, {"J", 1.0}}},
      {"one-sheet hyperboloid", {{"A", 1.0}, {"E", -1.0}, {"H", 1.0}, {"J", -1.0}}},
      {"two-sheet hyperboloid", {{"A", 1.0}, {"E", -1.0}, {"H", 1.0}, {"J", 1.0}}},
      {"two-sheet hyperboloid", {{"A", -1.0}, {"E", 1.0}, {"H", -1.0}, {"J", -1.0}}},
      {"cone", {{"A", 1.0}, {"E", -1.0}, {"H", 1.0}}},
      {"cone", {{"B", 1.0}, {"C", 1.0}, {"F", 1.0}}},
      {"elliptic paraboloid", {{"A", 1.0}, {"E", 2.0}, {"I", -0.5}}},
      {"hyperbolic paraboloid", {{"A", 1.0}, {"E", -2.0}, {"I", -0.5}}},
      {"elliptic cylinder", {{"A", 1.0}, {"E", 2.0}, {"J", -1.0}}},
      {"imaginary elliptic cylinder", {{"A", 1.0}, {"E", 2.0}, {"J", 1.0}}},
      {"line", {{"A", 1.0}, {"E", 2.0}}},
      {"hyperbolic cylinder", {{"A", 1.0}, {"E", -2.0}, {"J", -1.0}}},
      {"hyperbolic cylinder", {{"A", 1.0}, {"E", -2.0}, {"J", 1.0}}},
      {"intersecting planes", {{"B", 1.0}}},
      {"parabolic cylinder", {{"A", 1.0}, {"G", -1.0}}},
      {"parallel planes", {{"A", 1.0}, {"J", -1.0}}},
      {"imaginary parallel planes", {{"A", 1.0}, {"J", 1.0}}},
      {"double plane", {{"A", 1.0}, {"B", 2.0}, {"E", 4.0}, {"D", -1.0}, {"G", -2.0}, {"J", 1.0}}},
      {"plane", {{"D", 1.0}, {"J", -1.0}}},
      {"plane", {{"I", -1.0}, {"J", 1.0}}},
      {"empty", {{"J", 1.0}}},
      {"empty", {{"J", -1.0}}},
      // One bit decides: 4 x 1 - 2 x 2 = 0.
      {"parallel planes", {{"A", 1.0}, {"B", 2.0}, {"E", 4.0}, {"J", -1.0}}},
      {"elliptic cylinder", {{"A", 1.0}, {"B", 2.0}, {"E", 4 + 0x1p-50}, {"J", -1.0}}},
      {"hyperbolic cylinder", {{"A", 1.0}, {"B", 2.0}, {"E", 4 - 0x1p-51}, {"J", -1.0}}}};
  for (const Known& known : classes) EXPECT_EQ(surface(quadric(known.values))->variety(), known.name);
}

TEST_F(QuadraticFamily, SamplesLieOnTheSurfaceAndInItsBounds) {
  for (const char* type : {"sphere", "ellipsoid", "quadric"}) {
    for (const SurfaceSpec& spec : examples(type)) {
      const auto any = surface(spec);
      const Bounds bounds = any->bounds();
      Rng rng(3);
      for (int i = 0; i < 200; ++i) {
        const SurfaceSample sample = any->sample(rng.uniform(), rng.uniform());
        EXPECT_NEAR(norm(sample.normal), 1, 4 * kEpsilon);
        EXPECT_TRUE(bounds.lo.x <= sample.point.x && sample.point.x <= bounds.hi.x);
        EXPECT_TRUE(bounds.lo.y <= sample.point.y && sample.point.y <= bounds.hi.y);
        EXPECT_TRUE(bounds.lo.z <= sample.point.z && sample.point.z <= bounds.hi.z);
        // Along its normal a ray meets the surface where the sample is.
        const double away = 0.125 * any->size();
        const Answer back = answer(spec, {sample.point + away * sample.normal, -sample.normal});
        ASSERT_FALSE(back.l.empty()) << type;
        const double error = std::fabs(back.l[0] - away) / (norm(sample.point) + any->size());
        EXPECT_LE(error, 16 * kEpsilon) << type;
      }
    }
  }
}

TEST_F(QuadraticFamily, AnEllipsoidsBoxIsTight) {
  const Bounds box = surface(quadric({{"A", 4.0}, {"E", 1.0}, {"H", 0.25}, {"D", -4.0}}))->bounds();
  // 4 (x - 1)^2 + y^2 + z^2/4 = 4.
  EXPECT_NEAR(box.lo.x, 0, 1e-15);
  EXPECT_NEAR(box.hi.x, 2, 1e-15);
  EXPECT_NEAR(box.hi.y, 2, 1e-15);
  EXPECT_NEAR(box.lo.z, -4, 1e-15);
  EXPECT_LE(box.lo.x, 0);
  EXPECT_GE(box.hi.x, 2);
}

TEST_F(QuadraticFamily, RefusalsNameTheParameter) {
  const auto refused = [](const SurfaceSpec& spec, std::string_view word) {
    try {
      surface(spec);
      ADD_FAILURE() << "must throw: " << word;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused(sphere(0), "radius");
  refused(sphere(-1), "radius");
  refused(with_numbers("ellipsoid", {}), "semi_axes");
  refused(with_numbers("ellipsoid", {{"semi_axes", List{1, 0, 1}}}), "semi_axes");
  refused(with_numbers("ellipsoid", {{"P", Table{{1, 2, 0}, {2, 1, 0}, {0, 0, 1}}}}),
          "P must be positive definite");
  refused(with_numbers("ellipsoid", {{"P", Table{{1, 1, 0}, {1, 1, 0}, {0, 0, 1}}}}),
          "P must be positive definite");
  refused(with_numbers("ellipsoid", {{"P", Table{{1, 0.1, 0}, {0.2, 1, 0}, {0, 0, 1}}}}),
          "P must be symmetric");
  refused(quadric({}), "zero");
  // The determinant 2^-52 of this P is lost in plain arithmetic.
  const SurfaceSpec thin =
      with_numbers("ellipsoid", {{"P", Table{{1, 1, 0}, {1, 1 + 0x1p-52, 0}, {0, 0, 1}}}});
  EXPECT_GT(surface(thin)->size(), 0.9);
}

}  // namespace
}  // namespace graze::test
