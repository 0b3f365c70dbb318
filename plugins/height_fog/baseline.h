#pragma once
// What the source of the effect does: Wenzel, "Real-time Atmospheric Effects in Games
// Revisited" (GDC 2007), slide "Global Volumetric Fog: Shader Implementation", in float.
// Kept to compare with; nothing of brume runs it.

#include <cmath>

namespace height_fog::baseline {

/// Transmittance of density b exp(-c z) from a camera at height `eye_z` to the point at
/// `dx, dy, dz` from it. Within 0.01 m of the camera's height it takes the horizontal
/// limit, which shows as a step of about half |c| 0.01 of the optical depth.
inline float transmittance(float dx, float dy, float dz, float eye_z, float b, float c) {
  const float density_at_viewer = std::exp(-c * eye_z);
  float integral = std::sqrt(dx * dx + dy * dy + dz * dz) * density_at_viewer;
  constexpr float kThreshold = 0.01f;  // [m]; the slide calls it a slope
  if (std::fabs(dz) > kThreshold) {
    const float t = c * dz;
    integral *= (1.0f - std::exp(-t)) / t;
  }
  return std::exp(-b * integral);
}

}  // namespace height_fog::baseline
