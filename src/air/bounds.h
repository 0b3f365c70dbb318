#pragma once
// Where a ray is inside a half-space, a box or an ellipsoid: one interval, the shapes
// being convex. In local coordinates, x_local(t) = o + t d (d not of unit length).

#include "num/batch.h"

namespace brume::air::inline BRUME_ISA_NS {

/// From lo to hi along a ray [m]; hi <= lo: nowhere.
template <Real T>
struct Interval {
  T lo, hi;
};

// Inside local z <= 0.
//   Domain: any o, d; d = 0 (parallel) is inside everywhere or nowhere.
template <Real T>
BRUME_INLINE Interval<T> half_space(T o, T d, T far) {
  const T t = -o / d;
  const auto parallel = d == T(0), in = o <= T(0);
  const T lo = select(d < T(0), t, -far), hi = select(d > T(0), t, far);
  return {select(parallel, select(in, -far, far), lo), select(parallel, far, hi)};
}

// Inside |o + t d| <= 1 for one axis of a box (Kay & Kajiya 1986). A ray in the plane of
// a face is inside.
template <Real T>
BRUME_INLINE Interval<T> slab(T o, T d, T far) {
  const T inv = T(1) / d;
  const T t0 = (T(-1) - o) * inv, t1 = (T(1) - o) * inv;
  const auto parallel = d == T(0), in = abs(o) <= T(1);
  return {select(parallel, select(in, -far, far), min(t0, t1)),
          select(parallel, far, max(t0, t1))};
}

// Inside |o + t d|^2 <= r2, with c = |o|^2 - r2 given (it cancels at the surface, so the
// caller takes it from where it has more digits).
//   Roots of a t^2 + 2 b t + c by q = -(b + sign(b) sqrt(disc)), t = q/a and c/q, with
//   disc = b^2 - a c = a r2 - |o x d|^2 (Lagrange): no cancellation for far and for
//   grazing rays. Hearn & Baker; Haines et al. 2019, "Precision Improvements for
//   Ray/Sphere Intersection".
template <Real T>
BRUME_INLINE Interval<T> ball(const T o[3], const T d[3], T r2, T c, T far) {
  const T a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const T b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
  const T x = o[1] * d[2] - o[2] * d[1], y = o[2] * d[0] - o[0] * d[2],
          z = o[0] * d[1] - o[1] * d[0];
  const T disc = a * r2 - (x * x + y * y + z * z);
  const T root = sqrt(max(disc, T(0)));
  const T q = select(b < T(0), root - b, -(root + b));
  const T t0 = q / a;
  const T t1 = select(q == T(0), T(0), c / q);
  const auto meets = disc > T(0);
  return {select(meets, min(t0, t1), far), select(meets, max(t0, t1), far)};
}

template <Real T>
BRUME_INLINE Interval<T> unit_ball(const T o[3], const T d[3], T c, T far) {
  return ball(o, d, T(1), c, far);
}

// Inside a ball of any radius > 0 around the coordinates' origin, d of unit length.
//   In units of the larger of radius and |o|: no square leaves the floats.
template <Real T>
BRUME_INLINE Interval<T> centred_ball(const T o[3], const T d[3], float radius, T far) {
  const T unit =
      max(max(T(radius), T(1e-37f)), max(abs(o[0]), max(abs(o[1]), abs(o[2]))));
  const T s[3] = {o[0] / unit, o[1] / unit, o[2] / unit}, r = T(radius) / unit;
  const T away = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
  const auto in = ball(s, d, r * r, (away - r) * (away + r), far);
  return {min(in.lo * unit, far), min(in.hi * unit, far)};
}

}  // namespace brume::air::inline BRUME_ISA_NS
