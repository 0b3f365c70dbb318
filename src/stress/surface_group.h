#pragma once
// Pixels that show surfaces, and the lights on them: internal to src/stress.

#include "stress/group.h"
#include "stress/pixels.h"
#include "stress/shown.h"
#include "stress/slack.h"

namespace brume::stress {

struct SurfaceGroup final : Group {
  using Group::Group;

  Options options;
  FrameInfo frame;
  Subject subject;
  PixelStage stage;
  World world;
  std::unique_ptr<Shown> shown;
  Pixels in, out;
  Random random{0};
  bool spoilt = false;  ///< NaN and the like among the pixels
  bool smooth = false;  ///< one face without edges
  bool lights = false;  ///< the stage adds light and does nothing else

  int size() const override { return in.size(); }
  void check_laws(Findings&) override;
  Verdict check_truth(int i, Findings&) override;
  std::string describe(int i) override;

  /// A stage made for another frame and world, on these pixels.
  Pixels run(const PixelStage&, const World&, Pixels) const;
  AirOptions air_options() const;
  bool is_surface(int i) const;
  /// Angle between pixel i's ray and its nearest neighbour's: over it a normal is made.
  double ray_spacing(int i) const;
  /// What all lights send to pixel i unhindered, reflected by all of it, and what
  /// rounding may do to that: colour. Of a normal from depth that is what rounding the
  /// floats of its pixels may do, unless both sides have the `same` ones.
  struct Bound {
    double most[3] = {}, off[3] = {};
  };
  Bound bound(int i, bool same = false) const;
  double allowed(const Bound&, int c, std::size_t k, double value, double times) const;
  /// A vector among its channels: which way it points is the stage's business.
  bool has_vectors() const;
};

/// Camera, faces, coverage, colours, channels, lights and fog of a group.
void draw_surfaces(SurfaceGroup&);

}  // namespace brume::stress
