#pragma once
// Rays of a block as a cone that is flat: what takes a look at every ray, and at every
// medium.

#include "air/medium.h"
#include "num/isa.h"

namespace brume::air {

/// Around rays from the eye: unit axis, cosine and sine of the half angle, how far it
/// goes; and that no ray leaves the plane across the unit `normal` by more than `off`
/// (its sine), as the rays of a row of pixels do not.
struct Cone {
  float axis[3] = {0, 0, 1}, cosine = -1, sine = 0, farthest = 0;
  float normal[3] = {0, 0, 1}, off = 1;
};

/// Bounding spheres of media, relative to the eye, a plane each; radius inf: no bounds.
/// Room for a whole batch beyond n.
struct Spheres {
  int n = 0;
  const float *x = nullptr, *y = nullptr, *z = nullptr, *radius = nullptr;
};

struct ConeKernels {
  /// The sum of all directions, and the largest end. NaN in any leaves NaN in the sum.
  void (*axis)(const Rays&, float sum[3], float* farthest) noexcept;
  /// The least cosine between cone.axis and a ray, and the largest sine between a ray and
  /// the plane across cone.normal.
  void (*narrowest)(const Rays&, const Cone&, float* cosine, float* off) noexcept;
  /// Which spheres a ray of the cone may meet, in their order; how many. `found` has room
  /// for all.
  int (*meet)(const Cone&, const Spheres&, int* found) noexcept;
};
BRUME_ISA_DECLARE(ConeKernels, cone_kernels)

}  // namespace brume::air
