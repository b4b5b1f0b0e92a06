// What a surface is: a plain struct with formulations; and its type-erased form.
#pragma once

#include <array>
#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <graze/surfaces/equation_block.hpp>
#include <graze/surfaces/local_ray.hpp>
#include <graze/surfaces/spec.hpp>

namespace graze {

/// A hit in the surface's own frame. `t` is the profile parameter (or the surface's first parameter).
struct LocalHit {
  std::uint32_t ray = 0;
  std::uint32_t multiplicity = 1;
  double delta = 0;  ///< l - centre of its LocalRay
  double t = 0;
  double error = 0;  ///< bound on the rounding of delta by the lift, where it exceeds a few ulps
  bool in_doubt =
      false;  ///< a proved root whose enclosure does not locate the hit: see SurfaceModel::in_doubt
};

/// Normal and parameters of a hit in object space.
struct LocalPoint {
  Vec3 normal;  ///< outward, unit
  std::array<double, 2> params{};
};

/// A point of the surface in object space with its outward unit normal: raw material for case families, good
/// to a few ulps.
struct SurfaceSample {
  Vec3 point;
  Vec3 normal;
};

/// What case families aim at, in object space.
struct Landmarks {
  Vec3 centre;              ///< middle of the bounds
  Vec3 half;                ///< half their extent along x, y, z
  std::vector<Vec3> poles;  ///< points where the surface meets its axis, or other singular points
  bool has_axis = false;    ///< a surface of revolution about y
};

struct FormulationInfo {
  std::string_view name;     ///< "along_ray"
  std::string_view summary;  ///< the equation in one line
  std::string_view source;   ///< citation
  std::vector<Form> forms;   ///< forms it offers
};

struct SurfaceInfo {
  std::string_view summary;
  std::string_view source;
  std::string_view page;  ///< path of the page beside its code
  std::vector<std::string_view> parameters;
  std::array<std::string_view, 2> params;  ///< names of a hit's parameters
  std::vector<std::string_view> regions;   ///< names the scene's eps table may set
  std::vector<std::string_view> lengths;   ///< parameters that scale with the scene
};

/// A formulation is a plain struct built from its surface that poses the equations of one ray and turns
/// their roots back into hits:
///   static FormulationInfo info();
///   void pose(const LocalRay&, EquationBlock&) const;      // in block.form()
///   void lift(const LocalRay&, const Posed&, const Root&, std::vector<LocalHit>&) const;
/// `lift` appends hits with their delta; those with l <= 0 are dropped by the caller.
template <class F, class S>
concept Formulation = std::constructible_from<F, const S&> &&
    requires(const F& f, const LocalRay& ray, EquationBlock& block, const Posed& posed, const Root& root,
             std::vector<LocalHit>& hits) {
  { F::info() } -> std::same_as<FormulationInfo>;
  { f.pose(ray, block) } -> std::same_as<void>;
  { f.lift(ray, posed, root, hits) } -> std::same_as<void>;
};

/// A surface is a plain struct:
///   using Formulations = std::tuple<...>;                  // preferred ones first
///   static SurfaceInfo info();
///   explicit S(const SurfaceSpec&);                        // throws std::invalid_argument
///   int unit() const;                                      // its size is 2^unit up to a factor of 2
///   double size() const;                                   // L: its length scale
///   bool clip(LocalRay&) const;                            // recentre, bound delta; false: certainly no hit
///   LocalPoint describe(const LocalRay&, const LocalHit&) const;
///   SurfaceSample sample(double u, double v) const;        // a point for u, v in [0, 1)
///   Landmarks landmarks() const;
template <class S>
concept SurfaceType = std::constructible_from<S, const SurfaceSpec&> &&
    requires(const S& surface, LocalRay& ray, const LocalRay& clipped, const LocalHit& hit) {
  typename S::Formulations;
  { S::info() } -> std::same_as<SurfaceInfo>;
  { surface.unit() } -> std::same_as<int>;
  { surface.size() } -> std::same_as<double>;
  { surface.clip(ray) } -> std::same_as<bool>;
  { surface.describe(clipped, hit) } -> std::same_as<LocalPoint>;
  { surface.sample(0.5, 0.5) } -> std::same_as<SurfaceSample>;
  { surface.landmarks() } -> std::same_as<Landmarks>;
};

/// A surface with its type erased: one virtual call a batch.
class AnySurface {
 public:
  virtual ~AnySurface() = default;
  [[nodiscard]] virtual std::span<const FormulationInfo> formulations() const = 0;
  [[nodiscard]] virtual double size() const = 0;
  [[nodiscard]] virtual SurfaceSample sample(double u, double v) const = 0;
  [[nodiscard]] virtual Landmarks landmarks() const = 0;
  /// Rays into the surface's frame. rays[i] of the object space becomes local[i]; inside[i] says whether it
  /// can hit at all.
  virtual void localize(std::span<const Ray> rays, std::span<LocalRay> local,
                        std::span<bool> inside) const = 0;
  /// Poses the equations of every ray that is `inside`, in the block's form.
  virtual void pose(std::size_t formulation, std::span<const LocalRay> rays, std::span<const bool> inside,
                    EquationBlock& block) const = 0;
  /// Hits of roots[i], the answer to the block's equation i.
  virtual void lift(std::size_t formulation, std::span<const LocalRay> rays, const EquationBlock& block,
                    std::span<const Roots> roots, std::vector<LocalHit>& hits) const = 0;
  /// Normals and parameters of hits, in object space.
  virtual void describe(std::span<const LocalRay> rays, std::span<const LocalHit> hits,
                        std::vector<LocalPoint>& points) const = 0;
};

template <SurfaceType S>
class SurfaceModel final : public AnySurface {
 public:
  explicit SurfaceModel(const SurfaceSpec& spec)
      : surface_(spec), formulations_(make(std::make_index_sequence<kCount>{})) {
    std::apply([this](const auto&... f) { (infos_.push_back(f.info()), ...); }, formulations_);
  }

