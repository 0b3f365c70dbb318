#pragma once
// Where on a ray things begin and end: bounds of media, the ball that `start` leaves
// empty, cones of spotlights. In long double, from the published numbers.

#include <glm/glm.hpp>
#include <vector>

#include "scene/world.h"

namespace brume::truth {

/// A ray relative to World::eye: unit direction, end may be inf.
struct Ray {
  glm::dvec3 o{0}, d{0, 1, 0};
  double end = 0;

  glm::dvec3 at(double t) const { return o + t * d; }
};

/// A part of a ray; empty unless from < to.
struct Stretch {
  double from = 0, to = 0;
};
/// Where a ray is inside a medium's shape, beyond its `start`, and, if it has no end,
/// before its `ground`; ascending. Every shape
/// is convex, so that `start` alone can part it. Behind the ray's origin too.
struct Stays {
  Stretch part[2];
  int count = 0;

  const Stretch* begin() const { return part; }
  const Stretch* end() const { return part + count; }
  /// Whether some of them is on a ray of this length.
  bool meet(double length) const;
};
Stays stays(const World&, const brume_medium&, const Ray&);

/// Where something narrow is on a ray: how far from there it is no longer what it is
/// there [m]; 0: a kink.
struct Place {
  double t = 0, width = 0;
};

/// Where a ray is nearest to the middle of a medium's ground: about it lies its air.
Place nearest_ground(const World&, const brume_medium&, const Ray&);

/// Appends the places where light of a lamp has a kink or its peak: the point nearest to
/// it, its own surface, the edges of its cone.
void add_lamp(const World&, const brume_light&, const Ray&, std::vector<Place>&);

/// Appends the places from which the way to a light begins or ends to meet the medium's
/// shape or `start` ball, or turns from one side of a box to the next: kinks of the
/// depth on that way. Values outside the ray, NaN and inf may come along.
void add_shadow_edges(const World&, const brume_medium&, const brume_light&, const Ray&,
                      std::vector<double>&);

/// Whether a way from the light to a point of `ray` may meet the medium's shape; never
/// false where one does.
bool may_stand_between(const World&, const brume_medium&, const brume_light&,
                       const Ray& ray);

}  // namespace brume::truth
