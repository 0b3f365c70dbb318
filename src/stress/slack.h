#pragma once
// How far rounding may take an answer: internal to src/stress.

#include <glm/glm.hpp>

#include "scene/world.h"

namespace brume::stress {

/// Of an optical depth: |d tau| <= rel tau + abs. Of the light of lamps and suns in the
/// media: what follows from where they are known to be.
struct Slack {
  double rel = 0, abs = 0;
  double light_rel = 0;       ///< of it, for a lamp that is not quite where it should be
  double light_most[3] = {};  ///< as much as there could be if nothing dimmed it
  double light_next[3] = {};  ///< per optical depth, where most of it is
  double cone = 0;     ///< part of a lamp's light that the edge of its cone decides
  double grazing = 0;  ///< part of a sun's light that its slope in the fog decides

  /// Of T, and of an opacity near `opacity`:
  ///   |dT| <= T tau rel + abs,  T tau <= 1/e,  T tau <= -ln T <= 1.6 (1 - T) for tau <=
  ///   1
  double of_opacity(double opacity) const;

  /// Of lit light L in channel c, of which there would be `uncut` without cones. Of light
  /// that is dimmed by tau, rel tau is off; and tau is about ln(light_most / L). A
  /// boundary that is moved dims it on both of its ways.
  double of_light(int c, double L, double uncut) const;

  Slack& operator+=(const Slack&);
};

/// For the ray from `o` (relative to the eye) along the unit vector `d` over [0, t]: what
/// one rounding of each float on the way can do.
///   exponential: exponents falloff (|o| + t) in float; the thick end counts, so that
///     upward only the start's exponent does
///   boundaries: their places on the ray, times the density there
///   custom: `tolerance`, what a table may promise
///   lamps: a lamp at distance h from the ray, known to be there to within dh, gives 1/h
///     of light along it: dh/h; its phase function turns by dh/h, too
Slack slack_of(const World&, const glm::dvec3& o, const glm::dvec3& d, double t,
               double tolerance);

/// Part of an optical depth along the ray that is in doubt where media have functions of
/// their own and little of them is known, by what they are at points. The ray as asked
/// about is `shift` beside the one that is meant.
///   place   Int |rho(x + shift) - rho(x)| ds
///   detail  Of what varies within h = way / kDetail all that may be asked are looks so
///   far
///           apart: their sum has the variance Int v h ds, v = (rho(x + h) - rho(x))^2
///           / 2. Three deviations; the way is twice that to the middle of what is on it.
/// Against Int rho ds. 10 000 points: for cases that look broken without it.
double doubt_of(const World&, const glm::dvec3& o, const glm::dvec3& d, double t,
                const glm::dvec3& shift);
inline constexpr double kDetail = 16384;

}  // namespace brume::stress
