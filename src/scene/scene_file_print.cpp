// A scene as TOML, everything spelled out; and what a scene may be, as a JSON schema.

#include <array>
#include <string>

#include "params/schema.h"
#include "params/text.h"
#include "scene/scene_file.h"
#include "scene/scene_file_parts.h"

namespace brume {
namespace {

std::string line(const Settings& s, int i) {
  return s.specs[i].name + " = " + print(s.specs[i], s.values[i]) + "\n";
}

std::string lines(const Settings& s) {
  std::string out;
  for (int i = 0; i < int(s.specs.size()); ++i) {
    if (s.specs[i].knob && s.values[i].is_default)
      out += "# " + s.specs[i].name + ": from tolerance\n";
    else
      out += line(s, i);
  }
  return out;
}

// look_at and rotation exclude each other: only the one that holds is said.
std::string camera_lines(const Settings& s) {
  const bool turned = !s.values[s.find("rotation")].is_default;
  const int silent = s.find(turned ? "look_at" : "rotation");
  std::string out;
  for (int i = 0; i < int(s.specs.size()); ++i)
    if (i != silent) out += line(s, i);
  return out;
}

}  // namespace

std::string print(const SceneFile& scene) {
  std::string out = "version = " + std::to_string(scene.version) +
                    "\ntolerance = " + detail::float_text(scene.tolerance) +
                    "\ncolorspace = " + detail::quoted(scene.colorspace) + "\n";
  for (const auto& section : detail::kSceneSections) {
    if (section.given && !(scene.*section.given)) continue;
    const Settings& s = scene.*section.settings;
    out += std::string("\n[") + section.name + "]\n" +
           (section.given == &SceneFile::has_camera ? camera_lines(s) : lines(s));
  }
  for (const StageEntry& stage : scene.stages)
    out += "\n[[stage]]\ntype = " + detail::quoted(stage.type) + "\n" +
           lines(detail::common_of(stage)) + lines(stage.params);
  return out;
}

std::string scene_json_schema(std::span<const StageSchema> types) {
  std::string members;
  for (const auto& section : detail::kSceneSections)
    members += (members.empty() ? "" : ",\n") + detail::quoted(section.name) + ": " +
               object_schema((empty_scene().*section.settings).specs);
  // One alternative per stage type, told apart by `type`.
  const std::array<std::string, 1> required{"type"};
  std::string stages;
  for (const StageSchema& t : types) {
    std::vector<ParamSpec> specs = specs_of<StageCommon>();
    specs.insert(specs.end(), t.specs.begin(), t.specs.end());
    const std::string type = "\"type\": {\"const\": " + detail::quoted(t.type) +
                             ", \"description\": " + detail::quoted(t.doc) + "}";
    stages += (stages.empty() ? "" : ",\n") + object_schema(specs, type, required);
  }
  members += ",\n\"stage\": {\"type\": \"array\", \"items\": " +
             (stages.empty() ? std::string("{\"type\": \"object\"}")
                             : "{\"oneOf\": [" + stages + "]}") +
             "}";
  return "{\"$schema\": " + detail::quoted(kSchemaDialect) +
         ", \"title\": \"brume scene\", " +
         object_schema(specs_of<TopSection>(), members).substr(1) + "\n";
}

}  // namespace brume
