#pragma once
// What surfaces add, by the laws at a point, in double and on geometry that is known: no
// depth, no neighbours, none of src/air.

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace relight::oracle {

using Rgb = std::array<double, 3>;

/// A point light; a spotlight where cone < 180 degrees [rad].
struct Lamp {
  glm::dvec3 position{0};
  Rgb power{1, 1, 1};
  double radius = 0;
  glm::dvec3 direction{0, 0, -1};
  double cone = 10, cone_soft = 0;
  bool ratio = false;  ///< falloff of Intel 2008
};

/// Irradiance at x on a plane of unit normal n through even fog of extinction sigma.
Rgb irradiance(const Lamp&, const glm::dvec3& x, const glm::dvec3& n, const Rgb& sigma);

/// Irradiance on planes of unit normals n from a radiance by direction that jumps at the
/// elevation `horizon` [rad]: the sphere in 400 x 400 cells, small ones at the horizon
/// and about the azimuth `bright` [rad from x to y].
std::vector<Rgb> irradiance(const std::function<Rgb(const glm::dvec3&)>& radiance,
                            const std::vector<glm::dvec3>& n, double bright,
                            double horizon);

}  // namespace relight::oracle
