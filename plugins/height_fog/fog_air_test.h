#pragma once
// Height fog as the tests of this folder ask it: a World with one fog, made by the
// product's own path. Its bounds are said here once: asserted by the tests, printed into
// the README.

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "../../tests/stage/through_air.h"

namespace height_fog {

using namespace brume;
using test::Answer;
using test::Ray;
using test::Set;
using test::text;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kEps = std::numeric_limits<float>::epsilon();

// A float exponent x is off by eps |x| / 2 of itself; T = e^-tau is then off by at most
// (1/e) of tau's relative error, and 1 - T by all of it.
constexpr double kErrorT = 1e-6;        ///< absolute, plus eps |c dz| / e
constexpr double kErrorOpacity = 2e-6;  ///< of 1 - T, relative, plus eps |c dz|

inline Ray climbing(double mu, double t) {
  return {.d = {float(std::sqrt((1 - mu) * (1 + mu))), 0, float(mu)}, .t = float(t)};
}

inline FrameInfo at(double z) { return test::eye_at(0, 0, z); }

/// A fog in the world, of colour 1 unless told otherwise.
class FogAir : public test::ThroughAir {
 public:
  explicit FogAir(const Set& set, const FrameInfo& frame, bool linked = false,
                  std::optional<Isa> isa = {})
      : ThroughAir(frame, linked ? inside() : registry()) {
    Set all = {{"color", "1"}};
    all.insert(all.end(), set.begin(), set.end());
    add("height_fog", all).compile(1e-3, isa);
  }

  /// The stages that are linked in.
  static Registry& inside() {
    static Registry linked({.files = {}, .use_environment = false, .use_trees = false});
    return linked;
  }
};

}  // namespace height_fog
