#pragma once
// Irradiance from a sky on planes of any normal, by adaptive quadrature of its radiance.

#include <glm/glm.hpp>
#include <vector>

#include "truth/truth.h"

namespace brume::truth {

/// A sky light as directions and what comes from each: nodes of rules on patches of
/// the sphere, halved in height or in azimuth, whichever changes more, until halving
/// changes the whole by less than 1e-5. Seen from the eye, as the product takes it
/// (brume_world.irradiance). The light must live as long.
class SkyLight {
 public:
  SkyLight(const brume_light&, const glm::dvec3& up);

  /// Int L(d) max(d . n, 0) dd of each colour, n a unit vector; good to 5e-5 of the
  /// largest.
  Rgb irradiance(const glm::dvec3& n) const;

 private:
  struct Node {
    glm::dvec3 to;
    Rgb light;  ///< radiance times solid angle
  };
  std::vector<Node> nodes_;
};

}  // namespace brume::truth
