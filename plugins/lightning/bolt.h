#pragma once
// Where the lights of a bolt are. World metres.

#include <cstddef>
#include <vector>

#include "params/describe.h"

namespace lightning {

using brume::Vec3;

/// A light and its share of the whole, > 0; the shares add up to 1.
struct Spark {
  Vec3 at;
  double share;
};

struct Bolt {
  int seed = 0;
  double roughness = 0;  ///< how far a stretch's middle strays, as a part of its length
  int branches = 0;
};

/// `count` lights evenly along the polyline `points` (two or more), each in the middle of
/// its stretch and with the same share. Length 0: all at the first point.
std::vector<Spark> along_line(const std::vector<Vec3>& points, int count);

/// The polyline with every stretch broken at a random middle, six times over (midpoint
/// displacement, as in Fournier, Fussell & Carpenter 1982), and the branches that leave
/// it: the same for the same numbers on every machine. The first line is the trunk.
std::vector<std::vector<Vec3>> grow(const std::vector<Vec3>& points, const Bolt&);

/// Lights along all lines by their length, a branch's with half a trunk's share per
/// metre; `count` in all, at least one for each line.
std::vector<Spark> along_lines(const std::vector<std::vector<Vec3>>& lines, int count);

}  // namespace lightning
