#pragma once
// The density of noise fog at a point of the world, by another route than the kernel's:
// double, absolute positions, gradients from a list, the noise as a sum over eight
// corners, and the mean of its exponential by quadrature instead of a fit.

#include <array>
#include <vector>

#include "place.h"

namespace brume::noise_fog {

using Point = std::array<double, 3>;

/// Gradient noise at q [cells], period in cells or 0.
double gradient_noise(const Point& q, std::uint32_t seed, int period);

/// ln E[e^(c n)] of it: over places in the cell by Gauss-Legendre, over gradients
/// exactly.
double log_mean_exponential(double c);

class Oracle {
 public:
  explicit Oracle(const Look&);

  /// rho at a world position [m], as a pixel sees it: filtered by its footprint there.
  double density(const Point&) const;
  /// The same without the pixel's filter.
  double unfiltered(const Point&) const;

 private:
  double rho(const Point&, double filter_variance) const;
  struct Wave {
    double cell, c;
    Point apart;
  };
  Look s_;
  std::vector<Wave> waves_;
};

}  // namespace brume::noise_fog
