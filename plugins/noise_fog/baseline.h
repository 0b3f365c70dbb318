#pragma once
// What the source of the effect does (Intel, "Ocean fog", 2008), and how a march in equal
// steps would do it. Kept to compare with; nothing of brume runs it.

#include <cmath>

namespace brume::noise_fog::baseline {

/// Fog of extinction `density` at `distance`, the noise taken once, at the surface:
/// f = e^(-density distance noise).
inline double transmittance(double density, double distance, double noise_at_surface) {
  return std::exp(-density * distance * noise_at_surface);
}

/// Optical depth over [0, t] of `sigma(t)` [1/m] in n equal steps, looked at in the
/// middle of each, or, as loops are mostly written, where it begins.
template <class F>
double march(const F& sigma, double t, int n, bool in_the_middle) {
  double sum = 0;
  for (int j = 0; j < n; ++j) sum += sigma((j + (in_the_middle ? 0.5 : 0.)) * t / n);
  return sum * t / n;
}

}  // namespace brume::noise_fog::baseline
