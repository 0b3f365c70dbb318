#pragma once
// A ray cut where anything begins, ends or has a peak, and the march along it.

#include <algorithm>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "truth/geometry.h"
#include "truth/march.h"
#include "truth/physics.h"
#include "truth/truth.h"

namespace brume::truth {

/// A medium that the ray meets.
struct OnRay {
  OnRay(const World& w, const Published<brume_medium>& p, const Ray& ray,
        const Stays& where)
      : medium(&p.what), line(w, p.what, ray), stays(where), stage(p.stage) {}

  const brume_medium* medium;
  MediumOnRay line;
  Stays stays;
  int stage;
  double weight = 1;
  /// Where max_opacity ends it, per channel [m].
  Rgb cap{std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity()};
  Place lowest{};         ///< of a medium with a ground: where the ray is nearest to it
  bool scatters = true;   ///< extinction in some channel
  bool converged = true;  ///< its caps are known
  /// It emits alone, and so little at the ends of its stay (the box about a Gaussian)
  /// that these are no kinks. The ray is not cut there: it may be present on a part of a
  /// piece.
  bool fades = false;

  bool stays_at(double t) const {
    return std::ranges::any_of(stays,
                               [&](const Stretch& s) { return s.from < t && t < s.to; });
  }
};
using Media = std::vector<OnRay>;

/// What there is on a part of the ray.
struct Present {
  std::vector<const OnRay*> media;
  /// Those of them that are lorentzian and emit alone, such as the hundreds of lights of
  /// a bolt, are here instead: emission / (width^2 + (t - at)^2).
  struct Glow {
    double at, width2, emission[3];
  };
  std::vector<Glow> glows;

  bool empty() const { return media.empty() && glows.empty(); }
  /// Light of the glows at t [radiance/m].
  Rgb glow(double t) const;
};

/// The media of the World with weight (by stage; empty: 1) and coefficients that the ray
/// meets, and their caps: where weight x extinction x Int rho from the ray's origin on
/// reaches -ln(1 - max_opacity), to 1e-12 of the distance. Of other stages than
/// `only_stage` (-1: all) none that emit alone.
Media media_on(const World&, const Ray&, const Options&, Cost&);

/// Where a ray is cut beside the bounds and peaks of media.
struct Cuts {
  std::span<const Place> lights = {};  ///< where media answer to lights
  /// Media that say nothing of their detail are looked at in so many parts at least.
  int parts = 16;
};

/// Marches from `begin` to the ray's end; `at` is asked with the media present there.
template <int N>
using LocalOf = std::function<Local<N>(const Present&, double t)>;
template <int N>
void walk(const Media&, const Ray&, March<N>&, const LocalOf<N>& at, const Cuts&,
          double begin = 0);

}  // namespace brume::truth
