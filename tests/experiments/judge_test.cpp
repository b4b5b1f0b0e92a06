// The judge, on claims made up so that the right verdict is known.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <graze/experiments/judge.hpp>
#include <surfaces/cells.hpp>

namespace graze::test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// The horizontal ray at y = 3/2 crosses the teardrop at l = 25/8 and 55/8.
const Ray kCrossing{{-5, 1.5, 0}, {1, 0, 0}};
/// It touches the circle of radius 15/8 there, at l = 5.
const Ray kTouching{{1.875, 1.5, -5}, {0, 0, 1}};
const Ray kMissing{{-5, 8, 0}, {1, 0, 0}};

struct Question {
  explicit Question(const Ray& asked)
      : surface(truth::make_surface(teardrop(1))), ray(asked), truth(surface->all(ray, {})) {}

  [[nodiscard]] Judgement judge(const std::vector<double>& l, Status status = Status::ok) const {
    return graze::judge(ray, truth, {status, l, {}, {}}, {}, nullptr);
  }

  std::unique_ptr<truth::Surface> surface;
  Ray ray;
  truth::Answer truth;
};

TEST(Judge, ExactHitsAreRightWithoutError) {
  const Judgement judgement = Question(kCrossing).judge({3.125, 6.875});
  EXPECT_EQ(judgement.verdict, Verdict::right);
  EXPECT_EQ(judgement.missed, 0);
  EXPECT_EQ(judgement.spurious, 0);
  EXPECT_EQ(judgement.ulps.value(), 0);
  EXPECT_EQ(judgement.condition_units.value(), 0);
  EXPECT_FALSE(judgement.wrong_first);
}

TEST(Judge, ErrorsAreCountedInUlpsOfTruthAndInConditionUnits) {
  const double ulp = 2 * kEps;  // of 25/8 in [2, 4)
  const Judgement judgement = Question(kCrossing).judge({3.125 + 3 * ulp, 6.875});
  EXPECT_EQ(judgement.verdict, Verdict::right);
  EXPECT_DOUBLE_EQ(judgement.ulps.value(), 3);
  // |n.d| = 8/sqrt(65) at t = 1/2, and L = 1.
  const double unit = kEps * (3.125 + std::sqrt(65.0) / 8);
  EXPECT_NEAR(judgement.condition_units.value(), 3 * ulp / unit, 1e-12);
}

TEST(Judge, AMissedFirstHitIsWrongFirstAndAnInfiniteError) {
  const Judgement judgement = Question(kCrossing).judge({6.875});
  EXPECT_EQ(judgement.verdict, Verdict::wrong);
  EXPECT_EQ(judgement.missed, 1);
  EXPECT_EQ(judgement.spurious, 0);
  EXPECT_TRUE(judgement.wrong_first);
  EXPECT_TRUE(std::isinf(judgement.ulps.value()));
  EXPECT_TRUE(std::isinf(judgement.condition_units.value()));
}

TEST(Judge, AMissedSecondHitIsWrongButTheFirstIsNot) {
  const Judgement judgement = Question(kCrossing).judge({3.125});
  EXPECT_EQ(judgement.verdict, Verdict::wrong);
  EXPECT_EQ(judgement.missed, 1);
  EXPECT_FALSE(judgement.wrong_first);
}

TEST(Judge, OneHitOfMultiplicityTwoAnswersTwoThatDoublesCannotPart) {
  SurfaceSpec box;
  box.type = "box";
  box.parameters.set("min", std::vector<double>{0, 0, 0});
  box.parameters.set("max", std::vector<double>{1, 1, 1});
  // In through x = 0 at l = 8, out through y = 1 at 8 + 2^-50, which rounds to 8.
  const Ray ray{{-8, -7 - 0x1p-50, 0.5}, {1, 1, 0}};
  const truth::Answer truth = truth::make_surface(box)->all(ray, {});
  ASSERT_EQ(truth.hits.size(), 2U);
  ASSERT_EQ(truth.hits[1].l.head, 8);
  const auto verdict = [&](double l, std::uint32_t multiplicity) {
    return graze::judge(ray, truth, {Status::ok, {&l, 1}, {}, {}, {&multiplicity, 1}}, {}, nullptr).verdict;
  };
  EXPECT_EQ(verdict(8, 2), Verdict::right);
  EXPECT_EQ(verdict(8, 1), Verdict::wrong);
  EXPECT_EQ(verdict(8 + 0x1p-40, 2), Verdict::wrong) << "doubles could tell that one from the others";
}

