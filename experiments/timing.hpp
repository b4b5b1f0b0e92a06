// Times cells against one another: one pinned core, seeded interleaved order, every repeat kept.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <graze/surfaces/intersector.hpp>

namespace graze {

/// Rays and the scene that answers them. One contestant may have several groups: other scales of a surface.
struct TimedGroup {
  const Scene* scene = nullptr;
  std::span<const Ray> rays;
};

/// One contestant: its groups are answered one after the other.
struct Contestant {
  std::vector<TimedGroup> groups;
  Query query = Query::all;
};

struct TimingOptions {
  int repeats = 7;
  double budget_seconds = 0.25;  ///< a turn stops after this time; the rays done by then are what it timed
  std::uint64_t seed = 1;        ///< of the order
  int threads = 1;               ///< that share the rays of a turn; starting one takes some 20 us
};

/// One turn of one contestant.
struct TimingSample {
  std::size_t contestant = 0;
  int repeat = 0;
  std::size_t turn = 0;
  std::size_t rays = 0;
  double ns_per_ray = 0;  ///< of the clock, however many threads share the rays
  bool censored = false;  ///< the budget ended before all rays were done
};

/// Runs every contestant `repeats` times in one shuffled order on the calling thread (or on `threads`, one
/// contestant at a time), after one warm-up turn each. `done` is called after each turn; it returns false to
/// stop early.
void time_contestants(std::span<const Contestant> contestants, const TimingOptions& options,
                      const std::function<bool(const TimingSample&)>& done);

/// Pins the calling thread to the core it runs on, for the object's life. Says in `warning` what failed.
class PinnedCore {
 public:
  PinnedCore();
  ~PinnedCore();
  PinnedCore(const PinnedCore&) = delete;
  PinnedCore& operator=(const PinnedCore&) = delete;
  [[nodiscard]] const std::string& warning() const { return warning_; }

 private:
  std::string warning_;
  std::vector<unsigned char> previous_;
};

/// min, median and 90th percentile of samples (nearest rank).
struct Spread {
  double min = 0, median = 0, p90 = 0;
};
Spread spread(std::vector<double> samples);

}  // namespace graze
