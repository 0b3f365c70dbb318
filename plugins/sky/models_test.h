#pragma once
// Models and rays that the tests of the sky share.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "model.h"

namespace brume::sky {

// What is judged is solved here and now, not found on disk.
[[maybe_unused]] inline const int kNoStore = setenv("BRUME_CACHE", "off", 1);

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline const std::vector<double> kThree = {680, 550, 440};

inline const Model& earth() {
  static const Model m(preset("earth", kThree), Quality{});
  return m;
}
inline const Model& fast_earth() {
  static const Model m(preset("earth", kThree), Quality::fast());
  return m;
}

inline Quality nishita() {
  Quality q;
  q.method = Method::nishita93;
  return q;
}

inline Ray ray_at(double h, double view, double sun, double azimuth,
                  double distance = kInf) {
  const double v = view * M_PI / 180, s = sun * M_PI / 180, a = azimuth * M_PI / 180;
  return {h, std::cos(v), std::cos(s),
          std::clamp(std::cos(v) * std::cos(s) + std::sin(v) * std::sin(s) * std::cos(a),
                     -1., 1.),
          distance};
}

}  // namespace brume::sky
