#pragma once
// The optical depth of a fog volume along a ray, by another route than the product's:
// long double, the turn by quaternions, where the ray is inside from convexity alone, and
// fading edges by adaptive quadrature.

#include <array>

namespace fog_volume {

using Real = long double;
using Point = std::array<Real, 3>;

struct Volume {
  bool box = true;
  Point center{}, half{1, 1, 1}, degrees{};
  Point origin{}, gradient{0, 0, 1};  // gradient: of length 1
  Real density = 1, falloff = 0, softness = 0;
};

/// A world point in the coordinates in which the shape is the unit box or ball; a
/// direction with `is_direction`.
Point to_local(const Volume&, const Point&, bool is_direction);

/// tau over [0, t_end] of the ray (t_end may be inf) [1]; and the depth and places where
/// it enters and leaves.
struct Depth {
  Real tau = 0, t0 = 0, t1 = 0, sigma0 = 0, sigma1 = 0;
};
Depth optical_depth(const Volume&, const Point& o, const Point& d, Real t_end);

}  // namespace fog_volume
