#pragma once
// A world and its rays: internal to src/stress.

#include <optional>
#include <vector>

#include "air/air.h"
#include "stress/stress.h"

namespace brume::stress {

/// Rays in planes; origins relative to the eye, none when all begin there.
struct Rays {
  std::vector<float> o[3], d[3], t;

  int size() const { return int(t.size()); }
  bool from_eye() const { return o[0].empty(); }
  glm::dvec3 origin(int i) const {
    const auto k = std::size_t(i);
    return from_eye() ? glm::dvec3(0) : glm::dvec3(o[0][k], o[1][k], o[2][k]);
  }
  glm::dvec3 direction(int i) const {
    const auto k = std::size_t(i);
    return {d[0][k], d[1][k], d[2][k]};
  }
  /// Gives them origins, if they have none.
  void place();
};

/// Rays [begin, begin + count) of a group.
struct Part {
  int begin = 0, count = kGroup;
};

/// By ray of the group; nothing outside the part that was asked for.
struct Answers {
  std::vector<float> T[3], L[3];
};

/// `weight` of the stage, by ray of the group; `shift` floats off alignment.
Answers ask(const Air&, const Rays&, Part = {}, const float* weight = nullptr,
            int shift = 0);

/// A world, and what is still to be drawn in it.
struct Setting {
  std::uint64_t number = 0;
  FrameInfo frame;
  Subject subject;
  Random random{0};
};

struct Group {
  std::uint64_t number = 0;
  FrameInfo frame;
  Subject subject;
  std::vector<Isa> isas;  ///< the processor's, best last
  std::vector<Air> airs;  ///< one each
  Rays rays;
  Random random{0};  ///< for what the laws draw

  bool own = false;       ///< functions of its own somewhere
  bool capped = false;    ///< max_opacity: counts from a ray's origin
  bool one_form = false;  ///< one medium, constant source, no light: closed form
  bool constant = false;  ///< sources are constant
  bool emits = false;     ///< light of its own per length
  bool glows = false;     ///< that with no extinction: L has no bound
  /// A planet stops rays, at its ground or at a surface seen a little below, so that T of
  /// a ray through it is no product and not a function of distance alone; and T is a mean
  /// over wavelengths, which is no product either, nor what points say. Its own tests
  /// judge.
  bool sky = false;
  double source[3] = {};  ///< the largest
  /// What laws ask that need answers of their own: all rays, or some where a source with
  /// functions of its own is dear.
  Part part;

  const Air& air() const { return airs.back(); }
  const World& world() const { return subject.world; }
};

/// Compiled for all instruction sets.
Air compile(const World&, const Options&, Isa);

/// Nothing where the stage is idle. Throws Error where it refuses.
std::optional<Setting> make_setting(const Maker&, const Options&, std::uint64_t number);

/// How many groups share a world: more than one where a world is dear (a sky's takes
/// tenths of a second). By what the first world that is not idle publishes.
std::uint64_t groups_per_world(const Maker&, const Options&);

/// Group `number` in the world number / share.
Group make_group(const Setting&, const Options&, std::uint64_t share,
                 std::uint64_t number);

}  // namespace brume::stress
