#pragma once
// The slow, obviously correct way: what DESIGN says the air is, in double, one ray at a
// time, one adaptive march over all media and lights together.
//
//   dT/dt = -T Sum rho extinction,
//   dL/dt =  T Sum rho (emission + extinction (source + albedo lights))
//
// It knows a medium by what it is at a point: the formula of its profile, its `point`
// function, extinction, albedo, phase, emission. It never calls a stage's `integral`,
// `density`, `source_at` or `alone`, and shares no code with src/air: two ways to the
// same number, so that one finds the other's mistakes.

#include <array>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "scene/world.h"

namespace brume::truth {

using Rgb = std::array<double, 3>;

struct Options {
  /// Asked for: |dT| <= tolerance T and |dL| <= tolerance (white + |L|), per channel.
  double tolerance = 1e-9, white = 1;
  /// Per stage, 0..1: scales extinction and emission of its media along this ray, not on
  /// the ways from lights (mask x mix). Empty: all 1.
  std::span<const double> weights = {};
  /// Light of this stage's media alone, dimmed by all: the shares of all stages add up to
  /// L. -1: all.
  int only_stage = -1;
  /// How often media may be asked at a point, along the ray and on the ways of light to
  /// it, before the march goes on with lights that nothing dims: the light from there on
  /// is then an upper bound and all of it error. After twice as many it ends.
  long evaluations = 5'000'000;
  /// Lights through media that say nothing of their detail (BRUME_CUSTOM): error that
  /// they may make of L, in units of white + |L| (0: as much as other lights, half of the
  /// tolerance), and evaluations after which no more ways are asked for, however much it
  /// is.
  double enough = 0;
  long ways = std::numeric_limits<long>::max();
};

/// What comes along a ray, and how far from converged it may be: the sum over all pieces
/// of the change that halving them made, far above the error that is left.
struct Answer {
  Rgb T{1, 1, 1}, L{0, 0, 0};
  Rgb T_error{}, L_error{};
  bool converged = true;  ///< every piece met the tolerance, within the evaluations
  long evaluations = 0;   ///< how often the media were asked at a point
};

/// T and L from `origin` (world metres) along `direction` (any length but 0) to t_end
/// [m], which may be inf. `start` counts from World::eye, `max_opacity` from the ray's
/// origin, as in the product. What stands between a lamp or an attenuated sun and a point
/// is integrated likewise. A medium of wavelengths is marched by wavelength, under the
/// colours of all others (one such medium on a ray; a second counts by its three
/// colours, as do all on the way of light to a point). Interfaces reflect once. The march
/// ends where T < e^-200 in every channel: T is then that small, not exact. A place where
/// density jumps without being a boundary that the medium names costs time, not truth.
/// Thread-safe.
Answer along(const World&, const glm::dvec3& origin, const glm::dvec3& direction,
             double t_end, const Options& = {});

/// Optical depth alone, of media and shadowers (as light meets them: no weights).
Rgb optical_depth(const World&, const glm::dvec3& origin, const glm::dvec3& direction,
                  double t_end, double tolerance = 1e-10);

/// Radiance from beyond all air in this direction, seen from `origin`.
Rgb background(const World&, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace brume::truth
