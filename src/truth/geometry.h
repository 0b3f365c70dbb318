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

/// Appends where the ray may enter or leave the medium's shape or its `start` ball.
/// Values outside the ray, NaN and inf may come along.
void add_bounds(const World&, const brume_medium&, const Ray&, std::vector<double>&);

/// Whether the ray is inside shape and `start` at t, which is not on a boundary.
bool inside(const World&, const brume_medium&, const Ray&, double t);

/// Appends the places where light of a lamp has a kink or its peak: the point nearest to
/// it, its own surface, the edges of its cone.
void add_lamp(const World&, const brume_light&, const Ray&, std::vector<double>&);

/// Appends the places from which the way to a light begins or ends to meet the medium's
/// shape or `start` ball, or turns from one side of a box to the next: kinks of the
/// depth on that way. Values outside the ray, NaN and inf may come along.
void add_shadow_edges(const World&, const brume_medium&, const brume_light&, const Ray&,
                      std::vector<double>&);

/// Appends the point nearest to `world`.
void add_foot(const World&, const double world[3], const Ray&, std::vector<double>&);

}  // namespace brume::truth
