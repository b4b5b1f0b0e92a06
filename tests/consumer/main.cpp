// Where does a ray along x meet the teardrop? By hand: l = 25/8 and 55/8, both exact in double.
#include <cstdio>
#include <graze/solvers/companion.hpp>
#include <graze/surfaces/intersector.hpp>
#include <graze/surfaces/teardrop.hpp>
#include <vector>

int main() {
  graze::SurfaceSpec spec;
  spec.type = "teardrop";
  spec.parameters.set("s", 1.0);

  graze::Scene scene;
  scene.add(graze::surface_entry<graze::Teardrop>("teardrop"), spec,
            graze::solver_entry<graze::Companion>("companion"));

  const std::vector<graze::Ray> rays{{.o = {-5, 1.5, 0}, .d = {1, 0, 0}}};
  graze::Scene::Workspace work;
  graze::HitBuffer hits;
  scene.intersect(rays, graze::Query::all, {}, work, hits);

  for (std::size_t i = hits.begin(0); i < hits.end(0); ++i) std::printf("l = %.17g\n", hits.l[i]);
  return hits.count(0) == 2 ? 0 : 1;
}
