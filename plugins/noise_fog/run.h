#pragma once
// The kernels, by instruction set.

#include <memory>

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

/// None are kept yet. 25 MiB of address space; memory is what nodes are written to.
inline std::unique_ptr<Tracks> new_tracks() {
  return std::make_unique_for_overwrite<Tracks>();
}

struct Kernels {
  void (*integral)(const Fog&, Tracks&, const brume_rays&, const float* t0,
                   const float* t1, float* D) noexcept;
  void (*density)(const Fog&, const brume_rays&, const float* t, float* rho) noexcept;
};
BRUME_ISA_DECLARE(Kernels, kernels)

}  // namespace brume::noise_fog
