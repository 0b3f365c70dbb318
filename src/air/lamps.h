#pragma once
// The glow of lamps in media.

#include "air/compose.h"

namespace brume::air {

struct LampKernels {
  /// Adds to L (and each share[k].L, if share) what the media scatter of all lamps:
  ///   Int T(s) sum_i rho_i sigma_i albedo_i phase_i E(s) ds
  /// `scratch` as for the walk.
  void (*add)(const Compiled&, int k, const Medium* const* media,
              const float* const* weights, const Rays&, float* const L[3],
              const Stretch* share, void* scratch) noexcept;
  unsigned long (*scratch_bytes)(int k);
};
BRUME_ISA_DECLARE(LampKernels, lamp_kernels)

}  // namespace brume::air
