#pragma once
// Which media a block of rays can meet at all: those whose bounding sphere meets the cone
// around the block's rays. What it drops, no ray of the block meets; so it never changes
// a bit.

#include "air/cone.h"

namespace brume::air {

/// A cone from the eye: unit axis, cosine and sine of its half angle, and how far it
/// goes.
struct Cone {
  double axis[3] = {0, 0, 1}, cosine = -1, sine = 0, farthest = 0;
};

/// Around all rays of a block that start at the eye; the whole sphere when they are too
/// far apart, or start elsewhere.
Cone cone_around(const Rays&, const ConeKernels&);

/// False only where no ray in the cone meets the medium's bounds.
bool may_meet(const Cone&, const Medium&);

}  // namespace brume::air
