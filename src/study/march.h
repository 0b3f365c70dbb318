#pragma once
// Even steps through everything at once, as renderers do it. Internal to src/study.

#include "air/medium.h"
#include "num/isa.h"

namespace brume::study {

/// As many media a world may have.
inline constexpr int kMarchedMedia = 64;

struct MarchKernels {
  /// Adds up `steps` steps between a ray's begin and the lesser of its end and `far` [m]:
  /// T *= e^(-sigma ds), L += T e ds with everything taken in the middle of the step.
  /// rays.n is a multiple of 16; `weights` by stage, null: 1.
  void (*march)(const air::Compiled&, const air::Rays&, const float* const* weights,
                int steps, float far, float* const T[3], float* const L[3]) noexcept;
};
BRUME_ISA_DECLARE(MarchKernels, march_kernels)

}  // namespace brume::study
