#pragma once
// What is right along rays. Internal to src/study.

#include "study/prepared.h"

namespace brume::study {

/// The air of one stage, or of all (""), of a prepared frame.
World world_of(const Prepared&, const std::string& stage);
std::shared_ptr<const Air> air_of(const Prepared&, const std::string& stage,
                                  double white);

/// The truth about a subject's rays: truth::along of the frame prepared at its finest.
///
/// A medium that knows itself alone better than at a point (brume_medium.alone: the sky,
/// whose light comes by wavelengths, of which a point tells three colours) is another
/// model to the truth. There brume itself at its finest, every ray asked for itself,
/// stands for the same model converged; model_gap says how far the truth is from it.
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
  /// How far truth and reference part where they are two models: largest of the colour,
  /// relative to white + |C|, over a few of these rays. 0 where they are one.
  double model_gap(const Rays&) const;

 private:
  Reference truth_of(const Rays&) const;

  World world_;
  double white_;
  std::shared_ptr<const Air> by_ray_;
  std::vector<int> stages_;  ///< of by_ray_, which stage of the frame each is; -1 none
};

}  // namespace brume::study
