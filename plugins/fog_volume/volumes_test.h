#pragma once
// Fog volumes as the tests of this folder ask for them: a Volume as settings, places in
// it, rays to them.

#include <cmath>
#include <limits>
#include <string>

#include "../../tests/stage/through_air.h"
#include "oracle.h"
#include "placement.h"

namespace fog_volume {

using namespace brume;
using namespace brume::test;
using brume::test::text;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kEps = std::numeric_limits<float>::epsilon();

// The bound, said once: asserted by the tests, printed into the README.
constexpr double kError = 1e-5;  ///< of L and of 1 - T, relative, beside the conditioning

inline std::string text(const Point& p) {
  return text(double(p[0]), double(p[1]), double(p[2]));
}
inline Set settings(const Volume& v) {
  return {{"shape", v.box ? "box" : "ellipsoid"},
          {"center", text(v.center)},
          {"half", text(v.half)},
          {"rotation", text(v.degrees)},
          {"origin", text(v.origin)},
          {"gradient", text(v.gradient)},
          {"density", text(double(v.density))},
          {"falloff", text(double(v.falloff))},
          {"softness", text(double(v.softness))},
          {"color", "1"}};
}

inline Ray toward(const Point& from, const Point& to, double t = kInf) {
  long double v[3], n = 0;
  for (std::size_t i = 0; i < 3; ++i) v[i] = to[i] - from[i], n += v[i] * v[i];
  n = std::sqrt(n);
  Ray r;
  for (std::size_t i = 0; i < 3; ++i) r.d[i] = float(v[i] / n);
  r.t = float(t);
  return r;
}

inline Point in_world(const Volume& v, const Point& local) {
  const auto R = fog_volume::rotation(
      {double(v.degrees[0]), double(v.degrees[1]), double(v.degrees[2])});
  Point p = v.center;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) p[i] += R[i][k] * v.half[k] * local[k];
  return p;
}

}  // namespace fog_volume
