#include <graze/surfaces/intersector.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <tuple>

#include <graze/solvers/math/double_double.hpp>

namespace graze {
namespace {

bool offers(const FormulationInfo& formulation, Form form) {
  return std::find(formulation.forms.begin(), formulation.forms.end(), form) != formulation.forms.end();
}

/// Whether the solver takes this formulation in this form and arithmetic. A pairing is made before there is
/// a surface: see why_limited.
bool fits(const SolverEntry& solver, const FormulationInfo& formulation, Form form, Precision precision) {
  if (!offers(formulation, form) || !solver.takes(form, precision)) return false;
  // A degree that depends on the surface is none that a solver of limited degree can rely on.
  const int limit = solver.info.max_degree;
  return form != Form::polynomial || limit == 0 || (0 < formulation.degree && formulation.degree <= limit);
}

/// The first of the solver's forms that fits the formulation.
std::optional<Form> common_form(const SolverEntry& solver, const FormulationInfo& formulation,
                                Precision precision) {
  for (const Form form : solver.info.forms) {
    if (fits(solver, formulation, form, precision)) return form;
  }
  return std::nullopt;
}

/// The surface's kernel for the solver; kernels compute in double.
const KernelEntry* kernel_for(const SolverEntry& solver, const SurfaceEntry& surface, Precision precision) {
  if (precision != Precision::binary64) return nullptr;
  for (const KernelEntry& kernel : surface.kernels) {
    if (kernel.solver == solver.name) return &kernel;
  }
  return nullptr;
}

std::size_t find_formulation(const SurfaceEntry& surface, std::string_view name) {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < surface.formulations.size(); ++i) {
    if (surface.formulations[i].name == name) return i;
    known.push_back(surface.formulations[i].name);
  }
  throw std::invalid_argument(
      unknown_name_message("formulation of " + std::string(surface.name), name, known));
}

/// Inverse by the adjugate, on the matrix scaled by a power of two so that nothing over- or underflows.
Mat3 inverse(const Mat3& matrix) {
  const double size = std::max({max_abs(matrix[0]), max_abs(matrix[1]), max_abs(matrix[2])});
  const int k = exponent_of(size);
  Mat3 m = matrix;
  for (Vec3& row : m) row = scale_by_power(row, -k);
  const Mat3 adjugate = transpose({cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])});
  const double determinant = dot(m[0], cross(m[1], m[2]));
  Mat3 result = adjugate;
  for (Vec3& row : result) {
    row = scale_by_power(Vec3{row.x / determinant, row.y / determinant, row.z / determinant}, -k);
  }
  return result;
}

/// The graver of two: invalid, coincident, failed, uncertain, ok.
Status worse(Status a, Status b) { return std::max(a, b); }
static_assert(Status::ok < Status::uncertain && Status::uncertain < Status::failed &&
              Status::failed < Status::coincident && Status::coincident < Status::invalid);

/// What a solver of limited degree may be refused for.
std::string why_limited(const SolverEntry& solver) {
  if (solver.info.max_degree == 0) return "";
  return "; it takes polynomials up to degree " + std::to_string(solver.info.max_degree) +
         ", and none whose degree depends on the surface";
}

std::string in_float(Precision precision) { return precision == Precision::binary32 ? " in float" : ""; }

/// Hits of one surface at one l are one hit, unless the surface knows better: then they get neighbouring
/// doubles.
void merge_equal(std::vector<SceneHit>& hits) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    SceneHit* const last = kept > 0 ? &hits[kept - 1] : nullptr;
    if (last != nullptr && last->ray == hits[i].ray && last->l == hits[i].l &&
        last->surface == hits[i].surface) {
      if (last->local.is_apart && hits[i].local.is_apart) {
        // The one that is nearer to its neighbouring double moves there: both stay within an ulp.
        const bool down = hits[i].local.side < 0;
        double& moved = down ? last->l : hits[i].l;
        moved = std::nextafter(moved, down ? 0 : std::numeric_limits<double>::infinity());
        hits[kept++] = hits[i];
      } else {
        last->local.multiplicity += hits[i].local.multiplicity;
      }
    } else {
      hits[kept++] = hits[i];
    }
  }
  hits.resize(kept);
}

void keep_first(std::vector<SceneHit>& hits) {
  const auto same_ray = [](const SceneHit& a, const SceneHit& b) { return a.ray == b.ray; };
  hits.erase(std::unique(hits.begin(), hits.end(), same_ray), hits.end());
}

}  // namespace

