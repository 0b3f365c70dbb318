#pragma once
// A world and its rays: internal to src/stress.

#include <optional>
#include <string>
#include <vector>

#include "air/air.h"
#include "stress/group.h"
#include "stress/patience.h"
#include "stress/slack.h"

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

struct AirGroup final : Group {
  using Group::Group;
  int size() const override { return kGroup; }
  void check_laws(Findings&) override;
  Verdict check_truth(int i, Findings&) override;
  std::string describe(int i) override;
  bool given_up() const override { return patience && patience->lost(); }

  /// Compiled as the subject has it, for one instruction set.
  Air compile(const World&, Isa) const;
  /// Ray i over t metres.
  Slack slack(int i, double t) const;
  /// What T may be off by rounding, `times` roundings together.
  static double allowed_T(const Slack&, double T, double times);
  /// What L of ray i, the larger of what is compared, may be off: a constant source times
  /// the opacity's error, what lamps may be off, and what was asked of the integrator.
  /// Light added per length is off by as much of itself as depth is: by all of it where a
  /// ray may meet it or not.
  double allowed_L(const Slack&, int i, int c, double L, double opacity,
                   double times) const;
  /// Of it, what follows from rounding, once. `whole`: what lamps would make without
  /// their cones.
  double rounding_L(const Slack&, int c, double L, double opacity, double whole) const;

  Options options;
  FrameInfo frame;
  Subject subject;
  std::unique_ptr<Patience> patience;
  std::vector<Isa> isas;  ///< the processor's, best last
  std::vector<Air> airs;  ///< one each
  Rays rays;
  Random random{0};  ///< for what the laws draw

  bool own = false;       ///< functions of its own somewhere
  bool capped = false;    ///< max_opacity: counts from a ray's origin
  bool one_form = false;  ///< one medium, constant source, no light: closed form
  bool constant = false;  ///< sources are constant
  bool dims = false;      ///< there is extinction somewhere
  bool emits = false;     ///< light of its own per length
  bool glows = false;     ///< that with no extinction: L has no bound
  /// A planet stops rays, at its ground or at a surface seen a little below, so that T of
  /// a ray through it is no product and not a function of distance alone; and T is a mean
  /// over wavelengths, which is no product either. The truth judges it, and steps.
  bool sky = false,
       spectral = false;  ///< the clear sky; colours are sums over wavelengths
  double source[3] = {};  ///< the largest
  /// What laws ask that need answers of their own: all rays, or some where a source with
  /// functions of its own is dear.
  Part part;

  /// What allowed_L goes by, of the rays that `judge` has been told of. What lamps would
  /// add without their cones, where any has one: what the edge of a cone may make a
  /// difference to. The largest channel of a ray's light: what the tolerance of its pixel
  /// is relative to.
  std::vector<float> uncut[3], brightest;
  void judge(Part, const Answers&);
  /// The air with lamps for spotlights; nothing where there is none.
  std::optional<Air> without_cones() const;

  /// What the truth is asked for: less than any law can tell. A sky's source is solved to
  /// 1e-5, and its wavelengths are many.
  double truth_tolerance() const { return sky ? 1e-6 : 1e-8; }

  const Air& air() const { return airs.back(); }
  const World& world() const { return subject.world; }
};

/// Whether floats do not tell if a ray meets the ground that a medium knows of, or its
/// core; or on which side it begins.
bool at_the_ground(const World&, const glm::dvec3& o, const glm::dvec3& d);

/// What lights owe: T without them, sums of them, no change by the order in which they
/// and the media are told (light_laws.cpp).
void check_lights(AirGroup&, const Answers& whole, Findings&);

/// What may not jump (step_laws.cpp): along ways through the group's world, and from ray
/// i to one beside it.
void check_jumps(AirGroup&, Findings&);
void check_step(const AirGroup&, int i, Findings&);
std::string describe_steps(const AirGroup&, int i);

}  // namespace brume::stress
