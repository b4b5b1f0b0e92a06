// What a surface is: a plain struct with formulations; and its type-erased form.
#pragma once

#include <array>
#include <concepts>
#include <deque>
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

#include <graze/surfaces/bounds.hpp>
#include <graze/surfaces/equation_block.hpp>
#include <graze/surfaces/kernel.hpp>
#include <graze/surfaces/local_ray.hpp>
#include <graze/surfaces/spec.hpp>

namespace graze {

/// A hit in the surface's own frame. `t` is the profile parameter (or the surface's first parameter).
struct LocalHit {
  std::uint32_t ray = 0;
  std::uint32_t multiplicity = 1;
  double delta = 0;  ///< l - centre of its LocalRay
  double t = 0;
  double error = 0;       ///< bound on the rounding of delta by the lift, where it exceeds a few ulps
  bool is_root = false;   ///< delta is the equation's root itself: the lift rounds nothing
  bool is_apart = false;  ///< another point than any other hit of the ray, even where both round to one l
  bool is_world = false;  ///< delta is l itself in world units, as a kernel gave it, and t is not known yet
  bool in_doubt = false;  ///< a proved root that does not locate the hit: see GroupModel::in_doubt
  double tail = 0;        ///< l = fl(centre + delta + tail): what delta leaves, from solvers that know it
  int side = 0;           ///< the sign of the exact l - l, from the same solvers
};

/// Normal and parameters of a hit in object space.
struct LocalPoint {
  Vec3 normal;  ///< outward, unit
  std::array<double, 2> params{};
  bool is_singular = false;  ///< no tangent plane there: the normal in the world faces the ray, -d/|d|
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
  std::vector<Vec3> poles;  ///< points where the surface meets its axis
  bool has_axis = false;    ///< a surface of revolution about y

  enum class Singular { apex, cusp, crossing };  ///< tip of a cone, cusp, or where the surface crosses itself
  std::vector<std::pair<Vec3, Singular>> singular;  ///< points without a tangent plane
  std::vector<std::array<Vec3, 2>> edges;           ///< of figures and solids
  std::vector<Vec3> parallels;   ///< unit directions along faces, axes of cylinders, generators
  std::vector<Vec3> asymptotes;  ///< unit directions in which the equation's leading coefficient vanishes
};

struct FormulationInfo {
  std::string_view name;     ///< "along_ray"
  std::string_view summary;  ///< the equation in one line
  std::string_view source;   ///< citation
  std::vector<Form> forms;   ///< forms it offers
  int degree = 0;  ///< of its polynomials; 0: depends on the surface, so not for solvers with a limit
  /// It takes decisions about the ray in plain arithmetic: no answer is certified, whatever the solver proves
  /// of the equation.
  bool is_plain = false;
};

struct SurfaceInfo {
  std::string_view summary;
  std::string_view source;
  std::string_view page;  ///< path of the page beside its code
  std::vector<std::string_view> parameters;
  std::array<std::string_view, 2> params;   ///< names of a hit's parameters; "" where there is none
  std::vector<std::string_view> regions;    ///< names the scene's eps table may set
  std::vector<std::string_view> varieties;  ///< names that `variety` may give a surface of this type
};

/// A formulation is a plain struct built from its surface that poses the equations of one ray and turns
/// their roots back into hits:
///   static FormulationInfo info();
///   void pose(const LocalRay&, EquationBlock&) const;      // in block.form()
///   void lift(const LocalRay&, const Posed&, const Root&, std::vector<LocalHit>&) const;
/// `lift` appends hits with their delta; those with l <= 0 are dropped by the caller. A formulation that a
/// kernel answers and whose unknown is not l also has
///   double place(const LocalRay&, double delta) const;     // t of the surface's point at delta
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
///   static Parameters scaled(const Parameters&, double k); // of the surface with every length times k
///   explicit S(const SurfaceSpec&);                        // throws std::invalid_argument
///   int unit() const;                                      // its size is 2^unit up to a factor of 2
///   double size() const;                                   // L: its length scale
///   Bounds bounds() const;                                 // object space, rounded outward
///   bool clip(LocalRay&) const;                            // recentre, bound delta; false: certainly no hit
///   LocalPoint describe(const LocalRay&, const LocalHit&) const;
///   SurfaceSample sample(double u, double v) const;        // a point for u, v in [0, 1)
///   Landmarks landmarks() const;
/// and, if its type has kinds of its own (a quadric's canonical class): std::string_view variety() const.
template <class S>
concept SurfaceType = std::constructible_from<S, const SurfaceSpec&> &&
    requires(const S& surface, LocalRay& ray, const LocalRay& clipped, const LocalHit& hit,
             const Parameters& parameters) {
  typename S::Formulations;
  { S::info() } -> std::same_as<SurfaceInfo>;
  { S::scaled(parameters, 2.0) } -> std::same_as<Parameters>;
  { surface.unit() } -> std::same_as<int>;
  { surface.size() } -> std::same_as<double>;
  { surface.bounds() } -> std::same_as<Bounds>;
  { surface.clip(ray) } -> std::same_as<bool>;
  { surface.describe(clipped, hit) } -> std::same_as<LocalPoint>;
  { surface.sample(0.5, 0.5) } -> std::same_as<SurfaceSample>;
  { surface.landmarks() } -> std::same_as<Landmarks>;
};

/// One surface with its type erased: what a program asks of it that is not about rays.
class AnySurface {
 public:
  virtual ~AnySurface() = default;
  [[nodiscard]] virtual double size() const = 0;
  [[nodiscard]] virtual Bounds bounds() const = 0;
  [[nodiscard]] virtual SurfaceSample sample(double u, double v) const = 0;
  [[nodiscard]] virtual Landmarks landmarks() const = 0;
  /// "cone", "ring torus", ...; empty where a type has no kinds.
  [[nodiscard]] virtual std::string_view variety() const = 0;
};

template <SurfaceType S>
class SurfaceModel final : public AnySurface {
 public:
  explicit SurfaceModel(const SurfaceSpec& spec) : surface_(spec) {}

