#pragma once
// Pictures to look at: scene light through a tone curve, numbers as colours, several side
// by side.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "image/image.h"

namespace brume {

/// What a screen shall show, before its encoding: linear light, 0 black to 1 white,
/// Rec.709 primaries; r g b of a pixel together, top row first.
struct Picture {
  int width = 0, height = 0;
  std::vector<float> rgb;

  Picture() = default;
  Picture(int w, int h) : width(w), height(h), rgb(3 * std::size_t(w) * std::size_t(h)) {}
  float* pixel(int x, int y) {
    return rgb.data() + 3 * (std::size_t(y) * std::size_t(width) + std::size_t(x));
  }
};

enum class Curve { filmic, linear };

/// Scene light to screen light. filmic rolls highlights off like film (Narkowicz 2015,
/// "ACES Filmic Tone Mapping Curve": x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14), x =
/// 0.6 of the input, which brings middle grey near its place); linear clips. NaN is
/// black, inf white.
float tone(float scene, Curve);

/// The perceptually even map from 0 (dark blue) over green to 1 (pale yellow): lightness
/// rises linearly in OKLab (Ottosson 2020), the hue turns from 285 to 100 degrees. Screen
/// light; outside [0, 1] the ends hold.
std::array<float, 3> false_color(float t);

/// sRGB's transfer function, IEC 61966-2-1, and its inverse.
float srgb_encoded(float linear);
float srgb_decoded(float encoded);

/// Where numbers begin and end as false colours.
struct Range {
  double low = 0, high = 1;
  bool logarithmic = false;
};

/// The range of the values that are neither background of a depth (<= 0, >= 1e9,
/// infinite) nor NaN; logarithmic where they span more than a factor of 20. {0, 1} when
/// there are none.
Range range_of(std::span<const float>);
float place(const Range&, float value);  ///< to 0..1; NaN for what is no number in it

/// One picture of several, with what stands below it ("" none) and the range its colour
/// bar shows (nullptr none).
struct Tile {
  Picture picture;
  std::string label;
  bool has_range = false;
  Range range;
};

struct Montage {
  int columns = 0;  ///< 0: as square as can be
  int width = 0;    ///< of each picture, scaled; 0: as they are
};

/// The tiles as one picture. Drawing is OpenCV's, in a module (picture.so of
/// num/modules.h) that is opened only when there is something to draw: a single tile
/// without scaling, label and range comes back as it is. Throws Error when the module is
/// not there.
Picture montage(std::span<const Tile>, const Montage&);

/// Eight bits a channel, sRGB, as an image ready to be written.
Image screen_image(const Picture&);

}  // namespace brume
