#pragma once
// The scene's tolerance, shared out among what makes numerical errors. Internal to
// src/pipeline.

#include <span>
#include <vector>

#include "pipeline/pipeline.h"

namespace brume {

/// What the integrator of the air promises at each of its own tolerances, as
/// ParamSpec::curve (src/air/curve.h).
std::span<const double> air_curve();

struct Knobs {
  std::vector<StageEntry> stages;  ///< as given, knobs set
  std::vector<KnobPlan> plans;     ///< the air's last
  double air = 0;                  ///< AirOptions::tolerance
  double promised = 0;             ///< of all together; inf: a knob without a promise
};

/// Sets the knobs of `stages` (those that run) that nobody gave. Errors add up: half of
/// the tolerance goes to the knobs, in equal shares, and each is set to the cheapest
/// value that promises its share (or its best); what they leave goes to the integrator.
/// Throws Error where the best of all is not good enough, unless `best_effort`. A knob
/// that the scene gives promises what it can and is no error; half of the tolerance is
/// left for the others at least. So with `fixed`, what stages promise that have no knob.
Knobs set_knobs(const SceneFile&, std::vector<StageEntry> stages,
                bool best_effort = false, std::span<const double> air = air_curve(),
                std::vector<KnobPlan> fixed = {});

}  // namespace brume
