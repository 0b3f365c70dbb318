#pragma once
// Which media a block of rays can meet at all: those whose bounding sphere meets the flat
// cone around the block's rays. What it drops, no ray of the block meets; so it never
// changes a bit.

#include <vector>

#include "air/cone.h"

namespace brume::air {

/// Around all rays of a block that start at the eye; everything when they are too far
/// apart, or start elsewhere.
Cone cone_around(const Rays&, const ConeKernels&);

/// Some of the world's media, in its order, with their bounding spheres side by side.
class Candidates {
 public:
  /// All of them.
  void start(List<Medium> media);
  /// Those of `from` that a ray of the cone may meet.
  void choose(const Candidates& from, const Cone&, const ConeKernels&);

  const std::vector<const Medium*>& media() const { return media_; }
  int size() const { return int(media_.size()); }

 private:
  void put(const Medium*, std::size_t at);
  Spheres spheres() const;

  std::vector<const Medium*> media_;
  std::vector<float> sphere_[4];
  std::vector<int> found_;
};

}  // namespace brume::air