Pairing pair_up(const SolverEntry& solver, const SurfaceEntry& surface, std::string_view formulation,
                Precision precision) {
  if (!formulation.empty()) {
    const std::size_t index = find_formulation(surface, formulation);
    if (const auto form = common_form(solver, surface.formulations[index], precision))
      return {index, *form, precision};
    throw std::invalid_argument("solver '" + std::string(solver.name) + "' takes no form of formulation '" +
                                std::string(formulation) + "'" + in_float(precision) + why_limited(solver) +
                                " (see graze list)");
  }
  if (const KernelEntry* const kernel = kernel_for(solver, surface, precision))
    return pair_up(solver, surface, kernel->formulation, precision);
  for (std::size_t i = 0; solver.info.trusts_surface && i < surface.formulations.size(); ++i) {
    if (const auto form = common_form(solver, surface.formulations[i], precision))
      return {i, *form, precision};
  }
  for (const Form form : solver.info.forms) {
    for (std::size_t i = 0; i < surface.formulations.size(); ++i) {
      if (fits(solver, surface.formulations[i], form, precision)) return {i, form, precision};
    }
  }
  throw std::invalid_argument("solver '" + std::string(solver.name) + "' takes no form that surface '" +
                              std::string(surface.name) + "' offers" + in_float(precision) +
                              why_limited(solver) + " (see graze list)");
}

std::vector<Pairing> all_pairings(const SolverEntry& solver, const SurfaceEntry& surface,
                                  Precision precision) {
  std::vector<Pairing> pairings;
  for (std::size_t i = 0; i < surface.formulations.size(); ++i) {
    if (const auto form = common_form(solver, surface.formulations[i], precision))
      pairings.push_back({i, *form, precision});
  }
  return pairings;
}

// --------------------------------------------------------------------------------------------- intersector

Intersector::Intersector(const SurfaceEntry& surface, const SolverEntry& solver, const Method& method)
    : surface_name_(surface.name),
      solver_name_(solver.name),
      options_(method.options),
      pairing_(pair_up(solver, surface, method.formulation, method.precision)),
      certified_(solver.info.claims.certified && !surface.formulations[pairing_.formulation].is_plain),
      digits_(solver.info.digits),
      group_(surface.make_group(pairing_.formulation)),
      solver_(solver.make(method.options)) {
  const KernelEntry* const kernel = kernel_for(solver, surface, pairing_.precision);
  if (kernel != nullptr && kernel->formulation == surface.formulations[pairing_.formulation].name)
    kernel_ = kernel->make(method.options);
}

std::size_t Intersector::add(const SurfaceEntry& entry, const SurfaceSpec& spec) {
  check_names(spec, entry.name, entry.info);
  group_->add(spec);
  if (kernel_ != nullptr) kernel_->add(spec);
  frames_.push_back({!spec.placement.is_identity(), spec.placement, inverse(spec.placement.matrix)});
  return frames_.size() - 1;
}

bool Intersector::serves(const SurfaceEntry& surface, const SolverEntry& solver, const Method& method) const {
  return surface.name == surface_name_ && solver.name == solver_name_ &&
         method.options.values() == options_.values() &&
         pair_up(solver, surface, method.formulation, method.precision) == pairing_;
}

void Intersector::intersect(std::span<const Ray> rays, std::span<const Task> tasks, bool all,
                            Workspace& work) const {
  work.kernel_hits.clear();
  work.coincident.clear();
  if (kernel_ == nullptr) return solve_tasks(rays, tasks, work);
  run_kernel(rays, tasks, all, work);
  solve_tasks(rays, work.open, work);
}

/// Answers what the kernel can prove; the rest is left in work.open.
void Intersector::run_kernel(std::span<const Ray> rays, std::span<const Task> tasks, bool all,
                             Workspace& work) const {
  to_object(rays, tasks, work);
  kernel_->intersect(work.object_rays, work.numbers, all, work.kernel);
  work.open.clear();
  for (std::uint32_t i = 0; i < tasks.size(); ++i) {
    if (work.kernel.hits[i] == KernelAnswers::kOpen) work.open.push_back(tasks[i]);
    if (work.kernel.hits[i] == KernelAnswers::kCoincident) work.coincident.push_back(tasks[i]);
    for (int k = 0; k < work.kernel.hits[i]; ++k) {
      work.kernel_hits.push_back(
          {i, work.kernel.multiplicity(i, k), work.kernel.l[static_cast<std::size_t>(k)][i]});
    }
  }
}