  [[nodiscard]] std::span<const FormulationInfo> formulations() const override { return infos_; }
  [[nodiscard]] double size() const override { return surface_.size(); }
  [[nodiscard]] SurfaceSample sample(double u, double v) const override { return surface_.sample(u, v); }
  [[nodiscard]] Landmarks landmarks() const override { return surface_.landmarks(); }

  void localize(std::span<const Ray> rays, std::span<LocalRay> local, std::span<bool> inside) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      local[i] = to_unit(rays[i], surface_.unit());
      inside[i] = surface_.clip(local[i]);
    }
  }

  void pose(std::size_t formulation, std::span<const LocalRay> rays, std::span<const bool> inside,
            EquationBlock& block) const override {
    with(formulation, [&](const auto& f) {
      for (std::size_t i = 0; i < rays.size(); ++i) {
        block.begin_ray(static_cast<std::uint32_t>(i));
        if (inside[i]) f.pose(rays[i], block);
      }
    });
  }

  void lift(std::size_t formulation, std::span<const LocalRay> rays, const EquationBlock& block,
            std::span<const Roots> roots, std::vector<LocalHit>& hits) const override {
    with(formulation, [&](const auto& f) {
      for (std::size_t i = 0; i < roots.size(); ++i) {
        const Posed posed = block.posed()[i];
        for (const Root& root : roots[i].list) {
          const std::size_t first = hits.size();
          f.lift(rays[posed.ray], posed, root, hits);
          const std::size_t last = hits.size();
          for (std::size_t h = first; h < last; ++h) {
            hits[h].ray = posed.ray;
            if (root.certified) hits[h].in_doubt = in_doubt(f, rays[posed.ray], posed, root, h, hits);
          }
        }
      }
    });
  }

  void describe(std::span<const LocalRay> rays, std::span<const LocalHit> hits,
                std::vector<LocalPoint>& points) const override {
    for (const LocalHit& hit : hits) points.push_back(surface_.describe(rays[hit.ray], hit));
  }

 private:
  using Tuple = typename S::Formulations;
  static constexpr std::size_t kCount = std::tuple_size_v<Tuple>;

  template <std::size_t... I>
  Tuple make(std::index_sequence<I...>) const {
    static_assert((Formulation<std::tuple_element_t<I, Tuple>, S> && ...));
    return Tuple(std::tuple_element_t<I, Tuple>(surface_)...);
  }
  /// Calls `function` with formulation number `index`.
  template <class Function>
  void with(std::size_t index, Function&& function) const {
    bool found = false;
    const auto try_one = [&](std::size_t i, const auto& f) {
      if (i == index) function(f);
      found = found || i == index;
    };
    std::apply(
        [&](const auto&... f) {
          std::size_t i = 0;
          (try_one(i++, f), ...);
        },
        formulations_);
    if (!found) throw std::logic_error("graze: formulation index out of range");
  }

  /// A root is proved within its enclosure, the hit within the enclosure's image: the lifted ends, and the
  /// rounding of the lift (16 operations on terms of size |centre| and 1, in local units, or the hit's
  /// error). In doubt if the image reaches to both sides of the ray's origin, or is wider than kLocated: then
  /// the solver knows that there is a hit of the line, but not where.
  template <class F>
  static bool in_doubt(const F& f, const LocalRay& ray, const Posed& posed, const Root& root, std::size_t h,
                       std::vector<LocalHit>& hits) {
    constexpr double kLocated =
        0x1p-22;  // four times the default grazing epsilon, the widest that a root has
    const double scale = 1 + std::fabs(ray.centre);
    const double noise = 0x1p-49 * scale + hits[h].error;
    double lo = hits[h].delta - noise;
    double hi = hits[h].delta + noise;
    const std::size_t size = hits.size();
    for (const double end : {-root.radius, root.radius}) {
      Root moved = root;
      moved.x += end;
      f.lift(ray, posed, moved, hits);
    }
    for (std::size_t i = size; i < hits.size(); ++i) {
      lo = std::min(lo, hits[i].delta - noise);
      hi = std::max(hi, hits[i].delta + noise);
    }
    hits.resize(size);
    return !(hi - lo <= kLocated * scale) || (lo <= -ray.centre && hi >= -ray.centre);
  }

  S surface_;
  Tuple formulations_;
  std::vector<FormulationInfo> infos_;
};

/// Throws std::invalid_argument for parameters or eps regions that the surface does not have, eps values
/// that are not positive, and a placement that cannot be inverted.
void check_names(const SurfaceSpec& spec, std::string_view type, const SurfaceInfo& info);

/// One line of the generated registry.
struct SurfaceEntry {
  std::string_view name;
  SurfaceInfo info;
  std::vector<FormulationInfo> formulations;
  std::function<std::unique_ptr<AnySurface>(const SurfaceSpec&)> make;
};

/// The entry of surface S under `name`. `make` checks names and placement, then builds S; it throws
/// std::invalid_argument with a sentence that names the parameter.
template <SurfaceType S>
SurfaceEntry surface_entry(std::string_view name) {
  SurfaceEntry entry{name, S::info(), {}, {}};
  []<class... F>(std::tuple<F...>*, std::vector<FormulationInfo>& list) { (list.push_back(F::info()), ...); }(
      static_cast<typename S::Formulations*>(nullptr), entry.formulations);
  entry.make = [name](const SurfaceSpec& spec) -> std::unique_ptr<AnySurface> {
    check_names(spec, name, S::info());
    return std::make_unique<SurfaceModel<S>>(spec);
  };
  return entry;
}

}  // namespace graze
