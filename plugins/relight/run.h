#pragma once
// The kernels, by instruction set.

#include <cstddef>

#include "num/isa.h"

namespace relight {

/// Pixels worked on together: their planes stay in the first-level cache.
inline constexpr int kRun = 256;
/// A surface is farther from the eye than this [m]: nearer to a lamp no light is told.
inline constexpr float kNearest = 1e-15f;

/// A run of pixels with two more on each side, in a row of a tile: planes at the run's
/// first pixel. Origins null: all at the eye.
struct Seen {
  int n = 0;
  std::ptrdiff_t row_stride = 0;
  const float *t = nullptr, *dx = nullptr, *dy = nullptr, *dz = nullptr;
  const float *ox = nullptr, *oy = nullptr, *oz = nullptr;
  float forward[3] = {};  ///< of the camera
  float footprint = 0;    ///< of a pixel: angle [rad]; orthographic: width [m]
};

/// Points and unit normals; w, inverse distance, is 0 where there is no surface. All
/// surfaces lie between lo and hi.
struct Surface {
  alignas(64) float w[kRun], x[3][kRun], n[3][kRun];
  float lo[3], hi[3];
};

/// What can be told of a light from afar.
struct Reach {
  bool lamp = true;         ///< else: light from `direction`, toward it
  float position[3] = {};   ///< relative to the eye
  float direction[3] = {};  ///< of a spotlight: where it shines to
  float cosine = -2;        ///< of its cone, a little less; -2: it has none
  float cone = 0;           ///< that angle [rad]
  float radius2 = 0;        ///< farther away it is left out [m^2]
};

struct Kernels {
  /// x, and w = 1/t, 0 for background and where alpha is not > 0. Returns whether there
  /// is any surface.
  bool (*points)(const Seen&, const float* alpha, Surface&) noexcept;
  /// Normals from depth. The neighbours' planes must hold two pixels around the run.
  void (*normals)(const Seen&, Surface&) noexcept;
  /// Normals from channels: v = M (nx, ny, nz), M row by row; toward the eye where the
  /// channels hold no direction.
  void (*from_channels)(const Seen&, const float* nx, const float* ny, const float* nz,
                        const float M[9], Surface&) noexcept;
  /// The pixels that a light may reach, in order; returns how many. What it leaves out
  /// gets no light, or is farther away than `radius2`.
  int (*lit)(const Reach&, const Surface&, int n, int* out) noexcept;
};
BRUME_ISA_DECLARE(Kernels, kernels)

}  // namespace relight
