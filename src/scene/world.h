#pragma once
// What there is around one frame: media, lights, shadowers, interfaces and a background,
// as the stages published them. The structs are the plugin interface's own (plugin.h): a
// built-in plugin and a third party's say the same words.

#include <algorithm>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "plugin.h"

namespace brume {

/// A published thing, and which stage (index into the pipeline's stages) published it.
template <class T>
struct Published {
  T what;
  int stage = 0;
  std::string name;  ///< owned; what.name points here or is ""
};

/// Everything that tells lights apart, functions excepted: put in this order, lights come
/// to the same bits whatever the order of stages in a file.
inline std::vector<double> content(const brume_light& l) {
  std::vector<double> key = {double(l.kind)};
  for (int i = 0; i < 3; ++i)
    key.insert(key.end(), {l.position[i], l.direction[i], l.power[i]});
  key.insert(key.end(), {l.radius, l.cone, l.cone_soft, double(l.cone_falloff),
                         double(l.attenuated)});
  return key;
}

struct World {
  glm::dvec3 eye{0};  ///< world position that rays are relative to
  glm::dvec3 up{0, 0, 1};
  std::vector<Published<brume_medium>> media;
  std::vector<Published<brume_light>> lights;
  std::vector<Published<brume_shadower>> shadowers;
  std::vector<Published<brume_interface>> interfaces;
  std::vector<Published<brume_background>> backgrounds;
};

/// Puts lights into the order of their content: what surface stages are shown.
inline void sort_lights(World& w) {
  std::stable_sort(w.lights.begin(), w.lights.end(), [](const auto& a, const auto& b) {
    return content(a.what) < content(b.what);
  });
}

}  // namespace brume
