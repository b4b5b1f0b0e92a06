#include "timing.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>
#include <numeric>
#include <thread>
#include <utility>

namespace graze {
namespace {

using Clock = std::chrono::steady_clock;

/// Rays between two looks at the clock: its 20 ns are nothing beside them, and a slow solver stops in time.
constexpr std::size_t kStep = 32;
/// The same for fast solvers: as many rays as a renderer's tile.
constexpr std::size_t kFastStep = 4096;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What a thread needs of its own.
struct Memory {
  Scene::Workspace work;
  HitBuffer hits;
};

/// The rays of all groups, in order, that threads take in turn: a core that something else slows takes fewer.
class Supply {
 public:
  explicit Supply(std::span<const TimedGroup> groups) : groups_(groups) {}

  /// The next rays, at most `most` and all of one group; none at the end.
  TimedGroup take(std::size_t most) {
    const std::scoped_lock lock(mutex_);
    while (group_ < groups_.size() && next_ == groups_[group_].rays.size()) ++group_, next_ = 0;
    if (group_ == groups_.size()) return {};
    const TimedGroup& group = groups_[group_];
    const std::size_t size = std::min(most, group.rays.size() - next_);
    return {group.scene, group.rays.subspan(std::exchange(next_, next_ + size), size)};
  }

 private:
  std::mutex mutex_;
  std::span<const TimedGroup> groups_;
  std::size_t group_ = 0, next_ = 0;
};

/// Answers rays until none is left or the budget ends; returns their number.
std::size_t answer(Supply& supply, Query query, double budget, Memory& memory) {
  const auto start = Clock::now();
  double seconds = 0;
  std::size_t done = 0;
  while (seconds <= budget) {
    // Fast solvers get large batches, as in real use; the first step tells which kind this one is.
    const bool fast = done > 0 && seconds / static_cast<double>(done) < 1e-5;
    const TimedGroup part = supply.take(fast ? kFastStep : kStep);
    if (part.rays.empty()) break;
    memory.hits.clear();
    part.scene->intersect(part.rays, query, {}, memory.work, memory.hits);
    done += part.rays.size();
    seconds = seconds_since(start);
  }
  return done;
}

TimingSample run_once(const Contestant& contestant, double budget, std::span<Memory> memory) {
  TimingSample sample;
  const auto start = Clock::now();
  Supply supply(contestant.groups);
  std::vector<std::size_t> done(memory.size());
  const auto run = [&](std::size_t i) { done[i] = answer(supply, contestant.query, budget, memory[i]); };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < memory.size(); ++i) threads.emplace_back(run, i);
  run(0);
  for (std::thread& thread : threads) thread.join();
  sample.rays = std::accumulate(done.begin(), done.end(), std::size_t{0});
  const double seconds = seconds_since(start);
  sample.ns_per_ray = 1e9 * seconds / static_cast<double>(std::max<std::size_t>(sample.rays, 1));
  std::size_t all = 0;
  for (const TimedGroup& group : contestant.groups) all += group.rays.size();
  sample.censored = sample.rays < all;
  return sample;
}

}  // namespace

void time_contestants(std::span<const Contestant> contestants, const TimingOptions& options,
                      const std::function<bool(const TimingSample&)>& done) {
  std::vector<std::pair<std::size_t, int>> order;
  for (int repeat = -1; repeat < options.repeats; ++repeat) {
    for (std::size_t i = 0; i < contestants.size(); ++i) order.emplace_back(i, repeat);
  }
  // Fisher-Yates on the counted turns; the warm-up turns (repeat -1) stay first.
  Rng rng(options.seed);
  for (std::size_t i = order.size(); i > contestants.size() + 1; --i) {
    const std::size_t span = i - contestants.size();
    std::swap(order[i - 1], order[contestants.size() + rng.next() % span]);
  }
  const auto threads = static_cast<std::size_t>(std::max(1, options.threads));
  std::vector<std::vector<Memory>> memory(contestants.size());
  for (std::vector<Memory>& own : memory) own.resize(threads);
  for (std::size_t turn = 0; turn < order.size(); ++turn) {
    const auto [index, repeat] = order[turn];
    // A warm-up needs one block only: it fills memory pools and the branch predictors.
    const double budget = repeat < 0 ? 0.1 * options.budget_seconds : options.budget_seconds;
    TimingSample sample = run_once(contestants[index], budget, memory[index]);
    if (repeat < 0) continue;
    sample.contestant = index;
    sample.repeat = repeat;
    sample.turn = turn - contestants.size();
    if (!done(sample)) return;
  }
}

PinnedCore::PinnedCore() {
  cpu_set_t before;
  CPU_ZERO(&before);
  const int core = sched_getcpu();
  if (core < 0 || sched_getaffinity(0, sizeof before, &before) != 0) {
    warning_ = "could not pin the timing pass to one core";
    return;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(core), &one);
  if (sched_setaffinity(0, sizeof one, &one) != 0) {
    warning_ = "could not pin the timing pass to one core";
    return;
  }
  previous_.resize(sizeof before);
  std::memcpy(previous_.data(), &before, sizeof before);
}

PinnedCore::~PinnedCore() {
  if (previous_.empty()) return;
  cpu_set_t before;
  std::memcpy(&before, previous_.data(), sizeof before);
  sched_setaffinity(0, sizeof before, &before);
}

Spread spread(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto rank = [&](double q) {
    const auto n = static_cast<double>(samples.size());
    return samples[static_cast<std::size_t>(std::max(0.0, std::ceil(q * n) - 1))];
  };
  return {samples.front(), rank(0.5), rank(0.9)};
}

}  // namespace graze