void Intersector::solve_tasks(std::span<const Ray> rays, std::span<const Task> tasks, Workspace& work) const {
  work.hits.clear();
  work.solved = tasks;
  work.status.assign(tasks.size(), Status::ok);
  work.counters.assign(tasks.size(), {});
  if (tasks.empty()) return;
  localize(rays, tasks, work);
  const std::span<bool> inside{work.inside.data(), tasks.size()};
  work.equations.reset(pairing_.form, pairing_.precision, certified_, digits_);
  group_->pose(work.local, inside, work.equations);
  solve(work);

  for (const auto& [task, status] : work.equations.settled())
    work.status[task] = worse(work.status[task], status);
  for (const auto& [task, tests] : work.equations.tests()) work.counters[task].tests += tests;
  const std::size_t count = work.equations.posed().size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t task = work.equations.posed()[i].ray;
    work.status[task] = worse(work.status[task], work.roots[i].status);
    work.counters[task] += work.roots[i].counters;
  }
  group_->lift(work.local, work.equations, {work.roots.data(), count}, work.hits);
}

/// The tasks' rays in the object space of their surfaces.
void Intersector::to_object(std::span<const Ray> rays, std::span<const Task> tasks, Workspace& work) const {
  work.object_rays.resize(tasks.size());
  work.numbers.resize(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const Ray& ray = rays[tasks[i].ray];
    const Frame& frame = frames_[tasks[i].surface];
    work.numbers[i] = tasks[i].surface;
    work.object_rays[i] =
        frame.is_placed ? Ray{frame.to_object * (ray.o - frame.placement.translate), frame.to_object * ray.d}
                        : ray;
  }
}

void Intersector::localize(std::span<const Ray> rays, std::span<const Task> tasks, Workspace& work) const {
  to_object(rays, tasks, work);
  work.local.resize(tasks.size());
  group_->localize(work.object_rays, work.numbers, work.local, {work.inside.data(), tasks.size()});
}

template <class Equation>
void Intersector::solve_all(Workspace& work) const {
  const std::span<const Equation> equations = work.equations.of<Equation>();
  if (work.roots.size() < equations.size()) work.roots.resize(equations.size());
  solver_->solve(equations, {work.roots.data(), equations.size()});
}

void Intersector::solve(Workspace& work) const {
  const bool wide = pairing_.precision == Precision::binary64;
  switch (pairing_.form) {
    case Form::polynomial:
      return wide ? solve_all<PolynomialEquation>(work) : solve_all<BasicPolynomialEquation<float>>(work);
    case Form::scalar:
      return wide ? solve_all<ScalarEquation>(work) : solve_all<BasicScalarEquation<float>>(work);
    case Form::interval:
      return solve_all<IntervalEquation>(work);
    case Form::system:
      return wide ? solve_all<SystemEquation>(work) : solve_all<BasicSystemEquation<float>>(work);
  }
}

void Intersector::describe(std::span<const Ray> rays, std::span<const Task> tasks, std::span<LocalHit> hits,
                           Workspace& work) const {
  localize(rays, tasks, work);
  group_->place(work.local, hits);
  work.points.clear();
  group_->describe(work.local, hits, work.points);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const Frame& frame = frames_[tasks[i].surface];
    LocalPoint& point = work.points[i];
    if (point.is_singular) {
      point.normal = -normalized(rays[tasks[i].ray].d);
    } else if (frame.is_placed) {
      point.normal = normalized(transpose(frame.to_object) * point.normal);
    }
  }
}

// --------------------------------------------------------------------------------------------------- scene

void Scene::add(const SurfaceEntry& surface, const SurfaceSpec& spec, const SolverEntry& solver,
                const Method& method) {
  const auto found = std::find_if(
      intersectors_.begin(), intersectors_.end(),
      [&](const Intersector& intersector) { return intersector.serves(surface, solver, method); });
  const auto index = static_cast<std::size_t>(found - intersectors_.begin());
  if (found == intersectors_.end()) {
    Intersector fresh(surface, solver, method);
    fresh.add(surface, spec);
    intersectors_.push_back(std::move(fresh));
    surface_of_.emplace_back();
  } else {
    found->add(surface, spec);
  }
  const std::size_t number = surface_of_[index].size();
  surface_of_[index].push_back(static_cast<std::uint32_t>(members_.size()));
  members_.push_back({index, number, intersectors_[index].bounds(number)});
  lazy_culling_ = std::make_unique<Culling>();
}

