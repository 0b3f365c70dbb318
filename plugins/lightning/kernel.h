#pragma once
// The bright core of a bolt along rays: a straight stretch of channel, blurred by a
// Gaussian. README, "The core". Positions are relative to the eye.
//
//   o, d    ray: origin, unit direction          M, a, H  stretch: middle, unit axis,
//   half y(u)    M + u a, |u| <= H                              its length [m] s
//   deviation of the Gaussian [m]: channel and pixel together rho     (r/s)^2 Int du
//   exp(-|x - y(u)|^2 / 2 s^2) / (sqrt(2 pi) s)            [1] r       deviation of the
//   channel alone [m]: rho is 1 on the axis where pixels are small
//
// s and r are those of the place of the stretch that is nearest to the ray, s what a
// pixel is wide there across the stretch as the eye sees it: along one ray they are
// constant.

#include "num/math.h"
#include "num/quadrature.h"

namespace lightning {

/// A stretch of channel as kernels see it.
struct Channel {
  float middle[3] = {}, axis[3] = {0, 0, 1}, half = 0;
  float radius = 1, tapers = 0;  ///< r = radius + tapers u
  // s^2 = r^2 + w^2, w^2 as stage/footprint.h has it for the plane through eye and
  // stretch
  float even2 = 1e-8;
  float wide = 0, widens = 0;  ///< linear . y = wide + widens u
  float fan2 = 0, tilt2 = 1;
  float level[2][2] = {};  ///< level . y = level[k][0] + level[k][1] u
  /// A ray through a ball about the stretch sees all of it: half the square of its radius
  /// in deviations, up to 18, the ball in its box; what is beyond, e^-whole, is too
  /// little to see at this brightness. 0: none is.
  float whole = 15.68f;
};

constexpr float kReach = 6;    ///< deviations at which the core ends: e^-18 of its light
constexpr float kSeen = 8.5f;  ///< as far as its box's corners: e^-36
constexpr float kNone = 3e38f;

}  // namespace lightning

namespace lightning::inline BRUME_ISA_NS {

using namespace brume::BRUME_ISA_NS;

template <Real T>
BRUME_INLINE T dot(const T x[3], const T y[3]) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}
// Each component correct though its products cancel: far stretches keep their digits.
template <Real T>
BRUME_INLINE void cross(const T x[3], const T y[3], T out[3]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out[i] = difference_of_products(x[j], y[k], x[k], y[j]);
  }
}

/// A stretch and a ray seen along the ray: the stretch as a straight line in the plane
/// across it, u + g/p from the foot of the perpendicular.
template <Real T>
struct Meeting {
  T foot;      ///< t of the stretch's middle on the ray [m]
  T along, p;  ///< cosine between ray and stretch; its sine / (sqrt(2) s) [1/m]
  T g;         ///< u at the perpendicular's foot, times -p [1]
  T away2;     ///< length of the perpendicular, squared, over 2 s^2
  T strength;  ///< (r/s)^2
  T inv_s;     ///< 1 / (sqrt(2) s) [1/m]
};

// w^2 at the place u of the stretch [m^2].
template <Real T>
BRUME_INLINE T pixel_variance(const Channel& k, T u) {
  using S = Scalar_t<T>;
  const T linear = T(S(k.wide)) + T(S(k.widens)) * u;
  T w2 = T(S(k.even2)) + linear * linear;
  if (k.fan2 > 0) {
    T y2(0), level2(0);
    for (int i = 0; i < 3; ++i) {
      const T y = T(S(k.middle[i])) + u * T(S(k.axis[i]));
      y2 += y * y;
    }
    for (const auto& v : k.level) {
      const T y = T(S(v[0])) + u * T(S(v[1]));
      level2 += y * y;
    }
    const T tilted = T(S(k.tilt2)) * y2;
    w2 += T(S(k.fan2)) * y2 *
          select(tilted < level2, tilted / max(level2, T(S(1e-30))), T(1));
  }
  return w2;
}

