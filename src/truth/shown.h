#pragma once
// The world as surface stages are shown it while their truth is asked.

#include <memory>
#include <vector>

#include "plugin.h"
#include "truth/sky_light.h"
#include "truth/truth.h"

namespace brume::truth {

/// A world's light by the truth: transmittance is e^-optical_depth, irradiance a light's
/// own formula dimmed by that; a sky's is its radiance over the hemisphere. The world,
/// its lights in the product's order (sort_lights), must live as long. Its functions are
/// thread-safe.
class Shown {
 public:
  /// Optical depths are good to `tolerance` (optical_depth).
  explicit Shown(const World&, double tolerance = 1e-10);
  ~Shown();
  Shown(const Shown&) = delete;
  Shown& operator=(const Shown&) = delete;

  const brume_world& table() const { return table_; }

 private:
  struct Sky;
  Rgb transmittance(const glm::dvec3& o, const glm::dvec3& d, double end) const;
  Rgb irradiance(std::size_t light, const glm::dvec3& o, const glm::dvec3& n) const;

  const World& world_;
  double tolerance_;
  std::vector<std::unique_ptr<Sky>> skies_;  ///< by light; worked out when asked for
  brume_world table_{};
};

}  // namespace brume::truth
