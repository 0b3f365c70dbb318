#pragma once
// What glare must be, computed the plainest way, in long double.

#include <vector>

#include "kernel.h"

namespace brume::glare {

/// A pixel that gives light.
struct Lit {
  int x, y;
  double value;
};

/// Sum over s of K(x - s) B(s) at the pixel (x, y), every pixel that gives light one by
/// one.
long double spread_at(const std::vector<Lit>&, const Kernel&, int channel, int x, int y);

/// out = I + e (sum over s of K(x - s) I(s) - I), every pixel against every bright one.
/// Pixels that are not finite, or negative, give nothing and stay.
std::vector<long double> direct(const std::vector<float>& image, int width, int height,
                                const Kernel&, int channel, double strength);

/// Energy of the Airy pattern of a round aperture over the square pixel at (x, y), of a
/// total of 1: the mean of (pi / 4) (2 J1(v) / v)^2 over it, v = pi D theta / lambda.
/// `pixel`: its side in units of lambda / D.
double airy(double x, double y, double pixel);

}  // namespace brume::glare
