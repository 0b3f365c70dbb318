#pragma once
// How far two pictures are apart: numbers per channel, and two measures of what people
// see.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace brume {

/// Of values b against a, differences d = |a - b|. Pairs in which both are NaN, or the
/// same infinity, count as equal; any other pair with a NaN or an infinity counts as
/// `broken` and in nothing else.
struct Errors {
  std::uint64_t count = 0, broken = 0;
  double max = 0, p99 = 0, rms = 0, mean = 0;
  double relative = 0;    ///< largest d / max(|a|, floor)
  std::size_t worst = 0;  ///< index of the largest d
  /// 20 log10(peak / rms) [dB]; inf where rms is 0.
  double psnr(double peak = 1) const;
};
/// Lengths are equal. p99: the smallest difference that 99 of 100 do not exceed (nearest
/// rank).
Errors errors(std::span<const float> a, std::span<const float> b, double floor = 1);
Errors errors(std::span<const double> a, std::span<const double> b, double floor = 1);

/// A plane of a picture: rows of `width` values, top row first.
struct PlaneView {
  std::span<const float> values;
  int width = 0, height = 0;
};

/// Mean structural similarity (Wang, Bovik, Sheikh & Simoncelli 2004, eq. 13): Gaussian
/// window 11 x 11, sigma 1.5, K1 = .01, K2 = .03, dynamic range `peak`; over all pixels
/// whose window lies inside. Pictures smaller than the window are one window. 1 for equal
/// pictures, at least -1. NaN counts as 0.
double ssim(PlaneView a, PlaneView b, double peak = 1);

/// r g b planes, scene-linear, Rec.709 primaries.
struct ColorView {
  std::array<std::span<const float>, 3> rgb;
  int width = 0, height = 0;
};

/// Separable convolution, edges replicated; kernels of odd length centred.
std::vector<float> convolve(PlaneView, std::span<const float> across,
                            std::span<const float> down);

}  // namespace brume
