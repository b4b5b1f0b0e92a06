#include <graze/experiments/peers/embree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <type_traits>

#include <embree3/rtcore.h>

#include <errors.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze {
namespace {

constexpr std::size_t kPacket = 16;
constexpr int kDefaultTriangles = 1000000;

struct Options {
  explicit Options(const Parameters& parameters)
      : triangles(parameters.integer("triangles", kDefaultTriangles, 8, 100000000)),
        packets(parameters.flag("packets", false)),
        robust(parameters.flag("robust", false)) {}
  int triangles;
  bool packets, robust;
};

// ------------------------------------------------------------------------------------------------- meshes

/// How two parameters cover a surface: what `AnySurface::sample` makes of them, and whether the first closes
/// on itself as the second always does.
struct Cover {
  std::string_view surface;
  bool by_equal_areas = false;  ///< its first parameter counts areas of a sphere from pole to pole
  bool first_closes = false;
};

constexpr std::array<Cover, 5> kCovers{{{"teardrop", false, false},
                                        {"bezier_revolution", false, false},
                                        {"sphere", true, false},
                                        {"ellipsoid", true, false},
                                        {"torus", false, true}}};

/// Null for surfaces without one.
const Cover* find_cover(std::string_view surface) {
  const auto* const found = std::find_if(kCovers.begin(), kCovers.end(),
                                         [&](const Cover& cover) { return cover.surface == surface; });
  return found != kCovers.end() ? found : nullptr;
}

/// A surface by its two parameters, each in [0, 1].
class Chart {
 public:
  explicit Chart(const SurfaceSpec& spec)
      : cover_(find_cover(spec.type)), surface_(find_surface(spec.type).make(spec)) {}

  [[nodiscard]] Vec3 point(double x, double y) const {
    if (!cover_->by_equal_areas) return surface_->sample(x, y).point;
    // Equal areas leave long triangles at the poles: here equal angles.
    const double half_chord = std::sin(0.5 * std::numbers::pi * x);
    return surface_->sample(half_chord * half_chord, y).point;
  }
  [[nodiscard]] bool first_closes() const { return cover_->first_closes; }

 private:
  const Cover* cover_;
  std::unique_ptr<AnySurface> surface_;
};

/// rows x columns vertices; a side that closes has its first row or column once.
struct Grid {
  Grid(int triangles, bool first_closes)
      : cells(static_cast<unsigned>(std::lround(std::sqrt(0.5 * triangles)))),
        rows(first_closes ? cells : cells + 1) {}
  /// Number of a vertex; the far side of what closes is the near side.
  [[nodiscard]] unsigned vertex(unsigned row, unsigned column) const {
    return (row % rows) * cells + column % cells;
  }
  unsigned cells;  ///< along x and along y: two triangles each
  unsigned rows;
};

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release>;
using MeshScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, Release>;

void fill_vertices(const Chart& chart, const Grid& grid, float* out) {
  for (unsigned row = 0; row < grid.rows; ++row) {
    for (unsigned column = 0; column < grid.cells; ++column) {
      const Vec3 p =
          chart.point(static_cast<double>(row) / grid.cells, static_cast<double>(column) / grid.cells);
      for (const double coordinate : {p.x, p.y, p.z}) *out++ = static_cast<float>(coordinate);
    }
  }
}

void fill_triangles(const Grid& grid, unsigned* out) {
  for (unsigned row = 0; row < grid.cells; ++row) {
    for (unsigned column = 0; column < grid.cells; ++column) {
      const unsigned a = grid.vertex(row, column), b = grid.vertex(row, column + 1);
      const unsigned c = grid.vertex(row + 1, column), d = grid.vertex(row + 1, column + 1);
      for (const unsigned corner : {a, b, c, c, b, d}) *out++ = corner;
    }
  }
}

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    throw EnvironmentError("Embree: error " + std::to_string(static_cast<int>(error)) +
                           " while the mesh was built (fewer triangles?)");
}

MeshScene build_mesh(RTCDevice device, const Chart& chart, const Options& options) {
  const Grid grid(options.triangles, chart.first_closes());
  const std::size_t triangles = 2 * std::size_t{grid.cells} * grid.cells;
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* const vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 3 * sizeof(float), std::size_t{grid.rows} * grid.cells);
  void* const corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(unsigned), triangles);
  check(device);
  fill_vertices(chart, grid, static_cast<float*>(vertices));
  fill_triangles(grid, static_cast<unsigned*>(corners));
  rtcCommitGeometry(geometry);

  MeshScene scene(rtcNewScene(device));
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  if (options.robust) rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  check(device);
  return scene;
}

