#pragma once
// The kernels behind distances_from_depth, distances_from_position and has_uncovered, one
// table per instruction set.

#include "num/isa.h"
#include "scene/view.h"

namespace brume {

/// DepthRule in the floats that the kernels use.
struct DepthConstants {
  float scale = 1;                 ///< metres per unit; normalised: far - near [m]
  float near = 0;                  ///< normalised: [m]
  float from = 0;                  ///< the smallest float that is background
  float slope = 1, intercept = 0;  ///< normalised: t = slope v + intercept
};

/// The constants of a rule.
DepthConstants depth_constants(const DepthRule&) noexcept;

/// The eye in the position pass's own units, in two floats: (P - high) - low is P - eye
/// without cancellation.
struct PositionConstants {
  float high[3], low[3];
  float metres;
};

struct DepthKernels {
  using Distances = void(const DepthConstants&, int n, const float* depth,
                         const float* per_planar, float* distance) noexcept;
  Distances *planar, *distance, *inverse, *normalised;
  void (*position)(const PositionConstants&, int n, const float* px, const float* py,
                   const float* pz, const float* alpha, const RaySpan&,
                   float* distance) noexcept;
  bool (*uncovered)(int n, const float* alpha, const float* distance) noexcept;
  bool (*any_finite)(int n, const float* distance) noexcept;
};
BRUME_ISA_DECLARE(DepthKernels, depth_kernels)

}  // namespace brume
