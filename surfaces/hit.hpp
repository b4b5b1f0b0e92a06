// Hits of a batch of rays, as parallel arrays: only what was asked for is computed and stored.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <graze/solvers/roots.hpp>
#include <graze/surfaces/ray.hpp>

namespace graze {

/// all hits, the first hit, or whether there is one (shadow rays: at most one hit is reported, any one).
enum class Query : std::uint8_t { all, first, any };

/// What to compute beside l. What is not wanted costs nothing.
struct Wanted {
  bool points = false;
  bool normals = false;
  bool params = false;
};

/// Answers of a batch of rays, in the order of the rays. Hits of ray i: indices [begin(i), end(i)), sorted by
/// l.
class HitBuffer {
 public:
  std::vector<double> l;                      ///< in units of |d|, > 0
  std::vector<std::uint32_t> surface;         ///< index in the scene
  std::vector<std::uint32_t> multiplicity;    ///< 2 = touches
  std::vector<Vec3> point;                    ///< if wanted
  std::vector<Vec3> normal;                   ///< if wanted: outward, unit
  std::vector<std::array<double, 2>> params;  ///< if wanted: named by the surface's info
  std::vector<Status> status;                 ///< one a ray
  std::vector<Counters> counters;             ///< one a ray

  [[nodiscard]] std::size_t rays() const { return status.size(); }
  [[nodiscard]] std::size_t begin(std::size_t ray) const { return ray == 0 ? 0 : ends_[ray - 1]; }
  [[nodiscard]] std::size_t end(std::size_t ray) const { return ends_[ray]; }
  [[nodiscard]] std::size_t count(std::size_t ray) const { return end(ray) - begin(ray); }

  /// A hit of the ray that is closed next.
  void append(double hit_l, std::uint32_t hit_surface, std::uint32_t hit_multiplicity) {
    l.push_back(hit_l);
    surface.push_back(hit_surface);
    multiplicity.push_back(hit_multiplicity);
  }
  /// Closes the answer of the next ray: the hits appended since the last call are its hits.
  void close_ray(Status ray_status, Counters ray_counters) {
    ends_.push_back(static_cast<std::uint32_t>(l.size()));
    status.push_back(ray_status);
    counters.push_back(ray_counters);
  }
  /// Closes the answers of counts.size() rays at once, all ok: hits of surface 0 that do not touch, ray i's
  /// at l_of[0][i], l_of[1][i], ..., counts[i] of them, at most kMost. `work`: as many counters, or more. No
  /// branch depends on a ray.
  template <std::size_t kMost>
  void append_rays(std::span<const std::int8_t> counts, const std::array<const double*, kMost>& l_of,
                   std::span<const Counters> work) {
    const std::size_t rays = ends_.size(), hits = l.size();
    l.resize(hits + kMost * counts.size());
    ends_.resize(rays + counts.size());
    double* const next = l.data();
    std::uint32_t* const ends = ends_.data() + rays;
    auto end = static_cast<std::uint32_t>(hits);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      for (std::size_t k = 0; k < kMost; ++k) next[end + k] = l_of[k][i];
      end += static_cast<std::uint8_t>(counts[i]);
      ends[i] = end;
    }
    l.resize(end);
    surface.resize(end, 0);
    multiplicity.resize(end, 1);
    status.resize(ends_.size(), Status::ok);
    counters.insert(counters.end(), work.begin(), work.begin() + static_cast<std::ptrdiff_t>(counts.size()));
  }
  /// Empties the buffer and keeps its memory.
  void clear() {
    l.clear();
    surface.clear();
    multiplicity.clear();
    point.clear();
    normal.clear();
    params.clear();
    status.clear();
    counters.clear();
    ends_.clear();
  }

 private:
  std::vector<std::uint32_t> ends_;
};

}  // namespace graze
