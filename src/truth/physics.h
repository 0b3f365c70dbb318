#pragma once
// Media and lights at a point.

#include <glm/glm.hpp>

#include "scene/world.h"
#include "truth/truth.h"

namespace brume::truth {

/// Density rho at `x` (relative to the eye) [1], >= 0 and finite; and, where the medium
/// has a source of its own, that toward -direction. Exponents are taken in long double
/// and end at 300: what is e^300 times denser than at the origin is opaque to every
/// light.
struct AtPoint {
  double rho = 0;
  Rgb source{}, tint{1, 1, 1};  // tint: factors on the medium's extinction
};
AtPoint medium_at(const World&, const brume_medium&, const glm::dvec3& x,
                  const glm::dvec3& direction);

/// The phase function [1/sr] for light that arrives from `to` and leaves along
/// -direction.
double phase(const brume_medium&, const glm::dvec3& to, const glm::dvec3& direction);

/// Light at `x` before anything stands between: irradiance on a plane that faces it,
/// where it comes from, and how far away (inf: sun). A sky light: its mean radiance, and
/// no way.
struct Incident {
  Rgb E{};
  glm::dvec3 to{0};
  double distance = 0;
};
Incident light_at(const World&, const brume_light&, const glm::dvec3& x);

}  // namespace brume::truth
