#pragma once
// A medium on a batch of rays: where they are inside, and its integral and density there.

#include "air/bounds.h"
#include "air/profile.h"

namespace brume::air::inline BRUME_ISA_NS {

BRUME_INLINE Ray<Batch> load_ray(const Rays& r, int i) {
  Ray<Batch> ray = {{0.f, 0.f, 0.f},
                    {load<Batch>(r.dx + i), load<Batch>(r.dy + i), load<Batch>(r.dz + i)},
                    r.ox == nullptr};
  if (!ray.from_eye) {
    ray.o[0] = load<Batch>(r.ox + i);
    ray.o[1] = load<Batch>(r.oy + i);
    ray.o[2] = load<Batch>(r.oz + i);
  }
  return ray;
}

/// The rays of a batch as a plugin's functions want them, with room for t and answers.
struct Spans {
  static constexpr int W = Batch::W;
  float o[3][W], d[3][W];
  brume_rays rays;

  explicit Spans(const Ray<Batch>& ray) {
    for (int i = 0; i < 3; ++i) {
      store(o[i], ray.o[i]);
      store(d[i], ray.d[i]);
    }
    rays = {W, o[0], o[1], o[2], d[0], d[1], d[2]};
    if (ray.from_eye) rays.ox = rays.oy = rays.oz = nullptr;
  }
  Spans(const Spans&) = delete;
};

BRUME_INLINE Batch forever(Batch t) {
  return select(t >= Batch(kFar), Batch(__builtin_inff()), t);
}

// What the medium's own function says, made safe: nothing over an empty stretch, and
// neither negative nor infinite.
inline Batch custom_integral(const Medium& m, const Ray<Batch>& ray, Batch t0, Batch t1) {
  const Spans s(ray);
  float a[Batch::W], b[Batch::W], D[Batch::W];
  store(a, t0);
  store(b, forever(t1));
  m.integral(m.self, &s.rays, a, b, D);
  return select(t0 < t1, clamp(load<Batch>(D), Batch(0.f), Batch(kFar)), Batch(0.f));
}

inline Batch custom_density(const Medium& m, const Ray<Batch>& ray, Batch t) {
  const Spans s(ray);
  float a[Batch::W], rho[Batch::W];
  store(a, t);
  m.density(m.self, &s.rays, a, rho);
  return clamp(load<Batch>(rho), Batch(0.f), Batch(kFar));
}

BRUME_INLINE Along<Batch> along(const Medium& m, const Ray<Batch>& ray) {
  switch (m.profile) {
    case BRUME_EXPONENTIAL:
      return exponential_along(m, ray);
    case BRUME_LORENTZIAN:
      return lorentzian_along(m, ray);
    default:
      return {0.f, 0.f, 0.f};
  }
}

BRUME_INLINE Batch integral(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                            Batch t0, Batch t1) {
  switch (m.profile) {
    case BRUME_UNIFORM:
      return max(t1 - t0, Batch(0.f));
    case BRUME_EXPONENTIAL:
      return exponential_integral(p, t0, t1);
    case BRUME_LORENTZIAN:
      return lorentzian_integral(p, t0, t1);
    default:
      return custom_integral(m, ray, t0, t1);
  }
}

BRUME_INLINE Batch density(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                           Batch t) {
  switch (m.profile) {
    case BRUME_UNIFORM:
      return 1.f;
    case BRUME_EXPONENTIAL:
      return exponential_density(p, t);
    case BRUME_LORENTZIAN:
      return lorentzian_density(p, t);
    default:
      return custom_density(m, ray, t);
  }
}

/// Inside a medium's bounds, from `lo` to `hi`, but not in the hole [hole0, hole1] around
/// the eye that `start` leaves (kFar: no hole). Nowhere: lo = hi = kFar.
struct Inside {
  Batch lo, hi, hole0, hole1;
};

BRUME_INLINE Interval<Batch> shape_interval(const Medium& m, const Ray<Batch>& ray) {
  const Batch far(kFar);
  if (m.shape == BRUME_EVERYWHERE) return {-far, far};
  Batch o[3], d[3];
  for (int i = 0; i < 3; ++i) {
    const Batch row[3] = {m.A[3 * i], m.A[3 * i + 1], m.A[3 * i + 2]};
    o[i] = Batch(m.b[i]);
    if (!ray.from_eye) o[i] += dot(row, ray.o);
    d[i] = dot(row, ray.d);
  }
  if (m.shape == BRUME_HALF_SPACE) return half_space(o[2], d[2], far);
  if (m.shape == BRUME_BOX) {
    Interval<Batch> in = {-far, far};
    for (int i = 0; i < 3; ++i) {
      const auto s = slab(o[i], d[i], far);
      in = {max(in.lo, s.lo), min(in.hi, s.hi)};
    }
    return in;
  }
  Batch c(m.b2_minus_1);
  if (!ray.from_eye) {  // |b + v|^2 - 1 = (|b|^2 - 1) + v.(v + 2 b), v = A o
    const Batch b[3] = {m.b[0], m.b[1], m.b[2]};
    const Batch v[3] = {o[0] - b[0], o[1] - b[1], o[2] - b[2]};
    c += v[0] * (o[0] + b[0]) + v[1] * (o[1] + b[1]) + v[2] * (o[2] + b[2]);
  }
  return unit_ball(o, d, c, far);
}

// Where weight x D from lo on reaches the medium's cap, for profiles without an inverse:
// bisection on the bit pattern of the length, which floats order as integers do; 31 steps
// end at the exact float.
inline Batch bisected_reach(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                            Batch lo, Batch D) {
  IntBatch length(0u);
  for (int bit = 30; bit >= 0; --bit) {
    const IntBatch longer = length | IntBatch(1u << bit);
    const Batch t1 = min(lo + value(longer), Batch(kFar));
    const auto short_of =
        (value(longer) < Batch(kFar)) & (integral(m, p, ray, lo, t1) < D);
    length = bits(select(short_of, value(longer), value(length)));
  }
  const Batch reach = lo + value(length);
  return select(integral(m, p, ray, lo, Batch(kFar)) < D, Batch(kFar), reach);
}

BRUME_INLINE Batch reach(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                         Batch lo, Batch D) {
  switch (m.profile) {
    case BRUME_UNIFORM:
      return min(lo + D, Batch(kFar));
    case BRUME_EXPONENTIAL:
      return exponential_reach(p, lo, D);
    default:
      return bisected_reach(m, p, ray, lo, D);
  }
}

// The part of [begin, end] of a ray that is inside. `start` and the cap count from the
// eye; along other rays the cap counts from their origin.
BRUME_INLINE Inside inside(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                           Batch weight, Batch begin, Batch end) {
  const Batch far(kFar);
  auto in = shape_interval(m, ray);
  in.lo = max(in.lo, Batch(0.f));
  Inside r = {in.lo, in.hi, far, far};
  if (m.start > 0) {
    if (ray.from_eye) {
      r.lo = max(r.lo, Batch(m.start));
    } else {
      const Batch inv = 1.f / m.start;
      const Batch o[3] = {ray.o[0] * inv, ray.o[1] * inv, ray.o[2] * inv};
      const Batch d[3] = {ray.d[0] * inv, ray.d[1] * inv, ray.d[2] * inv};
      const auto ball = unit_ball(o, d, dot(o, o) - Batch(1.f), far);
      r.hole0 = max(ball.lo, Batch(0.f));
      r.hole1 = max(ball.hi, Batch(0.f));
    }
  }
  if (m.cap > 0) r.hi = min(r.hi, reach(m, p, ray, r.lo, Batch(m.cap) / weight));
  r.lo = max(r.lo, begin);
  r.hi = min(r.hi, min(end, far));
  const auto in_it = (r.lo < r.hi) & (weight > Batch(0.f));
  r.lo = select(in_it, r.lo, far);
  r.hi = select(in_it, r.hi, far);
  return r;
}

/// D over the part of [t0, t1] that is inside.
BRUME_INLINE Batch integral_inside(const Medium& m, const Along<Batch>& p,
                                   const Ray<Batch>& ray, const Inside& in, Batch t0,
                                   Batch t1) {
  const Batch a = max(t0, in.lo), b = min(t1, in.hi);
  if (m.start <= 0 || ray.from_eye) return integral(m, p, ray, a, max(a, b));
  const Batch b0 = min(b, in.hole0), a1 = max(a, in.hole1);
  return integral(m, p, ray, a, max(a, b0)) + integral(m, p, ray, a1, max(a1, b));
}

// The integral of an exponential medium from where it begins to t (`end`, at most in.hi).
// Where that is from the eye on, it is rho0 t exprel(b t) with the signed exponent: one
// exponential less. It holds while e^(-b t) is no more than e^60, lane by lane.
template <bool open>  // no bounds: in.lo = 0 wherever it is anywhere
BRUME_INLINE Batch exponential_from_origin(const Medium& m, const Along<Batch>& p,
                                           const Ray<Batch>& ray, const Inside& in,
                                           Batch end) {
  if (!ray.from_eye || m.rho0 == 0) return integral_inside(m, p, ray, in, in.lo, end);
  const Batch far(kMaxLength), zero(0.f);
  const auto nowhere = in.lo >= end;
  const Batch t = open ? max(zero, min(end, far)) : select(nowhere, zero, min(end, far));
  const Batch y = p.p1 * t;
  auto plain = y > Batch(-60.f);
  if (!open) plain = plain & ((in.lo == zero) | nowhere);
  const Batch D = Batch(m.rho0) * t * exprel(max(y, Batch(-60.f)));
  if (all(plain)) return D;
  return select(plain, D, integral_inside(m, p, ray, in, in.lo, end));
}

}  // namespace brume::air::inline BRUME_ISA_NS
