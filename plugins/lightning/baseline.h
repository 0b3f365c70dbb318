#pragma once
// What the source of the effect does: Wenzel, "Real-time Atmospheric Effects in Games"
// (SIGGRAPH 2006), volumetric lightning: the antiderivative of 1 / (1 + a |o + t d -
// l|^2) as tables of integrals print it, in float. Kept to compare with: only `brume
// study` and tests run it.

#include <cmath>

namespace lightning::baseline {

/// Integral over [0, t] along the unit direction d from an origin at m from the light
/// (m = origin - light), with a the attenuation. Far lights cancel in both brackets.
inline float glow(const float m[3], const float d[3], float t, float a) {
  const float u = a * 2 * (m[0] * d[0] + m[1] * d[1] + m[2] * d[2]);
  const float v = 1 + a * (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  const float s = std::sqrt(4 * a * v - u * u);
  return 2 / s * (std::atan((2 * a * t + u) / s) - std::atan(u / s));
}

}  // namespace lightning::baseline
