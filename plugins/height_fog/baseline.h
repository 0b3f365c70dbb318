#pragma once
// What the source of the effect does: Wenzel, "Real-time Atmospheric Effects in Games
// Revisited" (GDC 2007), slide "Global Volumetric Fog: Shader Implementation", in float.
// Kept to compare with: only `brume study` and tests run it.

#include <cmath>

namespace height_fog::baseline {

/// Integral of exp(-c z) from a camera at height `eye_z` to the point at `dx, dy, dz`
/// from it. Within 0.01 m of the camera's height it takes the horizontal limit, which
/// shows as a step of about half |c| 0.01 of its value.
inline float integral(float dx, float dy, float dz, float eye_z, float c) {
  const float density_at_viewer = std::exp(-c * eye_z);
  float through = std::sqrt(dx * dx + dy * dy + dz * dz) * density_at_viewer;
  constexpr float kThreshold = 0.01f;  // [m]; the slide calls it a slope
  if (std::fabs(dz) > kThreshold) {
    const float t = c * dz;
    through *= (1.0f - std::exp(-t)) / t;
  }
  return through;
}

/// Transmittance of density b exp(-c z).
inline float transmittance(float dx, float dy, float dz, float eye_z, float b, float c) {
  return std::exp(-b * integral(dx, dy, dz, eye_z, c));
}

}  // namespace height_fog::baseline
