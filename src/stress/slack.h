#pragma once
// How far rounding may take an answer: internal to src/stress.

#include <glm/glm.hpp>

#include "scene/world.h"

namespace brume::stress {

/// Of an optical depth: |d tau| <= rel tau + abs.
struct Slack {
  double rel = 0, abs = 0;

  /// Of T, and of an opacity near `opacity`:
  ///   |dT| <= T tau rel + abs,  T tau <= 1/e,  T tau <= -ln T <= 1.6 (1 - T) for tau <=
  ///   1
  double of_opacity(double opacity) const;
};

/// For the ray from `o` (relative to the eye) along the unit vector `d` over [0, t]: what
/// one rounding of each float on the way can do.
///   exponential: exponents falloff (|o| + t) in float; the thick end counts, so that
///     upward only the start's exponent does
///   boundaries: their places on the ray, times the density there
///   custom: `tolerance`, what a table may promise
Slack slack_of(const World&, const glm::dvec3& o, const glm::dvec3& d, double t,
               double tolerance);

}  // namespace brume::stress
