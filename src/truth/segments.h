#pragma once
// A ray cut where anything begins, ends or has a peak, and the march along it.

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "truth/geometry.h"
#include "truth/march.h"
#include "truth/physics.h"
#include "truth/truth.h"

namespace brume::truth {

/// A medium that the ray may meet.
struct OnRay {
  OnRay(const World& w, const Published<brume_medium>& p, const Ray& ray)
      : medium(&p.what), line(w, p.what, ray), stage(p.stage) {}

  const brume_medium* medium;
  MediumOnRay line;
  int stage;
  double weight = 1;
  /// Where max_opacity ends it, per channel [m].
  Rgb cap{std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity()};
  bool scatters = true;   ///< extinction in some channel
  bool converged = true;  ///< its caps are known
};
using Media = std::vector<OnRay>;
using Present = std::vector<const OnRay*>;

/// The media of the World with weight (by stage; empty: 1) and coefficients, and their
/// caps: where weight x extinction x Int rho from the ray's origin on reaches -ln(1 -
/// max_opacity), to 1e-12 of the distance.
Media media_on(const World&, const Ray&, std::span<const double> weights,
               double tolerance, Cost&);

/// Marches from `begin` to the ray's end; `at` is asked with the media present there.
/// `lit`: cut at lamps too.
template <int N>
using LocalOf = std::function<Local<N>(const Present&, double t)>;
template <int N>
void walk(const World&, const Media&, const Ray&, March<N>&, const LocalOf<N>& at,
          bool lit, double begin = 0);

}  // namespace brume::truth
