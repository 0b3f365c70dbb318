#pragma once
// The sky as Nishita, Sirai, Tadamura and Nakamae computed it in 1993 ("Display of the
// Earth taking into account atmospheric scattering", equation 9): sunlight scattered
// once, 32 even steps along each ray, a table of 128 x 64 directions of the hemisphere
// from which the phase function is left out (Wenzel 2006). For comparison and for its
// look.

#include <array>
#include <vector>

#include "color.h"
#include "model.h"

namespace brume::sky {

constexpr int kNishitaSteps = 32, kNishitaAround = 128, kNishitaUp = 64;

/// The parts of light of one ray (scattered by molecules, by aerosol; without phase
/// functions) [size()], and T.
void nishita(const Atmosphere&, const Ray&, double* rayleigh, double* mie, double* T);

/// The hemisphere of an eye in colours. Directions by azimuth from the sun and elevation
/// above the horizontal, bilinear.
class NishitaTable {
 public:
  NishitaTable(const Atmosphere&, double h, double mu_s, const Colors&,
               const std::array<double, 3>& scale);

  /// Radiance; cosines of the view's and between view and sun; 0 below the horizontal.
  std::array<double, 3> look(double mu, double nu) const noexcept;

 private:
  double mu_s_, g_;
  std::vector<std::array<double, 6>> texels_;
};

}  // namespace brume::sky
