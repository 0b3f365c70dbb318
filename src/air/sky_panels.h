#pragma once
// A sky light's radiance by elevation and azimuth about the world's up: rings of
// directions, in panels of elevations that are narrow where the sky changes much.

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "plugin.h"

namespace brume::air {

inline constexpr double kTurn = 6.283185307179586;
inline constexpr std::size_t kSkySamples = 64;  ///< of a ring

/// cos and sin of j/N turns.
template <std::size_t N>
const std::array<std::array<double, 2>, N>& turns() {
  static const auto table = [] {
    std::array<std::array<double, 2>, N> t;
    for (std::size_t j = 0; j < N; ++j)
      t[j] = {std::cos(double(j) * kTurn / N), std::sin(double(j) * kTurn / N)};
    return t;
  }();
  return table;
}

/// Radiance at one elevation, at azimuths j/kSkySamples turns from the first axis toward
/// the second. What is no number, or negative, is no light.
struct SkyRing {
  double elevation, z, s;  ///< [rad], its sine, its cosine
  double L[3][kSkySamples];
};

/// Elevations from lo to hi [rad] at the nodes of Clenshaw and Curtis (1960), which has
/// both ends (nodes that keep away from them miss a strip beside one) and, in every
/// second node, a rule to be held against.
struct SkyPanel {
  static constexpr std::size_t kRings = 9;
  double lo, hi;
  std::vector<SkyRing> rings;

  /// Of ring k in an integral over sines of elevations.
  double weight(std::size_t k) const;
};

struct SkyPanels {
  glm::dvec3 axis[3];  ///< azimuth 0, 90 degrees, up
  std::vector<SkyPanel> panels;
  double horizon = 0;  ///< elevation where the sky jumps most [rad]; 0 if nowhere
};

/// Panels end at the elevation where the sky jumps most, its horizon, and are halved
/// until every second ring gives the same light but for 1e-5 of all: seen from high above
/// the sky has a rim as narrow as the air is thin. 10^4 directions of a clear sky.
SkyPanels panels_of(const brume_light& light, const glm::dvec3& up);

}  // namespace brume::air
