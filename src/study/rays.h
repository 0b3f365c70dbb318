#pragma once
// The pixels of a frame as rays: what every way of computing the air is given.

#include <cstdint>
#include <span>
#include <vector>

#include "air/air.h"
#include "pipeline/impl.h"
#include "pipeline/sources.h"

namespace brume::study {

/// Rays in planes; all of one eye unless `o` is there. Planes are longer than `count`:
/// they end with copies of the last ray, up to a multiple of 16.
struct Rays {
  std::size_t count = 0;
  std::vector<float> o[3];  ///< relative to the eye; empty: at it
  std::vector<float> d[3];  ///< unit
  std::vector<float> t;     ///< distance of what the pixel shows [m], inf for nothing
  std::vector<float> S[3];  ///< its colour
  std::vector<int> x, y;    ///< the pixel
  /// By running stage of the frame: mask x mix; empty: 1.
  std::vector<std::vector<float>> weights;

  /// Those with these indices, in that order.
  Rays pick(std::span<const std::uint32_t>) const;
  /// Makes planes a multiple of 16 long.
  void pad();
  /// n rays from `begin` as the integrator takes them; `w` is filled with weights.
  RaySpans spans(std::size_t begin, std::size_t n, std::vector<const float*>& w) const;
};

/// Every `step`-th row of the frame's data window, all columns. Rays and distances are
/// those of the product, bit for bit; coverage does not count: a pixel is one sample.
Rays read_rays(const PreparedFrame::Impl&, const FrameFiles&, int step);

}  // namespace brume::study
