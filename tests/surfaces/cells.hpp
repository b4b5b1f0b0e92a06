// What the surface tests share: every (surface, formulation, solver) cell of the build, rays to try them on,
// and answers in a shape that is easy to compare.
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/intersector.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze::test {

using Table = std::vector<std::vector<double>>;

inline SurfaceSpec teardrop(double s) {
  SurfaceSpec spec;
  spec.type = "teardrop";
  spec.parameters.set("s", s);
  return spec;
}

inline SurfaceSpec bezier(const Table& points) {
  SurfaceSpec spec;
  spec.type = "bezier_revolution";
  spec.parameters.set("control_points", points);
  return spec;
}

/// A surface by its name and parameters.
inline SurfaceSpec with_numbers(std::string_view type, std::map<std::string, ParameterValue> values) {
  SurfaceSpec spec;
  spec.type = type;
  spec.parameters = Parameters(std::move(values));
  return spec;
}

/// The teardrop's own control points.
inline Table teardrop_points(double s) { return {{0, 0}, {2 * s, 0}, {3 * s, 2 * s}, {0, 6 * s}}; }
/// A closed vase with a waist: not convex, up to six hits.
inline Table vase_points() { return {{0, 0}, {4, 0}, {3, 2}, {-2, 3}, {4, 4}, {0, 6}}; }
/// A profile that crosses the axis: r < 0 in its middle.
inline Table crossing_points() { return {{0, 0}, {3, 1}, {-4, 2}, {3, 4}, {0, 5}}; }
/// Degree 7.
inline Table degree_seven_points() {
  return {{0, 0}, {1, 0}, {2, 1}, {1, 2}, {2, 3}, {3, 4}, {1, 5}, {0, 6}};
}

inline SurfaceSpec box(std::vector<double> min, std::vector<double> max) {
  SurfaceSpec spec;
  spec.type = "box";
  spec.parameters.set("min", std::move(min));
  spec.parameters.set("max", std::move(max));
  return spec;
}

/// tetrahedron, triangle, polygon: `vertices`; convex_polyhedron: `halfspaces`.
inline SurfaceSpec table_spec(const std::string& type, const std::string& parameter, const Table& rows) {
  SurfaceSpec spec;
  spec.type = type;
  spec.parameters.set(parameter, rows);
  return spec;
}
inline SurfaceSpec tetrahedron(const Table& vertices) {
  return table_spec("tetrahedron", "vertices", vertices);
}
inline SurfaceSpec convex_polyhedron(const Table& halfspaces) {
  return table_spec("convex_polyhedron", "halfspaces", halfspaces);
}
/// |x| + |y| + |z| <= 1: four planes through each corner.
inline Table octahedron() {
  Table rows;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) rows.push_back({x, y, z, 1});
    }
  }
  return rows;
}

inline SurfaceSpec torus(double ring, double tube) {
  SurfaceSpec spec;
  spec.type = "torus";
  spec.parameters.set("R", ring);
  spec.parameters.set("r", tube);
  return spec;
}

inline SurfaceSpec implicit_polynomial(const Table& terms) {
  SurfaceSpec spec;
  spec.type = "implicit_polynomial";
  spec.parameters.set("terms", terms);
  return spec;
}

/// 4 x^4 - 4 x^3 + y^2 + z^2 = 0: a cusp at the origin.
inline Table piriform_terms() { return {{4, 4, 0, 0}, {-4, 3, 0, 0}, {1, 0, 2, 0}, {1, 0, 0, 2}}; }
/// (x^2 + y^2 + z^2 - 1)^2 + 3 x y z - 1/2 = 0: a quartic of several humps, without symmetry of revolution.
inline Table humps_terms() {
  return {{1, 4, 0, 0},  {1, 0, 4, 0},  {1, 0, 0, 4},  {2, 2, 2, 0}, {2, 2, 0, 2},  {2, 0, 2, 2},
          {-2, 2, 0, 0}, {-2, 0, 2, 0}, {-2, 0, 0, 2}, {3, 1, 1, 1}, {0.5, 0, 0, 0}};
}

