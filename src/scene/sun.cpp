#include "scene/sun.h"

#include <cmath>

#include "scene/ephemeris.h"

namespace brume {

glm::dvec3 direction_to_sun(double elevation, double azimuth, const glm::dvec3& up) {
  const double e = glm::radians(elevation), a = glm::radians(azimuth);
  const double east = std::cos(e) * std::sin(a), north = std::cos(e) * std::cos(a);
  const double above = std::sin(e);
  if (up.x > 0) return {above, east, north};
  if (up.y > 0) return {east, above, -north};
  return {east, north, above};
}

glm::dvec3 direction_to_sun(const SunSection& sun, const glm::dvec3& up) {
  if (sun.time.empty()) return direction_to_sun(sun.elevation, sun.azimuth, up);
  const SunPosition at = sun_position(julian_day(sun.time, "[sun]") + sun.hours / 24,
                                      sun.latitude, sun.longitude);
  return direction_to_sun(at.elevation, at.azimuth, up);
}

}  // namespace brume
