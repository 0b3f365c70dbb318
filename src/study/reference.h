#pragma once
// What is right along rays. Internal to src/study.

#include <optional>

#include "study/prepared.h"

namespace brume::study {

/// The air of one stage, or of all (""), of a prepared frame.
World world_of(const Prepared&, const std::string& stage);
std::shared_ptr<const Air> air_of(const Prepared&, const std::string& stage,
                                  double white);

/// The truth about a subject's rays.
///
/// It is truth::along of the frame prepared at its finest. But a medium that knows itself
/// alone better than at a point (brume_medium.alone: the sky, whose transmittance has a
/// colour that its density has not) answers for itself, ray by ray, without the tables of
/// a frame: for L and T where it is alone on a ray, elsewhere for its factor of T.
class Judge {
 public:
  /// `by_ray` is needed where has_alone(world).
  Judge(const Prepared& finest, const Prepared* by_ray, const std::string& stage,
        double white);

  static bool has_alone(const World&);

  Reference judge(const Rays&) const;
  /// Seconds (all cores) that a ray takes, from a few of these.
  double seconds_per_ray(const Rays&) const;
  /// In words.
  std::string describe() const;
  /// How far the truth at points and the medium's own answer part where that medium is
  /// alone: what of an error is the difference of two models. Largest of the colour,
  /// relative to white + |C|, over a few of these rays; 0 where there is no such medium.
  double model_gap(const Rays&) const;

 private:
  std::vector<bool> alone_on(const Rays&) const;
  Answers own_answers(const Rays&) const;

  World world_, others_, own_;
  double white_;
  std::shared_ptr<const Air> by_ray_, others_air_;
  std::vector<int> stages_;  ///< of by_ray_, which stage of the frame each is; -1 none
};

}  // namespace brume::study