inline SurfaceSpec plane(Vec3 a, double b, bool one_sided = false) {
  SurfaceSpec spec;
  spec.type = "plane";
  spec.parameters.set("a", std::vector<double>{a.x, a.y, a.z});
  spec.parameters.set("b", b);
  spec.parameters.set("one_sided", one_sided);
  return spec;
}

/// A triangle or a polygon.
inline SurfaceSpec figure(const std::string& type, const Table& vertices) {
  SurfaceSpec spec;
  spec.type = type;
  spec.parameters.set("vertices", vertices);
  return spec;
}

inline SurfaceSpec disk(Vec3 center, Vec3 normal, double radius) {
  SurfaceSpec spec;
  spec.type = "disk";
  spec.parameters.set("center", std::vector<double>{center.x, center.y, center.z});
  spec.parameters.set("normal", std::vector<double>{normal.x, normal.y, normal.z});
  spec.parameters.set("radius", radius);
  return spec;
}

/// A polygon that is not convex, in the plane x + 2y + z = 2.
inline Table arrow_points() { return {{3, 0, -1}, {0, 1, 0}, {-3, 1, 3}, {1, -1, 3}, {1, 0, 1}}; }

/// Under a sanitizer everything takes ten times as long: a few rays show what it looks for.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

/// Surfaces of each type to run the contract on. A new surface adds its line here.
inline std::vector<SurfaceSpec> examples(std::string_view type) {
  if (type == "teardrop") return {teardrop(1), teardrop(1.7)};
  if (type == "bezier_revolution") return {bezier(vase_points())};
  if (type == "box") return {box({-1, 2, 1}, {3, 3, 3}), box({-0.7, 0.1, -1.3}, {0.6, 1.9, 1e-3})};
  if (type == "tetrahedron") return {tetrahedron({{1, 0, 0}, {-1, 0, -1}, {-1, 0, 1}, {0, 1, 0}})};
  if (type == "convex_polyhedron") return {convex_polyhedron(octahedron())};
  if (type == "torus") return {torus(1, 0.25), torus(0.7, 1.1)};
  if (type == "ellipsoid") {
    return {with_numbers("ellipsoid", {{"semi_axes", std::vector<double>{1, 2, 0.5}}}),
            with_numbers("ellipsoid", {{"P", Table{{2, 0.5, 0}, {0.5, 1, 0.25}, {0, 0.25, 3}}},
                                       {"center", std::vector<double>{1, -2, 0.5}}})};
  }
  if (type == "quadric") {
    return {with_numbers("quadric", {{"A", 1.0}, {"E", 0.25}, {"H", 1.0}, {"J", -1.0}}),  // ellipsoid
            with_numbers("quadric", {{"A", 1.0}, {"E", -1.0}, {"H", 1.0}, {"J", -1.0}}),  // one sheet
            with_numbers("quadric", {{"A", 1.0}, {"E", -0.5}, {"H", 1.0}}),               // cone
            with_numbers("quadric", {{"A", 1.0}, {"B", 0.5}, {"H", 2.0}, {"G", -0.7}, {"J", 0.3}})};
  }
  if (type == "sphere") {
    return {with_numbers("sphere", {{"radius", 1.0}}),
            with_numbers("sphere", {{"radius", 1.3}, {"center", std::vector<double>{2, -3, 0.7}}})};
  }
  if (type == "implicit_polynomial")
    return {implicit_polynomial(piriform_terms()), implicit_polynomial(humps_terms()),
            implicit_polynomial({{1, 2, 0, 0}, {1, 0, 2, 0}, {1, 0, 0, 2}, {-1, 0, 0, 0}})};
  if (type == "plane") return {plane({0.3, -1, 2}, 1.7), plane({0, 3, 0}, 0)};
  if (type == "triangle")
    return {figure("triangle", {{0, 0, 0}, {3, 0.5, 1}, {0.5, 2, -1}}),
            figure("triangle", {{1e3, -2, 0.1}, {1e3, 1.3, 0.2}, {1e3, -0.3, 1.9}})};
  if (type == "polygon")
    return {figure("polygon", arrow_points()),
            figure("polygon", {{0, 0, 1}, {0, 3, 1}, {2, 3, 1}, {2, 0, 1}})};
  if (type == "disk") return {disk({0, 1, 0}, {0, -2, 0}, 1.5), disk({2, -3, 0.7}, {1, 2, -0.3}, 0.9)};
  throw std::logic_error("tests/surfaces/cells.hpp has no example of surface " + std::string(type));
}