template <Real T>
BRUME_INLINE Meeting<T> meet(const Channel& k, const T o[3], const T d[3]) {
  using S = Scalar_t<T>;
  const T a[3] = {T(S(k.axis[0])), T(S(k.axis[1])), T(S(k.axis[2]))};
  const T w[3] = {T(S(k.middle[0])) - o[0], T(S(k.middle[1])) - o[1],
                  T(S(k.middle[2])) - o[2]};
  const T H{S(k.half)};
  T c[3], e[3], ce[3];
  cross(w, d, c);
  cross(a, d, e);
  cross(c, e, ce);
  const T e2 = dot(e, e), c_e = dot(c, e);
  // The nearest place; of a stretch along the ray, its middle.
  const T u = clamp(-c_e / (e2 + T(S(1e-6))), -H, H);
  const T r = T(S(k.radius)) + T(S(k.tapers)) * u;
  const T s2 = r * r + pixel_variance(k, u);
  Meeting<T> m;
  m.inv_s = T(S(0.70710678118654752)) / sqrt(s2);
  m.strength = r * r / s2;
  m.foot = dot(w, d);
  m.along = dot(a, d);
  const auto aligned = e2 < T(S(1e-12));
  const T sine = sqrt(max(e2, T(S(1e-12))));
  m.p = select(aligned, T(0), sine * m.inv_s);
  m.g = select(aligned, T(0), c_e / sine * m.inv_s);
  const T h2 = select(aligned, dot(c, c), dot(ce, ce) / (sine * sine));
  m.away2 = h2 * m.inv_s * m.inv_s;
  return m;
}

// Int exp(-(p u + g)^2) du over [u0, u1]: sqrt(pi)/2 [erf] / p, and the length times one
// exponential where p is (almost) 0.
template <Real T>
BRUME_INLINE T across(const Meeting<T>& m, T u0, T u1) {
  using S = Scalar_t<T>;
  const T length = max(u1 - u0, T(0)), width = m.p * length;
  const auto thin = width < T(S(1e-3));  // (width^2/12 of the value is left out)
  const T x = m.p * (u0 + T(S(0.5)) * length) + m.g;
  const T from = m.p * u0 + m.g;
  const T whole = T(S(0.88622692545275801)) * erf_difference(from, from + width, width) /
                  select(thin, T(1), m.p);
  return select(thin, length * exp(-min(x * x, T(80))), whole);
}

// What part of the Gaussian about y(u) lies between t0 and t1 of the ray.
template <Real T>
BRUME_INLINE T between(const Meeting<T>& m, T u, T t0, T t1) {
  using S = Scalar_t<T>;
  const T y = m.foot + m.along * u;
  return T(S(0.5)) *
         erf_difference((t0 - y) * m.inv_s, (t1 - y) * m.inv_s, (t1 - t0) * m.inv_s);
}

// The same as `across`, each u with its part between t0 and t1: Gauss-Legendre. Over 17
// deviations 32 nodes leave 3e-7.
template <Real T>
BRUME_INLINE T across_part(const Meeting<T>& m, T u0, T u1, T t0, T t1) {
  using S = Scalar_t<T>;
  constexpr auto rule = gauss_legendre<32>();
  const T half = T(S(0.5)) * max(u1 - u0, T(0)), middle = u0 + half;
  T sum(0);
  for (int k = 0; k < rule.size; ++k) {
    const T u = middle + half * T(S(rule.x[k])), x = m.p * u + m.g;
    sum += T(S(rule.w[k])) * exp(-min(x * x, T(80))) * between(m, u, t0, t1);
  }
  return half * sum;
}

