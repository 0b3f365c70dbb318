#pragma once
// A lamp and a batch of rays: where it is from each, and what lies on both ways, from the
// eye to a point on the ray and from there to the lamp.

#include "air/lit.h"
#include "air/on_ray.h"

namespace brume::air::inline BRUME_ISA_NS {

/// Where a lamp is from a ray: t of its foot, the nearest point, the vector from there to
/// the lamp, h its length.
struct Foot {
  Batch t, to[3], h, h2;
};

// By cross products, w = c x d and to = d x w: c - (c d) d would leave no digits of h
// where the ray passes near.
inline Foot foot_of(const Light& lamp, const Ray<Batch>& ray) {
  const auto cross = [](const Batch a[3], const Batch b[3], Batch out[3]) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      out[i] = difference_of_products(a[j], b[k], a[k], b[j]);
    }
  };
  Foot f;
  Batch c[3], w[3];
  for (int i = 0; i < 3; ++i) c[i] = Batch(lamp.position[i]) - ray.o[i];
  f.t = dot(c, ray.d);
  cross(c, ray.d, w);
  cross(ray.d, w, f.to);
  f.h2 = dot(w, w);
  f.h = sqrt(f.h2);
  return f;
}

/// From a point at distance x from the foot to the lamp. Distance and direction are the
/// foot's, not a difference of positions.
struct Leg {
  Batch to[3], r, fall;
};

BRUME_INLINE Leg leg_from(const Light& lamp, const Foot& f, const Ray<Batch>& ray,
                          Batch x) {
  Leg leg;
  const Batch r2 = max(x * x + f.h2, Batch(1e-30f)), inv = Batch(1.f) / sqrt(r2);
  leg.r = sqrt(r2);
  for (int i = 0; i < 3; ++i) leg.to[i] = (f.to[i] - x * ray.d[i]) * inv;
  leg.fall = Batch(1.f) / max(r2, Batch(lamp.radius2));
  const Batch axis[3] = {lamp.direction[0], lamp.direction[1], lamp.direction[2]};
  if (lamp.kind == BRUME_SPOT) leg.fall = leg.fall * cone_edge(lamp, -dot(axis, leg.to));
  return leg;
}

// Where the ray crosses the cone of half angle acos(mu): (v.a)^2 = mu^2 |v|^2 with
// v = x d - to; the mirror cone's crossings come along and do no harm.
inline void cone_crossings(const Light& lamp, const Foot& f, const Ray<Batch>& ray,
                           float mu, Batch t[2]) {
  const Batch a[3] = {lamp.direction[0], lamp.direction[1], lamp.direction[2]};
  const Batch da = dot(ray.d, a), pa = dot(f.to, a), C(mu * mu);
  const Batch A = da * da - C, b = -da * pa, c = pa * pa - C * f.h2;
  const Batch disc = C * (da * da * f.h2 + pa * pa - C * f.h2);
  const Batch root = sqrt(max(disc, Batch(0.f)));
  const Batch q = select(b < Batch(0.f), root - b, -(root + b));
  const auto crosses = disc > Batch(0.f);
  t[0] = select(crosses, f.t + q / A, Batch(kFar));
  t[1] = select(crosses, f.t + c / q, Batch(kFar));
}

/// One medium on the rays, and what the lamp at hand makes of it on the piece at hand.
struct Lit : OnRay {
  Batch piece[3];
};

/// All that a piece of a ray in a lamp's light depends on.
struct LampRays {
  const Compiled& world;
  const Light& lamp;
  Lit* on;
  int k;  ///< media in `on`
  const Ray<Batch>& ray;
  const Foot f;

  /// Optical depth from the ray's beginning to t.
  BRUME_INLINE void depth_before(Batch t, Batch tau[3]) const {
    for (int c = 0; c < 3; ++c) tau[c] = Batch(0.f);
    for (int j = 0; j < k; ++j) {
      const Lit& r = on[j];
      if (!r.m->absorbs || none(r.in.lo < t)) continue;
      const Batch D = depth_to(*r.m, r.p, ray, r.weight, r.in, t);
      for (int c = 0; c < 3; ++c) tau[c] += min(Batch(r.m->sigma[c]) * D, Batch(kFar));
    }
  }

  /// tau += what dims the lamp on the leg from x.
  BRUME_INLINE void add_depth_of(const Leg& leg, Batch x, Batch tau[3]) const {
    if (!lamp.attenuated) return;
    Batch at[3];
    point_at(ray, f.t + x, at);
    const Ray<Batch> along_leg = {
        {at[0], at[1], at[2]}, {leg.to[0], leg.to[1], leg.to[2]}, false};
    add_optical_depth(world, along_leg, leg.r, tau);
  }
};

}  // namespace brume::air::inline BRUME_ISA_NS
