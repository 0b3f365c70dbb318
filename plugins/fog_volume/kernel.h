#pragma once
// Fog that fades toward the boundary of its box or ball, along rays. README, "Softness".
//
//   x      local coordinates, in which the shape is |x_i| <= 1 or |x| <= 1
//   s      softness: the part of the way from the boundary to the middle that fades
//   rho    S(u) e^(a - b t), u = 0 at the boundary, 1 where s ends; S(u) = u^2 (3 - 2 u)

#include "num/math.h"

namespace fog_volume {

/// What kernels see of a soft volume. Positions of rays are relative to the eye.
struct Soft {
  bool box = true;
  float A[9] = {}, b[3] = {};  ///< local = A x + b
  float softness = 1;
  float log_rho0 = 0, scale = 1, thins[3] = {};  ///< scale e^(log_rho0 - thins . x)
};

}  // namespace fog_volume

namespace fog_volume::inline BRUME_ISA_NS {

using namespace brume::BRUME_ISA_NS;

constexpr float kFar = 3e38f;

// Gauss-Legendre 8 on [-1, 1] (Abramowitz & Stegun 25.4.30): exact to degree 15.
constexpr float kNode[4] = {0.1834346425f, 0.5255324099f, 0.7966664774f, 0.9602898565f};
constexpr float kWeight[4] = {0.3626837834f, 0.3137066459f, 0.2223810345f, 0.1012285363f};

template <Real T>
BRUME_INLINE T fade(T u) {
  const T v = clamp(u, T(0), T(1));
  return v * v * (T(3) - T(2) * v);
}

/// A ray in local coordinates; b: e-folds per metre along it.
template <Real T>
struct Local {
  T o[3], d[3], a, b;
};

template <Real T>
BRUME_INLINE T dot(const float p[3], const T x[3]) {
  using S = Scalar_t<T>;
  return T(S(p[0])) * x[0] + T(S(p[1])) * x[1] + T(S(p[2])) * x[2];
}

template <Real T>
BRUME_INLINE Local<T> local(const Soft& v, const T o[3], const T d[3]) {
  using S = Scalar_t<T>;
  Local<T> r;
  for (int i = 0; i < 3; ++i) {
    r.o[i] = dot(v.A + 3 * i, o) + T(S(v.b[i]));
    r.d[i] = dot(v.A + 3 * i, d);
  }
  r.a = T(S(v.log_rho0)) - dot(v.thins, o);
  r.b = dot(v.thins, d);
  return r;
}

template <Real T>
BRUME_INLINE T density(const Soft& v, const Local<T>& r, T t) {
  using S = Scalar_t<T>;
  const T per = T(S(1) / S(v.softness));
  T w(1), r2(0);
  for (int i = 0; i < 3; ++i) {
    const T x = r.o[i] + t * r.d[i];
    if (v.box)
      w = w * fade((T(1) - abs(x)) * per);
    else
      r2 = r2 + x * x;
  }
  if (!v.box) w = fade((T(1) - r2) * per / T(S(2) - S(v.softness)));
  return w * T(S(v.scale)) * exp(min(r.a - r.b * t, T(S(70))));
}

// Where the ray is on |x|^2 = R^2: roots of t^2 d.d + 2 t o.d + o.o - R^2 with the
// discriminant R^2 d.d - |o x d|^2 (Lagrange), which does not cancel. None: t0 > t1.
template <Real T>
BRUME_INLINE void ball(const Local<T>& r, T R2, T& t0, T& t1) {
  const T(&o)[3] = r.o, (&d)[3] = r.d;
  const T a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const T b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
  const T x = o[1] * d[2] - o[2] * d[1], y = o[2] * d[0] - o[0] * d[2],
          z = o[0] * d[1] - o[1] * d[0];
  const T disc = R2 * a - (x * x + y * y + z * z);
  const T root = sqrt(max(disc, T(0))) / a, middle = -b / a;
  using S = Scalar_t<T>;
  t0 = select(disc > T(0), middle - root, T(S(kFar)));
  t1 = select(disc > T(0), middle + root, T(S(-kFar)));
}

// The rule over [t0, t0 + h].
template <Real T>
BRUME_INLINE T rule(const Soft& v, const Local<T>& r, T t0, T h) {
  using S = Scalar_t<T>;
  const T half = T(S(0.5)) * h, middle = t0 + half;
  T sum(0);
  for (int k = 0; k < 4; ++k)
    sum += T(S(kWeight[k])) * (density(v, r, middle - half * T(S(kNode[k]))) +
                               density(v, r, middle + half * T(S(kNode[k]))));
  return sum * half;
}

// Int rho over [t0, t1]: cut where the fading begins and ends on any axis, so that every
// piece is a polynomial of degree 9 at most, times the exponential. A piece of more than
// 4 e-folds is cut again 4, 12 and 40 e-folds from its thick end; beyond it is e^-40.
//   Relative error of the rule: 0 in even fog; 1e-7 over 4 e-folds, 2e-6 in all.
template <Real T>
BRUME_INLINE T integral(const Soft& v, const Local<T>& r, T t0, T t1) {
  using S = Scalar_t<T>;
  const T far{S(kFar)}, zero(0), inner(S(1) - S(v.softness));
  T cut[12], lo = t0, hi = t1;
  int cuts = 0;
  if (v.box) {
    for (int i = 0; i < 3; ++i) {
      const T inv = T(1) / r.d[i];
      const T p = (T(-1) - r.o[i]) * inv, q = (T(1) - r.o[i]) * inv;
      const auto level = r.d[i] == zero, in = abs(r.o[i]) <= T(1);
      lo = max(lo, select(level, select(in, -far, far), min(p, q)));
      hi = min(hi, select(level, far, max(p, q)));
      cut[cuts++] = (-inner - r.o[i]) * inv;
      cut[cuts++] = (inner - r.o[i]) * inv;
    }
  } else {
    T enter, leave;
    ball(r, T(1), enter, leave);
    lo = max(lo, enter);
    hi = min(hi, leave);
    ball(r, inner * inner, cut[0], cut[1]);
    cuts = 2;
  }
  T D(0);
  for (int piece = 0; piece < 8 && any(lo < hi); ++piece) {
    T next = hi;
    for (int k = 0; k < cuts; ++k)
      next = min(next, select((cut[k] > lo) & (cut[k] < next), cut[k], next));
    const T length = max(next - lo, zero), folds = abs(r.b) * length;
    const auto steep = folds > T(4);
    T from = zero;  // metres from the thick end
    for (int part = 0; part < 3; ++part) {
      const T end = T(S(part == 0   ? 4
                        : part == 1 ? 12
                                    : 40)) /
                    max(abs(r.b), T(S(1e-30)));
      const T to = select(steep, min(end, length), length);
      const T h = max(to - from, zero);
      const T start = select(r.b > zero, lo + from, next - to);
      D += select(h > zero, rule(v, r, start, h), zero);
      from = to;
      if (none(from < length)) break;
    }
    lo = select(lo < hi, next, lo);
  }
  return D;
}

}  // namespace fog_volume::inline BRUME_ISA_NS
