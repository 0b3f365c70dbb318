#pragma once
// Irradiance from a sky on planes of any normal n: its radiance over the hemisphere about
// n, weighted by the cosine.
//
//   L(d) = Sum L_lm Y_lm(d)   ->   E(n) = Sum A_l L_lm Y_lm(n)
//
// with A_l the coefficients of a clamped cosine: pi, 2 pi/3, then for even l
//   A_l = 2 pi (-1)^(l/2 - 1) l! / ((l + 2)(l - 1) 2^l ((l/2)!)^2),   0 for odd l > 1
// (Ramamoorthi & Hanrahan 2001, "On the relationship between radiance and irradiance").
// A_l falls with l^(-5/2), so that few degrees do: up to 20, a light that comes all from
// one direction would be off by up to 1.5 % of it (tests/air/sky_light_test.cpp), a clear
// sky by 4e-4 of its brightest irradiance, with the sun at 4 degrees by 1e-3
// (plugins/relight/test.cpp).

#include <glm/glm.hpp>
#include <mutex>

#include "plugin.h"

namespace brume::air {

/// E's coefficients by order m, then degree l >= m, on polynomials that begin with 1:
/// Q_m = 1, Q_l = rise z Q_(l-1) - fall Q_(l-2).
struct SkyHarmonics {
  static constexpr int kDegree = 20;
  static constexpr int kTerms = (kDegree + 1) * (kDegree + 2) / 2;
  float rise[kTerms] = {}, fall[kTerms] = {};
  float C[3][kTerms] = {}, S[3][kTerms] = {};  ///< of cos(m phi), sin(m phi)
};

/// Coefficients of a sky light, worked out when they are first asked for: 16384
/// directions of its radiance, split at the horizon, where a sky bends. The light's
/// functions must live as long.
class SkyIrradiance {
 public:
  SkyIrradiance(const brume_light& light, const glm::dvec3& up)
      : light_(light), up_(up) {}
  /// Thread-safe.
  const SkyHarmonics& harmonics() const;

 private:
  brume_light light_;
  glm::dvec3 up_;
  mutable std::once_flag once_;
  mutable SkyHarmonics harmonics_;
};

}  // namespace brume::air
