#pragma once
// One block of rays through the whole world: closed forms, their composition, the walk
// where that is not enough, lamps; and interfaces, where the block splits.

#include "air/impl.h"

namespace brume::air {

/// T and L along b.rays, interfaces and all.
void integrate_block(const Air::Impl&, const Block& b);

/// The same between rays.begin and rays.end, media only.
void segment_block(const Air::Impl&, const Rays& rays, const Block& b);

/// integrate_block where the world has interfaces: each ray is split at the first it
/// meets. There L += T R (what comes along the reflected ray), T *= 1 - R.
void split_at_interfaces(const Air::Impl&, const Block& b);

void transmittance_block(const Air::Impl&, const Block& b);
void background_block(const Air::Impl&, const Rays&, float* const B[3]);

}  // namespace brume::air
