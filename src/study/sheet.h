#pragma once
// What a surface or lens stage is given of a frame. Internal to src/study.

#include <optional>
#include <string>

#include "stage/sheet.h"
#include "study/subject.h"

namespace brume::study {

/// The stage of that name among those that run; null: none.
const RunningStage* find_stage(const Prepared&, const std::string& name);

/// What the stage reads; nothing, and why in `why_not`, where that cannot be had.
std::optional<Sheet> sheet_of(const Context&, const RunningStage&,
                              const std::string& name, const SceneFile&, Registry&,
                              const FrameFiles&, std::string& why_not);

}  // namespace brume::study
