// Rays in, hits out: one cell (surface, formulation, solver) at a time, and scenes of several.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <graze/solvers/solver.hpp>
#include <graze/surfaces/hit.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

/// What a solver makes of a surface: a formulation and the form in which it is posed.
struct Pairing {
  std::size_t formulation = 0;
  Form form = Form::polynomial;
};

/// The pairing of a solver with a surface. An empty `formulation`: the first of the solver's forms, in its
/// order, that a formulation of the surface offers. Throws std::invalid_argument when there is none.
Pairing pair_up(const SolverEntry& solver, const SurfaceEntry& surface, std::string_view formulation = {});

/// Every pairing that exists, a formulation once (in the first of the solver's forms that it offers).
std::vector<Pairing> all_pairings(const SolverEntry& solver, const SurfaceEntry& surface);

/// One surface with the solver that answers for it. Immutable: shared by threads.
class Intersector {
 public:
  /// Entries come from the registry (find_surface, find_solver), or from surface_entry<S>(name) and
  /// solver_entry<S>(name) where a program needs one method only and links no registry. Throws
  /// std::invalid_argument for parameters, options or a formulation that do not exist or do not fit.
  Intersector(const SurfaceEntry& surface, const SurfaceSpec& spec, const SolverEntry& solver,
              const Parameters& solver_options = {}, std::string_view formulation = {});

  /// Memory for one thread, reused from batch to batch.
  class Workspace;

  /// Hits of at most Scene::kBlock rays with this surface, unsorted, in the workspace (local frame).
  void intersect(std::span<const Ray> rays, Workspace& work) const;

  [[nodiscard]] const Pairing& pairing() const { return pairing_; }
  [[nodiscard]] const FormulationInfo& formulation() const {
    return surface_->formulations()[pairing_.formulation];
  }
  [[nodiscard]] double size() const { return surface_->size(); }

 private:
  friend class Scene;
  void to_object_space(std::span<const Ray> rays, Workspace& work) const;
  void solve(Workspace& work) const;
  /// Normals (world) and parameters of hits that `intersect` left in the workspace, into work.points.
  void describe(std::span<const LocalHit> hits, Workspace& work) const;

  Pairing pairing_;
  bool certified_ = false;
  bool placed_ = false;
  Vec3 translate_;
  Mat3 to_object_;  ///< world to object, rounded: a placed surface's answers are certified in object space
  std::unique_ptr<AnySurface> surface_;
  std::unique_ptr<AnySolver> solver_;
};

/// A hit of the scene before it is written out.
struct SceneHit {
  double l = 0;
  std::uint32_t ray = 0;
  std::uint32_t surface = 0;
  LocalHit local;
};

/// Several surfaces, each with its solver.
class Scene {
 public:
  /// Memory for one thread.
  class Workspace;

  void add(Intersector intersector) { members_.push_back(std::move(intersector)); }
  [[nodiscard]] std::span<const Intersector> members() const { return members_; }

  /// Appends the answers of all rays to `out`, in order. Rays that are no question (not finite, no
  /// direction) get Status::invalid. Never throws for numbers; cost: one virtual call a stage, a surface and
  /// a block of kBlock rays.
  void intersect(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                 HitBuffer& out) const;

  static constexpr std::size_t kBlock = 256;  ///< the working set of a block stays in the L2 cache

 private:
  void answer_block(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                    HitBuffer& out) const;

  static void collect(std::uint32_t surface, Intersector::Workspace& member, std::vector<SceneHit>& hits);
  static void merge_equal(std::vector<SceneHit>& hits);
  static void keep_first(std::vector<SceneHit>& hits);
  void write_out(std::span<const Ray> rays, Wanted wanted, Workspace& work, HitBuffer& out) const;
  void describe(Wanted wanted, std::size_t first, Workspace& work, HitBuffer& out) const;

  std::vector<Intersector> members_;
};

/// See Intersector::Workspace. One block of rays on its way through one surface.
class Intersector::Workspace {
 public:
  std::vector<Ray> object_rays;
  std::vector<LocalRay> local;
  std::array<bool, Scene::kBlock> inside{};
  EquationBlock equations;
  std::vector<Roots> roots;
  std::vector<LocalHit> hits;
  std::vector<LocalPoint> points;
  std::vector<Status> status;
  std::vector<Counters> counters;
};

class Scene::Workspace {
 public:
  std::vector<Intersector::Workspace> members;
  std::vector<SceneHit> hits;
  std::vector<LocalHit> of_surface;
};

}  // namespace graze
