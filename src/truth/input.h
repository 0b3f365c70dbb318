#pragma once
// What a frame says of its pixels, worked out anew in double: DESIGN "Exact meanings".
// Internal to src/truth.

#include <limits>

#include "pipeline/impl.h"
#include "pipeline/sources.h"

namespace brume::truth {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

/// A frame's files, what the pipeline planned for it, and all channels that are read.
struct FrameInput {
  FrameFiles files;
  PreparedFrame prepared;
  Window window;                       ///< the pixels there are: the data window
  std::vector<std::vector<float>> in;  ///< by input

  FrameInput(const Session&, double frame, const std::filesystem::path&);

  const PreparedFrame::Impl& f() const { return prepared.impl(); }
  std::size_t at(int x, int y) const {
    return std::size_t(y - window.y) * std::size_t(window.width) +
           std::size_t(x - window.x);
  }
  double value(int input, int x, int y) const {
    return double(in[std::size_t(input)][at(x, y)]);
  }
  View::RayAt ray(int x, int y) const;
  /// Of the pixel's sample, inf for none; of one partly covered without a depth its
  /// nearest neighbour's.
  double distance(int x, int y) const;
  /// Coverage as it stands in the file: any number. Without one all that has a distance
  /// is covered, and all of a plate.
  double alpha(int x, int y) const;
  /// Mask x mix of a stage. `behind`: nothing but background is seen there.
  double weight(const RunningStage&, int x, int y, bool behind) const;

 private:
  double sample_distance(int x, int y) const;
};

}  // namespace brume::truth
