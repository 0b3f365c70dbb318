#pragma once
// Is the promise kept? Pixels of a frame, chosen where errors hide, by the truth and by
// the product.

#include <string>
#include <vector>

#include "truth/frame.h"

namespace brume::truth {

/// What there is to say about a kind of pixels.
struct CheckClass {
  std::string name;  ///< "horizon", "silhouettes", "far", "bright", ...
  int pixels = 0;
  double worst = 0;  ///< largest |dC| / (promised (white + |C|)): above 1 breaks it
  double p99 = 0;
  int x = 0, y = 0;                       ///< where it is worst
  double dS = 0, dT = 0, dL = 0, dC = 0;  ///< there: errors of S, T, L, the colour
};

struct Check {
  double promised = 0, white = 1;
  std::vector<CheckClass> classes;
  double worst = 0;
  double truth_error = 0;  ///< of the truth itself, as a part of the promise
  int pixels = 0, unconverged = 0;
  /// Pixel::undecided: their colour is only held to be a number where the truth's is.
  int undecided = 0;
  std::vector<std::string> unproven;  ///< Frame::unproven
  bool kept() const { return worst <= 1; }
};

/// Compares about `count` pixels (all where there are fewer). A third are spread evenly;
/// the others look at the horizon (rays that hardly climb), grazing surfaces (distance
/// that changes fast from row to row), silhouettes (steps of distance, partial coverage),
/// the nearest and the farthest, the brightest, and the sky. The promise is the scene's:
/// |dC| <= tolerance (white + |C|), or the plan's where a stage promises less; what the
/// truth may be off is not counted against it.
/// Lens stages are left out: the promise is about the air. `seed` chooses other pixels.
Check check_frame(const Session&, double frame, const std::filesystem::path& in,
                  int count, std::uint64_t seed = 1);

}  // namespace brume::truth
