#pragma once
// FLIP: how large an error looks to someone who flips between two pictures on a screen.
//
//   LDR-FLIP  Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom & Fairchild 2020,
//   "FLIP:
//             A Difference Evaluator for Alternating Images"
//   HDR-FLIP  Andersson, Nilsson, Shirley & Akenine-Moller 2021, "Visualizing Errors in
//             Rendered High Dynamic Range Images"
//
// 0: looks the same, 1: as different as can be. Symmetric for one exposure; HDR-FLIP
// takes its exposures from the reference.

#include <optional>

#include "truth/metrics.h"

namespace brume {

struct FlipOptions {
  /// Pixels per degree of the eye: a 0.7 m wide screen of 3840 pixels seen from 0.7 m.
  double pixels_per_degree = 0.7 * 3840 / 0.7 * 3.14159265358979323846 / 180;
  /// The exposures [stops] between which HDR-FLIP looks; else from the reference: its
  /// brightest, and its median pixel, come to 0.85 on the screen.
  std::optional<std::pair<double, double>> exposures;
};

/// Values in [0, 1], top row first.
struct FlipMap {
  std::vector<float> error;
  double mean = 0;
  double first_exposure = 0, last_exposure = 0;
  int exposures = 1;
};

/// Screen light (linear, clamped to 0..1 here).
FlipMap ldr_flip(ColorView reference, ColorView test, const FlipOptions& = {});

/// Scene light: the largest LDR-FLIP over exposures a stop apart, through the ACES fit of
/// Narkowicz 2015. Negative values and NaN count as 0, more than 65536 as that.
FlipMap hdr_flip(ColorView reference, ColorView test, const FlipOptions& = {});

}  // namespace brume
