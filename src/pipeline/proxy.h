#pragma once
// Parts of a frame for look-dev: a region, a coarser grid, or both. Internal to
// src/pipeline.

#include "pipeline/frame_file.h"
#include "pipeline/sources.h"

namespace brume {

/// The region (display pixels of the full frame) of the frame, every proxy-th pixel: all
/// its channels, with the scene applied. The pixel (X, Y) of a proxy covers the pixels [X
/// n, X n + n) of the frame: colour, coverage and masks are their mean, depth and
/// positions (which have none) are taken at its middle. Fills report.counts and seconds.
/// Throws Error when the region misses the picture.
Image render_part(const PreparedFrame&, const FrameFiles&, const ApplyOptions&,
                  FrameReport&);

}  // namespace brume
