#pragma once
// Ways to compute the air along rays: ours, that of the document an effect comes from,
// and the two that renderers use for any medium.

#include <functional>
#include <memory>
#include <vector>

#include "air/air.h"
#include "scene/world.h"
#include "stage/instance.h"

namespace brume::study {

/// Rays worked on together; a way is asked for no more at once.
inline constexpr int kBlock = 256;

/// T and L of up to kBlock rays; `weights` by stage of the frame, null: 1. Thread-safe.
/// Throws Error where it has no answer.
using Way = std::function<void(const RaySpans&, std::span<const float* const> weights,
                               float* const T[3], float* const L[3])>;

/// The integrator's. `air` lives as long as the way; what its functions point into (the
/// prepared frame) is the caller's to keep.
Way ours(std::shared_ptr<const Air> air);

/// The stage's own baseline. Weights do not count.
Way of_source(const StageInstance&);

/// Even steps through everything at once, `steps` of them, the middle of each standing
/// for all of it: T *= e^(-sigma ds), L += T e ds. Rays without end are cut at `far` [m].
/// Throws Error for a world of interfaces, or of more than 64 media.
Way marching(std::shared_ptr<const Air> air, int steps, float far);

/// Each medium alone in closed form, then painted over the picture one after the other:
/// media without bounds first, then volumes, the farthest middle first (Wenzel 2006).
/// `options` as for ours.
Way painting(const World& world, const AirOptions& options);

}  // namespace brume::study
