#include "cases.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <graze/solvers/parameters.hpp>

#include "cases_aim.hpp"
#include "cases_special.hpp"

namespace graze {
namespace {

using aim::log_uniform, aim::random_direction, aim::random_index, aim::random_sample, aim::random_sign,
    aim::random_tangent, aim::random_target, aim::reach, aim::through;
using Singular = Landmarks::Singular;

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
  const std::size_t which = random_index(rng, marks.poles.size());
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
  // Beside the axis through the centre; at 0 without an addition, which would lose the sign of a zero.
  const auto beside = [](double centre, double x) { return centre == 0 ? x : centre + x; };
  const Vec3 origin{beside(marks.centre.x, radius * std::cos(angle)), height,
                    beside(marks.centre.z, radius * std::sin(angle))};
  return {{origin, {0, up, 0}}, offset};
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

constexpr std::array<CaseFamily, 19> kFamilies{{
    {"camera", "Rays from around the surface at random points of its bounds: about half hit.",
     "distance of the origin / size of the bounds", any_surface, make_camera},
    {"inside", "Rays that start inside, from deep down to 1e-12 of the way below the surface.",
     "depth below the surface / way to the centre", special::not_flat, make_inside},
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
    {"on_surface",
     "Rays that start at a point of the surface moved along its normal by up to 4 ulps or by 1e-16 to 1e-10 "
     "of the "
     "size.",
     "distance of the origin from the point / L", any_surface, special::make_on_surface},
    {"tangent", "Rays along a tangent through a point of the surface moved along its normal by 0 to 4 ulps.",
     "offset from tangency in ulps", any_surface, special::make_tangent},
    {"cluster", "Rays through two neighbouring points of the surface: nearly equal hits.",
     "distance between the points / L", special::without_faces, special::make_cluster},
    {"parallel",
     "Rays along faces, rulings or axes, one in four exactly, the others tilted by 1e-16 to 1e-2, at 0 to "
     "1e-1 "
     "of the size from the surface.",
     "tilt", special::with_parallels, special::make_parallel},
    {"edge",
     "Rays that pass an edge or a vertex, one in four through it, the others at 1e-16 to 1e-1 of the size.",
     "distance from the edge / L", special::with_edges, special::make_edge},
    {"parabolic",
     "Rays along directions in which the leading coefficient vanishes, tilted by 0 or by 1e-16 to 1e-2.",
     "tilt", special::with_asymptotes, special::make_parabolic},
    {"apex",
     "Rays that pass the tip of a cone, one in four through it, the others at 1e-16 to 1e-1 of the size.",
     "distance from the tip / L", special::with_singular<Singular::apex>,
     special::make_singular<Singular::apex>},
    {"cusp", "Rays that pass a cusp, one in four through it, the others at 1e-16 to 1e-1 of the size.",
     "distance from the cusp / L", special::with_singular<Singular::cusp>,
     special::make_singular<Singular::cusp>},
    {"crossing",
     "Rays that pass a point where the surface crosses itself, one in four through it, the others at 1e-16 "
     "to "
     "1e-1 of the size.",
     "distance from the crossing / L", special::with_singular<Singular::crossing>,
     special::make_singular<Singular::crossing>},
    {"extreme",
     "Rays with numbers from 1e-295 to 1e295 and subnormal ones: directions of any length, very far or all "
     "but "
     "zero origins, slopes of all but zero.",
     "largest |log10| of the numbers", any_surface, special::make_extreme},
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
