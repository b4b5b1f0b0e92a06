#include "cases.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <graze/solvers/parameters.hpp>

namespace graze {
namespace {

/// 10^uniform(lo, hi).
double log_uniform(Rng& rng, double lo, double hi) { return std::pow(10.0, rng.uniform(lo, hi)); }

/// Uniform on the unit sphere (Archimedes: height and angle are uniform).
Vec3 random_direction(Rng& rng) {
  const double height = rng.uniform(-1, 1);
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - height * height);
  return {radius * std::cos(angle), height, radius * std::sin(angle)};
}

double random_sign(Rng& rng) { return rng.uniform() < 0.5 ? -1.0 : 1.0; }

/// Radius of the ball about the bounds.
double reach(const Landmarks& marks) { return norm(marks.half); }

/// A point of the bounding box, or cylinder for surfaces with an axis.
Vec3 random_target(const Landmarks& marks, Rng& rng) {
  const double up = rng.uniform(-1, 1) * marks.half.y;
  if (!marks.has_axis) {
    return marks.centre + Vec3{rng.uniform(-1, 1) * marks.half.x, up, rng.uniform(-1, 1) * marks.half.z};
  }
  const double radius = marks.half.x * std::sqrt(rng.uniform());
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  return marks.centre + Vec3{radius * std::cos(angle), up, radius * std::sin(angle)};
}

SurfaceSample random_sample(const AnySurface& surface, Rng& rng) {
  const double u = rng.uniform();
  return surface.sample(u, rng.uniform());
}

/// A random unit vector orthogonal to n.
Vec3 random_tangent(Vec3 n, Rng& rng) {
  while (true) {
    const Vec3 d = random_direction(rng);
    const Vec3 tangent = d - dot(d, n) * n;
    if (norm(tangent) > 0.1) return normalized(tangent);
  }
}

/// A ray through `target` along `direction` that starts `distance` before it.
Ray through(Vec3 target, Vec3 direction, double distance) {
  return {target - distance * direction, direction};
}

bool any_surface(const Landmarks& /*marks*/) { return true; }
bool with_axis(const Landmarks& marks) { return marks.has_axis; }
bool with_poles(const Landmarks& marks) { return !marks.poles.empty(); }

CaseRay make_camera(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const double distance = rng.uniform(1.5, 4);
  const Vec3 origin = marks.centre + distance * reach(marks) * random_direction(rng);
  return {{origin, normalized(random_target(marks, rng) - origin)}, distance};
}

CaseRay make_inside(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const double depth = log_uniform(rng, -12, 0);
  const Vec3 on_surface = random_sample(surface, rng).point;
  return {{on_surface + depth * (marks.centre - on_surface), random_direction(rng)}, depth};
}

CaseRay make_graze(const AnySurface& surface, Rng& rng) {
  const SurfaceSample sample = random_sample(surface, rng);
  const double offset = log_uniform(rng, -16, -1);
  const Vec3 target = sample.point + random_sign(rng) * offset * surface.size() * sample.normal;
  const double distance = rng.uniform(1, 4) * reach(surface.landmarks());
  return {through(target, random_tangent(sample.normal, rng), distance), offset};
}

CaseRay make_flat(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const double steepness = log_uniform(rng, -16, -2);
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const Vec3 direction{std::cos(angle), random_sign(rng) * steepness, std::sin(angle)};
  const double distance = rng.uniform(1.5, 4) * reach(marks);
  return {through(random_target(marks, rng), direction, distance), steepness};
}

CaseRay make_horizontal(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  // One ray in four comes near the top or bottom plane, as near as 1e-12 of the height.
  const double edge = rng.uniform() < 0.25 ? log_uniform(rng, -12, 0) : rng.uniform();
  Vec3 target = random_target(marks, rng);
  target.y = marks.centre.y + random_sign(rng) * (1 - edge) * marks.half.y;
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const Vec3 direction{std::cos(angle), 0, std::sin(angle)};
  Ray ray = through(target, direction, rng.uniform(1.5, 4) * reach(marks));
  ray.d.y = 0;
  return {ray, edge};
}

CaseRay make_pole(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const auto which = static_cast<std::size_t>(rng.uniform() * static_cast<double>(marks.poles.size()));
  const double offset = log_uniform(rng, -16, -1);
  const Vec3 direction = random_direction(rng);
  const Vec3 target = marks.poles[which] + offset * surface.size() * random_tangent(direction, rng);
  return {through(target, direction, rng.uniform(1, 4) * reach(marks)), offset};
}

CaseRay make_axis(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  // One ray in four runs down the axis itself, the others parallel to it.
  const double offset = rng.uniform() < 0.25 ? 0 : log_uniform(rng, -16, 0);
  const double radius = offset * marks.half.x;
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const double up = random_sign(rng);
  const double height = marks.centre.y - up * rng.uniform(1.5, 4) * reach(marks);
  return {{{radius * std::cos(angle), height, radius * std::sin(angle)}, {0, up, 0}}, offset};
}

CaseRay make_far(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const double distance = log_uniform(rng, 1, 10);
  const Vec3 origin = marks.centre + distance * reach(marks) * random_direction(rng);
  return {{origin, normalized(random_target(marks, rng) - origin)}, distance};
}

CaseRay make_scale(const AnySurface& surface, Rng& rng) {
  CaseRay result = make_camera(surface, rng);
  result.difficulty = surface.size();
  return result;
}

constexpr std::array<CaseFamily, 9> kFamilies{{
    {"camera", "Rays from around the surface at random points of its bounds: about half hit.",
     "distance of the origin / size of the bounds", any_surface, make_camera},
    {"inside", "Rays that start inside, from deep down to 1e-12 of the way below the surface.",
     "depth below the surface / way to the centre", any_surface, make_inside},
    {"graze", "Rays along a tangent, offset from tangency by 1e-16 to 1e-1 of the size to either side.",
     "offset from tangency / L", any_surface, make_graze},
    {"flat", "Nearly horizontal rays, |q_y| from 1e-16 to 1e-2.", "|q_y|", with_axis, make_flat},
    {"horizontal", "Rays with q_y = 0 exactly, one in four near the top or bottom plane.",
     "distance from the end planes / half height", with_axis, make_horizontal},
    {"pole", "Rays that pass a pole (apex, bottom) at 1e-16 to 1e-1 of the size.",
     "distance from the pole / L", with_poles, make_pole},
    {"axis", "Rays parallel to the axis, one in four on it.", "distance from the axis / largest radius",
     with_axis, make_axis},
    {"far", "Rays from 10 to 1e10 sizes away.", "distance / size of the bounds", any_surface, make_far},
    {"scale", "Camera rays with the whole scene scaled by 1e-12 to 1e12.", "L after scaling", any_surface,
     make_scale},
}};

std::uint64_t hash_name(std::uint64_t seed, std::string_view name) {
  std::uint64_t hash = mix64(seed);
  for (const char c : name)
    hash = hash_combine(hash, static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  return hash;
}

}  // namespace

std::span<const CaseFamily> case_families() { return kFamilies; }

const CaseFamily& find_family(std::string_view name) {
  std::vector<std::string_view> known;
  for (const CaseFamily& family : kFamilies) {
    if (family.name == name) return family;
    known.push_back(family.name);
  }
  throw std::invalid_argument(unknown_name_message("case", name, known));
}

double block_scale(const CaseFamily& family, std::uint64_t seed, std::size_t block) {
  if (family.name != "scale") return 1;
  Rng rng(hash_combine(hash_name(seed, "scale of a block"), block));
  return log_uniform(rng, -12, 12);
}

std::vector<CaseRay> make_block(const CaseFamily& family, const AnySurface& surface, std::uint64_t seed,
                                std::size_t block, std::size_t count) {
  std::vector<CaseRay> rays;
  for (std::size_t i = 0; i < count; ++i) {
    Rng rng(hash_combine(hash_name(seed, family.name), block * kCaseBlock + i));
    rays.push_back(family.make(surface, rng));
  }
  return rays;
}

}  // namespace graze
