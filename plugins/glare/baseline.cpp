#include "baseline.h"

#include <algorithm>

namespace brume::glare {

std::vector<float> baseline(const Kernel& k, int channel, const Bright& bright, int width,
                            int height) {
  const Layout l(width, height, k);
  std::vector<float> image(l.W * l.H), kernel(l.W * l.H);
  for (std::size_t y = 0; y < l.height; ++y)
    for (std::size_t x = 0; x < l.width; ++x)
      image[y * l.W + x] = float(bright.value(x, y, l.width));
  const int rx = std::min(k.reach_x, width - 1), ry = std::min(k.reach_y, height - 1);
  for (int y = -ry; y <= ry; ++y)
    for (int x = -rx; x <= rx; ++x)
      kernel[std::size_t(y < 0 ? y + int(l.H) : y) * l.W +
             std::size_t(x < 0 ? x + int(l.W) : x)] = k.at(channel, x, y);
  std::vector<float> all(l.W * l.H), out;
  fft().plain(image.data(), kernel.data(), l.H, l.W, all.data());
  for (std::size_t y = 0; y < l.height; ++y)
    out.insert(out.end(), all.begin() + std::ptrdiff_t(y * l.W),
               all.begin() + std::ptrdiff_t(y * l.W + l.width));
  return out;
}

}  // namespace brume::glare
