#pragma once
// Fog that fades toward the boundary of its box or ball, along rays. README, "Softness".
//
//   x      local coordinates, in which the shape is |x_i| <= 1 or |x| <= 1
//   p, q   a box's distances from its two faces on an axis, 1 - x and 1 + x
//   f      softness: the part of the way from the boundary to the middle that fades
//   rho    S(u) e^(log_rho - thins s), u = 0 at the boundary, 1 where the fade ends;
//          S(u) = u^2 (3 - 2 u)
//   s      metres along the ray from a place near where the fog is
//
// All from a place near the fog, where the ray is known as well as there (along.h).

#include "along.h"
#include "num/math.h"

namespace fog_volume::inline BRUME_ISA_NS {

// Gauss-Legendre 8 on [-1, 1] (Abramowitz & Stegun 25.4.30): exact to degree 15.
constexpr float kNode[4] = {0.1834346425f, 0.5255324099f, 0.7966664774f, 0.9602898565f};
constexpr float kWeight[4] = {0.3626837834f, 0.3137066459f, 0.2223810345f, 0.1012285363f};

/// Fades per local length (box), per 1 - |x|^2 (ball).
template <Real T>
BRUME_INLINE T fades(const Soft& v) {
  using S = Scalar_t<T>;
  const S f(v.softness), fade = v.box ? f : f * (S(2) - f);
  return T(S(1) / (fade > S(1e-18) ? fade : S(1e-18)));  // 0: a hard edge
}

/// The fog along a ray, from s = 0 at the place it was made for.
template <Real T>
struct Path {
  BRUME_INLINE Path(const Soft& v) : box(v.box), per(fades<T>(v)) {}

