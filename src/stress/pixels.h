#pragma once
// Frames for stages that change pixels: internal to src/stress.

#include <array>

#include "stage/sheet.h"
#include "stress/stress.h"

namespace brume::stress {

/// A frame of at most kGroup pixels.
using Pixels = Sheet;

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
