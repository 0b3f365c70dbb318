#include "oracle.h"

#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numbers>

namespace brume::glare {

std::vector<long double> direct(const std::vector<float>& image, int width, int height,
                                const Kernel& k, int channel, double strength) {
  const auto lit = [&](std::size_t i) { return std::isfinite(image[i]) && image[i] > 0; };
  std::vector<long double> spread(image.size());
  for (int sy = 0; sy < height; ++sy)
    for (int sx = 0; sx < width; ++sx) {
      const std::size_t s = std::size_t(sy) * std::size_t(width) + std::size_t(sx);
      if (!lit(s)) continue;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          if (std::abs(x - sx) <= k.reach_x && std::abs(y - sy) <= k.reach_y)
            spread[std::size_t(y) * std::size_t(width) + std::size_t(x)] +=
                static_cast<long double>(image[s]) * k.at(channel, x - sx, y - sy);
    }
  for (std::size_t i = 0; i < image.size(); ++i) {
    const long double own = lit(i) ? image[i] : 0;
    spread[i] = image[i] + static_cast<long double>(strength) * (spread[i] - own);
  }
  return spread;
}

double airy(double x, double y, double pixel) {
  // Midpoints: the pattern's finest detail is one lambda / D.
  const int n = std::max(8, int(std::ceil(16 * pixel)));
  double sum = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double v = std::numbers::pi * pixel *
                       std::hypot(x + (i + 0.5) / n - 0.5, y + (j + 0.5) / n - 0.5);
      const double a = v == 0 ? 1 : 2 * boost::math::cyl_bessel_j(1, v) / v;
      sum += a * a;
    }
  return std::numbers::pi / 4 * pixel * pixel * sum / (n * n);
}

}  // namespace brume::glare
