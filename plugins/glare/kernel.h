#pragma once
// A glare pattern on the grid of pixels: what one pixel of brightness 1 becomes.

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace brume::glare {

/// Weights K(x, y) >= 0 for |x| <= reach_x, |y| <= reach_y, in one channel or three (R,
/// G, B). Their sum is 1, `beyond` of it outside what is held (there the light leaves the
/// frame).
struct Kernel {
  int reach_x = 0, reach_y = 0;
  bool quadrant = false;   ///< held for x, y >= 0 only: K(x, y) = K(|x|, |y|)
  bool symmetric = false;  ///< K(-x, -y) = K(x, y): its spectrum is real
  std::vector<std::vector<float>> planes;
  std::array<double, 3> beyond{};
  /// What a pixel gives away: all weights but the centre's, and `beyond`. 1 - centre but
  /// for the centre's rounding, which is more than all the rest of a narrow pattern.
  std::array<double, 3> lost{};

  const std::vector<float>& plane(int channel) const {
    return planes[planes.size() == 1 ? 0 : std::size_t(channel)];
  }
  int width() const { return quadrant ? reach_x + 1 : 2 * reach_x + 1; }
  /// (0, 0) <= (x, y) of the quadrant, or anywhere.
  float at(int channel, int x, int y) const {
    if (quadrant) x = x < 0 ? -x : x, y = y < 0 ? -y : y;
    const int left = quadrant ? 0 : reach_x, top = quadrant ? 0 : reach_y;
    return plane(
        channel)[std::size_t(y + top) * std::size_t(width()) + std::size_t(x + left)];
  }
};

/// What a pattern is made from; two equal ones make the same kernel.
struct PatternSettings {
  std::string kind = "photopic";  ///< photopic, mesopic, scotopic, aperture, image
  double pixel = 5e-4;            ///< angle of a pixel [rad]
  double reach = 0.35;            ///< where the eye's glare ends [rad]
  double rotation = 0;            ///< [rad], clockwise in the picture
  double aperture = 2e-3;         ///< diameter [m]
  int blades = 6;                 ///< < 3: a round one
  double roundness = 0.2;         ///< 0: straight blades, 1: a circle
  int dust = 0, scratches = 0, seed = 1;
  int grid = 4096;           ///< samples of the pupil's plane, per side
  std::string image;         ///< path of an EXR
  double image_width = 0.2;  ///< angle that it spans [rad]
  std::array<double, 8> chromaticities{.64, .33, .3, .6, .15, .06, .3127, .329};

  /// All of it as text, the path's time of change included.
  std::string key() const;
};

/// No pattern but the eye's reaches farther than this [pixels].
inline constexpr int kMostReach = 1536;

/// The pattern for a frame of width x height pixels: nothing is held that would reach
/// from one end of it beyond the other. Throws std::runtime_error: an image that cannot
/// be read, or is black.
Kernel make_kernel(const PatternSettings&, int width, int height);

/// The parts, each not yet normalised.
Kernel eye_kernel(const PatternSettings&, int width, int height);
Kernel aperture_kernel(const PatternSettings&, int width, int height);
Kernel image_kernel(const PatternSettings&, int width, int height);

/// Point-spread function of the eye at `angle` degrees [1/sr]: Spencer, Shirley,
/// Zimmerman & Greenberg 1995, eqs. 2 to 5 and table 1. `halo`: f3 at the wavelength (or
/// its mix).
double eye_psf(const std::string& kind, double angle, double halo);
double eye_halo(double angle, double wavelength_nm);

}  // namespace brume::glare
