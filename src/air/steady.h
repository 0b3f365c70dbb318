#pragma once
// Light that reaches every point of a ray alike: suns and sky light that nothing
// attenuates. Their in-scattering is a constant source along the ray.

#include "air/along.h"
#include "air/phase.h"

namespace brume::air::inline BRUME_ISA_NS {

/// S += sky_albedo (phase x irradiance of each sun + mean radiance of the sky).
BRUME_INLINE void add_steady(const Medium& m, const Compiled& world,
                             const Ray<Batch>& ray, Batch S[3]) {
  for (const Light& l : world.steady) {
    Batch p(1.f);  // the phase function's integral over a sky of one radiance
    if (l.kind == BRUME_SUN) {
      // Light travels along -direction and leaves toward the ray's origin, along -d.
      const Batch to[3] = {l.direction[0], l.direction[1], l.direction[2]};
      p = phase(m.phase, to, ray.d, m.g);
    }
    for (int c = 0; c < 3; ++c) S[c] += Batch(m.sky_albedo[c] * l.power[c]) * p;
  }
}

}  // namespace brume::air::inline BRUME_ISA_NS
