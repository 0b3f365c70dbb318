#pragma once
// Phase functions p(cos theta) [1/sr]: integral over all directions 1, mean cosine g
// (Rayleigh: 0). cos theta = 1 is straight on.

#include "num/math.h"
#include "plugin.h"

namespace brume::air::inline BRUME_ISA_NS {

// Henyey & Greenstein 1941: (1 - g^2)/(4 pi (1 + g^2 - 2 g mu)^(3/2)).
//   The bracket as (1 - |g|)^2 + 2 |g| (1 - sign(g) mu): no cancellation near the peak.
//   Domain: |g| < 1, |mu| <= 1. g = 0 is the same in all directions, and costs nothing.
template <Real T>
BRUME_INLINE T henyey_greenstein(T mu, float g) {
  if (g == 0) return T(static_cast<float>(1 / (4 * kPi)));
  const float m = g < 0 ? -g : g;
  const T away = T(1) - (g < 0 ? -mu : mu);
  const T q = T((1 - m) * (1 - m)) + T(2 * m) * max(away, T(0));
  return T(static_cast<float>(1 / (4 * kPi)) * (1 - m) * (1 + m)) / (q * sqrt(q));
}

// Rayleigh 1871: 3/(16 pi) (1 + mu^2).
template <Real T>
BRUME_INLINE T rayleigh(T mu) {
  return T(static_cast<float>(3 / (16 * kPi))) * (T(1) + mu * mu);
}

// Cornette & Shanks 1992, eq. 8: Henyey-Greenstein times 3/2 (1 + mu^2)/(2 + g^2).
template <Real T>
BRUME_INLINE T cornette_shanks(T mu, float g) {
  return henyey_greenstein(mu, g) * (T(1) + mu * mu) * T(1.5f / (2 + g * g));
}

template <Real T>
BRUME_INLINE T phase(brume_phase kind, T mu, float g) {
  switch (kind) {
    case BRUME_RAYLEIGH:
      return rayleigh(mu);
    case BRUME_CORNETTE_SHANKS:
      return cornette_shanks(mu, g);
    default:
      return henyey_greenstein(mu, g);
  }
}

}  // namespace brume::air::inline BRUME_ISA_NS