// --------------------------------------------------------------------------------------------------- rays

/// A ray in single precision, from `near` on.
struct FloatRay {
  std::array<float, 3> o{}, d{};
  float near = 0;

  [[nodiscard]] bool is_usable() const {
    const auto finite = [](float x) { return std::isfinite(x); };
    return std::all_of(o.begin(), o.end(), finite) && std::all_of(d.begin(), d.end(), finite) &&
           (d[0] != 0 || d[1] != 0 || d[2] != 0);
  }
};

FloatRay to_float(const Ray& ray) {
  const auto narrow = [](Vec3 v) {
    return std::array{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  return {narrow(ray.o), narrow(ray.d)};
}

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr float kMiss = -1;
constexpr float kSomewhere = std::numeric_limits<float>::max();

RTCRay one_ray(const FloatRay& ray) {
  RTCRay one{};
  one.org_x = ray.o[0], one.org_y = ray.o[1], one.org_z = ray.o[2];
  one.dir_x = ray.d[0], one.dir_y = ray.d[1], one.dir_z = ray.d[2];
  one.tnear = ray.near, one.tfar = kFar;
  one.mask = std::numeric_limits<unsigned>::max();
  return one;
}

/// Puts a ray into lane i of a packet.
void set_lane(RTCRay16& packet, std::size_t i, const FloatRay& ray) {
  packet.org_x[i] = ray.o[0], packet.org_y[i] = ray.o[1], packet.org_z[i] = ray.o[2];
  packet.dir_x[i] = ray.d[0], packet.dir_y[i] = ray.d[1], packet.dir_z[i] = ray.d[2];
  packet.tnear[i] = ray.near, packet.tfar[i] = kFar;
  packet.time[i] = 0, packet.flags[i] = 0, packet.id[i] = 0;
  packet.mask[i] = std::numeric_limits<unsigned>::max();
}

/// What each of up to kPacket rays meets first: l, kMiss, or kSomewhere where only that was asked.
using Distances = std::array<float, kPacket>;

class Mesh {
 public:
  Mesh(const Chart& chart, const Options& options)
      : packets_(options.packets), device_(rtcNewDevice("threads=1")) {
    if (device_ == nullptr) throw EnvironmentError("Embree does not start on this machine");
    scene_ = build_mesh(device_.get(), chart, options);
    rtcInitIntersectContext(&context_);
  }

  [[nodiscard]] Distances first(std::span<const FloatRay> rays) const {
    return packets_ ? first_of_packet(rays) : one_by_one(rays, &Mesh::first_of_one);
  }
  [[nodiscard]] Distances occluded(std::span<const FloatRay> rays) const {
    return packets_ ? occluded_packet(rays) : one_by_one(rays, &Mesh::occluded_one);
  }

 private:
  using Lanes = std::array<int, kPacket>;  // -1: asked

  [[nodiscard]] Distances one_by_one(std::span<const FloatRay> rays,
                                     float (Mesh::*ask)(const FloatRay&) const) const {
    Distances distances{};
    for (std::size_t i = 0; i < rays.size(); ++i)
      distances[i] = rays[i].is_usable() ? (this->*ask)(rays[i]) : kMiss;
    return distances;
  }

  [[nodiscard]] float first_of_one(const FloatRay& ray) const {
    RTCRayHit query{one_ray(ray), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context = context_;
    rtcIntersect1(scene_.get(), &context, &query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID ? query.ray.tfar : kMiss;
  }

  [[nodiscard]] float occluded_one(const FloatRay& ray) const {
    RTCRay query = one_ray(ray);
    RTCIntersectContext context = context_;
    rtcOccluded1(scene_.get(), &context, &query);
    return query.tfar < 0 ? kSomewhere : kMiss;  // Embree says "occluded" by tfar = -inf
  }

  static Lanes fill(std::span<const FloatRay> rays, RTCRay16& packet) {
    Lanes asked{};
    for (std::size_t i = 0; i < kPacket; ++i) {
      const bool usable = i < rays.size() && rays[i].is_usable();
      asked[i] = usable ? -1 : 0;
      set_lane(packet, i, usable ? rays[i] : FloatRay{{}, {0, 0, 1}});
    }
    return asked;
  }

  [[nodiscard]] Distances first_of_packet(std::span<const FloatRay> rays) const {
    alignas(64) RTCRayHit16 query;
    alignas(64) const Lanes asked = fill(rays, query.ray);
    for (std::size_t i = 0; i < kPacket; ++i) {
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context = context_;
    rtcIntersect16(asked.data(), scene_.get(), &context, &query);
    Distances distances{};
    for (std::size_t i = 0; i < kPacket; ++i)
      distances[i] = query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID ? query.ray.tfar[i] : kMiss;
    return distances;
  }

  [[nodiscard]] Distances occluded_packet(std::span<const FloatRay> rays) const {
    alignas(64) RTCRay16 query;
    alignas(64) const Lanes asked = fill(rays, query);
    RTCIntersectContext context = context_;
    rtcOccluded16(asked.data(), scene_.get(), &context, &query);
    Distances distances{};
    for (std::size_t i = 0; i < kPacket; ++i) distances[i] = query.tfar[i] < 0 ? kSomewhere : kMiss;
    return distances;
  }

  bool packets_;
  Device device_;
  MeshScene scene_;
  RTCIntersectContext context_{};
};

// ------------------------------------------------------------------------------------------------ kernels

/// The mesh of a surface in place of equations; `kAny`: whether there is a hit is all that is asked.
template <bool kAny>
class MeshKernel {
 public:
  using Surface = Chart;
  static constexpr std::string_view kSolver = "peer:embree";
  static constexpr std::string_view kFormulation = "triangles";

  MeshKernel(const Chart& chart, const Parameters& options) : mesh_(chart, Options(options)) {}

  void intersect(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const {
    for (std::size_t i = 0; i < rays.size(); i += kPacket)
      answer(rays.subspan(i, std::min(kPacket, rays.size() - i)), all, answers, first + i);
  }

 private:
  void answer(std::span<const Ray> rays, bool all, KernelAnswers& answers, std::size_t first) const {
    std::array<FloatRay, kPacket> memory;
    const std::span<FloatRay> asked(memory.data(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      asked[i] = to_float(rays[i]);
      // What is no question gets the scene's own answer.
      answers.hits[first + i] = is_valid(rays[i]) ? std::int8_t{0} : KernelAnswers::kOpen;
    }
    const std::size_t most = all ? KernelAnswers::kMost : 1;
    for (std::size_t k = 0; k < most; ++k) {
      if (!add_next(asked, k, answers, first)) break;
    }
  }

  /// Adds hit k of the rays that have one and moves them behind it; true while there are such rays.
  bool add_next(std::span<FloatRay> rays, std::size_t k, KernelAnswers& answers, std::size_t first) const {
    const Distances l = kAny ? mesh_.occluded(rays) : mesh_.first(rays);
    bool any = false;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!(l[i] > 0)) {
        rays[i].d = {};  // done: a ray without a direction is not asked
        continue;
      }
      answers.l[k][first + i] = static_cast<double>(l[i]);
      ++answers.hits[first + i];
      rays[i].near = std::nextafter(l[i], kFar);
      any = true;
    }
    return any;
  }

  Mesh mesh_;
};

}  // namespace

SolverInfo Embree::info() {
  SolverInfo info;
  info.summary = "Embree on a mesh of triangles, in single precision; takes rays, no equation";
  info.source = "Wald et al., ACM TOG 33 (2014); Embree 3.13";
  info.page = "experiments/peers/README.md";
  info.options = {{"triangles", "1000000", "about so many, two for each cell of a square grid"},
                  {"packets", "false", "16 rays at a time (rtcIntersect16) instead of one"},
                  {"robust", "false", "RTC_SCENE_FLAG_ROBUST: no gap between triangles"}};
  info.claims = {.finds_touching_roots = false, .certified = false, .deterministic = true};
  info.forms = {Form::scalar};
  return info;
}

Embree::Embree(const Parameters& options) { const Options checked(options); }

void Embree::solve(const ScalarEquation& /*equation*/, Roots& roots) const { roots.status = Status::failed; }

SurfaceEntry Embree::seen(SurfaceEntry surface, Query query) {
  surface.formulations.clear();
  surface.kernels.clear();
  if (find_cover(surface.name) == nullptr) return surface;
  surface.formulations.push_back({"triangles",
                                  "a mesh with its vertices on the surface",
                                  "experiments/peers/README.md",
                                  {Form::scalar},
                                  0,
                                  true});
  surface.kernels.push_back(query == Query::any ? kernel_entry<MeshKernel<true>>()
                                                : kernel_entry<MeshKernel<false>>());
  return surface;
}

}  // namespace graze
