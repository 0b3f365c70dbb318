#pragma once
// Density along a ray and its exact integral, for the profiles that have one.
//
//   exponential   rho(t) = e^(a - b t),        b = falloff (n . d), any sign
//   lorentzian    rho(t) = 1/(1 + f (h^2 + (t - tc)^2))

#include "air/medium.h"
#include "num/math.h"

namespace brume::air::inline BRUME_ISA_NS {

/// A ray: origin relative to the eye, unit direction.
template <Real T>
struct Ray {
  T o[3], d[3];
  bool from_eye;
};

template <Real T>
BRUME_INLINE T dot(const T x[3], const T y[3]) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

/// A profile along one ray.
///   exponential: p0 = a, p1 = b
///   lorentzian:  p0 = tc, p1 = k = sqrt(f/(1 + f h^2)), p2 = 1/(1 + f h^2)
template <Real T>
struct Along {
  T p0, p1, p2;
};

template <Real T>
BRUME_INLINE Along<T> exponential_along(const Medium& m, const Ray<T>& ray) {
  const T g[3] = {T(m.grad[0]), T(m.grad[1]), T(m.grad[2])};
  T a = T(m.log_rho0);
  if (!ray.from_eye) a = a - dot(g, ray.o);
  return {a, dot(g, ray.d), T(0)};
}

template <Real T>
BRUME_INLINE Along<T> lorentzian_along(const Medium& m, const Ray<T>& ray) {
  T c[3] = {T(m.middle[0]), T(m.middle[1]), T(m.middle[2])};
  if (!ray.from_eye)
    for (int i = 0; i < 3; ++i) c[i] = c[i] - ray.o[i];
  const T x = c[1] * ray.d[2] - c[2] * ray.d[1], y = c[2] * ray.d[0] - c[0] * ray.d[2],
          z = c[0] * ray.d[1] - c[1] * ray.d[0];
  // In lengths of 1/sqrt(f), 1e18 of them at most: no square or product leaves the
  // floats.
  const T s = sqrt(T(m.falloff)), far(1e18f);
  const T u = min(abs(x) * s, far), v = min(abs(y) * s, far), h = min(abs(z) * s, far);
  const T w = T(1) / (T(1) + (u * u + v * v + h * h));
  return {dot(c, ray.d), s * sqrt(w), w};
}

/// e^170 x 1e-44 m is still opaque, and its root a float.
inline constexpr float kMostFolds = 170;

// e^x with the one exponent clamped: never inf, and what is below e^-105 is 0.
template <Real T>
BRUME_INLINE T density_from_log(T x) {
  return exp(min(x, T(kMaxExponent)));
}

template <Real T>
BRUME_INLINE T exponential_density(const Along<T>& p, T t) {
  return density_from_log(p.p0 - p.p1 * min(t, T(kMaxLength)));
}

// D over [t0, t1] of e^(a - b t).
//   D = rho(densest end) |t1 - t0| exprel(|b (t1 - t0)|), the densest end's exponent one
//   clamped sum: neither factor overflows or is 0 x inf. README of height_fog, eq. 3.
//   Domain: t0 <= t1, t1 up to kFar (then the limit rho(t0)/b, or opaque); any a, b.
//   Relative error: 3e-7 + eps (|a| + |b t|), the rounding of the exponent itself.
template <Real T>
BRUME_INLINE T exponential_integral(const Along<T>& p, T t0, T t1) {
  const T from = min(t0, T(kMaxLength));
  const T length = max(min(t1, T(kMaxLength)) - from, T(0));
  const T x = p.p1 * length;
  const T densest = p.p0 - p.p1 * from + max(-x, T(0));
  // exprel(x) = 1/x is still a normal float at 1e37.
  // e^densest as a square: a density below the smallest float still counts over 1e30 m,
  // one above the largest over 1e-40 m.
  const T root = exp(T(0.5f) * min(densest, T(kMostFolds)));
  return min(length * exprel(min(abs(x), T(1e37f))) * root * root, T(kFar));
}

template <Real T>
BRUME_INLINE T lorentzian_density(const Along<T>& p, T t) {
  const T u = min(p.p1 * abs(t - p.p0), T(1e18f));
  return p.p2 / (T(1) + u * u);
}

// D over [t0, t1] of 1/(1 + f (h^2 + (t - tc)^2)) = (p2/k) [atan(k (t1 - tc)) -
// atan(k (t0 - tc))], the difference taken by one atan2 (METHODS A12): no cancellation.
//   Domain: t0 <= t1, t1 up to kFar; f > 0. Relative error <= 1e-6.
template <Real T>
BRUME_INLINE T lorentzian_integral(const Along<T>& p, T t0, T t1) {
  const T big(1e18f);
  const T x0 = clamp(p.p1 * (t0 - p.p0), -big, big);
  const T x1 = clamp(p.p1 * (t1 - p.p0), -big, big);
  const T u = p.p1 * max(t1 - t0, T(0));
  const T y = select(u < big, u, x1 - x0);
  return p.p2 / p.p1 * atan2pos(y, T(1) + x0 * x1);
}

// Where the integral from t0 on reaches D; kFar where it never does.
//   z = log(|b| D / rho(t0)); thinning: -log(1 - e^z)/b, growing: log(1 + e^z)/|b|.
//   While e^z is a moderate number it is computed directly, which also gives the limit
//   D / rho(t0) of b -> 0. Relative error 1e-6 + eps |a - b t0|. From less than e^-88 on,
//   that does not grow, kFar.
template <Real T>
BRUME_INLINE T exponential_reach(const Along<T>& p, T t0, T D) {
  const T a0 = p.p0 - p.p1 * t0;
  // Where there is less than e^-88, no depth is reached within kFar.
  const T len0 = min(D * exp(clamp(-a0, T(-kMaxExponent), T(88))), T(kFar));
  const T y = p.p1 * len0;  // = +-e^z
  // log(1 + w)/w at w = -y
  const T safe = select(abs(y) < T(1e-6f), T(1e-6f), -y);
  const T direct = len0 * select(abs(y) < T(1e-6f), T(1), log1p(safe) / safe);
  // Growing, and rho(t0) not a number one can divide by: log1p(e^z) with z apart.
  const T z = log(abs(p.p1) * D) - a0;
  const T soft = (max(z, T(0)) + log1p(exp(-abs(z)))) / abs(p.p1);
  const auto grows = (abs(a0) > T(60)) & (p.p1 < T(0));
  const T length = select((y >= T(1)) | ((a0 < T(-88)) & !grows), T(kFar),
                          select(grows, soft, direct));
  return min(t0 + length, T(kFar));
}

}  // namespace brume::air::inline BRUME_ISA_NS
