// Surfaces from a callable: f(x, y, z) = 0 within a box, f generic over its number type (document 004).
//
//   const auto f = [](auto x, auto y, auto z) { return x * x + y * y + z * z - 1.0; };
//   const SurfaceEntry entry = implicit_entry("ball", f);               // for scenes, every solver
//   const SurfaceSpec spec = implicit_spec("ball", {{-2, -2, -2}, {2, 2, 2}});
//   const Implicit surface(f, Bounds{{-2, -2, -2}, {2, 2, 2}}, 4.0);    // by itself: d(l), sphere tracing
//
// surface       f(x / scale) = 0 in the closed box [min, max]; a hit on the box's own faces may be lost
// needs         f callable with double, Interval, Dual<float>, Dual<double> and Dual<Interval>; twice
//               differentiable near its zeros. Its elementary functions come by `using std::sin;` and the
//               like inside it. A surface of a scene is made from numbers alone: there F is
//               default-constructible (a lambda without captures is) or constructible from const Parameters&,
//               with the names of its own parameters in `static std::vector<std::string_view> parameters()`
// parameters    min, max: the box, finite, min < max; scale > 0 (1); lipschitz > 0 of f in its own
//               coordinates (none); those of F
// error         scalar: f_error is the width of f's inclusion at the point; interval: inclusions are as sharp
//               as f is written, each mention of a variable counts
// source        document 004: d(t) = f(S + c t); sphere tracing: Hart, "Sphere tracing", The Visual Computer
//               12, 1996; changed: steps are rounded down, so that none passes the surface
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <graze/solvers/math/dual.hpp>
#include <graze/solvers/math/interval_elementary.hpp>
#include <graze/solvers/math/rng.hpp>
#include <graze/surfaces/recentred_ball.hpp>
#include <graze/surfaces/surface.hpp>

namespace graze {

template <class F>
concept ImplicitFunction = requires(const F& f, double x, Interval box, Dual<double> jet, Dual<float> small,
                                    Dual<Interval> boxes) {
  { f(x, x, x) } -> std::convertible_to<double>;
  { f(box, box, box) } -> std::convertible_to<Interval>;
  { f(jet, jet, jet) } -> std::convertible_to<Dual<double>>;
  { f(small, small, small) } -> std::convertible_to<Dual<float>>;
  { f(boxes, boxes, boxes) } -> std::convertible_to<Dual<Interval>>;
};

/// d(l) = f(o + l d) of document 004, with derivatives and inclusions. Keeps a pointer to f.
template <ImplicitFunction F>
class FunctionOnRay {
 public:
  using Point = std::array<Interval, 3>;

  FunctionOnRay(const F& f, const Ray& ray)
      : FunctionOnRay(f, Point{point(ray.o.x), point(ray.o.y), point(ray.o.z)},
                      Point{point(ray.d.x), point(ray.d.y), point(ray.d.z)}) {}
  /// An origin and a direction that are known within intervals.
  FunctionOnRay(const F& f, const Point& o, const Point& d) : f_(&f), o_(o), d_(d) {}

  /// Value, two derivatives, and a bound on the value's rounding.
  template <class T>
  [[nodiscard]] BasicJet<T> jet(T l) const {
    const auto coordinate = [&](std::size_t i) {
      const T o = static_cast<T>(mid(o_[i])), d = static_cast<T>(mid(d_[i]));
      return Dual<T>::variable(std::fma(l, d, o), d);
    };
    const Dual<T> dual = (*f_)(coordinate(0), coordinate(1), coordinate(2));
    // The inclusion at the point is as wide as rounding in double makes it; in T it is eps_T / eps wider.
    const Interval exact = f(point(static_cast<double>(l)));
    constexpr T kEps = std::numeric_limits<T>::epsilon();
    const double in_units_of_t = static_cast<double>(kEps) / std::numeric_limits<double>::epsilon();
    const T rounding = static_cast<T>(width(exact) * in_units_of_t);
    return {dual.value, dual.d, dual.dd, rounding + kEps * std::fabs(dual.value)};
  }
  /// Contains { d(v) : v in l }.
  [[nodiscard]] Interval f(Interval l) const {
    return (*f_)(o_[0] + d_[0] * l, o_[1] + d_[1] * l, o_[2] + d_[2] * l);
  }
  /// Contains { d'(v) : v in l }.
  [[nodiscard]] Interval df(Interval l) const {
    const auto coordinate = [&](std::size_t i) { return Dual<Interval>::variable(o_[i] + d_[i] * l, d_[i]); };
    const Dual<Interval> dual = (*f_)(coordinate(0), coordinate(1), coordinate(2));
    return dual.d;
  }

