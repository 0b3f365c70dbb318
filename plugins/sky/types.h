#pragma once
// What kernels of every instruction set are handed: plain arrays, S = float or double.
// Wavelengths are the fastest index, N of them to a group (4 or 8), the last repeated
// where there are fewer.
//
// h altitude [m] · z cosine of a path's direction to the local vertical · t distance from
// the eye [m]

#include "trace.h"

namespace brume::sky {

constexpr int kMaxN = 8;        // wavelengths in a group
constexpr int kMaxL = 10;       // harmonics
constexpr int kMaxPanels = 24;  // on a whole piece of a path
constexpr int kMaxPathPanels = 2 * kMaxPanels + kMaxStretches;  // on a path
constexpr int kMaxNodes = 3 * kMaxPathPanels + 12;              // with full lanes
constexpr int kMaxSuns = 128, kMaxAround = 64;
constexpr int harmonics_count(int L) { return (L + 1) * (L + 2) / 2; }
constexpr int harmonic(int l, int m) { return l * (l + 1) / 2 + m; }

/// Lengths of an atmosphere [m].
template <class S>
struct Shape {
  S R, top;         // planet radius; height of the air above it
  S H_R, H_M;       // scale heights of Rayleigh and Mie scatterers
  S O_mid, O_half;  // ozone tent: altitude of density 1, half width
};

/// Air goes on below the ground so far, in scale heights of aerosol: before surfaces that
/// are seen there, and for an eye down there.
constexpr double kDeep = .5;
/// So little of a planet's radius below its ground is on it.
constexpr double kGrain = 1e-9;
/// An eye is no deeper than this: the planet sinks with it.
constexpr double kDeepestEye = .25;

/// One group of wavelengths of an atmosphere; coefficients at density 1 [1/m].
template <class S>
struct Air {
  Shape<S> shape;
  S scatter_R[kMaxN], scatter_M[kMaxN], extinct_R[kMaxN], extinct_M[kMaxN],
      absorb_O[kMaxN];
  S irradiance[kMaxN], ground_albedo[kMaxN];
  S g;
  S beta_M[kMaxL + 1];  // eigenvalues of the Mie phase function
};

/// Points of a path in order of travel, planar, padded to full lanes with weight 0.
template <class S>
struct Nodes {
  int count = 0;             // a multiple of 3
  int mark[kMaxPathPanels];  // of the stretch that ends with this panel; -1: none
  S h[kMaxNodes], z[kMaxNodes], t[kMaxNodes];
  S du[kMaxNodes];                             // weight in an integral over distance [m]
  S R[kMaxNodes], M[kMaxNodes], O[kMaxNodes];  // densities
};

/// What a node's scattering counts for at the eye (scattering optical depth times
/// transmittance), [node][N]; and the transmittance of the whole path.
template <class S>
struct Weights {
  S R[kMaxNodes * kMaxN], M[kMaxNodes * kMaxN];
  S T[kMaxN],
      T_panel[kMaxPathPanels * kMaxN];  // of the whole path; up to each panel's end
};

/// A path and its place among the directions of the solver.
template <class S>
struct Line {
  Nodes<S> nodes;
  Weights<S> weights;
  S r, t_end;   // of the eye [m]; length of the path
  S mu, s;      // cosine, sine of its zenith angle
  bool ground;  // ends there
};

/// Sun heights times azimuths, [height][azimuth], padded to full lanes.
template <class S>
struct Suns {
  int count, heights, azimuths;
  const S *mu_s, *sin_cos;  // cosine of zenith angle; its sine times cos(azimuth)
  const S* cos_phi;         // of the azimuths
};

/// Light that arrives after one or more scatterings, without the sun: coefficients over
/// altitude h = top x^2 and the sun's elevation e, in steps of y = arsinh(e/kHorizon) +
/// kSpread e: densest at the horizon, and nearly even toward the zenith, where harmonics
/// turn with the sun. A ghost node at each end of y. They are stored without the way
/// twilight fades (lookup.h): light falls by ten orders, what is left is smooth.
template <class S>
struct Table {
  int altitudes, suns;
  static constexpr double kHorizon = .03, kSpread = 4;
  S inv_top, y_min, inv_dy;
  S kappa, even, dip_top;  // of fade()
  const S* nodes;          // [altitudes][suns + 2][harmonics_count(L)][N]
  const S* ground;         // [suns + 2][N] irradiance of the ground [W m^-2 nm^-1]
};

/// The forward peak that harmonics leave over (forward.h).
template <class S>
struct Forward {
  static constexpr int kAngles = 256, kTerms = 3;
  const S* series;  // [kAngles + 1][kTerms]: q_k/k! over sin(theta/2)
  static constexpr int kAltitudes = 20, kDirections = 33;
  static constexpr double kScale = .1;
  const S* column;  // [kAltitudes][kDirections] [m], h = top x^3, mu = kScale sinh(y)
  S inv_top, y_min, inv_dy;
};

/// What an eye sees along a ray.
template <class S>
struct Seen {
  S L[kMaxN];       // radiance the air adds [W m^-2 sr^-1 nm^-1]
  S T[kMaxN];       // transmittance
  S single[kMaxN];  // the part of L scattered once
};

/// The kernels for one N and L, of one instruction set.
template <class S>
struct Kernels {
  int N, L;
  void (*line)(const Air<S>&, const Trace&, int panels, Line<S>&);
  void (*first)(const Air<S>&, const Line<S>&, const Suns<S>&, S* light);
  void (*next)(const Air<S>&, const Table<S>&, const Line<S>&, const Suns<S>&, S* light);
  void (*project)(const Line<S>&, const Suns<S>&, S weight, const S* light, S* nodes,
                  S* ground);
  void (*see)(const Air<S>&, const Forward<S>&, const Table<S>&, const Trace&, const Ray&,
              int panels, Seen<S>&);
  void (*along)(const Air<S>&, const Forward<S>&, const Table<S>&, const Trace&,
                const Ray&, int panels, int distances, S* parts, S* T);
  void (*source)(const Air<S>&, const Forward<S>&, const Table<S>&, const Ray&, Seen<S>&);
};

}  // namespace brume::sky
