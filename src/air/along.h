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
  if (none(t0 < t1)) return Batch(0.f);
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
///   A cap ends a medium at a depth, not at a place: in a dense medium one step of a
///   float is many optical depths. So `hi` is only just beyond it, `until` is where the
///   medium would end without, and depths are no more than `left`, what the cap leaves
///   from lo on.
struct Inside {
  Batch lo, hi, hole0, hole1, until, left;

  /// The cap ends it before its bounds do.
  BRUME_INLINE Mask capped() const { return hi < until; }
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

// Where the integral from lo on reaches D, for profiles without an inverse: between lo
// and `end`, a few ulp too far at most. kFar: nowhere on the way there. (reach.cpp)
Batch sought_reach(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                   Batch lo, Batch D, Batch end);

BRUME_INLINE Batch reach(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                         Batch lo, Batch D, Batch end) {
  switch (m.profile) {
    case BRUME_UNIFORM:
      return min(lo + D, Batch(kFar));
    case BRUME_EXPONENTIAL:
      return exponential_reach(p, lo, D);
    default:
      return sought_reach(m, p, ray, lo, D, end);
  }
}

/// D over the part of [t0, t1] that is inside, the cap left out.
BRUME_INLINE Batch integral_inside(const Medium& m, const Along<Batch>& p,
                                   const Ray<Batch>& ray, const Inside& in, Batch t0,
                                   Batch t1) {
  const Batch a = max(t0, in.lo), b = min(t1, in.until);
  if (m.start <= 0 || ray.from_eye) return integral(m, p, ray, a, max(a, b));
  const Batch b0 = min(b, in.hole0), a1 = max(a, in.hole1);
  // Not infinite: a channel without extinction would make no number of it.
  return min(integral(m, p, ray, a, max(a, b0)) + integral(m, p, ray, a1, max(a1, b)),
             Batch(kFar));
}

// Out of line, both of the next two: few media have a start on rays that do not begin at
// the eye, or a cap, and every kernel would carry all profiles' code several times.
// The hole that `start` leaves around the eye, on rays that begin elsewhere.
[[gnu::noinline]] inline void leave_out_start(const Medium& m, const Ray<Batch>& ray,
                                              Inside& in) {
  if (ray.from_eye) {
    in.lo = max(in.lo, Batch(m.start));
    return;
  }
  const Batch far(kFar);
  const auto hole = centred_ball(ray.o, ray.d, m.start, far);
  in.hole0 = max(hole.lo, Batch(0.f));
  in.hole1 = max(hole.hi, Batch(0.f));
  const auto first = (in.hole0 <= in.lo) & (in.lo < in.hole1);
  in.lo = select(first, in.hole1, in.lo);
  in.hole0 = select(first, far, in.hole0);
  in.hole1 = select(first, far, in.hole1);
}

// What the cap of a medium leaves from `begin` on, and, if anybody asks, where it ends, a
// little beyond rather than before.
[[gnu::noinline]] inline void end_by_cap(const Medium& m, const Along<Batch>& p,
                                         const Ray<Batch>& ray, Batch weight, Batch begin,
                                         bool where, Inside& in) {
  const Batch far(kFar), D = Batch(m.cap) / weight;
  const auto just_after = [&](Batch t0, Batch t1) {
    const Batch t = t0 + (t1 - t0) * Batch(1 + 1e-5f);
    return min(t + max(t * Batch(2.4e-7f), Batch(1e-37f)), far);
  };
  if (where) {
    Batch end = just_after(in.lo, reach(m, p, ray, in.lo, D, in.until));
    if (any(in.hole0 < end)) {
      const Batch before = integral(m, p, ray, in.lo, max(in.lo, in.hole0));
      const Batch behind = max(D - before, Batch(0.f));
      end =
          select(in.hole0 < end,
                 just_after(in.hole1, reach(m, p, ray, in.hole1, behind, in.until)), end);
    }
    in.hi = min(in.hi, end);
  }
  in.left = Batch(m.cap);
  if (any(begin > in.lo))
    in.left =
        max(in.left - weight * integral_inside(m, p, ray, in, in.lo, begin), Batch(0.f));
}

// The part of [begin, end] of a ray that is inside. `start` counts from the eye, the cap
// from the ray's origin. Who needs depths alone does not ask `where_capped`: `hi` is then
// where the medium would end without a cap.
BRUME_INLINE Inside inside(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                           Batch weight, Batch begin, Batch end,
                           bool where_capped = true) {
  const Batch far(kFar);
  const auto shape = shape_interval(m, ray);
  Inside in = {max(shape.lo, Batch(0.f)), shape.hi, far, far, far, far};
  if (m.start > 0) leave_out_start(m, ray, in);
  in.until = min(in.hi, min(end, far));
  if (m.cap > 0) end_by_cap(m, p, ray, weight, begin, where_capped, in);
  in.lo = max(in.lo, begin);
  in.hi = min(in.hi, in.until);
  const auto in_it = (in.lo < in.hi) & (weight > Batch(0.f));
  in.lo = select(in_it, in.lo, far);
  in.hi = select(in_it, in.hi, far);
  in.until = select(in_it, in.until, far);
  return in;
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
  // In the order in which no product leaves the floats before the last.
  const Batch E = exprel(max(y, Batch(-60.f)));
  const Batch D = m.rho0 > 1 ? Batch(m.rho0) * (t * E) : Batch(m.rho0) * t * E;
  if (all(plain)) return D;
  return select(plain, D, integral_inside(m, p, ray, in, in.lo, end));
}

/// weight x D of a medium from in.lo to t, its cap counted in. Past in.hi as if at it.
BRUME_INLINE Batch depth_to(const Medium& m, const Along<Batch>& p, const Ray<Batch>& ray,
                            Batch weight, const Inside& in, Batch t) {
  const Batch end = min(t, m.cap > 0 ? in.until : in.hi);
  const Batch D =
      (m.profile == BRUME_EXPONENTIAL ? exponential_from_origin<false>(m, p, ray, in, end)
                                      : integral_inside(m, p, ray, in, in.lo, end)) *
      weight;
  return m.cap > 0 ? min(D, in.left) : D;
}

}  // namespace brume::air::inline BRUME_ISA_NS
