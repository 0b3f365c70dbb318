#pragma once
// Light on its way to points of a view ray. Internal to src/truth.

#include <array>
#include <optional>
#include <vector>

#include "truth/detail.h"
#include "truth/march.h"
#include "truth/physics.h"
#include "truth/segments.h"
#include "truth/way.h"

namespace brume::truth {

/// All lights of a world and what stands between them and the points of one ray: smooth
/// ways as polynomials, those through detail as nodes that the whole ray chooses
/// (detail.h). A march asks it point by point.
class Lights {
 public:
  Lights(const World&, const Ray&, const Options&, Cost&);
  Lights(const Lights&) = delete;
  Lights& operator=(const Lights&) = delete;

  /// Irradiance from light k at t, dimmed. Of the light S E, with S the part scattered
  /// per metre toward the ray's origin, `through` arrives there, and `sigma` ends it.
  Rgb dimmed(std::size_t k, const Incident&, double t, const Rgb& S, double through,
             const Rgb& sigma);
  /// Error that smooth ways have made in L.
  double error() const;

  /// Kinks and peaks of what they send.
  const std::vector<Place>& places() const { return places_; }

  /// Whether some ways go through media that say nothing of their detail. A march then
  /// begins with begin_march, is weighed, and refined until nothing more is asked for.
  bool detailed() const { return !through_detail_.empty(); }
  void begin_march();
  /// The light of detailed ways at the nodes of what a march has taken, at the eye as if
  /// extinction were even in each piece. `factor` by lane; lane k is of colour k % 3.
  template <int N>
  void weigh(const std::vector<typename March<N>::Taken>& pieces,
             const std::array<double, N>& factor);
  /// Asks for more ways through detail where L, with what it is now, needs them. Whether
  /// it has.
  bool refine_detail(const Rgb& L, const Options&, long& budget);
  const Rgb& detail_error() const { return detail_error_; }
  bool enough() const { return enough_; }

 private:
  double share_;  ///< error that the ways to each light may make in L
  Obstacles obstacles_;
  std::vector<Ways> ways_;  ///< by light
  std::vector<WaysToLight> smooth_;
  std::vector<std::optional<WaysThroughDetail>> detailed_;
  std::vector<Place> places_;

  /// What a light sends to a point of the ray, scattered toward the eye, per metre.
  struct Sent {
    double t;
    std::size_t light;
    Rgb light_per_metre;
  };
  std::vector<Sent> sent_;
  std::vector<const Ways*> through_detail_;
  Rgb detail_error_{};
  bool enough_ = true;
};

}  // namespace brume::truth
