#pragma once
// What reading, printing and describing a scene file share.

#include <array>
#include <string>

#include "scene/scene_file.h"

namespace brume::detail {

/// A section: its name, its settings, and the flag that says it was given (or null).
struct SceneSection {
  const char* name;
  Settings SceneFile::*settings;
  bool SceneFile::*given;
};

inline constexpr std::array<SceneSection, 5> kSceneSections{{
    {"input", &SceneFile::input, nullptr},
    {"camera", &SceneFile::camera, &SceneFile::has_camera},
    {"sun", &SceneFile::sun, &SceneFile::has_sun},
    {"time", &SceneFile::time, nullptr},
    {"output", &SceneFile::output, nullptr},
}};

/// A stage's common keys as settings, in the order of StageCommon.
Settings common_of(const StageEntry&);

}  // namespace brume::detail
