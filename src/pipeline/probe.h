#pragma once
// What the air does along rays that belong to no picture: `brume probe`.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "pipeline/pipeline.h"
#include "scene/scene_file.h"

namespace brume {

/// A ray as a person gives it: world metres, a direction of any length (not zero),
/// distance >= 0, which may be infinite.
struct ProbeRay {
  glm::dvec3 origin{0}, direction{0, 1, 0};
  double distance = 0;
};

/// Transmittance and in-scattered radiance, red green blue.
struct ProbeAnswer {
  float T[3] = {1, 1, 1}, L[3] = {0, 0, 0};
};

/// The scene without what only a picture has: names of channels and files, masks.
SceneFile without_picture(SceneFile);

/// How wide a probed ray is [rad]: a third of a pixel of a 4K frame, so that noise and
/// cores are seen as they are at points.
inline constexpr double kProbePixel = 1e-4;

/// What such a scene is prepared with: a frame of one pixel of that width, in a
/// projection that looks everywhere from `eye`, so that no stage thinks it is out of
/// sight.
FrameSource probe_source(const glm::dvec3& eye, double frame);

/// Answers for each ray, in order. Each ray is seen from its own origin, as if the camera
/// stood there: `start` and `max_opacity` count from it, and a world far from its own
/// origin costs no precision (the air is compiled anew for each run of equal origins).
/// Masks do not apply, `mix` does. Throws Error as Session::prepare does.
std::vector<ProbeAnswer> probe_rays(const SceneFile&, Registry&, double frame,
                                    std::span<const ProbeRay>);

}  // namespace brume
