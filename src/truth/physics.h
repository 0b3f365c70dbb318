#pragma once
// Media and lights at a point.

#include <glm/glm.hpp>

#include "scene/world.h"
#include "truth/geometry.h"
#include "truth/truth.h"

namespace brume::truth {

/// Density rho at t of a ray [1], >= 0 and finite; and, where the medium has a source of
/// its own, that toward the ray's origin. What the profile's formula has along the ray is
/// worked out once, in long double. Exponents are taken in long double
/// and end at 300: what is e^300 times denser than at the origin is opaque to every
/// light.
struct AtPoint {
  double rho = 0;
  Rgb source{}, tint{1, 1, 1};  // tint: factors on the medium's extinction
};
class MediumOnRay {
 public:
  MediumOnRay(const World&, const brume_medium&, const Ray&);
  AtPoint at(double t) const;

  /// Of a lorentzian profile: where it is densest, and how far from there it is half so.
  struct Peak {
    double t, width;
  };
  Peak peak() const;

 private:
  const World* world_;
  const brume_medium* medium_;
  Ray ray_;
  /// exponential: rho = e^-(a + b t); lorentzian: rho = 1/(a + falloff (t - b)^2).
  long double a_ = 0, b_ = 0;
};

/// The phase function [1/sr] for light that arrives from `to` and leaves along
/// -direction.
double phase(const brume_medium&, const glm::dvec3& to, const glm::dvec3& direction);

/// Light at `x` before anything stands between: irradiance on a plane that faces it,
/// where it comes from, and how far away (inf: sun). A sky light: its mean radiance, and
/// no way.
struct Incident {
  Rgb E{};
  glm::dvec3 to{0};
  double distance = 0;
};
Incident light_at(const World&, const brume_light&, const glm::dvec3& x);

}  // namespace brume::truth