const Scene::Culling& Scene::culling() const {
  Culling& culling = *lazy_culling_;
  std::call_once(culling.once, [&] {
    // A tree of one box would only repeat the test that the surface makes itself.
    constexpr std::size_t kFewest = 2;
    std::vector<Bounds> boxes;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const bool bounded = members_[i].bounds.is_finite();
      (bounded ? culling.in_tree : culling.always).push_back(static_cast<std::uint32_t>(i));
      if (bounded) boxes.push_back(members_[i].bounds);
    }
    if (boxes.size() < kFewest) {
      culling.always.insert(culling.always.end(), culling.in_tree.begin(), culling.in_tree.end());
      culling.in_tree.clear();
    } else {
      culling.tree = Bvh(boxes);
    }
  });
  return culling;
}

void Scene::intersect(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                      HitBuffer& out) const {
  work.tasks.resize(intersectors_.size());
  work.query = query;
  const AnyKernel* const kernel = lone_kernel(wanted);
  const std::size_t size = kernel != nullptr ? kKernelBlock : kBlock;
  for (std::size_t i = 0; i < rays.size(); i += size) {
    const std::span<const Ray> block = rays.subspan(i, std::min(size, rays.size() - i));
    if (kernel != nullptr) {
      answer_by_kernel(*kernel, block, work, out);
    } else {
      answer_block(block, query, wanted, work, out);
    }
  }
}

/// The kernel of a scene of one surface, where nothing but l is asked for: its answers are the scene's.
const AnyKernel* Scene::lone_kernel(Wanted wanted) const {
  const bool is_plain = !wanted.points && !wanted.normals && !wanted.params;
  if (!is_plain || members_.size() != 1 || intersectors_.front().is_placed(0)) return nullptr;
  return intersectors_.front().kernel();
}

void Scene::answer_by_kernel(const AnyKernel& kernel, std::span<const Ray> rays, Workspace& work,
                             HitBuffer& out) const {
  KernelAnswers& answers = work.block.kernel;
  kernel.intersect(rays, work.query == Query::all, answers);
  const KernelAnswers::Extremes extremes = answers.extremes();
  if (extremes.fewest >= 0) {
    work.first_tier.resize(kKernelBlock, {.tier = 1});
    append_answers(answers, extremes, work.first_tier, out);
  } else {
    complete_answers(answers, rays, work, out);
  }
}

/// The rays that the kernel left are asked of the solver; the answers of both in the order of the rays.
void Scene::complete_answers(const KernelAnswers& answers, std::span<const Ray> rays, Workspace& work,
                             HitBuffer& out) const {
  work.hits.clear();
  work.status.assign(rays.size(), Status::ok);
  work.counters.assign(rays.size(), {});
  work.nearest.assign(rays.size(), std::numeric_limits<double>::infinity());
  std::vector<Task>& open = work.block.open;
  open.clear();
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    if (answers.hits[i] == KernelAnswers::kCoincident) work.status[i] = Status::coincident;
    if (answers.hits[i] != KernelAnswers::kOpen) continue;
    if (is_valid(rays[i])) {
      open.push_back({i, 0});
    } else {
      work.status[i] = Status::invalid;
    }
  }
  work.block.kernel_hits.clear();
  work.block.coincident.clear();
  for (std::size_t i = 0; i < open.size(); i += kBlock) {
    const std::span<const Task> tasks = std::span(open).subspan(i, std::min(kBlock, open.size() - i));
    intersectors_.front().solve_tasks(rays, tasks, work.block);
    collect(0, tasks, work);
  }
  sort_hits(work);
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    work.counters[i].tier = std::max<std::uint32_t>(work.counters[i].tier, answers.tier[i]);
    for (int k = 0; k < answers.hits[i]; ++k) {
      out.append(answers.l[static_cast<std::size_t>(k)][i], 0, answers.multiplicity(i, k));
    }
    for (; next < work.hits.size() && work.hits[next].ray == i; ++next)
      out.append(work.hits[next].l, 0, work.hits[next].local.multiplicity);
    out.close_ray(work.status[i], work.counters[i]);
  }
}

