#pragma once
// The sky of one eye and one sun as tables: what a frame of many pixels looks up instead
// of asking along every ray.
//
// Directions go by elevation and azimuth from the sun. Elevation is cut at the horizon, a
// table above and one below, with nodes clustered there: angle from the horizon / its
// largest = crowd v^2 + (1 - crowd) v^4. Above, crowd = .3; below, where a path ends at
// the ground after sqrt(angle), within the eye's dip, 1/50. Azimuth from the sun is even
// at both ends and made of harmonics: asked at few nodes, filled up by polynomials of
// degree 7, looked up straight between. Distance d from where the direction enters the
// air to where it leaves it or meets the ground: d/d_end = (1 - k) x + k x^2, dense near
// the eye in thick air (k = 1), near the ground for an eye high above it (k < 0). Tables
// hold the parts of light by scattering angle (view.h), so that phase functions stay
// exact and the sun's aureole sharp; and over how light grows (column.h), so that L -> 0
// as d -> 0 and what is looked up is as smooth as the source.

#include "num/isa.h"
#include "types.h"

namespace brume::sky {

constexpr int kMapParts = 16;  // R, M[0], M[1], M[2], D as rgb; one to spare

constexpr int kMapWavelengths = 64;

constexpr float kCrowdAbove = .3f, kCrowdBelow = .02f;

/// [elevations + 2][azimuths][slices + 2, or 1][kMapParts]: with ghosts.
struct HalfMap {
  int elevations, slices;
  float bend;  // k
  const float* parts;
};

/// The air in the world, for transmittance: positions are relative to the eye.
struct SkyPlace {
  float ground[3],
      up[3];  // eye minus the point of the ground below the world's origin [m]; up there
  Shape<float> shape;
  int wavelengths;  // that some colour sees
  float extinct_R[kMapWavelengths], extinct_M[kMapWavelengths], absorb_O[kMapWavelengths],
      weight[3][kMapWavelengths];
  float grow_R[3], grow_M[3];  // extinction by colour: of light's growth
};

struct SkyMap {
  float up[3], sun[3];  // at the eye; unit vectors of the world
  float mu_s, sin_s;    // the sun there
  float h, r, q;     // altitude of the eye; distance from the planet's centre; R_top^2 -
                     // r^2 [m^2]
  float c, to_deep;  // r^2 - R^2 of the ground where paths end, and of the deepest that
                     // surfaces are seen at
  float horizon;     // its zenith angle [rad]
  float limb;        // that of the highest ray looked up: through the air, 0 from within;
                     // of what lies beyond the ground, that of its horizon
  float r_top;       // distance of the top of the air from the planet's centre [m]
  float g;           // Mie asymmetry
  float weight;      // how much of the air there is on the way to the eye
  int azimuths;
  HalfMap above, below, sky;  // `sky`: whole paths above the horizon, one slice, finer;
                              // without elevations where there is none
  Forward<float> forward;
};

struct MapKernels {
  /// n rays from the eye over [0, t1]. T is -1 where a ray goes on far beyond the ground,
  /// to a surface: tables of the deepest ground have those.
  void (*look)(const SkyMap&, const SkyPlace&, int n, const float* dx, const float* dy,
               const float* dz, const float* t1, float* const L[3], float* const T[3]);
  /// Transmittance of n rays over [t0, t1]; null origins: at the eye.
  void (*through)(const SkyPlace&, int n, const float* const o[3],
                  const float* const d[3], const float* t0, const float* t1,
                  float* const T[3]);
};
BRUME_ISA_DECLARE(MapKernels, map_kernels)

}  // namespace brume::sky
