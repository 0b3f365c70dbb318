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
  Batch to[3], r, per_r, fall;
};

BRUME_INLINE Leg leg_from(const Light& lamp, const Foot& f, const Ray<Batch>& ray,
                          Batch x) {
  Leg leg;
  const Batch r2 = max(x * x + f.h2, Batch(1e-30f));
  leg.r = sqrt(r2);
  leg.per_r = Batch(1.f) / leg.r;
  for (int i = 0; i < 3; ++i) leg.to[i] = (f.to[i] - x * ray.d[i]) * leg.per_r;
  leg.fall = Batch(1.f) / max(r2, Batch(lamp.near2));
  const Batch axis[3] = {lamp.direction[0], lamp.direction[1], lamp.direction[2]};
  if (lamp.kind == BRUME_SPOT) leg.fall = leg.fall * cone_edge(lamp, axis, leg.to);
  return leg;
}

// Where the ray crosses the cone: (v.a)^2 = (1 - s2) |v|^2 with v = x d - to and s2 the
// squared sine of its half angle; the mirror cone's crossings come along and do no harm.
// In sines, so that a narrow cone along the ray keeps its digits:
//   A x^2 - 2 (da pa) x + c = 0,  A = s2 - |d x a|^2,  c = s2 h^2 - |to x a|^2,
//   disc = (1 - s2) (s2 h^2 - (d . to x a)^2)
inline void cone_crossings(const Light& lamp, const Foot& f, const Ray<Batch>& ray,
                           float s2, Batch t[2]) {
  const Batch a[3] = {lamp.direction[0], lamp.direction[1], lamp.direction[2]};
  Batch da_sine[3], pa_sine[3];
  cross(ray.d, a, da_sine);
  cross(f.to, a, pa_sine);
  const Batch da = dot(ray.d, a), pa = dot(f.to, a), s(s2);
  const Batch A = s - dot(da_sine, da_sine), b = -da * pa,
              c = s * f.h2 - dot(pa_sine, pa_sine);
  const Batch apart = dot(ray.d, pa_sine);
  const Batch disc = Batch(1.f - s2) * (s * f.h2 - apart * apart);
  const Batch root = sqrt(max(disc, Batch(0.f)));
  const Batch q = select(b < Batch(0.f), root - b, -(root + b));
  const auto crosses = disc >= Batch(0.f);  // at 90 degrees a plane: 0
  t[0] = select(crosses, f.t + q / A, Batch(kFar));
  t[1] = select(crosses, f.t + c / q, Batch(kFar));
}

/// Nodes of the rule for a piece (lamp_rule.h).
constexpr int kNodes = 15;

/// One medium on the rays, and what the lamp at hand makes of it on the piece at hand.
struct Lit : OnRay {
  Batch piece[3];
  Batch rho[kNodes], D[kNodes];  ///< its density at the nodes, and weight x D to there
  Batch D_a, D_b;                ///< the same to the piece's beginning and end
  bool open;                     ///< see `is_open`
  Mask from_eye;                 ///< lanes that are in it from the eye on, or nowhere
};

/// Uniform or exponential, everywhere: then the density at a point is a factor of the
/// depth of every way from there, and on a ray from the eye its exponential is one with
/// that of the depth to there.
inline bool is_open(const Medium& m, const Ray<Batch>& ray) {
  const bool known =
      m.profile == BRUME_UNIFORM || (m.profile == BRUME_EXPONENTIAL && m.rho0 != 0);
  return known && m.shape == BRUME_EVERYWHERE && m.start == 0 && m.cap == 0 &&
         ray.from_eye;
}

/// Mean of e^-u over u in [0, y], and its end; for y >= -60, below it is that.
struct Decay {
  Batch mean, end;

  BRUME_INLINE explicit Decay(Batch y) {
    const Batch u = max(y, Batch(-60.f));
    const auto x = transmit(u);
    mean = select(u == Batch(0.f), Batch(1.f), x.A / u);
    end = x.T;
  }
};

/// All that a piece of a ray in a lamp's light depends on.
struct LampRays {
  const Compiled& world;
  const Light& lamp;
  Lit* on;
  int k;  ///< media in `on`
  const Ray<Batch>& ray;
  const Foot f;

