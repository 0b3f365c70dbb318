#pragma once
// Frames for stages that change pixels: internal to src/stress.

#include <vector>

#include "image/image.h"
#include "stress/stress.h"

namespace brume::stress {

/// A frame of at most kGroup pixels in planes, with `around` more on each side (copies of
/// the edge) for what a tile may look at there.
struct Pixels {
  int width = 1, height = 1, around = 0;
  std::ptrdiff_t stride = 1;  ///< from row to row, >= width + 2 around
  std::vector<float> rgb[3], alpha, t, d[3],
      o[3];                                  ///< o, t, d: empty where not asked for
  std::vector<std::vector<float>> channels;  ///< empty ones are missing

  int size() const { return width * height; }
  std::size_t at(int x, int y) const {
    return std::size_t((y + around) * stride + x + around);
  }
  std::size_t at(int i) const { return at(i % width, i / width); }

  /// Fits the planes of this size, `wide` floats longer a row than need be.
  void resize(int width_, int height_, int around_, int wide);
  /// The same pixels with rows so much longer, everything `shift` floats farther on.
  Pixels moved(int wide) const;
  /// Copies the edge pixels outward.
  void replicate();
};

/// Sizes that make trouble: one pixel, one row, one column, primes.
std::pair<int, int> draw_size(Random&);

/// Colours and coverage: any exposure, single bright pixels; where `spoilt`, NaN, inf,
/// denormal and negative numbers among them.
void draw_colors(Random&, Pixels&, bool spoilt);

/// A number that is none, or hardly one.
float draw_bad(Random&);

/// Runs a stage on a part of the pixels; `world` null: none.
void run_on(const PixelStage&, Pixels&, const Window& part, const brume_world* world);
/// On all of them.
void run_on(const PixelStage&, Pixels&, const brume_world* world = nullptr);
/// PixelStage::truth of pixel i: three numbers.
std::array<double, 3> truth_of(const PixelStage&, Pixels&, int i,
                               const brume_world* world = nullptr);

}  // namespace brume::stress