  [[nodiscard]] double size() const override { return surface_.size(); }
  [[nodiscard]] Bounds bounds() const override { return surface_.bounds(); }
  [[nodiscard]] SurfaceSample sample(double u, double v) const override { return surface_.sample(u, v); }
  [[nodiscard]] Landmarks landmarks() const override { return surface_.landmarks(); }
  [[nodiscard]] std::string_view variety() const override {
    if constexpr (requires { surface_.variety(); }) {
      return surface_.variety();
    } else {
      return {};
    }
  }

 private:
  S surface_;
};

/// Surfaces of one type, posed in one formulation: one virtual call a batch of rays, whichever of the
/// surfaces each ray belongs to.
class AnyGroup {
 public:
  virtual ~AnyGroup() = default;
  /// Adds a surface; throws std::invalid_argument as its constructor does.
  virtual void add(const SurfaceSpec& spec) = 0;
  [[nodiscard]] virtual double size(std::size_t surface) const = 0;
  [[nodiscard]] virtual Bounds bounds(std::size_t surface) const = 0;
  [[nodiscard]] virtual std::string_view variety(std::size_t surface) const = 0;
  /// Rays into their surfaces' frames. rays[i] of the object space of surface surfaces[i] becomes local[i];
  /// inside[i] says whether it can hit at all.
  virtual void localize(std::span<const Ray> rays, std::span<const std::uint32_t> surfaces,
                        std::span<LocalRay> local, std::span<bool> inside) const = 0;
  /// Poses the equations of every ray that is `inside`, in the block's form.
  virtual void pose(std::span<const LocalRay> rays, std::span<const bool> inside,
                    EquationBlock& block) const = 0;
  /// Hits of roots[i], the answer to the block's equation i.
  virtual void lift(std::span<const LocalRay> rays, const EquationBlock& block, std::span<const Roots> roots,
                    std::vector<LocalHit>& hits) const = 0;
  /// Makes hits that a kernel gave (is_world) local ones.
  virtual void place(std::span<const LocalRay> rays, std::span<LocalHit> hits) const = 0;
  /// Normals and parameters of hits, in object space.
  virtual void describe(std::span<const LocalRay> rays, std::span<const LocalHit> hits,
                        std::vector<LocalPoint>& points) const = 0;
};

template <SurfaceType S, Formulation<S> F>
class GroupModel final : public AnyGroup {
 public:
  void add(const SurfaceSpec& spec) override { members_.emplace_back(spec); }
  [[nodiscard]] double size(std::size_t surface) const override { return members_[surface].surface.size(); }
  [[nodiscard]] Bounds bounds(std::size_t surface) const override {
    return members_[surface].surface.bounds();
  }
  [[nodiscard]] std::string_view variety(std::size_t surface) const override {
    if constexpr (requires(const S& s) { s.variety(); }) {
      return members_[surface].surface.variety();
    } else {
      return {};
    }
  }