  bool box;
  T per;               ///< see fades
  T p[3], q[3], d[3];  ///< box: distances from its faces at s = 0, local length per metre
  T a, b, c;           ///< ball: 1 - |x|^2 = c - s (2 b + a s)
  T log_rho, thins;
};

template <Real T>
BRUME_INLINE T density(const Path<T>& r, T s) {
  using S = Scalar_t<T>;
  T w(1);
  if (r.box)
    for (int i = 0; i < 3; ++i)
      w = w * smoothstep(min(r.p[i] - s * r.d[i], r.q[i] + s * r.d[i]) * r.per);
  else
    w = smoothstep((r.c - s * (r.b + r.b + r.a * s)) * r.per);
  return w * exp(min(r.log_rho - r.thins * s, T(S(70))));
}

/// The path about the place where the rows are.
template <Real T>
BRUME_INLINE Path<T> path_of_box(const Soft& v, const Row<T> rows[4]) {
  Path<T> r(v);
  for (int i = 0; i < 3; ++i) {
    const Two<T>& x = rows[i].at;
    r.p[i] = sum(T(1), {-x.hi, -x.lo});
    r.q[i] = sum(T(1), x);
    r.d[i] = rows[i].per.hi;
  }
  r.log_rho = rows[3].at.hi;
  r.thins = -rows[3].per.hi;
  return r;
}

// Where a s^2 + 2 b s = c, for c > 0: neither root cancels. Else nowhere: lo > hi.
template <Real T>
BRUME_INLINE void roots(T a, T b, T c, T& lo, T& hi) {
  const T far{Scalar_t<T>(kFar)}, root = sqrt(max(b * b + a * c, T(0)));
  const T q = select(b < T(0), root - b, -(root + b)), x = q / a, y = -c / q;
  lo = select(c > T(0), min(x, y), far);
  hi = select(c > T(0), max(x, y), -far);
}

// The rule over [s, s + h].
template <Real T>
BRUME_INLINE T rule(const Path<T>& r, T s, T h) {
  using S = Scalar_t<T>;
  const T half = T(S(0.5)) * h, middle = s + half;
  T sum(0);
  for (int k = 0; k < 4; ++k)
    sum += T(S(kWeight[k])) * (density(r, middle - half * T(S(kNode[k]))) +
                               density(r, middle + half * T(S(kNode[k]))));
  return sum * half;
}

// Int rho over [lo, hi] between `cuts`, so that every piece is a polynomial of degree 9
// at most, times the exponential. A piece of more than 4 e-folds is cut again 4, 12 and
// 40 e-folds from its thick end; beyond it is e^-40.
//   Relative error of the rule: 0 in even fog; 1e-7 over 4 e-folds, 2e-6 in all.
template <Real T>
BRUME_INLINE T pieces(const Path<T>& r, T lo, T hi, const T* cut, int cuts) {
  using S = Scalar_t<T>;
  const T zero(0);
  T D(0);
  for (int piece = 0; piece < 8 && any(lo < hi); ++piece) {
    T next = hi;
    for (int k = 0; k < cuts; ++k)
      next = min(next, select((cut[k] > lo) & (cut[k] < next), cut[k], next));
    const T length = max(next - lo, zero), folds = abs(r.thins) * length;
    const auto steep = folds > T(4);
    T from = zero;  // metres from the thick end
    for (int part = 0; part < 3; ++part) {
      const T end = T(S(part == 0   ? 4
                        : part == 1 ? 12
                                    : 40)) /
                    max(abs(r.thins), T(S(1e-30)));
      const T to = select(steep, min(end, length), length);
      const T h = max(to - from, zero);
      const T begin = select(r.thins > zero, lo + from, next - to);
      D += select(h > zero, rule(r, begin, h), zero);
      from = to;
      if (none(from < length)) break;
    }
    lo = select(lo < hi, next, lo);
  }
  return D;
}

/// Int rho over [t0, t1] of a ray [m]; t1 at most kFar.
template <Real T>
BRUME_INLINE T integral(const Soft& v, const T* o, const T d[3], T t0, T t1) {
  using S = Scalar_t<T>;
  const T far{S(kFar)}, f{S(v.softness)};
  Row<T> rows[4];
  start(v, o, d, rows);
  near(v, rows, t0, t1);
  if (v.box) {
    const Path<T> r = path_of_box(v, rows);
    T cut[6];
    for (int i = 0; i < 3; ++i) {
      const T inv = T(1) / r.d[i], a = r.p[i] * inv, b = -r.q[i] * inv;
      const auto level = r.d[i] == T(0), in = (r.p[i] >= T(0)) & (r.q[i] >= T(0));
      t0 = max(t0, select(level, select(in, -far, far), min(a, b)));
      t1 = min(t1, select(level, far, max(a, b)));
      cut[2 * i] = (r.p[i] - f) * inv;
      cut[2 * i + 1] = (f - r.q[i]) * inv;
    }
    return pieces(r, t0, t1, cut, 6);
  }
  // 1 - |x|^2 = c - s (2 b + a s). From the point of [t0, t1] next to the middle no root
  // is farther than the ray goes, and none is there but for c > 0.
  Path<T> r(v);
  r.a = dot<true>(rows);
  r.b = dot<false>(rows);
  r.c = inward(rows);
  r.log_rho = rows[3].at.hi;
  r.thins = -rows[3].per.hi;
  T cut[2], lo, hi;
  roots(r.a, r.b, r.c, lo, hi);
  roots(r.a, r.b, r.c - f * (T(2) - f), cut[0], cut[1]);
  return pieces(r, max(t0, lo), min(t1, hi), cut, 2);
}

/// rho at t of a ray.
template <Real T>
BRUME_INLINE T density_at(const Soft& v, const T* o, const T d[3], T t) {
  using S = Scalar_t<T>;
  Row<T> rows[4];
  start(v, o, d, rows);
  for (auto& row : rows) row.go(min(t, T(S(kAway))));
  if (v.box) return density(path_of_box(v, rows), T(0));
  return smoothstep(inward(rows) * fades<T>(v)) * exp(min(rows[3].at.hi, T(S(70))));
}

}  // namespace fog_volume::inline BRUME_ISA_NS
