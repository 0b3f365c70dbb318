#pragma once
// Patterns that the tests of this stage share.

#include <gtest/gtest.h>

#include <cmath>

#include "image/io.h"
#include "spectrum.h"

namespace brume::glare {

// A pattern image: a cross, off its middle on one side, so that nothing is symmetric.
inline std::string pattern_image() {
  const std::string path = testing::TempDir() + "glare_pattern.exr";
  Image image;
  image.header.data_window = image.header.display_window = {0, 0, 31, 31};
  for (const char* c : {"B", "G", "R"})
    image.header.channels.push_back({c, PixelType::float32});
  for (int c = 0; c < 3; ++c) {
    std::vector<float> plane(31 * 31);
    for (int i = 0; i < 31; ++i)
      plane[std::size_t(15 * 31 + i)] = plane[std::size_t(31 * i + 15)] =
          1.f / float(1 + std::abs(i - 15) + c);
    plane[2 * 31 + 3] = 0.5f;
    image.planes.push_back(plane);
  }
  write_image(image, path);
  return path;
}

inline PatternSettings settings(const std::string& kind) {
  PatternSettings s;
  s.kind = kind;
  s.grid = 1024;
  if (kind == "aperture") s.aperture = 2e-4, s.dust = 5, s.scratches = 2, s.blades = 5;
  if (kind == "image") s.image = pattern_image(), s.image_width = 31 * s.pixel;
  return s;
}

}  // namespace brume::glare