  void localize(std::span<const Ray> rays, std::span<const std::uint32_t> surfaces, std::span<LocalRay> local,
                std::span<bool> inside) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const S& surface = members_[surfaces[i]].surface;
      local[i] = to_unit(rays[i], surface.unit());
      local[i].surface = surfaces[i];
      inside[i] = surface.clip(local[i]);
    }
  }

  void pose(std::span<const LocalRay> rays, std::span<const bool> inside,
            EquationBlock& block) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      block.begin_ray(static_cast<std::uint32_t>(i));
      if (inside[i]) formulation(rays[i]).pose(rays[i], block);
    }
  }

  void lift(std::span<const LocalRay> rays, const EquationBlock& block, std::span<const Roots> roots,
            std::vector<LocalHit>& hits) const override {
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const Posed posed = block.posed()[i];
      const LocalRay& ray = rays[posed.ray];
      const bool is_about_centre = origin_of(block, i) == ray.centre;
      for (const Root& root : roots[i].list) {
        const std::size_t first = hits.size();
        formulation(ray).lift(ray, posed, root, hits);
        const std::size_t last = hits.size();
        for (std::size_t h = first; h < last; ++h) {
          hits[h].ray = posed.ray;
          if (root.placed && hits[h].is_root && is_about_centre) {
            hits[h].tail = root.tail;
            hits[h].side = root.side;
          } else if (root.certified) {
            hits[h].in_doubt = in_doubt(formulation(ray), ray, posed, root, h, hits);
          }
        }
      }
    }
  }

  void place(std::span<const LocalRay> rays, std::span<LocalHit> hits) const override {
    std::vector<LocalHit> lifted;
    for (LocalHit& hit : hits) {
      if (!hit.is_world) continue;
      const LocalRay& ray = rays[hit.ray];
      const double delta = scale_by_power(hit.delta, -ray.l_exponent) - ray.centre;
      hit.delta = delta;
      if constexpr (requires { formulation(ray).place(ray, delta); }) {
        hit.t = formulation(ray).place(ray, delta);
      } else {
        lifted.clear();
        formulation(ray).lift(ray, {}, {.x = delta, .others = {}}, lifted);
        hit.t = lifted.empty() ? 0 : lifted.front().t;
      }
      hit.is_world = false;
    }
  }

  void describe(std::span<const LocalRay> rays, std::span<const LocalHit> hits,
                std::vector<LocalPoint>& points) const override {
    for (const LocalHit& hit : hits) {
      const LocalRay& ray = rays[hit.ray];
      points.push_back(members_[ray.surface].surface.describe(ray, hit));
    }
  }

 private:
  /// A surface and the one formulation that this group uses: the others are not set up.
  struct Member {
    explicit Member(const SurfaceSpec& spec) : surface(spec), formulation(surface) {}
    S surface;
    F formulation;
  };
  [[nodiscard]] const F& formulation(const LocalRay& ray) const { return members_[ray.surface].formulation; }

  /// From where equation i counts l (ExactCoefficients::origin).
  static double origin_of(const EquationBlock& block, std::size_t i) {
    const std::span<const PolynomialEquation> equations = block.of<PolynomialEquation>();
    return i < equations.size() ? equations[i].exact.origin : 0;
  }

  /// A root is proved within its enclosure, the hit within the enclosure's image: the lifted ends, and the
  /// rounding of the lift (of centre + delta alone where delta is the root; else 16 operations on terms of
  /// size |centre| and 1, in local units, and the hit's error). In doubt if the image reaches to both sides
  /// of the ray's origin, or is wider than kLocated: then the solver knows that there is a hit of the line,
  /// but not where.
  static bool in_doubt(const F& f, const LocalRay& ray, const Posed& posed, const Root& root, std::size_t h,
                       std::vector<LocalHit>& hits) {
    constexpr double kLocated =
        0x1p-22;  // four times the default grazing epsilon, the widest that a root has
    const double delta = hits[h].delta;
    // A root that is proved to be the origin itself is no hit, and no doubt.
    if (hits[h].is_root && root.radius == 0 && delta == -ray.centre) return false;
    const double size_of_l = std::fabs(ray.centre) + std::fabs(delta);
    const double scale = 1 + size_of_l;
    const double noise = hits[h].is_root ? 0x1p-52 * size_of_l : 0x1p-49 * scale + hits[h].error;
    double lo = delta - noise;
    double hi = delta + noise;
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

  std::deque<Member> members_;  // formulations point into their own members: no move
};

