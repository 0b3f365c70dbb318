#pragma once
// The truth about the sky along one ray, by another route than the product's: quadrature
// of the densities at points for what is scattered once, a random walk of photons for the
// rest. Double precision, vectors from the planet's centre; it shares with the product
// only the Atmosphere's numbers.

#include <cstdint>

#include "atmosphere.h"
#include "trace.h"

namespace brume::sky::oracle {

struct Answer {
  double T = 1;       // transmittance
  double single = 0;  // radiance scattered once [W m^-2 sr^-1 nm^-1]
  double L = 0;       // of all orders
  double error = 0;   // standard error of L
};

/// At the k-th wavelength. `panels` of the quadrature along the ray (relative error of T
/// and single falls with its fourth power; 2000 gives 1e-6 away from grazing sun),
/// `paths` photons followed back from the eye; paths = 0: single only.
Answer see(const Atmosphere&, int k, const Ray&, int panels, int paths,
           std::uint64_t seed);

/// Transmittance from altitude h out of the air in direction mu; 0 if the planet is in
/// the way.
double to_space(const Atmosphere&, int k, double h, double mu);

}  // namespace brume::sky::oracle
