#pragma once
// What other stages may have put into the world of the one under test: internal to
// src/stress.

#include "num/random.h"
#include "scene/world.h"
#include "stage/instance.h"

namespace brume::stress {

/// A lamp, half of them spotlights, about `away` from the eye: before it, behind it, at
/// it.
brume_light draw_lamp(Random&, const FrameInfo&, double away);

/// From anywhere, from straight above, from the horizon.
brume_light draw_sun(Random&, const FrameInfo&);

/// Fog that shows what light there is, without a colour of its own: even or thinning,
/// everywhere or in a box or an ellipsoid about the eye, thin to opaque over `away`, up
/// to 1e6 per metre.
brume_medium draw_fog(Random&, const FrameInfo&, double away);

/// The world in other units: x -> k x, what is per metre and the lamps' power with it, so
/// that everything looks the same.
World scaled(const World&, double k);
/// x -> eye + R (x - eye); R a rotation. Worlds of functions cannot be turned.
World turned(const World&, const glm::dmat3& R);

/// The world with these of its lights, in this order.
World with_lights(const World&, const std::vector<std::size_t>& which);

}  // namespace brume::stress
