#include "oracle.h"

#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace brume::glare {

long double spread_at(const std::vector<Lit>& lit, const Kernel& k, int channel, int x,
                      int y) {
  long double sum = 0;
  for (const Lit& s : lit)
    if (std::abs(x - s.x) <= k.reach_x && std::abs(y - s.y) <= k.reach_y)
      sum += static_cast<long double>(s.value) * k.at(channel, x - s.x, y - s.y);
  return sum;
}

std::vector<long double> direct(const std::vector<float>& image, int width, int height,
                                const Kernel& k, int channel, double strength) {
  std::vector<Lit> lit;
  for (std::size_t i = 0; i < image.size(); ++i)
    if (std::isfinite(image[i]) && image[i] > 0)
      lit.push_back({int(i) % width, int(i) / width, image[i]});
  std::vector<long double> out(image.begin(), image.end());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      long double& to = out[std::size_t(y) * std::size_t(width) + std::size_t(x)];
      const long double own = std::isfinite(to) && to > 0 ? to : 0;
      to += static_cast<long double>(strength) * (spread_at(lit, k, channel, x, y) - own);
    }
  return out;
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
