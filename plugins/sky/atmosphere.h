#pragma once
// The air of a planet as three constituents with one density profile each, at n
// wavelengths.
//
//   Rayleigh scatterers (molecules)  density e^{-h/H_R}, no absorption
//   Mie scatterers (aerosol, dust)   density e^{-h/H_M}
//   ozone                            a tent of density 1 at `ozone_altitude`, 0 at +-
//   `ozone_half_width`; absorbs only
//
// h [m] is the altitude above the sphere of radius R; above `atmosphere_height` there is
// nothing. Because each density is common to all wavelengths, an optical depth is the sum
// of three coefficients times three column densities [m].

#include <string_view>
#include <vector>

namespace brume::sky {

struct Atmosphere {
  double planet_radius = 6360e3;         // R [m]
  double atmosphere_height = 60e3;       // top above R [m]
  std::vector<double> wavelengths;       // [nm]
  std::vector<double> solar_irradiance;  // above the air, across the beam [W m^-2 nm^-1]
  std::vector<double> rayleigh_scattering;  // at h = 0 [1/m]
  double rayleigh_scale_height = 8000;      // [m]
  std::vector<double> mie_scattering;       // at h = 0 [1/m]
  std::vector<double> mie_extinction;       // at h = 0 [1/m], >= mie_scattering
  double mie_scale_height = 1200;           // [m]
  double mie_g = 0.8;                       // of the Cornette-Shanks phase function
  std::vector<double> ozone_absorption;     // at density 1 [1/m]
  double ozone_altitude = 25e3;             // [m]
  double ozone_half_width = 15e3;           // [m]
  std::vector<double> ground_albedo;        // Lambertian

  int size() const { return static_cast<int>(wavelengths.size()); }
};

/// Spectral irradiance of the sun at 1 au, above the air [W m^-2 nm^-1].
double sun_spectrum(double nm);

/// The atmosphere called `name` ("earth", "hazy", "mars") at the given wavelengths [nm],
/// 360 to 830. At 680, 550, 440 nm `earth` is, to the printed digits, the atmosphere of
/// data/reference/sky. Throws Error for a name it does not know.
Atmosphere preset(std::string_view name, const std::vector<double>& wavelengths);

/// Throws Error unless lists have one length, every number is finite and in its physical
/// range.
void check(const Atmosphere& a);

}  // namespace brume::sky
