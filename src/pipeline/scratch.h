#pragma once
// The memory that a RowWorker works in. Internal to rows.cpp and surface.cpp.

#include <limits>
#include <utility>
#include <vector>

#include "pipeline/rows.h"

namespace brume {

/// Pixels per block: the planes a block needs stay in 32 KB, and every batch width
/// divides it.
constexpr int kBlock = 256;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Planes that a surface stage gets of its rays: distance, direction, origin.
constexpr std::size_t kRayPlanes = 7;

/// A plane of one block.
struct alignas(64) Plane {
  float v[kBlock];
};
using Rgb3 = Plane[3];

struct RowWorker::Scratch {
  // Rays of the block; origins are used by orthographic cameras only.
  Plane ox, oy, oz, dx, dy, dz, per_planar, distance, alpha, infinite;
  Plane surface_distance;  // of a plate: before what is at infinity got a place
  Rgb3 T, L, T_inf, L_inf, B, S, before;
  Plane before_alpha, fills;
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

  // For surface stages that look around: rays and distances of rows, and a block of them.
  struct AroundRow {
    int y = std::numeric_limits<int>::min();
    std::pair<int, int> columns;
    std::vector<float> planes;
  };
  std::vector<AroundRow> around;
  std::vector<float> halo;
  std::vector<float*> halo_at;
};

}  // namespace brume
