#pragma once
// The memory that a RowWorker works in. Internal to rows.cpp and surface.cpp.

#include <limits>
#include <vector>

#include "pipeline/rows.h"

namespace brume {

/// Pixels per block: the planes a block needs stay in 32 KB, and every batch width
/// divides it.
constexpr int kBlock = 256;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A plane of one block.
struct alignas(64) Plane {
  float v[kBlock];
};
using Rgb3 = Plane[3];

struct RowWorker::Scratch {
  // Rays of the block; origins are used by orthographic cameras only.
  Plane ox, oy, oz, dx, dy, dz, per_planar, distance, alpha, infinite;
  Rgb3 T, L, T_inf, L_inf, B, S, before;
  Plane before_alpha;
  bool at_eye = true;

  std::vector<Plane> weight_planes;       // by stage
  std::vector<const float*> weights;      // by stage; null: 1
  std::vector<Plane> shares, shares_inf;  // 3 L planes, then 3 T planes, per stage
  std::vector<float*> share_L, share_T, share_L_inf, share_T_inf;

  // Distances of whole rows, for looking around a pixel; kept by row.
  struct KeptRow {
    int y = std::numeric_limits<int>::min();
    std::vector<float> distance;
  };
  std::vector<KeptRow> kept;
  std::vector<float> patch;  // of distances, around a block
};

}  // namespace brume
