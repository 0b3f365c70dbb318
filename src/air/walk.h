#pragma once
// The general rule: any number of media on a ray, overlapping, with any sources.

#include "air/compose.h"

namespace brume::air {

struct WalkKernels {
  /// How many bytes of scratch `walk` wants for k media, aligned to 64.
  unsigned long (*scratch_bytes)(const Compiled&, int k);
  /// L of all media together, from the eye outward, each lane in steps of its own.
  /// weights[k] may be null. share[k]: three planes each, or share null.
  void (*walk)(const Compiled&, int k, const Medium* const* media,
               const float* const* weights, const Rays&, float* const L[3],
               const Stretch* share, void* scratch) noexcept;
};
BRUME_ISA_DECLARE(WalkKernels, walk_kernels)

}  // namespace brume::air
