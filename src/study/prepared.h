#pragma once
// The frame prepared at the settings under study. Internal to src/study.

#include <memory>
#include <string>
#include <vector>

#include "pipeline/impl.h"
#include "pipeline/sources.h"
#include "study/study.h"

namespace brume::study {

/// The scene at one setting, ready for its frame.
struct Prepared {
  std::string setting;
  std::vector<std::string> set;
  std::string knob;            ///< the stage's own that was set; "" none
  double once = 0, frame = 0;  ///< what preparing took: first, and again [s]
  double tolerance = 0;        ///< the integrator's
  std::shared_ptr<const Session> session;
  std::shared_ptr<const PreparedFrame> made;

  const PreparedFrame::Impl& impl() const { return made->impl(); }
};

/// Prepares one frame of a scene at many settings.
class Preparer {
 public:
  Preparer(const SceneFile& scene, Registry& registry, const FrameFiles& files);

  /// The scene as it stands.
  Prepared given() const { return prepare({}, "as the scene says"); }
  /// Along the tolerance, and along each stage's own knob.
  std::vector<Prepared> along_knobs() const;
  /// What everything is held against: the smallest tolerance, knobs following it.
  Prepared finest() const;
  /// The same for the rays of a frame, one by one, without tables of the frame.
  Prepared finest_by_ray(const PreparedFrame& like, double frame) const;

 private:
  Prepared prepare(std::vector<std::string> set, std::string setting) const;
  Prepared prepare(const SceneFile&) const;

  const SceneFile& scene_;
  Registry& registry_;
  const FrameFiles& files_;
};

/// Values along which a knob is studied, from coarse or small upward: whole numbers
/// double from the smallest to the largest; others go by powers of ten, at most 8.
std::vector<double> values_along(const ParamSpec&);

}  // namespace brume::study
