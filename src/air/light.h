#pragma once
// Light at points, for surfaces.

#include "air/medium.h"
#include "air/sky_light.h"
#include "num/isa.h"

namespace brume::air {

struct LightKernels {
  /// Irradiance E on planes at points rays.o with unit normals rays.d, with what stands
  /// between. A sky light by its map where it has one, else pi x its mean radiance.
  void (*irradiance)(const Compiled&, const Light&, const SkyMap*, const Rays&,
                     float* const E[3]) noexcept;
};
BRUME_ISA_DECLARE(LightKernels, light_kernels)

}  // namespace brume::air
