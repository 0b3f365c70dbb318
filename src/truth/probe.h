#pragma once
// What `brume probe` answers, by the truth.

#include <span>
#include <vector>

#include "pipeline/probe.h"
#include "truth/truth.h"

namespace brume::truth {

/// Options::weights for the stages of a prepared frame, without masks: `mix` of each.
std::vector<double> mixes(const PreparedFrame&);

/// The truth for each ray, in order; meaning, order and errors as probe_rays. All cores.
/// options.weights and only_stage do not count.
std::vector<Answer> probe(const SceneFile&, Registry&, double frame,
                          std::span<const ProbeRay>, const Options& = {});

}  // namespace brume::truth