struct Cell {
  const SurfaceEntry* surface;
  const SolverEntry* solver;
  Pairing pairing;

  [[nodiscard]] std::string formulation() const {
    return std::string(surface->formulations[pairing.formulation].name);
  }
  [[nodiscard]] bool in_float() const { return pairing.precision == Precision::binary32; }
  [[nodiscard]] bool has_kernel() const {
    for (const KernelEntry& kernel : surface->kernels) {
      if (kernel.solver == solver->name && kernel.formulation == formulation()) return !in_float();
    }
    return false;
  }
  /// Solvers from random starts get few of them here: what is tested does not depend on their number.
  [[nodiscard]] Parameters options(double tries) const {
    Parameters parameters;
    for (const auto& option : solver->info.options) {
      if (option.name == "tries") parameters.set("tries", tries);
    }
    return parameters;
  }
  [[nodiscard]] Scene scene(const SurfaceSpec& spec, double tries = 5) const {
    Scene result;
    result.add(*surface, spec, *solver, {options(tries), formulation(), pairing.precision});
    return result;
  }
  [[nodiscard]] std::string name() const {
    return std::string(surface->name) + "_" + formulation() + "_" + std::string(solver->name) +
           (in_float() ? "_float" : "");
  }
};

inline void PrintTo(const Cell& cell, std::ostream* out) { *out << cell.name(); }

inline std::vector<Cell> all_cells() {
  std::vector<Cell> cells;
  for (const SurfaceEntry& surface : surface_registry()) {
    for (const SolverEntry& solver : solver_registry()) {
      for (const Precision precision : {Precision::binary64, Precision::binary32}) {
        for (const Pairing pairing : all_pairings(solver, surface, precision))
          cells.push_back({&surface, &solver, pairing});
      }
    }
  }
  return cells;
}

/// The cells in double, for tests of what rounding to float would spoil.
inline std::vector<Cell> double_cells() {
  std::vector<Cell> cells = all_cells();
  std::erase_if(cells, [](const Cell& cell) { return cell.in_float(); });
  return cells;
}

inline bool has_surface(std::string_view name) {
  for (const SurfaceEntry& surface : surface_registry()) {
    if (surface.name == name) return true;
  }
  return false;
}

/// None where the build leaves it out.
inline const SolverEntry* solver_named(std::string_view name) {
  for (const SolverEntry& solver : solver_registry()) {
    if (solver.name == name) return &solver;
  }
  return nullptr;
}

/// One surface with its solver, in double.
inline Scene scene_of(const SurfaceSpec& spec, const SolverEntry& solver, std::string_view formulation = {}) {
  Scene scene;
  scene.add(find_surface(spec.type), spec, solver, {{}, std::string(formulation), Precision::binary64});
  return scene;
}

/// The surface answered by formulas; an empty scene in a build without them.
inline Scene closed_form_scene(const SurfaceSpec& spec, std::string_view formulation = {}) {
  const SolverEntry* const solver = solver_named("closed_form");
  return solver == nullptr ? Scene() : scene_of(spec, *solver, formulation);
}