 private:
  const F* f_;
  Point o_, d_;
};

/// Where sphere tracing stopped: no point of the ray with start < l < this l is on the surface.
struct SphereTrace {
  enum class End {
    near,    ///< the surface may be within 2^-40 of the box's size: a hit, or a ray that passes closely
    passed,  ///< the end of the range
    budget,  ///< max_steps
  };
  double l = 0;
  End end = End::budget;
  int steps = 0;
};

template <ImplicitFunction F>
class Implicit;

template <ImplicitFunction F>
struct ImplicitAlongRay {
  static FormulationInfo info() {
    return {"along_ray",
            "d(l) = f(o + l d), recentred, derivatives by dual numbers",
            "document 004",
            {Form::scalar, Form::interval}};
  }
  explicit ImplicitAlongRay(const Implicit<F>& implicit) : surface(&implicit) {}

  void pose(const LocalRay& ray, EquationBlock& block) const {
    if (!is_finite(ray.p) || !std::isfinite(ray.lo) || !std::isfinite(ray.hi))
      return block.settle(Status::failed);
    const auto* const self = block.arena().make(surface->on_local(ray));
    constexpr int kUnknown = 0;  // how many roots a callable has
    if (block.form() == Form::scalar)
      return pose_scalar(block, 0, self, ray.lo, ray.hi, kUnknown, ray.seed());
    pose_interval(block, 0, self, ray.lo, ray.hi, sharp_epsilons(block.arena(), 1, 0));
  }
  void lift(const LocalRay& /*ray*/, const Posed& /*posed*/, const Root& root,
            std::vector<LocalHit>& hits) const {
    hits.push_back({.multiplicity = root.multiplicity, .delta = root.x, .is_root = true});
  }

  const Implicit<F>* surface;
};

template <ImplicitFunction F>
class Implicit {
 public:
  using Formulations = std::tuple<ImplicitAlongRay<F>>;
  static constexpr double kNoBound = std::numeric_limits<double>::infinity();
  static constexpr int kSampleLines = 256;

  /// Throws std::invalid_argument for a box that is not finite or has no inside, and for numbers that are not
  /// positive.
  Implicit(F f, const Bounds& box, double lipschitz = kNoBound, double scale = 1)
      : f_(std::move(f)), box_(box), lipschitz_(lipschitz), scale_(scale) {
    prepare();
  }
  explicit Implicit(const SurfaceSpec& spec)
      : Implicit(make_function(spec.parameters),
                 Bounds{vec3(spec.parameters, "min"), vec3(spec.parameters, "max")},
                 spec.parameters.has("lipschitz") ? spec.parameters.number("lipschitz") : kNoBound,
                 spec.parameters.number("scale", 1)) {}

  static SurfaceInfo info() {
    SurfaceInfo info;
    info.summary = "f(x, y, z) = 0 of a callable, in a box";
    info.source = "document 004";
    info.page = "surfaces/implicit.md";
    info.parameters = {"min", "max", "scale", "lipschitz"};
    if constexpr (requires { F::parameters(); }) {
      for (const std::string_view name : F::parameters()) info.parameters.push_back(name);
    }
    return info;
  }
  static Parameters scaled(const Parameters& parameters, double factor) {
    constexpr std::array kLengths{Length{"min"}, Length{"max"}};
    Parameters result = scale_lengths(parameters, kLengths, factor);
    result.set("scale", factor * parameters.number("scale", 1));
    return result;
  }

  // As a surface of graze.
  [[nodiscard]] int unit() const { return unit_; }
  [[nodiscard]] double size() const { return max_abs(0.5 * box_.hi - 0.5 * box_.lo); }
  [[nodiscard]] Bounds bounds() const { return box_; }
  [[nodiscard]] bool clip(LocalRay& ray) const;
  [[nodiscard]] LocalPoint describe(const LocalRay& ray, const LocalHit& hit) const;
  /// A crossing of one of kSampleLines seeded lines through the box, polished along the gradient; where f is
  /// found nowhere to change its sign, the middle of the box and the normal (1, 0, 0).
  [[nodiscard]] SurfaceSample sample(double u, double v) const;
  [[nodiscard]] Landmarks landmarks() const {
    Landmarks marks;
    marks.centre = middle();
    marks.half = 0.5 * box_.hi - 0.5 * box_.lo;
    return marks;
  }
  /// f along a ray of the local frame, from its recentred point.
  [[nodiscard]] FunctionOnRay<F> on_local(const LocalRay& ray) const;

  // By itself, in object space. No clipping to the box.
  [[nodiscard]] FunctionOnRay<F> on(const Ray& ray) const;
  /// The gradient of f(x / scale), in double.
  [[nodiscard]] Vec3 gradient(Vec3 x) const;
  /// No point of the surface is nearer to x than this: |f| / L, rounded down; 0 without a Lipschitz bound.
  [[nodiscard]] double distance_bound(Vec3 x) const { return distance_within({x, {}}, point(0)); }
  /// Steps by distance_bound from l = start to at most l = end.
  [[nodiscard]] SphereTrace sphere_trace(const Ray& ray, double start, double end,
                                         int max_steps = 10000) const;

