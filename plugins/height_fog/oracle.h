#pragma once
// The truth about height fog along one ray, by another route than the product's: adaptive
// quadrature of the density at points, in long double. It knows no closed form.

namespace height_fog {

/// One colour channel of the fog. Units as in README.md.
struct Fog {
  long double density = 0;  ///< extinction at `height` [1/m]
  long double height = 0;   ///< [m]
  long double falloff = 0;  ///< c [1/m]
  long double start = 0;    ///< [m]
  long double max_opacity = 1;
};

/// Extinction at height z [1/m].
long double extinction(const Fog&, long double z);

/// Optical depth of the ray's stretch from t0 to t1 [m] (t1 may be inf), which starts at
/// height z [m] and climbs mu metres per metre. Relative error 1e-14 + 1e-18 c (|z - h| +
/// |mu| t1), the second term the rounding of the exponent; inf where there is no end to
/// it.
long double optical_depth(const Fog&, long double z, long double mu, long double t0,
                          long double t1);

/// What `start` and `max_opacity` leave of it: the optical depth that the eye sees up to
/// distance t.
long double seen(const Fog&, long double z, long double mu, long double t);

}  // namespace height_fog