  /// Optical depth from the ray's beginning to t, and each medium's part, D_b.
  BRUME_INLINE void depth_before(Batch t, Batch tau[3]) const {
    for (int c = 0; c < 3; ++c) tau[c] = Batch(0.f);
    for (int j = 0; j < k; ++j) {
      Lit& r = on[j];
      r.D_b = Batch(0.f);
      if (!r.m->absorbs || none(r.in.lo < t)) continue;
      r.D_b = depth_to(*r.m, r.p, ray, r.weight, r.in, t);
      add(r, r.D_b, tau);
    }
  }

  /// Optical depth to node n at t, of the lanes that are `going`; and the media's
  /// densities and depths there.
  BRUME_INLINE void node(int n, Batch t, Mask going, Batch tau[3]) const {
    for (int c = 0; c < 3; ++c) tau[c] = Batch(0.f);
    for (int j = 0; j < k; ++j) {
      Lit& r = on[j];
      const Medium& m = *r.m;
      if (!r.open) {
        r.D[n] = at_point(r, t, r.rho[n]);
        add(r, r.D[n], tau);
        continue;
      }
      if (m.profile == BRUME_UNIFORM) {
        r.rho[n] = Batch(1.f);
        r.D[n] = max(min(t, r.in.hi) - r.in.lo, Batch(0.f)) * r.weight;
        add(r, r.D[n], tau);
        continue;
      }
      // Lane by lane, so that no lane's bits depend on its neighbours.
      const Batch y = r.p.p1 * t;
      const Decay e(y);
      const Mask plain = r.from_eye & (y >= Batch(-60.f));
      Batch& D = r.D[n];
      D = min(Batch(m.rho0) * (t * e.mean), Batch(kFar)) * r.weight;
      r.rho[n] = min(Batch(m.rho0) * e.end, Batch(kFar));
      if (!all(plain | !going)) {
        Batch rho;
        D = select(plain, D, at_point(r, t, rho));
        r.rho[n] = select(plain, r.rho[n], rho);
      }
      add(r, D, tau);
    }
  }

  /// tau += what dims the lamp on the leg from x.
  BRUME_INLINE void add_depth_of(const Leg& leg, Batch x, Batch tau[3]) const {
    if (lamp.attenuated) add_optical_depth(world, along_leg(leg, x), leg.r, tau);
  }

  /// The same of one open medium, whose density is known where the leg begins.
  BRUME_INLINE void add_open_leg(const Medium& m, Batch rho, const Leg& leg, Batch x,
                                 Mask lit, Batch tau[3]) const {
    Batch D = leg.r;
    Mask plain(true);
    if (m.profile == BRUME_EXPONENTIAL) {
      const Batch grad[3] = {m.grad[0], m.grad[1], m.grad[2]};
      const Batch y = dot(grad, leg.to) * leg.r;
      D = min(rho * (leg.r * Decay(y).mean), Batch(kFar));
      plain = y >= Batch(-60.f);
    }
    Batch of_leg[3];
    for (int c = 0; c < 3; ++c) of_leg[c] = min(Batch(m.sigma[c]) * D, Batch(kFar));
    if (!all(plain | !lit)) {
      Batch other[3] = {0.f, 0.f, 0.f};
      add_optical_depth(m, along_leg(leg, x), leg.r, other);
      for (int c = 0; c < 3; ++c) of_leg[c] = select(plain, of_leg[c], other[c]);
    }
    for (int c = 0; c < 3; ++c) tau[c] += of_leg[c];
  }

  BRUME_INLINE Ray<Batch> along_leg(const Leg& leg, Batch x) const {
    Ray<Batch> r = {{}, {leg.to[0], leg.to[1], leg.to[2]}, false};
    point_at(ray, f.t + x, r.o);
    return r;
  }

 private:
  // Depth and density by the general way. Out of line: it carries all profiles' code.
  [[gnu::noinline]] Batch at_point(const Lit& r, Batch t, Batch& rho) const {
    const Medium& m = *r.m;
    if (m.glows_by_lamp || r.open) rho = density(m, r.p, ray, t);
    if (!m.absorbs || none(r.in.lo < t)) return Batch(0.f);
    return depth_to(m, r.p, ray, r.weight, r.in, t);
  }
  BRUME_INLINE static void add(const Lit& r, Batch D, Batch tau[3]) {
    for (int c = 0; c < 3; ++c) tau[c] += min(Batch(r.m->sigma[c]) * D, Batch(kFar));
  }
};

}  // namespace brume::air::inline BRUME_ISA_NS
