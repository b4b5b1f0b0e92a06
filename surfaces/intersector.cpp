#include <graze/surfaces/intersector.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <tuple>

namespace graze {
namespace {

bool offers(const FormulationInfo& formulation, Form form) {
  return std::find(formulation.forms.begin(), formulation.forms.end(), form) != formulation.forms.end();
}

/// The first of the solver's forms that the formulation offers.
std::optional<Form> common_form(const SolverEntry& solver, const FormulationInfo& formulation) {
  for (const Form form : solver.info.forms) {
    if (offers(formulation, form)) return form;
  }
  return std::nullopt;
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
  for (Vec3& row : m) {
    row = {scale_by_power(row.x, -k), scale_by_power(row.y, -k), scale_by_power(row.z, -k)};
  }
  const Mat3 adjugate = transpose({cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])});
  const double determinant = dot(m[0], cross(m[1], m[2]));
  Mat3 result = adjugate;
  for (Vec3& row : result) {
    row = {scale_by_power(row.x / determinant, -k), scale_by_power(row.y / determinant, -k),
           scale_by_power(row.z / determinant, -k)};
  }
  return result;
}

/// The graver of two: invalid, coincident, failed, uncertain, ok.
Status worse(Status a, Status b) { return std::max(a, b); }
static_assert(Status::ok < Status::uncertain && Status::uncertain < Status::failed &&
              Status::failed < Status::coincident && Status::coincident < Status::invalid);

}  // namespace

Pairing pair_up(const SolverEntry& solver, const SurfaceEntry& surface, std::string_view formulation) {
  if (!formulation.empty()) {
    const std::size_t index = find_formulation(surface, formulation);
    if (const auto form = common_form(solver, surface.formulations[index])) return {index, *form};
    throw std::invalid_argument("solver '" + std::string(solver.name) + "' takes no form of formulation '" +
                                std::string(formulation) + "' (see graze list)");
  }
  for (const Form form : solver.info.forms) {
    for (std::size_t i = 0; i < surface.formulations.size(); ++i) {
      if (offers(surface.formulations[i], form)) return {i, form};
    }
  }
  throw std::invalid_argument("solver '" + std::string(solver.name) + "' takes no form that surface '" +
                              std::string(surface.name) + "' offers (see graze list)");
}

std::vector<Pairing> all_pairings(const SolverEntry& solver, const SurfaceEntry& surface) {
  std::vector<Pairing> pairings;
  for (std::size_t i = 0; i < surface.formulations.size(); ++i) {
    if (const auto form = common_form(solver, surface.formulations[i])) pairings.push_back({i, *form});
  }
  return pairings;
}

Intersector::Intersector(const SurfaceEntry& surface, const SurfaceSpec& spec, const SolverEntry& solver,
                         const Parameters& solver_options, std::string_view formulation)
    : pairing_(pair_up(solver, surface, formulation)),
      certified_(solver.info.claims.certified),
      placed_(!spec.placement.is_identity()),
      surface_(surface.make(spec)),
      solver_(solver.make(solver_options)) {
  translate_ = spec.placement.translate;
  to_object_ = inverse(spec.placement.matrix);
}

void Intersector::intersect(std::span<const Ray> rays, Workspace& work) const {
  to_object_space(rays, work);
  surface_->localize(work.object_rays, work.local, {work.inside.data(), rays.size()});
  for (std::size_t i = 0; i < rays.size(); ++i) work.inside[i] = work.inside[i] && is_valid(rays[i]);

  work.equations.reset(pairing_.form, certified_);
  surface_->pose(pairing_.formulation, work.local, {work.inside.data(), rays.size()}, work.equations);
  solve(work);

  work.status.assign(rays.size(), Status::ok);
  work.counters.assign(rays.size(), {});
  for (const auto& [ray, status] : work.equations.settled())
    work.status[ray] = worse(work.status[ray], status);
  const std::size_t count = work.equations.posed().size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t ray = work.equations.posed()[i].ray;
    work.status[ray] = worse(work.status[ray], work.roots[i].status);
    work.counters[ray] += work.roots[i].counters;
  }
  work.hits.clear();
  surface_->lift(pairing_.formulation, work.local, work.equations, {work.roots.data(), count}, work.hits);
}

void Intersector::to_object_space(std::span<const Ray> rays, Workspace& work) const {
  work.object_rays.assign(rays.begin(), rays.end());
  work.local.resize(rays.size());
  if (!placed_) return;
  for (Ray& ray : work.object_rays) ray = {to_object_ * (ray.o - translate_), to_object_ * ray.d};
}

void Intersector::solve(Workspace& work) const {
  const std::size_t count = work.equations.posed().size();
  if (work.roots.size() < count) work.roots.resize(count);
  const std::span<Roots> roots{work.roots.data(), count};
  switch (pairing_.form) {
    case Form::polynomial:
      return solver_->solve(work.equations.polynomials(), roots);
    case Form::scalar:
      return solver_->solve(work.equations.scalars(), roots);
    case Form::interval:
      return solver_->solve(work.equations.intervals(), roots);
    case Form::system:
      return solver_->solve(work.equations.systems(), roots);
  }
}

