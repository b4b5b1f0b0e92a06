// Surfaces for the adversarial search beside the contract's examples: hard ones that were published or that
// are nearly of another kind, and random ones.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <graze/experiments/specs.hpp>
#include <surfaces/cells.hpp>

#include "attack_rays.hpp"

namespace graze::test {

inline std::vector<std::string> hard_examples(std::string_view type) {
  if (type == "teardrop") return {"teardrop:s=1e-9", "teardrop:s=0.1"};
  if (type == "sphere")
    return {"sphere:radius=1e-4,center=[1e4,0,0]", "sphere:radius=1e4,center=[0,1,0]",
            "sphere:radius=0.1,center=[0.3,0.7,-1e6]"};
  if (type == "ellipsoid")
    return {"ellipsoid:semi_axes=[1,1e-6,1]", "ellipsoid:semi_axes=[1e5,1,1],center=[1,2,3]"};
  if (type == "quadric")
    return {"quadric:A=1,E=-1,H=1",            // cone
            "quadric:A=1,H=1e-13,G=-0.5",      // nearly a parabolic cylinder
            "quadric:A=1,E=1e-13,H=1,G=-0.5",  // nearly a paraboloid
            "quadric:A=1,H=1,J=-1",            // circular cylinder
            "quadric:A=1,G=-0.5",              // parabolic cylinder
            "quadric:A=1,G=-0.5,H=-1",         // hyperbolic paraboloid
            "quadric:A=1,E=-1,H=1,J=1e-12",    // nearly a cone
            "quadric:A=1,J=-1",                // two planes
            "quadric:A=1,H=-1",                // two planes that meet
            "quadric:A=1e-3,B=2,C=-0.7,E=3,F=0.11,H=0.3,J=-1"};
  if (type == "torus")
    return {"torus:R=1,r=1", "torus:R=1,r=1e-3", "torus:R=1,r=0.999999999", "torus:R=1,r=1.000000001",
            "torus:R=1e-3,r=1"};
  if (type == "bezier_revolution")
    return {"bezier_revolution:control_points=[[1,0],[0,2]]",  // cone
            "bezier_revolution:control_points=[[1,0],[1,2]]",  // cylinder
            "bezier_revolution:control_points=[[0,0],[2,0],[3,2],[0,6]]",
            "bezier_revolution:control_points=[[0,0],[3,1],[-4,2],[3,4],[0,5]]",
            "bezier_revolution:control_points=[[0,1],[2,1],[0,0.5]]"};
  if (type == "implicit_polynomial")
    return {
        "implicit_polynomial:terms=[[4,2,0,0],[4,0,2,0],[4,0,0,2],[16,1,1,1],[-1,0,0,0]]",  // Cayley
                                                                                            // Two unit
                                                                                            // spheres that
                                                                                            // meet in a
                                                                                            // circle.
        "implicit_polynomial:terms=[[1,4,0,0],[1,0,4,0],[1,0,0,4],[2,2,2,0],[2,2,0,2],[2,0,2,2],[-2.5,2,"
        "0,0],[-1.5,0,2,0],[-1.5,0,0,2],[0.5625,0,0,0]]"};
  return {};
}

/// A number of few bits, or of all.
inline double random_number(Rng& rng) {
  if (chance(rng, 0.5)) return static_cast<double>(whole(rng, 8)) / 4;
  return chance(rng, 0.1) ? std::ldexp(rng.uniform(-1, 1), whole(rng, 40)) : rng.uniform(-2, 2);
}

/// Parameters drawn at random; they may be no surface. Named one by one: arguments have no order.
inline std::optional<SurfaceSpec> random_parameters(std::string_view type, Rng& rng) {
  const auto point = [&rng] {
    return std::vector<double>{random_number(rng), random_number(rng), random_number(rng)};
  };
  const auto sizes = [&point] {
    std::vector<double> list = point();
    for (double& x : list) x = std::fabs(x);
    return list;
  };
  const std::vector<double> p = point(), q = point(), s = sizes();
  if (type == "teardrop") return teardrop(s[0]);
  if (type == "torus") return torus(s[0], s[1]);
  if (type == "sphere") return with_numbers(type, {{"radius", s[0]}, {"center", p}});
  if (type == "ellipsoid") return with_numbers(type, {{"semi_axes", s}, {"center", p}});
  if (type == "triangle") return figure("triangle", {p, q, s});
  if (type == "tetrahedron") return tetrahedron({p, q, s, point()});
  if (type == "plane") return plane({p[0], p[1], p[2]}, q[0]);
  if (type == "disk") return disk({p[0], p[1], p[2]}, {q[0], q[1], q[2]}, s[0]);
  if (type == "box") return box({p[0], p[1], p[2]}, {p[0] + s[0], p[1] + s[1], p[2] + s[2]});
  if (type == "quadric") {
    SurfaceSpec spec = with_numbers(type, {});
    for (const char* name : {"A", "B", "C", "D", "E", "F", "G", "H", "I", "J"})
      if (chance(rng, 0.5)) spec.parameters.set(name, random_number(rng));
    return spec;
  }
  if (type == "bezier_revolution") {
    Table points(2 + pick(rng, 4));
    for (std::vector<double>& one : points) one = {random_number(rng), random_number(rng)};
    return bezier(points);
  }
  return std::nullopt;
}

/// A random surface of the type; none where they are not drawn.
inline std::optional<SurfaceSpec> random_surface(std::string_view type, Rng& rng) {
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    const std::optional<SurfaceSpec> spec = random_parameters(type, rng);
    if (!spec) return std::nullopt;
    if (refusal(*spec).empty()) return spec;
  }
  return std::nullopt;
}

inline std::vector<SurfaceSpec> attacked_surfaces(std::string_view type) {
  std::vector<SurfaceSpec> all = examples(type);
  for (const std::string& text : hard_examples(type)) all.push_back(parse_surface(text));
  return all;
}

}  // namespace graze::test
