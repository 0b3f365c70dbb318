#pragma once
// A SkyMap's tables, filled from a Model.

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "color.h"
#include "map.h"
#include "model.h"

namespace brume::sky {

/// Nodes of the tables, azimuths before they are refined.
struct MapSize {
  int above = 40, below = 32, azimuths = 24, slices = 30, sky = 128;
  double detail = 1;        // of each path (Model::along)
  double whole_detail = 2;  // of that, of paths without slices, whose ends add panels
};

/// Enough of them for an eye at h, paths to the ground and the sun at mu_s, `detail`
/// times as many along each axis as usual: from outside the air a whole day lies around
/// it, and more is to be seen where the planet's shadow begins within sight.
MapSize map_size(const Model&, double h, double ground, double mu_s, double detail = 1);

struct MapTables {
  SkyMap map;
  std::vector<float> memory[3];  // of above, below, sky

  MapTables() = default;
  MapTables(const MapTables&) = delete;
  MapTables& operator=(const MapTables&) = delete;
};

/// For an eye at altitude h [m], paths that end at `ground` (Model::ground, or the
/// deepest for surfaces beyond it), sun zenith cosine mu_s, and so much of the air on the
/// way to the eye (Ray::weight); `scale` multiplies radiance.
/// Directions come later, from map.up and map.sun, which the caller sets.
void build_map(const Model&, double h, double ground, double mu_s, double weight,
               const Colors&, const double scale[3], const MapSize&, MapTables&);

/// The last few tables of a Model: frames whose eye keeps its height and whose sun stands
/// still share theirs. Thread-safe.
class Maps {
 public:
  /// As build_map makes them, of the size that map_size says.
  std::shared_ptr<const MapTables> get(const Model&, double h, double ground, double mu_s,
                                       double weight, const Colors&,
                                       const std::array<double, 3>& scale,
                                       double detail) const;

 private:
  struct Entry {
    std::vector<double> key;
    std::shared_ptr<const MapTables> tables;
  };
  mutable std::mutex mutex_;
  mutable std::vector<Entry> entries_;  // the newest last
};

/// For transmittance; `ground` and `up` are the caller's.
SkyPlace place_of(const Model&, const Colors&);

}  // namespace brume::sky
