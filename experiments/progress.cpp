#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace graze {
namespace {

std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_interrupt(int signal) {
  stop_asked = true;
  std::signal(signal, SIG_DFL);
}

using Clock = std::chrono::steady_clock;

std::string duration(double seconds) {
  return fmt::format("{:%H:%M:%S}", std::chrono::seconds(static_cast<long>(seconds)));
}

}  // namespace

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      shown_() {
  show(false);
}

Progress::~Progress() { show(true); }

void Progress::advance(std::size_t parts) {
  const std::lock_guard lock(mutex_);
  done_ += parts;
  const double pause = terminal_ ? 0.2 : 15;  // seconds
  if (std::chrono::duration<double>(Clock::now() - shown_).count() >= pause) show(false);
}

void Progress::show(bool last) {
  shown_ = Clock::now();
  const double seconds = std::chrono::duration<double>(shown_ - start_).count();
  const double share = total_ == 0 ? 1 : static_cast<double>(done_) / static_cast<double>(total_);
  const std::string eta = done_ == 0 || done_ >= total_
                              ? ""
                              : fmt::format(", about {} left", duration(seconds * (1 - share) / share));
  const std::string text =
      fmt::format("{}: {}/{} ({:.0f} %) in {}{}", what_, done_, total_, 100 * share, duration(seconds), eta);
  if (terminal_) {
    constexpr int kWidth = 30;
    const int filled = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
    fmt::print(stderr, "\r\x1b[K[{:#<{}}{:.<{}}] {}{}", "", filled, "", kWidth - filled, text,
               last ? "\n" : "");
  } else {
    fmt::print(stderr, "{}\n", text);
  }
  std::fflush(stderr);
}

void watch_for_interrupt() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

bool interrupted() { return stop_asked; }

}  // namespace graze
