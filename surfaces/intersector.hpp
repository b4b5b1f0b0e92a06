// Rays in, hits out: surfaces with the solvers that answer for them, and scenes of many.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <graze/solvers/solver.hpp>
#include <graze/surfaces/bvh.hpp>
#include <graze/surfaces/hit.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

/// What a solver makes of a surface: a formulation, the form in which it is posed, and in which arithmetic.
struct Pairing {
  std::size_t formulation = 0;
  Form form = Form::polynomial;
  Precision precision = Precision::binary64;

  friend bool operator==(const Pairing&, const Pairing&) = default;
};

/// The pairing of a solver with a surface. An empty `formulation`: the first of the solver's forms, in its
/// order, that a formulation of the surface offers. Throws std::invalid_argument when there is none.
Pairing pair_up(const SolverEntry& solver, const SurfaceEntry& surface, std::string_view formulation = {},
                Precision precision = Precision::binary64);

/// Every pairing that exists, a formulation once (in the first of the solver's forms that it offers).
std::vector<Pairing> all_pairings(const SolverEntry& solver, const SurfaceEntry& surface,
                                  Precision precision = Precision::binary64);

/// How a solver is to answer for a surface.
struct Method {
  Parameters options;       ///< of the solver
  std::string formulation;  ///< empty: see pair_up
  Precision precision = Precision::binary64;
};

/// Which ray of a block goes to which surface of an Intersector.
struct Task {
  std::uint32_t ray = 0;
  std::uint32_t surface = 0;
};

/// Surfaces of one type, posed in one formulation, with the solver that answers for them: a batch of rays
/// goes to all of them at once.
class Intersector {
 public:
  /// Entries come from the registry (find_surface, find_solver), or from surface_entry<S>(name) and
  /// solver_entry<S>(name) where a program needs one method only and links no registry. Throws
  /// std::invalid_argument for options or a formulation that do not exist or do not fit.
  Intersector(const SurfaceEntry& surface, const SolverEntry& solver, const Method& method);

  /// Adds a surface and returns its number here; throws std::invalid_argument for bad parameters.
  std::size_t add(const SurfaceEntry& entry, const SurfaceSpec& spec);

  /// Whether surfaces of this type, solver and method belong here.
  [[nodiscard]] bool serves(const SurfaceEntry& surface, const SolverEntry& solver,
                            const Method& method) const;

  /// Memory for one thread, reused from batch to batch.
  class Workspace;

  /// Hits of at most kBlock tasks, unsorted, in the workspace: the kernel's as they are (kernel_hits), the
  /// others in local frames (hits). Without `all` a kernel looks for the first hit only.
  void intersect(std::span<const Ray> rays, std::span<const Task> tasks, bool all, Workspace& work) const;
  /// The same by equations alone, for tasks that the kernel left: hits, status and counters of work.solved.
  void solve_tasks(std::span<const Ray> rays, std::span<const Task> tasks, Workspace& work) const;
  /// Normals (world) and parameters of hits, one task a hit (hits[i].ray = i), into work.points.
  void describe(std::span<const Ray> rays, std::span<const Task> tasks, std::span<LocalHit> hits,
                Workspace& work) const;

  [[nodiscard]] const Pairing& pairing() const { return pairing_; }
  [[nodiscard]] const AnyGroup& group() const { return *group_; }
  /// The surface's own batch kernel for this cell; null if it has none.
  [[nodiscard]] const AnyKernel* kernel() const { return kernel_.get(); }
  [[nodiscard]] bool is_placed(std::size_t surface) const { return frames_[surface].is_placed; }
  [[nodiscard]] Bounds bounds(std::size_t surface) const {
    return placed(group_->bounds(surface), frames_[surface].placement);
  }

  static constexpr std::size_t kBlock = 256;  ///< the working set of a block stays in the L2 cache

 private:
  void to_object(std::span<const Ray> rays, std::span<const Task> tasks, Workspace& work) const;
  void localize(std::span<const Ray> rays, std::span<const Task> tasks, Workspace& work) const;
  void run_kernel(std::span<const Ray> rays, std::span<const Task> tasks, bool all, Workspace& work) const;
  void solve(Workspace& work) const;
  template <class Equation>
  void solve_all(Workspace& work) const;

  struct Frame {
    bool is_placed = false;
    Placement placement;
    Mat3 to_object;  ///< world to object, rounded: a placed surface's answers are certified in object space
  };

  std::string surface_name_, solver_name_;
  Parameters options_;
  Pairing pairing_;
  bool certified_ = false;
  Digits digits_ = Digits::rounded;
  std::unique_ptr<AnyGroup> group_;
  std::unique_ptr<AnySolver> solver_;
  std::unique_ptr<AnyKernel> kernel_;
  std::vector<Frame> frames_;
};

/// A hit that a kernel proved.
struct KernelHit {
  std::uint32_t task = 0;
  std::uint32_t multiplicity = 1;
  double l = 0;
};

/// A hit of the scene before it is written out.
struct SceneHit {
  double l = 0;
  std::uint32_t ray = 0;
  std::uint32_t surface = 0;
  LocalHit local;
};

