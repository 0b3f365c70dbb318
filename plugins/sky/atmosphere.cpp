#include "atmosphere.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "num/error.h"

namespace brume::sky {
namespace {

// Means over [lambda, lambda + 10 nm), from 360 nm.
constexpr int kFirst = 360, kStep = 10, kCount = 48;
// Spectral irradiance of the sun above the air [W m^-2 nm^-1]: ASTM G173-03,
// extraterrestrial.
constexpr double kSun[kCount] = {
    1.11776, 1.14259, 1.01249, 1.14716, 1.72765, 1.73054, 1.6887,  1.61253,
    1.91198, 2.03474, 2.02042, 2.02212, 1.93377, 1.95809, 1.91686, 1.8298,
    1.8685,  1.8931,  1.85149, 1.8504,  1.8341,  1.8345,  1.8147,  1.78158,
    1.7533,  1.6965,  1.68194, 1.64654, 1.6048,  1.52143, 1.55622, 1.5113,
    1.474,   1.4482,  1.41018, 1.36775, 1.34188, 1.31429, 1.28303, 1.26758,
    1.2367,  1.2082,  1.18737, 1.14683, 1.12362, 1.1058,  1.07124, 1.04992};
// Absorption cross section of ozone at 233 K [m^2]: Serdyuchenko, Gorshelev et al. 2014
// (IUP Bremen, o3spectra2011).
constexpr double kOzone[kCount] = {
    1.18e-27,  2.182e-28, 2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27,
    8.451e-27, 1.582e-26, 2.316e-26, 3.669e-26, 4.924e-26, 7.752e-26, 9.016e-26,
    1.48e-25,  1.602e-25, 2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25,   4.266e-25,
    4.672e-25, 4.398e-25, 4.701e-25, 5.019e-25, 4.305e-25, 3.74e-25,  3.215e-25,
    2.662e-25, 2.238e-25, 1.852e-25, 1.473e-25, 1.209e-25, 9.423e-26, 7.455e-26,
    6.566e-26, 5.105e-26, 4.15e-26,  4.228e-26, 3.237e-26, 2.451e-26, 2.801e-26,
    2.534e-26, 1.624e-26, 1.465e-26, 2.078e-26, 1.383e-26, 7.105e-27};
constexpr double kDobson = 2.687e20;  // molecules per m^2 in one Dobson unit

double table(const double* values, double nm) {
  const double x = std::clamp((nm - kFirst) / kStep, 0., kCount - 1.);
  const int i = std::min(static_cast<int>(x), kCount - 2);
  return values[i] + (x - i) * (values[i + 1] - values[i]);
}

void fill(std::vector<double>& to, const std::vector<double>& nm, auto f) {
  to.clear();
  for (double x : nm) to.push_back(f(x));
}

// Bruneton 2017: the demonstration of "Precomputed atmospheric scattering", whose
// Rayleigh coefficient is 1.24062e-6 m^-1 (lambda / um)^-4, aerosol of optical depth
// .0053 and albedo .9, 300 Dobson units of ozone; ground of albedo .1.
Atmosphere earth(const std::vector<double>& nm) {
  Atmosphere a;
  a.wavelengths = nm;
  fill(a.solar_irradiance, nm, [](double x) { return table(kSun, x); });
  fill(a.rayleigh_scattering, nm,
       [](double x) { return 1.24062e-6 * std::pow(x * 1e-3, -4); });
  fill(a.mie_extinction, nm, [](double) { return 5.328e-3 / 1200; });
  fill(a.mie_scattering, nm, [](double) { return .9 * 5.328e-3 / 1200; });
  fill(a.ozone_absorption, nm,
       [](double x) { return 300 * kDobson / 15000 * table(kOzone, x); });
  fill(a.ground_albedo, nm, [](double) { return .1; });
  return a;
}

// Continental haze: aerosol of optical depth .25 at 550 nm with Angstrom exponent 1.3
// (the medium case of Angstrom 1961) and albedo .93, g = .75, scale height 1.5 km: 22 km
// visibility at the ground (Koschmieder: 3.912/sigma).
Atmosphere hazy(const std::vector<double>& nm) {
  Atmosphere a = earth(nm);
  a.mie_scale_height = 1500;
  a.mie_g = .75;
  fill(a.mie_extinction, nm,
       [](double x) { return .25 / 1500 * std::pow(x / 550, -1.3); });
  fill(a.mie_scattering, nm,
       [](double x) { return .93 * .25 / 1500 * std::pow(x / 550, -1.3); });
  fill(a.ground_albedo, nm, [](double) { return .15; });
  return a;
}

// Mars on a clear day. Gas: 610 Pa of CO2 at 215 K, 2.1e23 molecules per m^3, of cross
// section 1.2e-30 m^2 at 532 nm (Sneep and Ubachs 2005). Dust: optical depth .5, grey,
// mixed with the gas to 11 km; its albedo falls from .97 in the red to .76 in the blue,
// which makes the sky butterscotch (after Tomasko et al. 1999, rounded); g = .65. Sun
// at 1.524 au.
Atmosphere mars(const std::vector<double>& nm) {
  Atmosphere a;
  a.planet_radius = 3389.5e3;
  a.atmosphere_height = 110e3;
  a.wavelengths = nm;
  a.rayleigh_scale_height = a.mie_scale_height = 11100;
  a.mie_g = .65;
  fill(a.solar_irradiance, nm, [](double x) { return table(kSun, x) / (1.524 * 1.524); });
  fill(a.rayleigh_scattering, nm,
       [](double x) { return 2.1e23 * 1.2e-30 * std::pow(x / 532, -4); });
  fill(a.mie_extinction, nm, [](double) { return .5 / 11100; });
  fill(a.mie_scattering, nm, [](double x) {
    return .5 / 11100 * std::clamp(.76 + .21 * (x - 440) / 230, .72, .97);
  });
  fill(a.ozone_absorption, nm, [](double) { return 0.; });
  fill(a.ground_albedo, nm,
       [](double x) { return std::clamp(.07 + .2 * (x - 440) / 240, .05, .3); });
  return a;
}

void require(bool good, const char* name, const char* allowed) {
  if (!good) throw Error("sky", std::string(name) + " is out of range", allowed);
}

void check_list(const std::vector<double>& v, std::size_t n, double most,
                const char* name) {
  require(v.size() == n, name, "as many numbers as wavelengths");
  for (double x : v) require(x >= 0 && x <= most, name, "finite numbers, 0 or more");
}

}  // namespace

double sun_spectrum(double nm) { return table(kSun, nm); }

Atmosphere preset(std::string_view name, const std::vector<double>& wavelengths) {
  if (name == "earth") return earth(wavelengths);
  if (name == "hazy") return hazy(wavelengths);
  if (name == "mars") return mars(wavelengths);
  throw Error("sky.preset", "\"" + std::string(name) + "\"", "earth, hazy or mars");
}

void check(const Atmosphere& a) {
  const std::size_t n = a.wavelengths.size();
  require(n > 0, "wavelengths", "at least one");
  require(a.planet_radius >= 1e4 && a.planet_radius <= 1e9, "planet_radius",
          "1e4 to 1e9 m");
  require(a.atmosphere_height >= 1 && a.atmosphere_height <= .5 * a.planet_radius,
          "atmosphere_height", "1 m to half the planet's radius");
  const double longest =
      .05 * a.planet_radius;  // the closed form of a column is an expansion in H/R
  require(a.rayleigh_scale_height > 0 && a.rayleigh_scale_height <= longest,
          "rayleigh_scale_height", "up to R/20");
  require(a.mie_scale_height > 0 && a.mie_scale_height <= longest, "mie_scale_height",
          "up to R/20");
  require(std::abs(a.mie_g) <= .98, "mie_g", "-.98 to .98");
  require(a.ozone_half_width > 0, "ozone_half_width", "above 0");
  check_list(a.solar_irradiance, n, 1e12, "solar_irradiance");
  check_list(a.rayleigh_scattering, n, 1e3, "rayleigh_scattering");
  check_list(a.mie_scattering, n, 1e3, "mie_scattering");
  check_list(a.mie_extinction, n, 1e3, "mie_extinction");
  check_list(a.ozone_absorption, n, 1e3, "ozone_absorption");
  check_list(a.ground_albedo, n, 1, "ground_albedo");
  for (std::size_t i = 0; i < n; ++i)
    require(a.mie_scattering[i] <= a.mie_extinction[i], "mie_scattering",
            "no more than mie_extinction");
}

}  // namespace brume::sky