/// In the order of rays and l, what one surface meets at one l joined; without `all`, the first of each ray.
void Scene::sort_hits(Workspace& work) const {
  // Stable: of two hits at one l the surface's own order stands, as a solid's entry before its exit.
  std::stable_sort(work.hits.begin(), work.hits.end(), [](const SceneHit& a, const SceneHit& b) {
    return std::tie(a.ray, a.l, a.surface) < std::tie(b.ray, b.l, b.surface);
  });
  merge_equal(work.hits);
  if (work.query != Query::all) keep_first(work.hits);
}

void Scene::answer_block(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                         HitBuffer& out) const {
  work.hits.clear();
  work.status.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i)
    work.status[i] = is_valid(rays[i]) ? Status::ok : Status::invalid;
  work.counters.assign(rays.size(), {});
  work.nearest.assign(rays.size(), std::numeric_limits<double>::infinity());
  ask_always(rays, work);
  if (culling_ && query == Query::all) ask_all(rays, work);
  if (culling_ && query != Query::all) ask_in_front(rays, query, work);
  sort_hits(work);
  write_out(rays, wanted, work, out);
}

/// Surfaces without bounds, or all of them without culling.
void Scene::ask_always(std::span<const Ray> rays, Workspace& work) const {
  const auto ask = [&](std::uint32_t surface) {
    for (std::uint32_t ray = 0; ray < rays.size(); ++ray) add_task(rays, ray, surface, work);
  };
  if (culling_) {
    for (const std::uint32_t surface : culling().always) ask(surface);
  } else {
    for (std::uint32_t surface = 0; surface < members_.size(); ++surface) ask(surface);
  }
  flush(rays, work);
}

/// Every surface whose box a ray meets.
void Scene::ask_all(std::span<const Ray> rays, Workspace& work) const {
  const Culling& boxes = culling();
  if (boxes.tree.empty()) return;
  work.walks.resize(1);
  for (std::uint32_t ray = 0; ray < rays.size(); ++ray) {
    if (work.status[ray] == Status::invalid) continue;
    work.walks[0].start(boxes.tree, rays[ray]);
    while (work.walks[0].next(boxes.tree, std::numeric_limits<double>::infinity(), work.leaf)) {
      for (const std::uint32_t box : work.leaf) add_task(rays, ray, boxes.in_tree[box], work);
    }
  }
  flush(rays, work);
}

/// Front to back: every ray asks the nearest leaf that it has not asked yet, until no box begins before its
/// nearest hit (`any`: until it has a hit).
void Scene::ask_in_front(std::span<const Ray> rays, Query query, Workspace& work) const {
  const Culling& boxes = culling();
  if (boxes.tree.empty()) return;
  if (work.walks.size() < rays.size()) work.walks.resize(rays.size());
  work.active.clear();
  for (std::uint32_t ray = 0; ray < rays.size(); ++ray) {
    if (work.status[ray] == Status::invalid) continue;
    work.walks[ray].start(boxes.tree, rays[ray]);
    work.active.push_back(ray);
  }
  const auto is_done = [&](std::uint32_t ray) {
    if (query == Query::any && std::isfinite(work.nearest[ray])) return true;
    if (!work.walks[ray].next(boxes.tree, work.nearest[ray], work.leaf)) return true;
    for (const std::uint32_t box : work.leaf) add_task(rays, ray, boxes.in_tree[box], work);
    return false;
  };
  while (!work.active.empty()) {
    work.active.erase(std::remove_if(work.active.begin(), work.active.end(), is_done), work.active.end());
    flush(rays, work);
  }
}

void Scene::add_task(std::span<const Ray> rays, std::uint32_t ray, std::uint32_t surface,
                     Workspace& work) const {
  if (work.status[ray] == Status::invalid) return;
  const Member& member = members_[surface];
  std::vector<Task>& tasks = work.tasks[member.intersector];
  tasks.push_back({ray, static_cast<std::uint32_t>(member.number)});
  if (tasks.size() == kBlock) run(member.intersector, rays, work);
}

void Scene::flush(std::span<const Ray> rays, Workspace& work) const {
  for (std::size_t i = 0; i < intersectors_.size(); ++i) {
    if (!work.tasks[i].empty()) run(i, rays, work);
  }
}

