// Progress on stderr: a bar with ETA on a terminal, a plain line now and then otherwise. And Ctrl-C.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace graze {

/// Counts finished parts of a long piece of work. Thread-safe.
class Progress {
 public:
  Progress(std::string what, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void advance(std::size_t parts = 1);

 private:
  void show(bool last);

  std::string what_;
  std::size_t total_;
  std::size_t done_ = 0;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, shown_;
  std::mutex mutex_;
};

/// Makes the first Ctrl-C ask the program to stop at the next good place; the second ends it at once.
void watch_for_interrupt();
bool interrupted();

}  // namespace graze
