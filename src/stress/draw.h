#pragma once
// Numbers that make trouble: internal to src/stress.

#include <glm/glm.hpp>

#include "num/random.h"
#include "params/params.h"
#include "stage/instance.h"

namespace brume::stress {

inline double log_uniform(Random& r, double lo, double hi) {
  return lo * std::pow(hi / lo, r.uniform());
}
inline int integer(Random& r, int n) { return int(r.uniform() * n); }

/// A value within the spec's range: the default, an end, 0, something tiny, any order of
/// magnitude, anything between. Infinite ranges end at 1e7, those of colours at 1e9.
Value draw_value(const ParamSpec&, Random&);

/// Eye, up, sun of a frame.
FrameInfo draw_frame(Random&);

/// A unit vector: level, vertical, nearly level, anywhere.
glm::dvec3 draw_direction(Random&, const glm::dvec3& up);

/// 0, denormal, any order of magnitude to 1e30, inf.
double draw_distance(Random&);

}  // namespace brume::stress
