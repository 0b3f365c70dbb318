#pragma once
// Irradiance from a sky on planes of any normal n: its radiance over the hemisphere about
// n, weighted by the cosine.
//
// About the world's up, a ring of directions at height z = cos(angle to up) sends, where
// its radiance is Sum_m L_m e^(i m phi), to a plane whose normal lies at theta from up
//
//   E_m = L_m Int cos(m psi) max(cos(theta) z + sin(theta) sqrt(1 - z^2) cos(psi), 0)
//   dpsi
//
// which is closed (sky_light.cpp), so that azimuths cost nothing in accuracy: L_m falls
// as the sky is smooth along a ring, the integral with m^(-2). Heights are a quadrature,
// split at the horizon. E as a function of n is kept in a map. Beside a bright and narrow
// rim it is nearly a cone about up (and down): the rim's directions all leave the
// hemisphere together. So the map's angles are dense there.

#include <cstddef>
#include <glm/glm.hpp>
#include <mutex>
#include <vector>

#include "plugin.h"

namespace brume::air {

/// E of normals above the horizontal, by their angle theta to up and their azimuth phi.
/// Rows: a cap from the angle `edge` to up, dense at the edge, and a belt from there to
/// the horizontal, likewise:
///   theta = edge - edge (k/kCap)^2,   theta = edge + (pi/2 - edge) (k/kBelt)^2
/// cubic in k (Lagrange), and in phi a periodic cubic B-spline. Below the horizontal
///   E(n) = E(-n) + n . F,   F = Int L(d) d dd
struct SkyMap {
  static constexpr int kCap = 16, kBelt = 48, kAround = 64;
  static constexpr int kRows = kCap + 1 + kBelt + 1;
  static constexpr int kRow = 4 * (kAround + 3);  ///< floats: r g b and one more

  float axis[3][3] = {};  ///< phi = 0, phi = 90 degrees, up
  float flux[3][3] = {};  ///< F of each colour along these axes
  float edge = 0;
  float cap = 0, belt = 0;  ///< kCap^2/edge, kBelt^2/(pi/2 - edge)
  std::vector<float> E;     ///< coefficients by row, from phi = -1 step on
};

/// The map of a sky light, worked out when it is first asked for. The light's functions
/// must live as long.
class SkyIrradiance {
 public:
  SkyIrradiance(const brume_light& light, const glm::dvec3& up)
      : light_(light), up_(up) {}
  /// Thread-safe.
  const SkyMap& map() const;

 private:
  brume_light light_;
  glm::dvec3 up_;
  mutable std::once_flag once_;
  mutable SkyMap map_;
};

}  // namespace brume::air
