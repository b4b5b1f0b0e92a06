// What the tests of certified truth share: surfaces by name and parameters, the question of one ray, and the
// answer that is wanted.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <graze/experiments/truth.hpp>

namespace graze::test {

using Table = std::vector<std::vector<double>>;

inline SurfaceSpec spec_of(const std::string& type, const std::map<std::string, ParameterValue>& parameters) {
  SurfaceSpec spec;
  spec.type = type;
  spec.parameters = Parameters(parameters);
  return spec;
}

inline std::vector<double> list(Vec3 v) { return {v.x, v.y, v.z}; }

inline Table table(const std::vector<Vec3>& points) {
  Table rows;
  for (const Vec3& p : points) rows.push_back(list(p));
  return rows;
}

inline truth::Answer ask(const SurfaceSpec& spec, const Ray& ray, int digits = 40) {
  return truth::make_surface(spec)->all(ray, {digits});
}

struct Wanted {
  std::string l;
  std::uint32_t multiplicity = 1;
};

inline void expect_hits(const truth::Answer& answer, const std::vector<Wanted>& wanted) {
  EXPECT_EQ(answer.status, Status::ok) << answer.why;
  ASSERT_EQ(answer.hits.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_EQ(answer.hits[i].l.decimal, wanted[i].l);
    EXPECT_EQ(answer.hits[i].multiplicity, wanted[i].multiplicity);
    EXPECT_EQ(answer.hits[i].tangent, wanted[i].multiplicity >= 2);
  }
}

inline void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

}  // namespace graze::test
