#include "air/cull.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume::air {

Cone cone_around(const Rays& r, const ConeKernels& kernels) {
  Cone cone;
  cone.farthest = std::numeric_limits<double>::infinity();
  if (r.ox) return cone;
  float axis[3], cosine = 1, farthest = 0;
  kernels.axis(r, axis, &farthest);
  const double length = std::hypot(axis[0], axis[1], axis[2]);
  if (!(length > 0.1 * r.n)) return cone;
  for (int c = 0; c < 3; ++c) {
    cone.axis[c] = axis[c] / length;
    axis[c] = float(cone.axis[c]);
  }
  kernels.narrowest(r, axis, &cosine);
  // Room for float, and for directions that are unit vectors only to float.
  cone.cosine = std::max(-1.0, cosine - 1e-5);
  cone.sine = std::sqrt(std::max(0.0, 1 - cone.cosine * cone.cosine));
  cone.farthest = farthest;
  return cone;
}

bool may_meet(const Cone& cone, const Medium& m) {
  if (!std::isfinite(m.radius) || cone.cosine <= -1) return true;
  const double x = m.center[0], y = m.center[1], z = m.center[2], r = m.radius;
  const double d2 = x * x + y * y + z * z;
  if (d2 <= r * r) return true;
  const double d = std::sqrt(d2);
  if (d - r > cone.farthest * (1 + 1e-5)) return false;
  // Angle to the centre > half angle of the cone + that of the sphere.
  const double along = cone.axis[0] * x + cone.axis[1] * y + cone.axis[2] * z;
  const double s = r / d, c = std::sqrt(1 - s * s);
  const double limit_cos = cone.cosine * c - cone.sine * s;
  const bool limit_over_pi = cone.sine * c + cone.cosine * s < 0;
  return limit_over_pi || !(along < d * (limit_cos - 1e-6));
}

}  // namespace brume::air
