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

/// Values of a stage's parameters, one after the other.
class Draw {
 public:
  Draw(Random& random, const FrameInfo& frame) : random_(random), frame_(frame) {}

  /// A value within the spec's range: the default, an end, 0, something tiny, any order
  /// of magnitude, anything between. Infinite ranges end at 1e7, those of colours at 1e9.
  /// Places lie around the eye, mostly, from a millimetre to 100 km away; directions
  /// point to it or from it as often as anywhere else.
  Value value(const ParamSpec&);

 private:
  glm::dvec3 near_eye();

  Random& random_;
  const FrameInfo& frame_;
  glm::dvec3 place_{0};  ///< the last that was drawn
};

/// Eye, camera, up, sun of a frame.
FrameInfo draw_frame(Random&);

/// A unit vector: level, vertical, nearly level, anywhere.
glm::dvec3 draw_direction(Random&, const glm::dvec3& up);

/// 0, denormal, any order of magnitude to 1e30, inf.
double draw_distance(Random&);

}  // namespace brume::stress
