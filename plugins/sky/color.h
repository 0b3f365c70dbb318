#pragma once
// From spectra to the colours of a frame: CIE 1931 matching functions, to any primaries.

#include <array>
#include <vector>

namespace brume::sky {

/// x, y, z of the CIE 1931 2 degree observer at nm. Fit of eight lobes: Wyman, Sloan and
/// Shirley 2013, "Simple analytic approximations to the CIE XYZ color matching
/// functions", JCGT 2(2), table 1; errs by at most 3 % of y's maximum.
std::array<double, 3> matching(double nm);

/// Rows of the matrix from XYZ to primaries given by chromaticities rx ry gx gy bx by wx
/// wy, white with Y = 1 at (1, 1, 1). Throws Error when the primaries lie on a line.
std::array<std::array<double, 3>, 3> rgb_from_xyz(
    const std::array<double, 8>& chromaticities);

/// How spectral values at a few wavelengths become three colours.
struct Colors {
  std::vector<std::array<double, 3>> radiance;  // rgb = sum of radiance[i] L_i
  std::vector<std::array<double, 3>>
      transmittance;  // likewise T; not negative, sums to 1
};

/// Weights that integrate sunlight's fine structure exactly: between the wavelengths it
/// is not L but L over the sun's irradiance, smooth, that is interpolated (by the cubic
/// through four neighbours), and the integral against sun times matching function is done
/// at every nanometre. `sun(nm)` is that irradiance; wavelengths ascend or descend.
Colors colors_of(const std::vector<double>& wavelengths,
                 const std::array<double, 8>& chromaticities, double (*sun)(double));

/// The first three wavelengths as r, g, b.
Colors colors_none(int wavelengths);

}  // namespace brume::sky
