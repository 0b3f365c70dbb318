#pragma once
// Phase functions p(mu) [1/sr], mu = to . d of unit vectors, `to` toward the light, d
// along the ray: integral over all directions 1, mean cosine g (Rayleigh: 0). mu = 1 is
// straight on.

#include "num/math.h"
#include "plugin.h"

namespace brume::air::inline BRUME_ISA_NS {

// Henyey & Greenstein 1941: (1 - g^2)/(4 pi (1 + g^2 - 2 g mu)^(3/2)).
//   The bracket as (1 - |g|)^2 + |g| |to - sign(g) d|^2: no cancellation near the peak,
//   where mu has lost its digits (of (1 - |g|)^2 = 1e-4 at .99 a float mu leaves 2e-3).
//   Domain: |g| < 1. g = 0 is the same in all directions, and costs nothing.
template <Real T>
BRUME_INLINE T henyey_greenstein(const T to[3], const T d[3], float g) {
  if (g == 0) return T(static_cast<float>(1 / (4 * kPi)));
  const float m = g < 0 ? -g : g;
  T chord[3];
  for (int i = 0; i < 3; ++i) chord[i] = g < 0 ? to[i] + d[i] : to[i] - d[i];
  const T q = T((1 - m) * (1 - m)) + T(m) * dot(chord, chord);
  return T(static_cast<float>(1 / (4 * kPi)) * (1 - m) * (1 + m)) / (q * sqrt(q));
}

// Rayleigh 1871: 3/(16 pi) (1 + mu^2).
template <Real T>
BRUME_INLINE T rayleigh(T mu) {
  return T(static_cast<float>(3 / (16 * kPi))) * (T(1) + mu * mu);
}

// Cornette & Shanks 1992, eq. 8: Henyey-Greenstein times 3/2 (1 + mu^2)/(2 + g^2).
template <Real T>
BRUME_INLINE T cornette_shanks(const T to[3], const T d[3], float g) {
  const T mu = dot(to, d);
  return henyey_greenstein(to, d, g) * (T(1) + mu * mu) * T(1.5f / (2 + g * g));
}

template <Real T>
BRUME_INLINE T phase(brume_phase kind, const T to[3], const T d[3], float g) {
  switch (kind) {
    case BRUME_RAYLEIGH:
      return rayleigh(dot(to, d));
    case BRUME_CORNETTE_SHANKS:
      return cornette_shanks(to, d, g);
    default:
      return henyey_greenstein(to, d, g);
  }
}

}  // namespace brume::air::inline BRUME_ISA_NS
