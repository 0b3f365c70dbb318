#pragma once
// Looking light up: sunlight at a point, the table of diffuse light, the forward peak.

#include "harmonics.h"
#include "path.h"

namespace brume::sky::inline BRUME_ISA_NS {

template <class S, int N>
BRUME_INLINE Spectrum<S, N> transmittance(const Air<S>& a, S R, S M, S O) {
  using Color = Spectrum<S, N>;
  return exp(-(Color::at(a.extinct_R) * Color(R) + Color::at(a.extinct_M) * Color(M) +
               Color::at(a.absorb_O) * Color(O)));
}

/// x between lo and hi; NaN becomes lo, so that what it places stays in its table.
template <Real T>
BRUME_INLINE T within(T x, Same<T> lo, Same<T> hi) {
  return min(max(lo, x), hi);
}

template <Real T>
BRUME_INLINE T arsinh(T y) {
  const T a = abs(y), v = log(a + sqrt(a * a + T(1)));
  return select(y < T(0), -v, v);
}

/// Row of the table (ghosts included) from which four follow with Catmull-Rom weights;
/// clamped at both ends.
template <class T>
struct Place {
  T row, w[4];
  T e;  // what was placed: the sun's elevation [rad]
};
template <Real T>
BRUME_INLINE Place<T> place_sun(const Table<Scalar_t<T>>& t, T mu_s) {
  using S = Scalar_t<T>;
  using Axis = Table<S>;
  const T e = asin(mu_s),
          axis = arsinh(e * T(S(1 / Axis::kHorizon))) + T(S(Axis::kSpread)) * e;
  const T y =
      within((axis - T(t.y_min)) * T(t.inv_dy), T(0), T(S(t.suns - 1) * S(.999999)));
  const T i = floor(y), f = y - i, half(S(.5));
  return {i,
          {half * f * (f * (T(2) - f) - T(1)), half * (f * f * (T(3) * f - T(5)) + T(2)),
           half * f * (f * (T(4) - T(3) * f) + T(1)), half * f * f * (f - T(1))},
          e};
}

/// How twilight fades, at altitude top x^2, with the sun m below the horizon there, which
/// dips by x dip_top. The planet's shadow rises by R m^2/2, and air thins by e over a
/// scale height: e^{-kappa m^2}, kappa = R/2H. Once it stands three scale heights high
/// (m = even) light comes sideways from where it is lower, and fades evenly.
template <Real T>
BRUME_INLINE T fade(const Table<Scalar_t<T>>& t, T x, Same<T> e) {
  const T m = max(-e - x * T(t.dip_top), T(0)), c = min(m, T(t.even));
  return exp(-min(T(t.kappa) * c * (m + m - c), T(Scalar_t<T>(80))));
}

/// Altitude in units of table nodes.
template <class S>
BRUME_INLINE S place_altitude(const Table<S>& t, S h) {
  return sqrt(within(h * t.inv_top, S(0), S(.999998))) * S(t.altitudes - 1);
}

/// Component of a direction toward the sun's azimuth; z its cosine to the vertical. 0/0
/// at the zenith is any azimuth.
template <Real T>
BRUME_INLINE T toward_sun(T nu, Same<T> mu_s, Same<T> z) {
  using S = Scalar_t<T>;
  const T sin_s = sqrt(max(T(1) - mu_s * mu_s, T(S(1e-8)))),
          reach = sqrt(max(T(1) - z * z, T(0)));
  return clamp((nu - mu_s * z) / sin_s, -reach, reach);
}

/// Diffuse irradiance of the ground.
template <int N, class S>
BRUME_INLINE Spectrum<S, N> ground_irradiance(const Table<S>& t, S mu_s) {
  const auto p = place_sun(t, mu_s);
  Spectrum<S, N> e(0);
  for (int k = 0; k < 4; ++k)
    e += Spectrum<S, N>(p.w[k]) * Spectrum<S, N>::at(t.ground + (int(p.row) + k) * N);
  return max(e * Spectrum<S, N>(fade(t, S(0), p.e)), Spectrum<S, N>(0));
}

/// Mie column [m] averaged over the neighbourhood of direction mu; linear in both
/// coordinates.
template <class S>
BRUME_INLINE S neighbourhood_column(const Forward<S>& f, S h, S mu) {
  const S y = within((arsinh(mu * S(1 / f.kScale)) - f.y_min) * f.inv_dy, S(0),
                     S(f.kDirections - 1) * S(.9999));
  const S x = exp(log(within(h * f.inv_top, S(1e-12), S(.9999))) * S(1. / 3)) *
              S(f.kAltitudes - 1);
  const int i = int(x), j = int(y);
  const S p = x - S(i), q = y - S(j);
  const S *a = f.column + i * f.kDirections + j, *b = a + f.kDirections;
  return (1 - p) * ((1 - q) * a[0] + q * a[1]) + p * ((1 - q) * b[0] + q * b[1]);
}

/// The terms q_k/k! at scattering angle arccos(nu).
template <class S>
BRUME_INLINE void forward_terms(const Forward<S>& f, S nu, S* q) {
  const S x = sqrt(within((1 - nu) * S(.5), S(0), S(.9999))) * S(f.kAngles),
          part = x - S(int(x));
  const S* s = f.series + int(x) * f.kTerms;
  for (int k = 0; k < f.kTerms; ++k) q[k] = s[k] + part * (s[k + f.kTerms] - s[k]);
}

}  // namespace brume::sky::inline BRUME_ISA_NS
