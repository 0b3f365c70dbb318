#pragma once
// The same physics by another route: densities and sources at points, in double, added up
// by adaptive Gauss-Legendre panels that compose as (L1 + T1 L2, T1 T2). It knows the
// media only as published and shares no code with src/air.

#include <array>
#include <functional>
#include <vector>

#include "scene/world.h"

namespace brume::oracle {

using Rgb = std::array<double, 3>;

struct Answer {
  Rgb T = {1, 1, 1}, L = {0, 0, 0};
};

struct Ray {
  double o[3] = {0, 0, 0};  ///< relative to the eye
  double d[3] = {0, 0, 1};
  double end = 0;  ///< finite
};

/// T and L along the ray, to about `accuracy` of the largest source.
Answer integrate(const World&, const Ray&, double accuracy = 1e-9);

/// Transmittance alone.
Rgb transmittance(const World&, const Ray&);

}  // namespace brume::oracle
