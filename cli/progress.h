#pragma once
// How far a run is: a bar on a terminal, a line per frame elsewhere.

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "terminal.h"

namespace brume::cli {

class Progress {
 public:
  Progress(const Terminal&, std::size_t frames);
  ~Progress();  ///< removes the bar

  /// Frame `i` has come this far (0 to 1). From any thread; draws ten times a second.
  void reached(std::size_t i, double fraction);
  /// Frame `i` is over; `text` says how, on its own line where there is no bar.
  void over(std::size_t i, const std::string& text);

  double seconds() const;

 private:
  void draw();

  const Terminal& terminal_;
  mutable std::mutex mutex_;
  std::vector<float> fractions_;
  double sum_ = 0;
  std::size_t over_ = 0;
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), drawn_{};
};

/// "0:04", "12:31", "1:02:03".
std::string clock_text(double seconds);

}  // namespace brume::cli