void Intersector::describe(std::span<const LocalHit> hits, Workspace& work) const {
  work.points.clear();
  surface_->describe(work.local, hits, work.points);
  if (!placed_) return;
  const Mat3 normal_to_world = transpose(to_object_);
  for (LocalPoint& point : work.points) point.normal = normalized(normal_to_world * point.normal);
}

void Scene::intersect(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                      HitBuffer& out) const {
  work.members.resize(members_.size());
  for (std::size_t i = 0; i < rays.size(); i += kBlock) {
    answer_block(rays.subspan(i, std::min(kBlock, rays.size() - i)), query, wanted, work, out);
  }
}

void Scene::answer_block(std::span<const Ray> rays, Query query, Wanted wanted, Workspace& work,
                         HitBuffer& out) const {
  work.hits.clear();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    members_[i].intersect(rays, work.members[i]);
    collect(static_cast<std::uint32_t>(i), work.members[i], work.hits);
  }
  std::sort(work.hits.begin(), work.hits.end(), [](const SceneHit& a, const SceneHit& b) {
    return std::tie(a.ray, a.l, a.surface) < std::tie(b.ray, b.l, b.surface);
  });
  merge_equal(work.hits);
  if (query != Query::all) keep_first(work.hits);
  write_out(rays, wanted, work, out);
}

void Scene::collect(std::uint32_t surface, Intersector::Workspace& member, std::vector<SceneHit>& hits) {
  for (const LocalHit& hit : member.hits) {
    if (hit.in_doubt) {  // proved to be a hit of the line, but not where on the ray
      member.status[hit.ray] = worse(member.status[hit.ray], Status::uncertain);
      continue;
    }
    const LocalRay& ray = member.local[hit.ray];
    const double l = scale_by_power(ray.centre + hit.delta, ray.l_exponent);
    if (l > 0 && std::isfinite(l)) hits.push_back({l, hit.ray, surface, hit});
  }
}

void Scene::merge_equal(std::vector<SceneHit>& hits) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    SceneHit* const last = kept > 0 ? &hits[kept - 1] : nullptr;
    if (last != nullptr && last->ray == hits[i].ray && last->l == hits[i].l &&
        last->surface == hits[i].surface) {
      last->local.multiplicity += hits[i].local.multiplicity;
    } else {
      hits[kept++] = hits[i];
    }
  }
  hits.resize(kept);
}

void Scene::keep_first(std::vector<SceneHit>& hits) {
  const auto same_ray = [](const SceneHit& a, const SceneHit& b) { return a.ray == b.ray; };
  hits.erase(std::unique(hits.begin(), hits.end(), same_ray), hits.end());
}

void Scene::write_out(std::span<const Ray> rays, Wanted wanted, Workspace& work, HitBuffer& out) const {
  const std::size_t first = out.l.size();
  std::size_t next = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& ray = rays[i];
    for (; next < work.hits.size() && work.hits[next].ray == i; ++next) {
      const SceneHit& hit = work.hits[next];
      out.l.push_back(hit.l);
      out.surface.push_back(hit.surface);
      out.multiplicity.push_back(hit.local.multiplicity);
      if (!wanted.points) continue;
      out.point.push_back({std::fma(hit.l, ray.d.x, ray.o.x), std::fma(hit.l, ray.d.y, ray.o.y),
                           std::fma(hit.l, ray.d.z, ray.o.z)});
    }
    Status status = is_valid(ray) ? Status::ok : Status::invalid;
    Counters counters;
    for (const auto& member : work.members) {
      status = worse(status, member.status[i]);
      counters += member.counters[i];
    }
    out.close_ray(status, counters);
  }
  if (wanted.normals || wanted.params) describe(wanted, first, work, out);
}

void Scene::describe(Wanted wanted, std::size_t first, Workspace& work, HitBuffer& out) const {
  if (wanted.normals) out.normal.resize(out.l.size());
  if (wanted.params) out.params.resize(out.l.size());
  for (std::size_t surface = 0; surface < members_.size(); ++surface) {
    work.of_surface.clear();
    for (const SceneHit& hit : work.hits) {
      if (hit.surface == surface) work.of_surface.push_back(hit.local);
    }
    members_[surface].describe(work.of_surface, work.members[surface]);
    std::size_t next = 0;
    for (std::size_t i = 0; i < work.hits.size(); ++i) {
      if (work.hits[i].surface != surface) continue;
      const LocalPoint& point = work.members[surface].points[next++];
      if (wanted.normals) out.normal[first + i] = point.normal;
      if (wanted.params) out.params[first + i] = point.params;
    }
  }
}

}  // namespace graze
