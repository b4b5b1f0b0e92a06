// Named parameters: readers that name what is wrong.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <stdexcept>

#include <graze/solvers/parameters.hpp>

namespace graze {
namespace {

/// The message of the exception that `call` throws, or nothing.
template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(Parameters, ReadersReturnWhatWasSetOrTheFallback) {
  Parameters p;
  p.set("s", 1.5);
  p.set("polish", true);
  p.set("formulation", std::string("along_ray"));
  p.set("points", std::vector<std::vector<double>>{{0, 1}, {2, 3}});
  EXPECT_EQ(p.number("s"), 1.5);
  EXPECT_EQ(p.number("r", 7), 7);
  EXPECT_TRUE(p.flag("polish", false));
  EXPECT_TRUE(p.flag("other", true));
  EXPECT_EQ(p.word("formulation", ""), "along_ray");
  EXPECT_EQ(p.integer("tries", 30, 1, 100), 30);
  EXPECT_EQ(p.table("points", 2)[1][0], 2);
}

TEST(Parameters, MissingOnesAreNamed) {
  EXPECT_NE(message_of([] { (void)Parameters().number("radius"); }).find("radius"), std::string::npos);
  EXPECT_NE(message_of([] { (void)Parameters().table("control_points", 2); }).find("control_points"),
            std::string::npos);
}

TEST(Parameters, WrongTypesAreNamed) {
  Parameters p;
  p.set("s", true);
  p.set("polish", 1.0);
  EXPECT_THROW((void)p.number("s"), std::invalid_argument);
  EXPECT_THROW((void)p.flag("polish", false), std::invalid_argument);
  EXPECT_THROW((void)p.word("s", ""), std::invalid_argument);
  EXPECT_THROW((void)p.table("s", 2), std::invalid_argument);
}

TEST(Parameters, NumbersMustBeFinite) {
  for (const double value :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    Parameters p;
    p.set("s", value);
    p.set("points", std::vector<std::vector<double>>{{0, 1}, {2, value}});
    EXPECT_THROW((void)p.number("s"), std::invalid_argument);
    EXPECT_NE(message_of([&] { (void)p.table("points", 2); }).find("points[1]"), std::string::npos);
  }
}

TEST(Parameters, IntegersMustBeWholeAndInRange) {
  for (const double value : {0.0, 101.0, 2.5, -1.0, 1e18}) {
    Parameters p;
    p.set("tries", value);
    EXPECT_THROW((void)p.integer("tries", 30, 1, 100), std::invalid_argument) << value;
  }
}

TEST(Parameters, RowsOfTheWrongLengthAreNamed) {
  Parameters p;
  p.set("points", std::vector<std::vector<double>>{{0, 1}, {2, 3, 4}});
  EXPECT_NE(message_of([&] { (void)p.table("points", 2); }).find("points[1]"), std::string::npos);
}

TEST(Parameters, AnUnknownOneNamesTheNearest) {
  Parameters p;
  p.set("triess", 3.0);
  const std::array<std::string_view, 2> known{"seed", "tries"};
  EXPECT_NE(message_of([&] { p.expect_only(known, "newton_slices"); }).find("tries"), std::string::npos);
  p = Parameters();
  p.set("seed", 3.0);
  EXPECT_NO_THROW(p.expect_only(known, "newton_slices"));
}

TEST(NearestNames, AreAtMostThreeNearestFirst) {
  const std::array<std::string_view, 4> known{"companion", "newton_slices", "ceres_slices",
                                              "interval_bisection"};
  const auto names = nearest_names("compnion", known);
  ASSERT_EQ(names.size(), 3U);
  EXPECT_EQ(names[0], "companion");
  EXPECT_EQ(unknown_name_message("solver", "x", {}), "unknown solver 'x' (there are none)");
}

}  // namespace
}  // namespace graze
