#pragma once
// Where a ray passes through the shadow that a bounded medium throws in sunlight.
// Sunlight along the ray has a kink at either end; the walk cuts there, so that no shadow
// falls between its samples.

#include "air/along.h"

namespace brume::air::inline BRUME_ISA_NS {

// The part of a ray within the shape swept along the light's direction w, both ways; a
// superset of the shadow, with its edges.
//   Box: the prism |x . (e_k x w)| <= sum of |components|, k = 1..3. Ellipsoid: the
//   cylinder |x - (x . w) w| <= 1. In the shape's local coordinates.
//   Domain: any direction; the empty interval where the ray misses it.
BRUME_INLINE Interval<Batch> swept_interval(const Medium& m, const Ray<Batch>& ray,
                                            const float direction[3]) {
  const Batch far(kFar);
  Batch o[3], d[3];
  float w[3];
  for (int i = 0; i < 3; ++i) {
    const Batch row[3] = {m.A[3 * i], m.A[3 * i + 1], m.A[3 * i + 2]};
    o[i] = Batch(m.b[i]);
    if (!ray.from_eye) o[i] += dot(row, ray.o);
    d[i] = dot(row, ray.d);
    w[i] = m.A[3 * i] * direction[0] + m.A[3 * i + 1] * direction[1] +
           m.A[3 * i + 2] * direction[2];
  }
  if (m.shape == BRUME_BOX) {
    Interval<Batch> in = {-far, far};
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const Batch inv(1 / max(abs(w[i]) + abs(w[j]), 1e-30f));
      const auto s =
          slab((o[i] * w[j] - o[j] * w[i]) * inv, (d[i] * w[j] - d[j] * w[i]) * inv, far);
      in = {max(in.lo, s.lo), min(in.hi, s.hi)};
    }
    return in;
  }
  const float w2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  const Batch ow = (o[0] * w[0] + o[1] * w[1] + o[2] * w[2]) * (1 / w2);
  const Batch dw = (d[0] * w[0] + d[1] * w[1] + d[2] * w[2]) * (1 / w2);
  for (int i = 0; i < 3; ++i) {
    o[i] -= ow * w[i];
    d[i] -= dw * w[i];
  }
  return unit_ball(o, d, dot(o, o) - Batch(1.f), far);
}

/// How many numbers `shadow_cuts` may write.
inline int most_shadow_cuts(const Compiled& world) {
  return 2 * world.casters.size * world.suns.size;
}

/// Both ends of every shadow on rays that are `lit`, kFar on the others. Shadows that no
/// ray meets are left out. How many numbers there are.
inline int shadow_cuts(const Compiled& world, const Ray<Batch>& ray, Mask lit,
                       Batch* cuts) {
  int n = 0;
  for (const Medium* m : world.casters)
    for (const Light& sun : world.suns) {
      const auto in = swept_interval(*m, ray, sun.direction);
      const auto there = lit & (in.lo < in.hi) & (in.hi > Batch(0.f));
      if (none(there)) continue;
      cuts[n++] = select(there, in.lo, Batch(kFar));
      cuts[n++] = select(there, in.hi, Batch(kFar));
    }
  return n;
}

}  // namespace brume::air::inline BRUME_ISA_NS