/// The sentence with which a specification is refused; empty if it is not.
inline std::string refusal(const SurfaceSpec& spec) {
  try {
    find_surface(spec.type).make(spec);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

struct Answer {
  Status status = Status::ok;
  std::vector<double> l;
  std::vector<std::uint32_t> multiplicity;
  std::vector<Vec3> point, normal;
  std::vector<std::array<double, 2>> params;

  friend bool operator==(const Answer&, const Answer&) = default;
};

inline void PrintTo(const Answer& answer, std::ostream* out) {
  *out << to_string(answer.status) << std::hexfloat;
  for (const double l : answer.l) *out << " " << l;
}

inline constexpr Wanted kEverything{.points = true, .normals = true, .params = true};

inline std::vector<Answer> answers_of(const HitBuffer& hits) {
  std::vector<Answer> answers;
  for (std::size_t i = 0; i < hits.rays(); ++i) {
    Answer answer{
        .status = hits.status[i], .l = {}, .multiplicity = {}, .point = {}, .normal = {}, .params = {}};
    for (std::size_t k = hits.begin(i); k < hits.end(i); ++k) {
      answer.l.push_back(hits.l[k]);
      answer.multiplicity.push_back(hits.multiplicity[k]);
      answer.point.push_back(hits.point[k]);
      answer.normal.push_back(hits.normal[k]);
      answer.params.push_back(hits.params[k]);
    }
    answers.push_back(answer);
  }
  return answers;
}

inline std::vector<Answer> ask(const Scene& scene, std::span<const Ray> rays, Query query = Query::all) {
  Scene::Workspace work;
  HitBuffer hits;
  scene.intersect(rays, query, kEverything, work, hits);
  return answers_of(hits);
}

inline Vec3 random_direction(Rng& rng) {
  const double height = rng.uniform(-1, 1);
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - height * height);
  return {radius * std::cos(angle), height, radius * std::sin(angle)};
}

/// From around the surface towards its bounds.
inline Ray camera_ray(const AnySurface& surface, Rng& rng) {
  const Landmarks marks = surface.landmarks();
  const Vec3 o = marks.centre + 3 * norm(marks.half) * random_direction(rng);
  const Vec3 target =
      marks.centre + Vec3{rng.uniform(-1, 1) * marks.half.x, rng.uniform(-1, 1) * marks.half.y,
                          rng.uniform(-1, 1) * marks.half.z};
  return {o, normalized(target - o)};
}

/// Nearly horizontal, |d_y| from 1e-16 to 1e-2.
inline Ray flat_ray(const AnySurface& surface, Rng& rng) {
  Ray ray = camera_ray(surface, rng);
  const double steepness = std::pow(10.0, rng.uniform(-16, -2));
  ray.o.y = surface.landmarks().centre.y + rng.uniform(-1, 1) * surface.landmarks().half.y;
  ray.d.y = ray.d.x < 0 ? -steepness : steepness;
  return ray;
}

/// Along a tangent, 1e-16 to 1e-1 of the size beside it.
inline Ray graze_ray(const AnySurface& surface, Rng& rng) {
  const double u = rng.uniform();
  const SurfaceSample sample = surface.sample(u, rng.uniform());
  const double offset = std::pow(10.0, rng.uniform(-16, -1)) * (rng.uniform() < 0.5 ? -1 : 1);
  const Vec3 tangent = normalized(cross(sample.normal, random_direction(rng)));
  return {sample.point + offset * surface.size() * sample.normal - 2 * surface.size() * tangent, tangent};
}

inline std::vector<Ray> mixed_rays(const AnySurface& surface, std::size_t each, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < each; ++i) {
    rays.push_back(camera_ray(surface, rng));
    rays.push_back(flat_ray(surface, rng));
    rays.push_back(graze_ray(surface, rng));
  }
  return rays;
}

inline std::vector<Ray> camera_rays(const AnySurface& surface, std::size_t count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i) rays.push_back(camera_ray(surface, rng));
  return rays;
}

}  // namespace graze::test
