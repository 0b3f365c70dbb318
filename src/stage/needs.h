#pragma once
// What a stage wants to read and change at one frame: brume_needs of plugin.h as a value
// that owns its text. A C++ plugin fills it in; the host gets it back checked.

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace brume {

struct StageNeeds {
  std::string idle;  ///< not empty: nothing to do at this frame, and this is why
  std::vector<std::string>
      channels;  ///< further channels, delivered to run in this order
  std::vector<std::string> optional;  ///< null in run where the frame has none
  bool camera = false, depth = false;
  bool whole_frame = false;  ///< lens: wants the frame as one tile
  int rows_around = 0, columns_around = 0;
  bool changes_alpha = false;
  std::array<int, 4> screen{0, 0, 0, 0};  ///< x, y, width, height in display pixels
                                          ///< outside which nothing changes; width 0:
                                          ///< everywhere
  double nearest = 0;  ///< distance interval in which it can matter [m]
  double farthest = std::numeric_limits<double>::infinity();
  std::uint32_t lights = 0;  ///< surface: kinds of light it answers to, BRUME_LIGHT_BIT
                             ///< of each; left out where there are none of them
  std::uint32_t laws = 0;    ///< lens: what it promises, BRUME_LINEAR | BRUME_KEEPS_LIGHT
  double promise = 0;  ///< surface, without a knob: |dC| <= promise (white + |C|) is what
                       ///< run may be off by numerically
};

}  // namespace brume
