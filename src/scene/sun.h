#pragma once
// Where the sun stands.

#include <glm/glm.hpp>

#include "scene/scene_file.h"

namespace brume {

/// Unit direction to a sun of this elevation above the horizon and azimuth clockwise from
/// north [degrees], in a world with this up axis (world_up). In a z-up world north is +Y
/// and east +X. Other worlds are that one turned: y up has north at -Z and east at +X, as
/// packages do when they change one into the other; x up has north at +Z and east at +Y.
glm::dvec3 direction_to_sun(double elevation, double azimuth, const glm::dvec3& up);

/// The same from [sun]'s `elevation` and `azimuth`, or from `time`, `hours` and place
/// where a time is given. Throws Error for a time that is none.
glm::dvec3 direction_to_sun(const SunSection&, const glm::dvec3& up);

}  // namespace brume
