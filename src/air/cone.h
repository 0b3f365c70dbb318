#pragma once
// The cone around a block of rays: what of it takes a look at every ray.

#include "air/medium.h"
#include "num/isa.h"

namespace brume::air {

struct ConeKernels {
  /// The sum of all directions, and the largest end. NaN in any leaves NaN in the sum.
  void (*axis)(const Rays&, float sum[3], float* farthest) noexcept;
  /// The least cosine between `axis` and a ray.
  void (*narrowest)(const Rays&, const float axis[3], float* cosine) noexcept;
};
BRUME_ISA_DECLARE(ConeKernels, cone_kernels)

}  // namespace brume::air
