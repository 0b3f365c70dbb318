#pragma once
// Light at a point: from a sun, a sky, a lamp; with what stands between.

#include "air/attenuation.h"
#include "air/phase.h"

namespace brume::air::inline BRUME_ISA_NS {

/// Light on its way to a batch of points: the direction it comes from, the distance to
/// its source (kFar: sun), and its irradiance on a plane facing it, unattenuated.
struct Incident {
  Batch to[3], distance, E[3];
};

BRUME_INLINE void cross(const Batch a[3], const Batch b[3], Batch out[3]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = difference_of_products(a[j], b[k], a[k], b[j]);
  }
}

// How much of a spotlight goes out along -`to`, at the angle theta from its axis; by the
// cross product, as a cosine near 1 tells no angles below 3e-4.
//   cone_falloff 0: 1 inside, smoothstep over the outer cone_soft. 1: saturate(|cone /
//   theta| - 1) (Intel, "Ocean fog" 2008); 1 on the axis.
BRUME_INLINE Batch cone_edge(const Light& l, const Batch axis[3], const Batch to[3]) {
  const Batch one(1.f), zero(0.f);
  Batch sine[3];
  cross(axis, to, sine);
  const Batch theta = atan2pos(sqrt(dot(sine, sine)), -dot(axis, to));
  if (l.cone_falloff == 1)
    return clamp(Batch(l.cone) / max(theta, Batch(1e-9f)) - one, zero, one);
  const Batch soft(l.cone_soft > 1e-6f ? l.cone_soft : 1e-6f);
  const Batch x = clamp((Batch(l.cone) - theta) / soft, zero, one);
  return x * x * (Batch(3.f) - Batch(2.f) * x);
}

BRUME_INLINE Incident incident(const Light& l, const Batch x[3]) {
  Incident in;
  const Batch axis[3] = {l.direction[0], l.direction[1], l.direction[2]};
  if (l.kind == BRUME_SUN || l.kind == BRUME_SKY_LIGHT) {
    for (int c = 0; c < 3; ++c) {
      in.to[c] = axis[c];
      in.E[c] = Batch(l.power[c]);
    }
    in.distance = Batch(kFar);
    return in;
  }
  Batch v[3];
  for (int c = 0; c < 3; ++c) v[c] = Batch(l.position[c]) - x[c];
  const Batch r2 = max(dot(v, v), Batch(1e-30f));
  const Batch r = sqrt(r2), inv = Batch(1.f) / r;
  for (int c = 0; c < 3; ++c) in.to[c] = v[c] * inv;
  Batch fall = Batch(1.f) / max(r2, Batch(l.near2));
  if (l.kind == BRUME_SPOT) fall = fall * cone_edge(l, axis, in.to);
  for (int c = 0; c < 3; ++c) in.E[c] = Batch(l.power[c]) * fall;
  in.distance = r;
  return in;
}

/// in.E attenuated by all that stands between the points x and the light.
BRUME_INLINE void attenuate(const Compiled& world, const Light& l, const Batch x[3],
                            Incident& in) {
  if (!l.attenuated) return;
  const Ray<Batch> ray = {{x[0], x[1], x[2]}, {in.to[0], in.to[1], in.to[2]}, false};
  Batch tau[3] = {0.f, 0.f, 0.f};
  add_optical_depth(world, ray, in.distance, tau);
  for (int c = 0; c < 3; ++c) in.E[c] = in.E[c] * exp(-tau[c]);
}

BRUME_INLINE void point_at(const Ray<Batch>& ray, Batch t, Batch x[3]) {
  for (int i = 0; i < 3; ++i) x[i] = ray.o[i] + t * ray.d[i];
}

}  // namespace brume::air::inline BRUME_ISA_NS
