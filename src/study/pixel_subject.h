#pragma once
// One surface or lens stage of a study. Internal to src/study.

#include "study/subject.h"

namespace brume::study {

/// Every way to do what stage `name` does to the frame's pixels: ours along its knob and
/// the tolerance, its source document's; of a lens that is linear, its own pattern summed
/// over windows. Timed on the whole frame, held against the stage's own truth on a grid
/// and where ways part most. Nothing, and why in `why_not`, where it has no truth, or
/// reads what cannot be had here.
std::optional<Subject> study_of_pixels(const Context&, const std::string& name,
                                       const SceneFile&, Registry&, const FrameFiles&,
                                       std::string& why_not);

}  // namespace brume::study