/// Many surfaces, each with its solver. Surfaces of one type, formulation, solver and arithmetic share an
/// Intersector; a bounding volume hierarchy finds which of them a ray may meet, front to back for `first`
/// and `any`. Rays of one block go in step, so that every Intersector sees batches.
class Scene {
 public:
  /// Memory for one thread.
  class Workspace;

  /// Adds a surface; its number is that of the surfaces before it. Throws std::invalid_argument for
  /// parameters, options or a formulation that do not exist or do not fit.
  void add(const SurfaceEntry& surface, const SurfaceSpec& spec, const SolverEntry& solver,
           const Method& method = {});
  [[nodiscard]] std::size_t size() const { return members_.size(); }
  [[nodiscard]] const Pairing& pairing(std::size_t surface) const { return intersector(surface).pairing(); }
  [[nodiscard]] std::string_view variety(std::size_t surface) const {
    return intersector(surface).group().variety(members_[surface].number);
  }

  /// Without culling every ray is tested against every surface: the same hits, for comparison.
  void set_culling(bool on) { culling_ = on; }

  /// Appends the answers of all rays to `out`, in order. Rays that are no question (not finite, no
  /// direction) get Status::invalid. A ray's status is the gravest among the surfaces it was tested against:
  /// for `first` and `any`, those that may lie before the reported hit. Never throws for numbers.
  void intersect(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                 HitBuffer& out) const;

  static constexpr std::size_t kBlock = Intersector::kBlock;

 private:
  /// Hard rays are few: kernels gather them from many.
  static constexpr std::size_t kKernelBlock = 16 * kBlock;

  struct Member {
    std::size_t intersector = 0;
    std::size_t number = 0;  ///< in the intersector
    Bounds bounds;           ///< world space
  };
  /// Which surfaces a ray may meet: a tree of those with bounds, a list of the others.
  struct Culling {
    std::once_flag once;
    Bvh tree;
    std::vector<std::uint32_t> in_tree;  ///< surface of each of the tree's boxes
    std::vector<std::uint32_t> always;
  };

  [[nodiscard]] const Intersector& intersector(std::size_t surface) const {
    return intersectors_[members_[surface].intersector];
  }
  [[nodiscard]] const Culling& culling() const;
  [[nodiscard]] const AnyKernel* lone_kernel(Wanted wanted) const;
  void answer_block(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                    HitBuffer& out) const;
  void answer_by_kernel(const AnyKernel& kernel, std::span<const Ray> rays, Workspace& work,
                        HitBuffer& out) const;
  void complete_answers(const KernelAnswers& answers, std::span<const Ray> rays, Workspace& work,
                        HitBuffer& out) const;
  void collect(std::size_t intersector, std::span<const Task> tasks, Workspace& work) const;
  void sort_hits(Workspace& work) const;
  void ask_always(std::span<const Ray> rays, Workspace& work) const;
  void ask_all(std::span<const Ray> rays, Workspace& work) const;
  void ask_in_front(std::span<const Ray> rays, Query query, Workspace& work) const;
  void add_task(std::span<const Ray> rays, std::uint32_t ray, std::uint32_t surface, Workspace& work) const;
  void flush(std::span<const Ray> rays, Workspace& work) const;
  void run(std::size_t intersector, std::span<const Ray> rays, Workspace& work) const;
  void write_out(std::span<const Ray> rays, Wanted wanted, Workspace& work, HitBuffer& out) const;
  void describe(std::span<const Ray> rays, Wanted wanted, std::size_t first, Workspace& work,
                HitBuffer& out) const;

  std::vector<Intersector> intersectors_;
  std::vector<std::vector<std::uint32_t>> surface_of_;  ///< by intersector and number: the scene's index
  std::vector<Member> members_;
  bool culling_ = true;
  std::unique_ptr<Culling> lazy_culling_ = std::make_unique<Culling>();
};

/// One block of tasks on its way through one Intersector.
class Intersector::Workspace {
 public:
  std::vector<Ray> object_rays;
  std::vector<std::uint32_t> numbers;
  std::vector<LocalRay> local;
  std::array<bool, kBlock> inside{};
  EquationBlock equations;
  std::vector<Roots> roots;
  std::vector<LocalHit> hits;
  std::vector<KernelHit> kernel_hits;
  std::vector<LocalPoint> points;
  std::span<const Task> solved;    ///< tasks that were posed as equations: hits[i].ray is one of these
  std::vector<Status> status;      ///< of solved tasks
  std::vector<Counters> counters;  ///< of solved tasks
  KernelAnswers kernel;
  std::vector<Task> open;        ///< tasks that the kernel left
  std::vector<Task> coincident;  ///< tasks whose rays it proved to run inside their surfaces
};

class Scene::Workspace {
 public:
  Query query = Query::all;
  Intersector::Workspace block;
  std::vector<std::vector<Task>> tasks;  ///< by intersector: not yet asked
  std::vector<SceneHit> hits;
  std::vector<double> nearest;  ///< l of the nearest hit so far, by ray
  std::vector<Status> status;
  std::vector<Counters> counters;
  std::vector<Bvh::Walk> walks;
  std::vector<std::uint32_t> active, leaf;
  std::vector<LocalHit> described;
  std::vector<std::size_t> places;
  std::vector<Counters> first_tier;  ///< of a block of rays that its kernel's first tier answered
};

}  // namespace graze
