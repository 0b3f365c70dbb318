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

// Inside |o + t d|^2 <= 1, with c = |o|^2 - 1 given (it cancels at the surface, so the
// caller takes it from where it has more digits).
//   Roots of a t^2 + 2 b t + c by q = -(b + sign(b) sqrt(disc)), t = q/a and c/q, with
//   disc = b^2 - a c = a - |o x d|^2 (Lagrange): no cancellation for far and for grazing
//   rays. Hearn & Baker; Haines et al. 2019, "Precision Improvements for Ray/Sphere
//   Intersection".
template <Real T>
BRUME_INLINE Interval<T> unit_ball(const T o[3], const T d[3], T c, T far) {
  const T a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const T b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
  const T x = o[1] * d[2] - o[2] * d[1], y = o[2] * d[0] - o[0] * d[2],
          z = o[0] * d[1] - o[1] * d[0];
  const T disc = a - (x * x + y * y + z * z);
  const T root = sqrt(max(disc, T(0)));
  const T q = select(b < T(0), root - b, -(root + b));
  const T t0 = q / a;
  const T t1 = select(q == T(0), T(0), c / q);
  const auto meets = disc > T(0);
  return {select(meets, min(t0, t1), far), select(meets, max(t0, t1), far)};
}

}  // namespace brume::air::inline BRUME_ISA_NS
