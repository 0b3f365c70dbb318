#pragma once
// What the values of a depth channel look like.

#include <cstdint>
#include <string>
#include <vector>

#include "image/io.h"

namespace brume::cli {

struct DepthStats {
  std::uint64_t pixels = 0, background = 0, nan = 0, infinite = 0, negative = 0, zero = 0;
  double nearest = 0, median = 0,
         farthest = 0;                    ///< of the surfaces; 0 when there are none
  std::vector<double> background_values;  ///< the distinct ones, at most four
  /// What the values suggest of the convention: "distances or planar depths", "looks
  /// normalised (0..1)..."; never acted upon.
  std::string convention;
};

/// Reads the channel by bands. Background: <= 0, >= 1e9, infinite, NaN.
DepthStats depth_stats(const ImageReader&, int channel);

}  // namespace brume::cli
