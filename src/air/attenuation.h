#pragma once
// What stands between a point and a light: all media that absorb, and the shadowers.

#include "air/along.h"

namespace brume::air::inline BRUME_ISA_NS {

/// tau += optical depth of one medium from the points ray.o along ray.d over [0, far].
/// Stages' weights belong to the view ray and do not count here.
inline void add_optical_depth(const Medium& m, const Ray<Batch>& ray, Batch far,
                              Batch tau[3]) {
  const auto p = along(m, ray);
  const auto in = inside(m, p, ray, Batch(1.f), Batch(0.f), far, false);
  const Batch D = depth_to(m, p, ray, Batch(1.f), in, far);
  for (int c = 0; c < 3; ++c) tau[c] += min(Batch(m.sigma[c]) * D, Batch(kFar));
}

/// The same of all shadowers.
inline void add_shadowers(const Compiled& world, const Ray<Batch>& ray, Batch far,
                          Batch tau[3]) {
  const Spans s(ray);
  float t1[Batch::W], rgb[3][Batch::W];
  store(t1, forever(far));
  for (const Shadower& shadow : world.shadowers) {
    shadow.optical_depth(shadow.self, &s.rays, t1, rgb[0], rgb[1], rgb[2]);
    for (int c = 0; c < 3; ++c)
      tau[c] += clamp(load<Batch>(rgb[c]), Batch(0.f), Batch(kFar));
  }
}

/// The same of all there is.
inline void add_optical_depth(const Compiled& world, const Ray<Batch>& ray, Batch far,
                              Batch tau[3]) {
  for (const Medium* m : world.absorbers) add_optical_depth(*m, ray, far, tau);
  if (world.shadowers.size > 0) add_shadowers(world, ray, far, tau);
}

}  // namespace brume::air::inline BRUME_ISA_NS
