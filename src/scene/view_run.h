#pragma once
// The kernels behind fill_rays, one table per instruction set. What a row needs is made
// in double by the caller (view.cpp); the kernels see floats.

#include "num/isa.h"
#include "scene/view.h"

namespace brume {

/// One row of rays. The pixel in column x lies f = x + 1/2 - middle from the row's
/// middle, exact in float; what varies along the row is linear in f.
struct RayRow {
  int middle;                    ///< column that f counts from
  float at_middle[3], per_f[3];  ///< perspective: v with v . forward = 1; orthographic:
                                 ///< origin - eye [m]
  float forward[3];              ///< orthographic: the direction
  // latlong: longitude [turns] = turns_at_middle + f / pixels_per_turn; the direction is
  // sin(longitude) east + cos(longitude) ahead + pole
  float turns_at_middle, pixels_per_turn;
  float east[3], ahead[3], pole[3];
};

/// The row of pixels y of a view.
RayRow ray_row(const View&, int y) noexcept;

struct RayKernels {
  using Fill = void(const RayRow&, int x, int n, const RaySpan&) noexcept;
  Fill *perspective, *orthographic, *latlong;
};
BRUME_ISA_DECLARE(RayKernels, ray_kernels)

}  // namespace brume
