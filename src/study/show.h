#pragma once
// The frame before and after, for a screen. Internal to src/study.

#include "study/prepared.h"

namespace brume::study {

/// Fills study.before and study.after, at most 960 pixels wide.
void show(const SceneFile&, Registry&, const FrameFiles&, const Prepared& given, Study&);

}  // namespace brume::study
