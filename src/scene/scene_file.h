#pragma once
// The scene file: what to do to a frame. TOML, no programming. Sections declare their
// keys like stages do (params.h); they are in scene_file_sections.h.

#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "params/describe.h"
#include "params/params.h"
#include "scene/scene_file_sections.h"

namespace brume {

/// One [[stage]]: common keys and the stage's own parameters.
struct StageEntry {
  std::string type, name;  // name: type unless given; unique
  bool enabled = true;
  std::string mask;  // channel or file:channel, "" none
  Setting mix;       // 0..1, 1
  double first_frame = -std::numeric_limits<double>::infinity();
  double last_frame = std::numeric_limits<double>::infinity();
  Settings params;
  Location where;
};

struct SceneFile {
  std::filesystem::path path;  // "" for a scene made in memory
  int version = 1;
  double tolerance = 1e-3;
  std::string colorspace = "frame";           // of all colours below
  Settings input, camera, sun, time, output;  // specs of the sections above
  bool has_camera = false, has_sun = false;   // the section stands in the file
  std::vector<StageEntry> stages;             // in file order

  template <class Section>
  static Section section(const Settings& s, double frame) {
    Section out;
    const auto values = s.at(frame);
    assign(out, std::span<const Value>(values));
    return out;
  }
};

/// A scene of nothing: all sections at their defaults, no stages.
SceneFile empty_scene();

/// How the parser asks what parameters a stage type has; throws Error (unknown stage,
/// with the nearest name).
using StageSpecs =
    std::function<std::vector<ParamSpec>(const std::string& type, const Location&)>;

/// Reads a scene. Unknown keys, wrong kinds, values out of range: Error
/// "valley.toml:12:9: height_fog.density = -3; allowed 0 to 10 per m". The place is that
/// of the value, or of the key where the key is wrong. Columns count characters, from 1.
/// Files longer than 4 MiB are refused.
SceneFile read_scene(const std::filesystem::path&, const StageSpecs&);
SceneFile parse_scene(std::string_view toml, const std::string& source_name,
                      const StageSpecs&);

/// "name.param=value", "sun.elevation=3", "tolerance=1e-4": from the command line. A
/// stage's common keys (enabled, mask, mix, frames) too; not its type or name. Throws
/// Error; the scene is then as it was.
void set(SceneFile&, std::string_view assignment, const StageSpecs&);

/// The resolved scene as TOML (defaults spelled out): parses back to the same. What goes
/// into `brume/scene`. A knob that nobody gave stays a comment, so that it follows
/// `tolerance` again; so does the one of camera.look_at and camera.rotation that does not
/// hold.
std::string print(const SceneFile&);

/// A stage type, for the schema.
struct StageSchema {
  std::string type, doc;
  std::vector<ParamSpec> specs;
};

/// JSON schema (draft 2020-12) of a whole scene file.
std::string scene_json_schema(std::span<const StageSchema>);

}  // namespace brume