TEST(Judge, ASpuriousHitInFrontIsWrongFirst) {
  const Judgement judgement = Question(kCrossing).judge({1, 3.125, 6.875});
  EXPECT_EQ(judgement.verdict, Verdict::wrong);
  EXPECT_EQ(judgement.spurious, 1);
  EXPECT_EQ(judgement.missed, 0);
  EXPECT_TRUE(judgement.wrong_first);
}

TEST(Judge, ASpuriousHitBetweenOrBehindLeavesTheFirstRight) {
  for (const std::vector<double>& l : {std::vector<double>{3.125, 5, 6.875}, {3.125, 6.875, 9}}) {
    const Judgement judgement = Question(kCrossing).judge(l);
    EXPECT_EQ(judgement.verdict, Verdict::wrong);
    EXPECT_EQ(judgement.spurious, 1);
    EXPECT_FALSE(judgement.wrong_first);
  }
}

TEST(Judge, OneHitClaimedTwiceIsSpurious) {
  const Judgement judgement = Question(kTouching).judge({5 - 1e-9, 5 + 1e-9});
  EXPECT_EQ(judgement.verdict, Verdict::wrong);
  EXPECT_EQ(judgement.spurious, 1);
}

TEST(Judge, ATangentHitThatIsSeenIsRightAndOneThatIsNotIsMissed) {
  const Question question(kTouching);
  ASSERT_EQ(question.truth.hits.size(), 1U);
  const Judgement seen = question.judge({5 + 1e-9});
  EXPECT_EQ(seen.verdict, Verdict::right);
  EXPECT_EQ(seen.condition_units.value(), 0) << "an error at a tangent has infinite condition";
  EXPECT_GT(seen.ulps.value(), 1e5);
  EXPECT_EQ(question.judge({}).verdict, Verdict::wrong);
  EXPECT_TRUE(question.judge({}).wrong_first);
}

TEST(Judge, AMissIsRightWithNothingToMeasure) {
  const Judgement judgement = Question(kMissing).judge({});
  EXPECT_EQ(judgement.verdict, Verdict::right);
  EXPECT_FALSE(judgement.ulps.has_value());
  EXPECT_FALSE(judgement.condition_units.has_value());
}

TEST(Judge, AnyHitOnAMissIsWrongFirst) {
  const Judgement judgement = Question(kMissing).judge({4});
  EXPECT_EQ(judgement.verdict, Verdict::wrong);
  EXPECT_EQ(judgement.spurious, 1);
  EXPECT_TRUE(judgement.wrong_first);
}

TEST(Judge, UncertainAndFailedMayMissButNotInvent) {
  const Question question(kCrossing);
  EXPECT_EQ(question.judge({}, Status::uncertain).verdict, Verdict::uncertain);
  EXPECT_EQ(question.judge({6.875}, Status::uncertain).verdict, Verdict::uncertain);
  EXPECT_FALSE(question.judge({6.875}, Status::uncertain).wrong_first);
  EXPECT_EQ(question.judge({6.875}, Status::uncertain).missed, 1);
  EXPECT_EQ(question.judge({}, Status::failed).verdict, Verdict::failed);
  EXPECT_EQ(question.judge({1}, Status::uncertain).verdict, Verdict::wrong);
  EXPECT_EQ(question.judge({1}, Status::failed).verdict, Verdict::wrong);
}

