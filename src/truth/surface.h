#pragma once
// What surface stages make of single pixels, by their own truths. Internal to src/truth.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "num/random.h"
#include "stage/sheet.h"
#include "truth/input.h"
#include "truth/shown.h"

namespace brume::truth {

/// A pixel after its surface stages.
struct Surface {
  Rgb S{};                 ///< its colour
  Rgb S_error{};           ///< how far off that may be
  double alpha{};          ///< its coverage as they left it: what a file would hold
  std::vector<Rgb> added;  ///< by stage, after mask and mix
};

/// The surface stages of a frame in their order, each on the pixel as the one before left
/// it: brume_stage.truth where a stage has one, else `run` in float, which is all that
/// there is of it then. What a stage is shown of the world is the truth's (Shown) in the
/// one case, and the product's in the other. Coverage is what `run` makes of it.
///
/// A stage is given floats. What their last bits decide is found by asking it again with
/// all of them moved by as much as rounding may do (kAsked times): the largest change is
/// the error. On an edge of two faces, where a normal is of one or of the other, it is as
/// large as what one face gets and the other does not; edges are looked for a little
/// farther away, as the product's own planes and their differences are rounded more than
/// once.
class Surfaces {
 public:
  /// `in` must live as long.
  explicit Surfaces(const FrameInput& in);

  Surface at(int x, int y) const;

  /// Names of those that are taken at their word: they have no truth.
  std::vector<std::string> unproven() const;

  static constexpr int kAsked = 8;

 private:
  /// Where a pixel and its neighbours lie.
  struct Place {
    double t;
    glm::dvec3 d, o;
  };
  struct Moved {
    Random random;
    double by;  ///< as a part of a number
  };
  Sheet sheet(const RunningStage&, int x, int y, const std::vector<Place>&, int around,
              Moved*) const;
  std::vector<Place> places(int x, int y, int around) const;
  void apply(const RunningStage&, int x, int y, const std::vector<Place>&, int around,
             Surface&) const;

  const FrameInput& in_;
  Shown shown_;
  brume_world fast_;
};

}  // namespace brume::truth
