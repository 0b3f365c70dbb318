#include "oracle.h"

#include <algorithm>
#include <cmath>

namespace relight::oracle {
namespace {

// Part of a spotlight's power at the angle theta [rad] from its axis: plugins/lamps,
// README eq. 1 and 2.
double edge(const Lamp& l, double theta) {
  if (l.ratio) return theta == 0 ? 1 : std::clamp(std::abs(l.cone / theta) - 1, 0., 1.);
  if (l.cone_soft == 0) return theta < l.cone;
  const double s = std::clamp((l.cone - theta) / l.cone_soft, 0., 1.);
  return s * s * (3 - 2 * s);
}

}  // namespace

Rgb irradiance(const Lamp& l, const glm::dvec3& x, const glm::dvec3& n,
               const Rgb& sigma) {
  const glm::dvec3 way = x - l.position;
  const double r = glm::length(way);
  const double cosine = -glm::dot(way, n) / r;
  if (!(cosine > 0)) return {};
  const glm::dvec3 axis = glm::normalize(l.direction);
  const double theta =
      std::atan2(glm::length(glm::cross(axis, way)), glm::dot(axis, way));
  const double spot = l.cone > 3.2 ? 1 : edge(l, theta);
  const double near = std::max(r, l.radius);
  Rgb E;
  for (std::size_t c = 0; c < 3; ++c)
    E[c] = l.power[c] * spot * cosine / (near * near) * std::exp(-sigma[c] * r);
  return E;
}

std::vector<Rgb> irradiance(const std::function<Rgb(const glm::dvec3&)>& radiance,
                            const std::vector<glm::dvec3>& n, double bright,
                            double horizon) {
  constexpr int kCells = 200;
  std::vector<Rgb> E(n.size());
  for (int i = -kCells; i < kCells; ++i) {
    // Elevations by u^2 from the horizon on, azimuths by v^2: small cells where skies are
    // steep, and none across the horizon, where they jump.
    const double u = (i + .5) / kCells, whole = M_PI / 2 + (u > 0 ? -horizon : horizon),
                 e = horizon + whole * u * std::abs(u);
    const double high = 2 * whole * std::abs(u) / kCells;
    for (int j = -kCells; j < kCells; ++j) {
      const double v = (j + .5) / kCells, phi = bright + M_PI * v * std::abs(v);
      const double wide = 2 * M_PI * std::abs(v) / kCells * std::cos(e);
      const glm::dvec3 d(std::cos(e) * std::cos(phi), std::cos(e) * std::sin(phi),
                         std::sin(e));
      const Rgb L = radiance(d);
      for (std::size_t k = 0; k < n.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
          E[k][c] += high * wide * L[c] * std::max(glm::dot(d, n[k]), 0.);
    }
  }
  return E;
}

}  // namespace relight::oracle
