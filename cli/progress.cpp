#include "progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brume::cli {

Progress::Progress(const Terminal& terminal, std::size_t frames)
    : terminal_(terminal), fractions_(frames, 0.0f) {}

Progress::~Progress() { terminal_.status(""); }

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::reached(std::size_t i, double fraction) {
  if (!terminal_.shows_progress()) return;
  const std::lock_guard lock(mutex_);
  // Bands end in any order; a bar never goes back.
  const float f = std::clamp(float(fraction), fractions_[i], 1.0f);
  sum_ += double(f) - double(fractions_[i]);
  fractions_[i] = f;
  if (Clock::now() - drawn_ < std::chrono::milliseconds(100)) return;
  draw();
}

void Progress::over(std::size_t i, const std::string& text) {
  const std::lock_guard lock(mutex_);
  ++over_;
  sum_ += 1 - double(fractions_[i]);
  fractions_[i] = 1;
  if (terminal_.shows_progress()) {
    const bool all = fractions_.size() == 1;  // then no line sums it up
    if (!text.empty()) all ? terminal_.say(text) : terminal_.detail(text);
    if (!all) draw();
  } else if (!text.empty()) {
    const std::string of =
        fractions_.size() > 1 ? fmt::format("[{}/{}] ", over_, fractions_.size()) : "";
    terminal_.say(of + text);
  }
}

void Progress::draw() {
  drawn_ = Clock::now();
  const double part = sum_ / double(fractions_.size()), t = seconds();
  std::string right = fmt::format(" {}/{}", over_, fractions_.size());
  if (over_ > 0) right += fmt::format("  {:.3g} frames/s", double(over_) / t);
  if (part > 0.02 && t > 0.5)
    right += fmt::format("  {} left", clock_text(t * (1 - part) / part));
  const int width = std::clamp(terminal_.columns() - int(right.size()) - 3, 8, 50);
  const int full = int(std::lround(part * width));
  terminal_.status('[' + std::string(std::size_t(full), '=') +
                   std::string(std::size_t(width - full), ' ') + ']' + right);
}

std::string clock_text(double seconds) {
  const long s = std::lround(std::ceil(seconds));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

}  // namespace brume::cli