 private:
  static F make_function(const Parameters& parameters) {
    static_assert(std::default_initializable<F> || std::constructible_from<F, const Parameters&>,
                  "a callable with captured state makes no surface of a scene: give it a constructor from "
                  "const Parameters&, or use Implicit by itself");
    if constexpr (std::constructible_from<F, const Parameters&>) {
      return F(parameters);
    } else {
      return F{};
    }
  }
  void prepare();
  [[nodiscard]] Vec3 middle() const { return 0.5 * box_.lo + 0.5 * box_.hi; }
  [[nodiscard]] double at(Vec3 x) const { return f_(x.x / scale_, x.y / scale_, x.z / scale_); }
  [[nodiscard]] double distance_within(const Ray& ray, Interval l) const;
  [[nodiscard]] std::optional<double> crossing(const Ray& chord, double pick) const;
  [[nodiscard]] std::optional<SurfaceSample> polished(Vec3 x) const;

  F f_;
  Bounds box_;
  double lipschitz_;
  double scale_;
  int unit_ = 0;
};

/// The registry entry of such surfaces. Its formulation offers the forms scalar and interval.
template <ImplicitFunction F>
SurfaceEntry implicit_entry(std::string_view name, const F& /*f*/ = F{}) {
  return surface_entry<Implicit<F>>(name);
}

/// Specification of one of them.
inline SurfaceSpec implicit_spec(std::string_view type, const Bounds& box,
                                 double lipschitz = std::numeric_limits<double>::infinity()) {
  SurfaceSpec spec;
  spec.type = type;
  spec.parameters.set("min", std::vector<double>{box.lo.x, box.lo.y, box.lo.z});
  spec.parameters.set("max", std::vector<double>{box.hi.x, box.hi.y, box.hi.z});
  if (std::isfinite(lipschitz)) spec.parameters.set("lipschitz", lipschitz);
  return spec;
}

// ----------------------------------------------------------------------------------------------- definitions

template <ImplicitFunction F>
void Implicit<F>::prepare() {
  if (!box_.is_finite()) throw std::invalid_argument("parameter 'min' and 'max' must be finite");
  if (!(box_.lo.x < box_.hi.x && box_.lo.y < box_.hi.y && box_.lo.z < box_.hi.z))
    throw std::invalid_argument("parameter 'min' must be below 'max' in x, y and z");
  if (!(lipschitz_ > 0)) throw std::invalid_argument("parameter 'lipschitz' must be positive");
  if (!(scale_ > 0 && std::isfinite(scale_)))
    throw std::invalid_argument("parameter 'scale' must be positive");
  unit_ = exponent_of(size());
}

template <ImplicitFunction F>
FunctionOnRay<F> Implicit<F>::on_local(const LocalRay& ray) const {
  // x / scale = X 2^unit / scale: powers of two apart, one division, exact for a scale that is a power of
  // two.
  const int exponent = exponent_of(scale_);
  const Interval ratio = scale_by_power(1.0, unit_ - exponent) / point(scale_by_power(scale_, -exponent));
  std::array<Interval, 3> o = recentred_point<Interval>(ray);
  for (Interval& x : o) x = x * ratio;
  return {f_, o, {ray.d.x * ratio, ray.d.y * ratio, ray.d.z * ratio}};
}

template <ImplicitFunction F>
FunctionOnRay<F> Implicit<F>::on(const Ray& ray) const {
  const auto divided = [this](Vec3 v) {
    return std::array<Interval, 3>{point(v.x) / scale_, point(v.y) / scale_, point(v.z) / scale_};
  };
  return {f_, divided(ray.o), divided(ray.d)};
}

template <ImplicitFunction F>
bool Implicit<F>::clip(LocalRay& ray) const {
  const Vec3 lo = scale_by_power(box_.lo, -unit_), hi = scale_by_power(box_.hi, -unit_);
  recentre(ray, 0.5 * lo + 0.5 * hi, max_abs(0.5 * hi - 0.5 * lo));
  const std::array<Interval, 3> p = recentred_point<Interval>(ray);
  Interval range{-ray.centre, std::numeric_limits<double>::infinity()};
  const auto cut = [&](std::size_t i, double d, double low, double high) {
    if (d == 0) return p[i].hi >= low && p[i].lo <= high;
    const Interval a = (point(low) - p[i]) / d, b = (point(high) - p[i]) / d;
    const Interval both = hull(a, b);
    range = {std::max(range.lo, both.lo), std::min(range.hi, both.hi)};
    return range.lo <= range.hi;
  };
  const bool may_meet =
      cut(0, ray.d.x, lo.x, hi.x) && cut(1, ray.d.y, lo.y, hi.y) && cut(2, ray.d.z, lo.z, hi.z);
  ray.lo = range.lo;
  ray.hi = range.hi;
  return may_meet;
}

template <ImplicitFunction F>
Vec3 Implicit<F>::gradient(Vec3 x) const {
  const Vec3 y{x.x / scale_, x.y / scale_, x.z / scale_};
  const auto slope = [&](double dx, double dy, double dz) {
    const Dual<double> f =
        f_(Dual<double>::variable(y.x, dx), Dual<double>::variable(y.y, dy), Dual<double>::variable(y.z, dz));
    return f.d / scale_;
  };
  return {slope(1, 0, 0), slope(0, 1, 0), slope(0, 0, 1)};
}

template <ImplicitFunction F>
LocalPoint Implicit<F>::describe(const LocalRay& ray, const LocalHit& hit) const {
  const Vec3 x = ray.at(hit.delta);
  const Vec3 g = gradient(scale_by_power(x, unit_));
  const bool is_singular = max_abs(g) == 0 || !is_finite(g);
  return {normalized(is_singular ? -ray.d : g), {}, is_singular};
}

template <ImplicitFunction F>
double Implicit<F>::distance_within(const Ray& ray, Interval l) const {
  if (!std::isfinite(lipschitz_)) return 0;
  return div_down(mul_down(mig(on(ray).f(l)), scale_), lipschitz_);
}

template <ImplicitFunction F>
SphereTrace Implicit<F>::sphere_trace(const Ray& ray, double start, double end, int max_steps) const {
  const double speed = sqrt(sqr(point(ray.d.x)) + sqr(point(ray.d.y)) + sqr(point(ray.d.z))).hi;
  const double nearest = 0x1p-40 * size();  // steps this small no longer pay: a root finder takes over
  SphereTrace trace;
  trace.l = start;
  while (trace.steps < max_steps) {
    const double distance = distance_within(ray, point(trace.l));
    ++trace.steps;
    const double next = add_down(trace.l, div_down(distance, speed));
    if (distance <= nearest || !(next > trace.l)) {
      trace.end = SphereTrace::End::near;
      return trace;
    }
    trace.l = std::min(next, end);
    if (trace.l == end) {
      trace.end = SphereTrace::End::passed;
      return trace;
    }
  }
  return trace;
}

/// A sign change along o + t d, 0 <= t <= 1, bisected to neighbouring doubles; `pick` in [0, 1) says which.
template <ImplicitFunction F>
std::optional<double> Implicit<F>::crossing(const Ray& chord, double pick) const {
  constexpr int kNodes = 64;
  // Zero counts as positive, so that a crossing on a node is found.
  const auto is_positive = [&](double t) { return at(chord.o + t * chord.d) >= 0; };
  std::vector<double> found;
  for (int i = 0; i < kNodes; ++i) {
    double a = static_cast<double>(i) / kNodes, b = static_cast<double>(i + 1) / kNodes;
    const bool side = is_positive(a);
    if (side == is_positive(b)) continue;
    for (double m = 0.5 * (a + b); m > a && m < b; m = 0.5 * (a + b)) (is_positive(m) == side ? a : b) = m;
    found.push_back(a);
  }
  if (found.empty()) return std::nullopt;
  return found[static_cast<std::size_t>(pick * static_cast<double>(found.size()))];
}

template <ImplicitFunction F>
std::optional<SurfaceSample> Implicit<F>::polished(Vec3 x) const {
  for (int i = 0; i < 2; ++i) {
    const Vec3 g = gradient(x);
    const double step = at(x) / dot(g, g);
    if (!std::isfinite(step)) return std::nullopt;
    x = x - step * g;
  }
  const Vec3 g = gradient(x);
  if (max_abs(g) == 0 || !is_finite(g)) return std::nullopt;
  return SurfaceSample{x, normalized(g)};
}

template <ImplicitFunction F>
SurfaceSample Implicit<F>::sample(double u, double v) const {
  Rng rng(hash_combine(hash_combine(0, u), v));
  const Vec3 extent = box_.hi - box_.lo;
  const auto random_point = [&] {
    return box_.lo + Vec3{rng.uniform() * extent.x, rng.uniform() * extent.y, rng.uniform() * extent.z};
  };
  for (int i = 0; i < kSampleLines; ++i) {
    const Vec3 a = random_point();
    const Ray chord{a, random_point() - a};
    const auto t = crossing(chord, rng.uniform());
    if (!t) continue;
    if (const auto sample = polished(chord.o + *t * chord.d)) return *sample;
  }
  return {middle(), {1, 0, 0}};
}

}  // namespace graze
