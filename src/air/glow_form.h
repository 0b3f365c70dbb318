#pragma once
// Which lamps' glow has a closed form: chosen once per world, then ray by ray
// (lamp_closed.h).

#include "air/impl.h"

namespace brume::air {

/// A point lamp; every medium uniform from edge to edge (no start, no max_opacity),
/// scattering evenly if it scatters lamps' light at all; and, for a lamp that the air
/// dims, every medium around the lamp and no shadower.
bool glow_is_closed(const Air::Impl&, const Light& lamp);

}  // namespace brume::air
