#pragma once
// An Atmosphere as kernels take it, and the table of its diffuse light.

#include "harmonics.h"
#include "path.h"

namespace brume::sky::inline BRUME_ISA_NS {

template <class S, int N>
struct Air {
  Shape<S> shape;
  Coefficients<S, N> at1;
  Spectrum<S, N> irradiance, ground_albedo;
  S g;
  S beta_M[8];  // eigenvalues of the Mie phase function

  BRUME_INLINE Spectrum<S, N> transmittance(const Columns<S>& c) const {
    using Color = Spectrum<S, N>;
    return exp(-(at1.extinct_R * Color(c.R) + at1.extinct_M * Color(c.M) +
                 at1.absorb_O * Color(c.O)));
  }
};

/// The forward peak that harmonics up to L leave over (forward.h), tabulated.
template <class S>
struct Forward {
  static constexpr int kAngles = 256, kTerms = 3;
  const S* series;  // [kAngles + 1][kTerms]: q_k/k! over sin(theta/2)
  static constexpr int kAltitudes = 20, kDirections = 33;
  static constexpr S kScale = S(.1);
  const S* column;  // [kAltitudes][kDirections], h ~ x^3, mu = kScale sinh
  S inv_top, x0, inv_dx;
};

/// Coefficients of the light that arrives at (altitude, sun height), h = top x^2, mu_s =
/// scale sinh. Cubic in the sun's height (light falls by e^-10 within ten degrees of
/// dusk), with a ghost node at each end.
template <class S>
struct Table {
  int altitudes, suns;
  S inv_top, scale, x_min, inv_dx;
  const S* nodes;   // [altitudes][suns + 2][harmonics_count(L)][N]
  const S* ground;  // [suns + 2][N] diffuse irradiance [W m^-2 nm^-1]
};

template <Real T>
BRUME_INLINE T asinh_(T y) {
  const T a = abs(y), v = log(a + sqrt(a * a + T(1)));
  return select(y < T(0), -v, v);
}

/// First row and Catmull-Rom weights of sun height mu_s.
template <class T>
struct Place {
  T row, w[4];
};
template <Real T>
BRUME_INLINE Place<T> place(const Table<Scalar_t<T>>& t, T mu_s) {
  using S = Scalar_t<T>;
  const T x = clamp((asinh_(mu_s * T(1 / t.scale)) - T(t.x_min)) * T(t.inv_dx), T(0),
                    T(S(t.suns - 1) * S(.999999)));
  const T i = floor(x), f = x - i, half(S(.5));
  return {i,
          {half * f * (f * (T(2) - f) - T(1)), half * (f * f * (T(3) * f - T(5)) + T(2)),
           half * f * (f * (T(4) - T(3) * f) + T(1)), half * f * f * (f - T(1))}};
}

/// The direction's component toward the sun's azimuth; z its cosine to the vertical. 0/0
/// at the zenith is any azimuth.
template <Real T>
BRUME_INLINE T toward_sun(T nu, Same<T> mu_s, Same<T> z) {
  using S = Scalar_t<T>;
  const T sin_s = sqrt(max(T(1) - mu_s * mu_s, T(S(1e-8)))),
          reach = sqrt(max(T(1) - z * z, T(0)));
  return clamp((nu - mu_s * z) / sin_s, -reach, reach);
}

/// Diffuse irradiance on the ground.
template <class S, int N>
BRUME_INLINE Spectrum<S, N> ground_irradiance(const Table<S>& t, S mu_s) {
  const auto p = place(t, mu_s);
  Spectrum<S, N> e(0);
  for (int k = 0; k < 4; ++k)
    e += Spectrum<S, N>(p.w[k]) * Spectrum<S, N>::at(t.ground + (int(p.row) + k) * N);
  return max(e, Spectrum<S, N>(0));
}

}  // namespace brume::sky::inline BRUME_ISA_NS
