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
  /// Room for up to `hits` hits of the next rays, to be filled in the arrays and cut by close_rays; hits of
  /// surface 0, not touching, if nobody says otherwise.
  void grow(std::size_t hits) {
    l.resize(l.size() + hits);
    surface.resize(l.size(), 0);
    multiplicity.resize(l.size(), 1);
  }
  /// Closes the answers of counts.size() rays at once, all ok: counts[i] hits each, in the arrays since the
  /// last ray was closed. `work`: as many counters, or more.
  void close_rays(std::span<const std::int8_t> counts, std::span<const Counters> work) {
    std::uint32_t end = ends_.empty() ? 0 : ends_.back();
    const std::size_t first = ends_.size();
    ends_.resize(first + counts.size());
    std::uint32_t* const ends = ends_.data() + first;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      end += static_cast<std::uint8_t>(counts[i]);  // not negative: no ray is open
      ends[i] = end;
    }
    l.resize(end);
    surface.resize(end);
    multiplicity.resize(end);
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
