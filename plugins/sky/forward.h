#pragma once
// The forward peak that harmonics up to L leave over.
//
// Light scattered by aerosol keeps close to its direction; harmonics up to L carry only
// the broad part. For what is left, path and direction separate: along a straight path
// through a Mie scattering optical depth tau, component l of the light grows by e^{beta_l
// tau} (the small-angle approximation of transport theory; Wang and Guth 1951). So a node
// scatters sunlight toward the eye with
//   p_M(nu) + sum_{l > L} (2l+1)/(4 pi) beta_l (e^{beta_l tau} - 1) P_l(nu) = p_M + sum_k
//   q_k(nu) tau^k/k!.
// tau is not that of the exact direction: near the horizon half of the peak's
// neighbourhood is ground. It is the column averaged over the neighbourhood of the sun's
// direction with the weight of light scattered twice, exact to second order where view
// meets sun (README).

#include <cmath>
#include <vector>

#include "atmosphere.h"
#include "types.h"

namespace brume::sky {

/// What Forward points to, and the coordinates of its columns.
struct ForwardTables {
  std::vector<double> series, column;
};
/// Of the columns' directions.
struct ForwardAxis {
  using F = Forward<double>;
  double y_min = std::asinh(-1 / F::kScale), dy = -2 * y_min / (F::kDirections - 1);
};

/// For harmonics up to L. Without a forward peak (g <= 0) the columns are 0.
ForwardTables forward_tables(const Atmosphere& a, int L);

}  // namespace brume::sky
