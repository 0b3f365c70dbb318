#pragma once
// Real spherical harmonics, even in azimuth, of a direction given by z (cosine to the
// local vertical) and x (component along the sun's azimuth). The sun's plane is a plane
// of symmetry of the light, so the odd ones never occur.
//   Y_lm = A_lm(z) C_m(x, z),  C_m = (1 - z^2)^{m/2} cos(m phi),  A_lm = K_lm P_l^m(z) (1
//   - z^2)^{-m/2},
// both polynomials; orthonormal over the sphere. Order of coefficients: (0,0) (1,0) (1,1)
// (2,0) (2,1) (2,2) ... And the phase functions, whose action on them is multiplication
// by an eigenvalue.

#include <array>

#include "spectrum.h"
#include "types.h"

namespace brume::sky::inline BRUME_ISA_NS {

namespace detail {
constexpr double constant_sqrt(double x) {
  double r = x > 1 ? x : 1;
  for (int i = 0; i < 100; ++i) r = .5 * (r + x / r);
  return r;
}
// K_lm, with (l-m)!/(l+m)! and sqrt 2 for m > 0.
template <int L>
constexpr auto norms() {
  std::array<double, harmonics_count(L)> k{};
  for (int l = 0; l <= L; ++l)
    for (int m = 0; m <= l; ++m) {
      double f = (2 * l + 1) / (4 * double(kPi)) * (m ? 2 : 1);
      for (int i = l - m + 1; i <= l + m; ++i) f /= i;
      k[harmonic(l, m)] = constant_sqrt(f);
    }
  return k;
}
}  // namespace detail

/// A_lm(z), l <= L.
template <int L, Real T>
BRUME_INLINE void polar_part(T z, T* a) {
  using S = Scalar_t<T>;
  constexpr auto K = detail::norms<L>();
  S odd(1);  // P_m^m: (2m-1)!!
  for (int m = 0; m <= L; ++m) {
    T before(0), p(odd);
    for (int l = m; l <= L; ++l) {
      a[harmonic(l, m)] = T(S(K[harmonic(l, m)])) * p;
      const T next =
          (T(S(2 * l + 1)) * z * p - T(S(l + m)) * before) * T(S(1) / S(l - m + 1));
      before = p, p = next;
    }
    odd *= S(2 * m + 1);
  }
}

/// C_m(x, z), m <= L: Chebyshev's recurrence made homogeneous.
template <int L, Real T>
BRUME_INLINE void azimuth_part(T x, Same<T> z, T* c) {
  const T s2 = max(T(1) - z * z, T(0));
  c[0] = T(1);
  c[1] = x;
  for (int m = 2; m <= L; ++m) c[m] = (x + x) * c[m - 1] - s2 * c[m - 2];
}

/// Phase functions [1/sr] of the cosine of the scattering angle.
template <Real T>
BRUME_INLINE T phase_rayleigh(T nu) {
  return T(Scalar_t<T>(3 / (16 * double(kPi)))) * (T(1) + nu * nu);
}
/// Cornette and Shanks 1992, equation 8; |g| < 1.
template <Real T>
BRUME_INLINE T phase_mie(T nu, Scalar_t<T> g) {
  using S = Scalar_t<T>;
  const S k = S(3 / (8 * double(kPi))) * (1 - g * g) / (2 + g * g);
  const T q = T((1 - g) * (1 - g)) + T(2 * g) * max(T(1) - nu, T(0));
  return T(k) * (T(1) + nu * nu) / (q * sqrt(q));
}

/// beta_l = 2 pi int p(c) P_l(c) dc, the eigenvalue of a phase function on Y_lm.
constexpr double rayleigh_eigenvalue(int l) { return l == 0 ? 1. : l == 2 ? .1 : 0.; }

/// From those of Henyey and Greenstein, g^l, and c P_l = ((l+1) P_{l+1} + l
/// P_{l-1})/(2l+1), used twice for the c^2 of Cornette and Shanks' factor 1 + c^2.
inline double mie_eigenvalue(int l, double g) {
  auto power = [g](int n) {
    double p = 1;
    for (int i = 0; i < n; ++i) p *= g;
    return p;
  };
  const double n = l;
  const double above =
      (n + 1) / (2 * n + 1) * ((n + 2) * power(l + 2) + (n + 1) * power(l)) / (2 * n + 3);
  const double below = l ? n / (2 * n + 1) *
                               (n * power(l) + (l > 1 ? (n - 1) * power(l - 2) : 0)) /
                               (2 * n - 1)
                         : 0;
  return 1.5 / (2 + g * g) * (power(l) + above + below);
}

}  // namespace brume::sky::inline BRUME_ISA_NS
