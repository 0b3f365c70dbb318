#pragma once
// The scene of a command: its file, then what the command line changes.

#include <memory>

#include "commands.h"
#include "scene/scene_file.h"
#include "stage/registry.h"

namespace brume::cli {

struct LoadedScene {
  std::unique_ptr<Registry> registry;
  SceneFile scene;
};

/// Throws Error for what is wrong in the file, UsageError for what is wrong in --set and
/// the like.
LoadedScene load_scene(const SceneArguments&);

}  // namespace brume::cli