TEST(Judge, ACoincidenceMustBeSeenAndMayNotBeInvented) {
  Question question(kCrossing);
  EXPECT_EQ(question.judge({}, Status::coincident).verdict, Verdict::wrong);
  question.truth = {};
  question.truth.status = Status::coincident;
  EXPECT_EQ(question.judge({}, Status::coincident).verdict, Verdict::right);
  EXPECT_EQ(question.judge({}, Status::ok).verdict, Verdict::wrong);
  EXPECT_EQ(question.judge({3}, Status::ok).verdict, Verdict::wrong);
  EXPECT_EQ(question.judge({}, Status::uncertain).verdict, Verdict::uncertain);
  EXPECT_EQ(question.judge({}, Status::failed).verdict, Verdict::failed);
}

TEST(Judge, PointsAndNormalsAreMeasuredAgainstTheSurface) {
  const Question question(kCrossing);
  const std::vector<double> l{3.125, 6.875};
  const std::vector<Vec3> points{{-1.875, 1.5, 0}, {1.875 + 0x1p-20, 1.5, 0}};
  const std::vector<Vec3> normals{question.truth.hits[0].normal, {1, 0, 0}};
  const Claim claim{Status::ok, l, points, normals};
  const Judgement judgement = judge(question.ray, question.truth, claim, {}, question.surface.get());
  // 2^-20 out along x is 8/sqrt(65) 2^-20 off the surface; the largest input, 55/8, has ulp 2^-50.
  EXPECT_NEAR(judgement.backward.value(), 0x1p30 * 8 / std::sqrt(65.0), 0x1p30 * 1e-5);
  EXPECT_NEAR(judgement.normal_error.value(), std::atan(1.0 / 8), 1e-14);
}

TEST(Judge, TheMatchRadiusSeparatesAnErrorFromAMiss) {
  const Question question(kCrossing);
  EXPECT_EQ(question.judge({3.125 + 1e-6, 6.875}).verdict, Verdict::right);
  EXPECT_EQ(question.judge({3.125 + 1e-5, 6.875}).verdict, Verdict::wrong);
}

TEST(Judge, ATruthThatOneUlpOverturnsIsAmbiguousAndAClearOneIsNot) {
  for (const Ray& ray : {kCrossing, kMissing}) {
    const Question question(ray);
    EXPECT_FALSE(is_ambiguous(*question.surface, ray, question.truth));
  }
  const Question touching(kTouching);
  EXPECT_TRUE(is_ambiguous(*touching.surface, kTouching, touching.truth));
  Ray outside = kTouching;
  outside.o.x = std::nextafter(outside.o.x, 2);
  const Question missing(outside);
  EXPECT_TRUE(missing.truth.hits.empty());
  EXPECT_TRUE(is_ambiguous(*missing.surface, outside, missing.truth));
}

TEST(Judge, ConditionGrowsWithoutBoundTowardsATangent) {
  const Question crossing(kCrossing);
  const double expected = (3.125 + std::sqrt(65.0) / 8) / 3.125;
  EXPECT_NEAR(condition(crossing.truth, kCrossing, 1).value(), expected, 1e-14);
  EXPECT_TRUE(std::isinf(condition(Question(kTouching).truth, kTouching, 1).value()));
  EXPECT_FALSE(condition(Question(kMissing).truth, kMissing, 1).has_value());
}

TEST(Judge, ADirectionTwiceAsLongChangesNoVerdictAndNoUnit) {
  const Ray twice{kCrossing.o, {2, 0, 0}};
  const Judgement judgement = Question(twice).judge({1.5625 + kEps, 3.4375});
  EXPECT_EQ(judgement.verdict, Verdict::right);
  const Judgement original = Question(kCrossing).judge({3.125 + 2 * kEps, 6.875});
  EXPECT_DOUBLE_EQ(judgement.condition_units.value(), original.condition_units.value());
}

TEST(Judge, VerdictsHaveNames) {
  EXPECT_EQ(to_string(Verdict::right), "right");
  EXPECT_EQ(to_string(Verdict::wrong), "wrong");
  EXPECT_EQ(to_string(Verdict::uncertain), "uncertain");
  EXPECT_EQ(to_string(Verdict::failed), "failed");
}

}  // namespace
}  // namespace graze::test
