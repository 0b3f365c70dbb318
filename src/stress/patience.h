#pragma once
// What a world may cost: internal to src/stress. Some are so dear that one group of rays
// takes minutes (a lamp in noise whose cells are a ten-thousandth of its ways). Past a
// deadline a medium's own integrals answer at once, with nothing, so that whatever asks
// them ends soon; what was found in such a world counts for nothing then.

#include <atomic>
#include <chrono>
#include <deque>

#include "scene/world.h"

namespace brume::stress {

class Patience {
 public:
  using Clock = std::chrono::steady_clock;

  /// Puts itself between the world's media and those who ask them; must outlive both.
  Patience(World&, Clock::time_point until);
  Patience(const Patience&) = delete;
  Patience& operator=(const Patience&) = delete;

  /// Somebody was answered with nothing.
  bool lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  struct Medium {
    brume_medium what;
    Patience& patience;
  };
  template <auto function>
  struct Through;
  static void integral(const void*, const brume_rays*, const float*, const float*,
                       float*);
  bool over();

  const Clock::time_point until_;
  std::atomic<bool> lost_{false};
  std::deque<Medium> media_;
};

}  // namespace brume::stress
