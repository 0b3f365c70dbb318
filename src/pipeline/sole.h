#pragma once
// Pixels under one medium alone, in one pass from depth to colour: rays, distances,
// transmittance and composite without a plane in between. The general way (rows.cpp)
// needs 30 planes of a block in the cache; most frames have one fog and no layers.

#include "air/air.h"
#include "scene/depth_run.h"
#include "scene/view_run.h"

namespace brume::pipeline {

/// A run of n pixels of one row. Depth is planar, the camera perspective.
struct SoleRun {
  int x = 0, n = 0;
  RayRow row;
  DepthConstants depth;
  /// falloff x rise per planar depth is linear along the row: at its middle, and per
  /// column.
  float fall_at_middle = 0, fall_per_f = 0;
  const float* z;         ///< planar depth
  const float* distance;  ///< in its place where edges were covered; null: from z
  const float* a;         ///< coverage; null: 1 where there is a depth, else 0
  const float* S[3];
  float* C[3];   ///< may be S
  float* a_out;  ///< may be null
};

struct SoleKernels {
  /// Composites (the arithmetic of composite.h). Returns whether any pixel was touched.
  bool (*apply)(const SoleMedium&, const SoleRun&) noexcept;
  /// Whether a pixel with a > 0 has no depth.
  bool (*uncovered)(const SoleRun&) noexcept;
};

BRUME_ISA_DECLARE(SoleKernels, sole_kernels)

}  // namespace brume::pipeline