/// Throws std::invalid_argument for parameters or eps regions that the surface does not have, eps values
/// that are not positive, and a placement that cannot be inverted.
void check_names(const SurfaceSpec& spec, std::string_view type, const SurfaceInfo& info);

/// One line of the generated registry.
struct SurfaceEntry {
  std::string_view name;
  SurfaceInfo info;
  std::vector<FormulationInfo> formulations;
  /// The surface; throws std::invalid_argument with a sentence that names the parameter.
  std::function<std::unique_ptr<AnySurface>(const SurfaceSpec&)> make;
  /// An empty group of surfaces of this type, posed in formulation number `index`.
  std::unique_ptr<AnyGroup> (*make_group)(std::size_t index) = nullptr;
  /// The parameters of the surface with every length times the factor.
  Parameters (*scaled)(const Parameters&, double factor) = nullptr;
  std::vector<KernelEntry> kernels;  ///< of this build
};

namespace detail {

template <class S, class... F>
std::unique_ptr<AnyGroup> make_group(std::tuple<F...>* /*formulations*/, std::size_t index) {
  using Make = std::unique_ptr<AnyGroup> (*)();
  constexpr std::array<Make, sizeof...(F)> kMakers{
      []() -> std::unique_ptr<AnyGroup> { return std::make_unique<GroupModel<S, F>>(); }...};
  return kMakers.at(index)();
}

}  // namespace detail

/// The entry of surface S under `name`, with kernels: surface_entry<S>("s", {kernel_entry<K>()}).
template <SurfaceType S>
SurfaceEntry surface_entry(std::string_view name, std::vector<KernelEntry> kernels = {}) {
  using Formulations = typename S::Formulations;
  SurfaceEntry entry;
  entry.name = name;
  entry.info = S::info();
  []<class... F>(std::tuple<F...>*, std::vector<FormulationInfo>& list) { (list.push_back(F::info()), ...); }(
      static_cast<Formulations*>(nullptr), entry.formulations);
  entry.make = [name](const SurfaceSpec& spec) -> std::unique_ptr<AnySurface> {
    check_names(spec, name, S::info());
    return std::make_unique<SurfaceModel<S>>(spec);
  };
  entry.make_group = [](std::size_t index) {
    return detail::make_group<S>(static_cast<Formulations*>(nullptr), index);
  };
  entry.scaled = &S::scaled;
  entry.kernels = std::move(kernels);
  return entry;
}

}  // namespace graze
