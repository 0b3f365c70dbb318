#include "picture/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume {

float tone(float scene, Curve curve) {
  if (!(scene > 0)) return 0;
  if (curve == Curve::linear) return std::min(scene, 1.0f);
  const float x = 0.6f * std::min(scene, 1e6f);
  return std::min(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 1.0f);
}

std::array<float, 3> false_color(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  constexpr float kDegree = 3.14159265f / 180;
  // Chroma is small at the ends, where the screen has little of it.
  const float L = 0.26f + 0.69f * t, hue = (285 - 185 * t) * kDegree,
              chroma = 0.06f + 0.36f * t * (1 - t) + 0.06f * t;
  // OKLab to linear Rec.709 (Ottosson 2020, "A perceptual color space for image
  // processing").
  const float a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const auto cube = [](float v) { return v * v * v; };
  const float l = cube(L + 0.3963377774f * a + 0.2158037573f * b),
              m = cube(L - 0.1055613458f * a - 0.0638541728f * b),
              s = cube(L - 0.0894841775f * a - 1.2914855480f * b);
  const float rgb[3] = {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
                        -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
                        -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
  return {std::clamp(rgb[0], 0.0f, 1.0f), std::clamp(rgb[1], 0.0f, 1.0f),
          std::clamp(rgb[2], 0.0f, 1.0f)};
}

float srgb_encoded(float linear) {
  const float v = std::clamp(linear, 0.0f, 1.0f);
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

float srgb_decoded(float encoded) {
  const float v = std::clamp(encoded, 0.0f, 1.0f);
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

Range range_of(std::span<const float> values) {
  float low = std::numeric_limits<float>::infinity(), high = 0;
  for (const float v : values) {
    if (!(v > 0 && v < 1e9f)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (high == 0) return {};
  if (low == high) return {0, high, false};
  return {low, high, high / low > 20};
}

float place(const Range& r, float value) {
  if (std::isnan(value) || value >= 1e9f || std::isinf(value)) return NAN;
  double v = value, low = r.low, high = r.high;
  if (r.logarithmic) {
    if (!(v > 0)) return NAN;
    v = std::log(v);
    low = std::log(low);
    high = std::log(high);
  }
  return float(std::clamp((v - low) / (high - low), 0.0, 1.0));
}

Image screen_image(const Picture& p) {
  Image image;
  image.header.data_window = image.header.display_window = {0, 0, p.width, p.height};
  for (const char* name : {"B", "G", "R"})
    image.header.channels.push_back({.name = name, .type = PixelType::half});
  image.planes.resize(3);
  const std::size_t n = p.rgb.size() / 3;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<float>& plane = image.planes[2 - k];
    plane.resize(n);
    for (std::size_t i = 0; i < n; ++i) plane[i] = srgb_encoded(p.rgb[3 * i + k]);
  }
  return image;
}

}  // namespace brume
