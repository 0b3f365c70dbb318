#pragma once
// The kernels, by instruction set.

#include "num/isa.h"
#include "plugin.h"
#include "steps.h"

namespace brume::noise_fog {

/// What a thread keeps of the rays it was last asked about.
struct Tracks {
  static constexpr int kSlots = 4;
  Track slot[kSlots];
  std::uint64_t used[kSlots] = {}, clock = 0;
};

struct Kernels {
  void (*integral)(const Fog&, Tracks&, const brume_rays&, const float* t0,
                   const float* t1, float* D) noexcept;
  void (*density)(const Fog&, const brume_rays&, const float* t, float* rho) noexcept;
};
BRUME_ISA_DECLARE(Kernels, kernels)

}  // namespace brume::noise_fog
