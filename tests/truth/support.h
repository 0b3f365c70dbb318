#pragma once
// Worlds for the truth's tests. Legend: sigma extinction [1/m], S source radiance.

#include <cmath>
#include <limits>

#include "truth/truth.h"

namespace brume::testing_truth {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

inline brume_medium fog(double sigma, double S = 0) {
  brume_medium m = {};
  m.size = sizeof m;
  m.name = "";
  for (const int i : {0, 5, 10}) m.local_from_world[i] = 1;
  m.direction[2] = 1;
  for (int c = 0; c < 3; ++c) m.extinction[c] = sigma, m.color[c] = S;
  m.max_opacity = 1;
  return m;
}

inline brume_medium height_fog(double sigma, double falloff, double S = 1) {
  brume_medium m = fog(sigma, S);
  m.profile = BRUME_EXPONENTIAL;
  m.falloff = falloff;
  return m;
}

/// The medium inside a box or ellipsoid of this centre and these half extents.
inline brume_medium bounded(brume_medium m, brume_shape shape, glm::dvec3 center,
                            glm::dvec3 half) {
  m.shape = shape;
  for (int i = 0; i < 3; ++i) {
    m.local_from_world[5 * i] = 1 / half[i];
    m.local_from_world[4 * i + 3] = -center[i] / half[i];
  }
  return m;
}

inline World world(std::initializer_list<brume_medium> media,
                   std::initializer_list<brume_light> lights = {}) {
  World w;
  int stage = 0;
  for (const auto& m : media) w.media.push_back({m, stage++, ""});
  for (const auto& l : lights) w.lights.push_back({l, 0, ""});
  return w;
}

inline brume_light lamp(glm::dvec3 at, double power, bool attenuated = false) {
  brume_light l = {};
  l.size = sizeof l;
  l.name = "";
  l.kind = BRUME_POINT;
  l.direction[2] = -1;
  l.attenuated = attenuated;
  for (int c = 0; c < 3; ++c) l.position[c] = at[c], l.power[c] = power;
  return l;
}

}  // namespace brume::testing_truth