// Int rho dt over [t0, t1].
//   A Gaussian about one place holds sqrt(2 pi) s exp(-h^2/2s^2) on a whole ray, so the
//   stretch holds (r/s)^2 exp(-h^2/2s^2) Int exp(-(p u + g)^2) du: one difference of erf.
//   Where the ray begins or ends within the core: in the u that are halfway in, by
//   quadrature; in those that are all in, as before.
//   Domain: all, t1 up to 3e38. Relative error 1e-5 and what rounding of M does.
template <Real T>
BRUME_INLINE T integral(const Channel& k, const T o[3], const T d[3], T t0, T t1) {
  using S = Scalar_t<T>;
  const Meeting<T> m = meet(k, o, d);
  const T H{S(k.half)}, room2 = max(T(S(0.5 * kSeen * kSeen)) - m.away2, T(0));
  // The u and t that matter at this distance of the ray, in sqrt(2) s.
  const T room = sqrt(room2), per_u = T(1) / max(m.p, T(S(1e-12)));
  const T u_lo = clamp((-room - m.g) * per_u, -H, H),
          u_hi = clamp((room - m.g) * per_u, -H, H);
  const T edge_t = room / m.inv_s;
  // All of it is seen where the ray passes all of that ball.
  const T most = sqrt(max(T(S(k.whole)) - m.away2, T(0)));
  const T y_lo = m.foot + m.along * clamp((-most - m.g) * per_u, -H, H),
          y_hi = m.foot + m.along * clamp((most - m.g) * per_u, -H, H);
  const T most_t = most / m.inv_s;
  const T nearest = m.foot - m.along * m.g * per_u, chord = most * per_u;
  const auto straight = m.p > T(0);
  const T t_lo =
              max(min(y_lo, y_hi) - most_t, select(straight, nearest - chord, T(-kNone))),
          t_hi =
              min(max(y_lo, y_hi) + most_t, select(straight, nearest + chord, T(kNone)));
  const auto small = T(S(k.whole)) > T(0), nothing = t1 <= t0;
  const auto all_in = nothing | (room2 == T(0)) |
                      (small & ((most == T(0)) | ((t0 <= t_lo) & (t1 >= t_hi))));
  const T peak = m.strength * exp(-min(m.away2, T(80)));
  T sum = T(0);
  if (any(all_in)) sum = select(all_in, across(m, -H, H), T(0));
  if (any(!all_in)) {
    // As if the ray went the way of growing u: where a place u lies at t0, and at t1.
    const T turn = select(m.along < T(0), T(-1), T(1));
    const Meeting<T> f = {m.foot,  abs(m.along), m.p,    turn * m.g,
                          m.away2, m.strength,   m.inv_s};
    const T lo = select(turn < T(0), -u_hi, u_lo), hi = select(turn < T(0), -u_lo, u_hi);
    const T per = T(1) / max(f.along, T(S(1e-9))), edge = edge_t * per;
    const T at0 = (max(t0, f.foot - T(S(1e9))) - f.foot) * per,
            at1 = (min(t1, f.foot + T(S(1e9))) - f.foot) * per;
    const T first = clamp(at0 - edge, lo, hi), last = clamp(at1 + edge, lo, hi);
    T in = clamp(at0 + edge, first, last), out = clamp(at1 - edge, first, last);
    const T mid = clamp(T(S(0.5)) * (at0 + at1), first, last);
    const auto never = in >= out;
    in = select(never, mid, in);
    out = select(never, mid, out);
    T part = across_part(f, first, in, t0, t1) + across_part(f, out, last, t0, t1);
    if (any(in < out)) part += across(f, in, out);
    sum = select(all_in, sum, part);
  }
  return select(nothing, T(0), peak * max(sum, T(0)));
}

template <Real T>
BRUME_INLINE T density(const Channel& k, const T o[3], const T d[3], T t) {
  using S = Scalar_t<T>;
  const Meeting<T> m = meet(k, o, d);
  const T H{S(k.half)};
  T x[3], off[3];
  const T a[3] = {T(S(k.axis[0])), T(S(k.axis[1])), T(S(k.axis[2]))};
  for (int i = 0; i < 3; ++i) x[i] = o[i] + t * d[i] - T(S(k.middle[i]));
  cross(x, a, off);
  const T u = dot(x, a), q2 = dot(off, off) * m.inv_s * m.inv_s;
  return m.strength * exp(-min(q2, T(80))) * T(S(0.5)) *
         erf_difference((-H - u) * m.inv_s, (H - u) * m.inv_s);
}

}  // namespace lightning::inline BRUME_ISA_NS
