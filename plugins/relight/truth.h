#pragma once
// What relight must make of single pixels: equation (1) of the README in double, by the
// laws at a point (oracle.h). What lies between light and surface is the world's answer.

#include <array>
#include <span>

#include "plugin.h"

namespace relight {

/// A stage's settings, as its run has them.
struct Settings {
  bool has_albedo = false, has_normals = false, from_color = false;
  double albedo[3] = {};
  bool lamps = false, sun = false, sky = false;
  double eye[3] = {};
  float forward[3] = {}, turn[9] = {};
  float footprint = 0;  ///< of a pixel: angle [rad]; orthographic: width [m]

  bool answers_to(brume_light_kind kind) const {
    return kind == BRUME_SUN ? sun : kind == BRUME_SKY_LIGHT ? sky : lamps;
  }
};

/// The colours of pixels (xy[0], xy[1]), ... with the light of all lights on them, those
/// too that run leaves out as too weak. Normals without a layer are the README's
/// differences of depth, in double.
void truth(const Settings&, const brume_tile&, std::span<const int> xy, double* rgb);

}  // namespace relight