/// Asks one intersector its pending tasks and collects the hits.
void Scene::run(std::size_t index, std::span<const Ray> rays, Workspace& work) const {
  std::vector<Task>& tasks = work.tasks[index];
  intersectors_[index].intersect(rays, tasks, work.query == Query::all, work.block);
  collect(index, tasks, work);
  tasks.clear();
}

/// The block's hits as hits of the scene; `tasks` are those that the kernel was asked.
void Scene::collect(std::size_t index, std::span<const Task> tasks, Workspace& work) const {
  const Intersector::Workspace& block = work.block;
  for (std::size_t i = 0; i < block.solved.size(); ++i) {
    const std::uint32_t ray = block.solved[i].ray;
    work.status[ray] = worse(work.status[ray], block.status[i]);
    work.counters[ray] += block.counters[i];
  }
  const auto add = [&](double l, Task task, const LocalHit& hit) {
    if (!(l > 0 && std::isfinite(l))) return;
    work.hits.push_back({l, task.ray, surface_of_[index][task.surface], hit});
    work.nearest[task.ray] = std::min(work.nearest[task.ray], l);
  };
  for (const LocalHit& hit : block.hits) {
    const Task task = block.solved[hit.ray];
    if (hit.in_doubt) {  // proved to be a hit of the line, but not where on the ray
      work.status[task.ray] = worse(work.status[task.ray], Status::uncertain);
      continue;
    }
    const LocalRay& local = block.local[hit.ray];
    const DoubleDouble wide = two_sum(local.centre, hit.delta);
    const double own = hit.tail == 0 ? wide.hi : wide.hi + (wide.lo + hit.tail);
    const double l = scale_by_power(own, local.l_exponent);
    // A hit whose l is no double is not reported, nor passed over.
    if (own > 0 && std::isfinite(own) && (l == 0 || std::isinf(l)))
      work.status[task.ray] = worse(work.status[task.ray], Status::uncertain);
    add(l, task, hit);
  }
  for (const Task& task : block.coincident)
    work.status[task.ray] = worse(work.status[task.ray], Status::coincident);
  for (const KernelHit& hit : block.kernel_hits)
    add(hit.l, tasks[hit.task], {.multiplicity = hit.multiplicity, .delta = hit.l, .is_world = true});
}

void Scene::write_out(std::span<const Ray> rays, Wanted wanted, Workspace& work, HitBuffer& out) const {
  const std::size_t first = out.l.size();
  std::size_t next = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    for (; next < work.hits.size() && work.hits[next].ray == i; ++next) {
      const SceneHit& hit = work.hits[next];
      out.append(hit.l, hit.surface, hit.local.multiplicity);
      if (!wanted.points) continue;
      out.point.push_back({std::fma(hit.l, ray.d.x, ray.o.x), std::fma(hit.l, ray.d.y, ray.o.y),
                           std::fma(hit.l, ray.d.z, ray.o.z)});
    }
    out.close_ray(work.status[i], work.counters[i]);
  }
  if (wanted.normals || wanted.params) describe(rays, wanted, first, work, out);
}

/// Normals and parameters of the hits that are reported: their rays are brought to local frames once more.
void Scene::describe(std::span<const Ray> rays, Wanted wanted, std::size_t first, Workspace& work,
                     HitBuffer& out) const {
  if (wanted.normals) out.normal.resize(out.l.size());
  if (wanted.params) out.params.resize(out.l.size());
  for (std::size_t index = 0; index < intersectors_.size(); ++index) {
    std::vector<Task>& tasks = work.tasks[index];
    const auto finish = [&] {
      intersectors_[index].describe(rays, tasks, work.described, work.block);
      for (std::size_t i = 0; i < tasks.size(); ++i) {
        if (wanted.normals) out.normal[first + work.places[i]] = work.block.points[i].normal;
        if (wanted.params) out.params[first + work.places[i]] = work.block.points[i].params;
      }
      tasks.clear();
      work.described.clear();
      work.places.clear();
    };
    for (std::size_t i = 0; i < work.hits.size(); ++i) {
      const SceneHit& hit = work.hits[i];
      const Member& member = members_[hit.surface];
      if (member.intersector != index) continue;
      work.described.push_back(hit.local);
      work.described.back().ray = static_cast<std::uint32_t>(tasks.size());
      work.places.push_back(i);
      tasks.push_back({hit.ray, static_cast<std::uint32_t>(member.number)});
      if (tasks.size() == kBlock) finish();
    }
    if (!tasks.empty()) finish();
  }
}

}  // namespace graze
