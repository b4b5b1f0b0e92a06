// What the bounding volume hierarchy saves: 10 000 transformed teardrops, culled and tested one by one, side
// by side in one run. Prints a table; ./dev bench culling runs it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <vector>

#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/intersector.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

constexpr std::size_t kSurfaces = 10000;
constexpr double kRoom = 300;  ///< half the side of the room: about every other ray meets a teardrop

Vec3 random_vector(Rng& rng) { return {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)}; }

Scene teardrops() {
  Rng rng(1);
  Scene scene;
  for (std::size_t i = 0; i < kSurfaces; ++i) {
    SurfaceSpec spec;
    spec.type = "teardrop";
    spec.parameters.set("s", rng.uniform(0.5, 1.5));
    spec.placement.translate = kRoom * random_vector(rng);
    for (Vec3& row : spec.placement.matrix) row = row + 0.3 * random_vector(rng);
    scene.add(find_surface("teardrop"), spec, find_solver("companion"));
  }
  return scene;
}

std::vector<Ray> rays(std::size_t count) {
  Rng rng(2);
  std::vector<Ray> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back({kRoom * random_vector(rng), random_vector(rng)});
  return all;
}

struct Measured {
  double ns_per_ray = 0;
  std::size_t hits = 0;
};

Measured ask(const Scene& scene, std::span<const Ray> rays, Query query) {
  Scene::Workspace work;
  HitBuffer hits;
  // Processor time: other programs on the machine count for neither side.
  const std::clock_t start = std::clock();
  scene.intersect(rays, query, {}, work, hits);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return {1e9 * seconds / static_cast<double>(rays.size()), hits.l.size()};
}

/// The median of `repeats` turns, culled and one by one in turn.
void compare(Scene& scene, const char* name, Query query) {
  constexpr int kRepeats = 9;
  // Testing all takes so long that it gets fewer rays a turn; both get the same ones first.
  const std::vector<Ray> many = rays(5000);
  const std::span<const Ray> few = std::span(many).first(50);
  std::vector<double> culled, all;
  std::size_t culled_hits = 0, all_hits = 0;
  for (int i = 0; i < kRepeats; ++i) {
    scene.set_culling(true);
    culled.push_back(ask(scene, many, query).ns_per_ray);
    culled_hits = ask(scene, few, query).hits;
    scene.set_culling(false);
    const Measured measured = ask(scene, few, query);
    all.push_back(measured.ns_per_ray);
    all_hits = measured.hits;
  }
  std::nth_element(culled.begin(), culled.begin() + kRepeats / 2, culled.end());
  std::nth_element(all.begin(), all.begin() + kRepeats / 2, all.end());
  const double a = culled[kRepeats / 2], b = all[kRepeats / 2];
  std::printf("%-6s %12.0f %14.0f %8.0f   %s\n", name, a, b, b / a,
              culled_hits == all_hits ? "the same hits" : "DIFFERENT HITS");
}

}  // namespace
}  // namespace graze

int main() {
  graze::Scene scene = graze::teardrops();
  std::printf("10000 transformed teardrops, companion; ns a ray, median of 9 interleaved turns\n");
  std::printf("%-6s %12s %14s %8s\n", "query", "culled", "testing all", "ratio");
  graze::compare(scene, "first", graze::Query::first);
  graze::compare(scene, "any", graze::Query::any);
  graze::compare(scene, "all", graze::Query::all);
}
