#include <algorithm>
#include <cmath>

#include "air/cull.h"
#include "air/impl.h"

namespace brume {

bool Air::meets(std::span<const glm::dvec3> corners, double nearest,
                double farthest) const {
  if (empty() || !(farthest > 0)) return false;
  if (!impl_->interfaces.empty()) return true;
  // The cone around the corners holds all directions between them.
  glm::dvec3 axis(0);
  for (const auto& d : corners) axis += glm::normalize(d);
  air::Cone cone;
  if (glm::length(axis) > 1e-3) {
    axis = glm::normalize(axis);
    double cosine = 1;
    for (const auto& d : corners)
      cosine = std::min(cosine, glm::dot(axis, glm::normalize(d)));
    for (int c = 0; c < 3; ++c) cone.axis[c] = axis[c];
    // A cone is convex up to a right angle only.
    cone.cosine = cosine > 1e-3 ? cosine - 1e-6 : -1;
    cone.sine = std::sqrt(std::max(0.0, 1 - cone.cosine * cone.cosine));
  }
  cone.farthest = farthest;
  for (const air::Medium& m : impl_->media) {
    const double far_side =
        std::hypot(m.center[0], m.center[1], m.center[2]) + double(m.radius);
    if (m.start < farthest && !(far_side < nearest) && air::may_meet(cone, m))
      return true;
  }
  return false;
}

}  // namespace brume
