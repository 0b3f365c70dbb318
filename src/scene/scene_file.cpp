// Reading a scene: sections and stages to Settings, and --set on top.

#include "scene/scene_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <utility>

#include "params/text.h"
#include "params/toml.h"
#include "scene/scene_file_parts.h"

namespace brume {
namespace {

using detail::kSceneSections;
using toml_tree::Node;

Location key_at(const Node& n, const std::string& source) {
  return {source, n.key_line, n.key_column};
}

// Sets every key of a table; `skip` names the keys that are not parameters.
void read_table(Settings& out, const Node& table, const std::string& source,
                std::string_view owner, std::span<const std::string_view> skip = {}) {
  for (const Node& item : table.items) {
    if (std::find(skip.begin(), skip.end(), item.key) != skip.end()) continue;
    const int i = out.find(item.key);
    if (i < 0)
      detail::no_such_parameter(owner, item.key, out.specs, key_at(item, source));
    out.values[i] = detail::read_setting(out.specs[i], item, source, owner);
  }
}

// A camera looks one way: by look_at or by rotation.
void refuse_two_aims(const Settings& camera) {
  const Setting& look_at = camera.values[camera.find("look_at")];
  const Setting& rotation = camera.values[camera.find("rotation")];
  if (!look_at.is_default && !rotation.is_default)
    throw Error(rotation.where.text(),
                "camera.rotation and camera.look_at are both given", "leave one out");
}

void check_name(const std::string& name, const Location& where) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           c == '_' || c == '-';
  };
  if (name.empty() || name.size() > 100 || !std::all_of(name.begin(), name.end(), plain))
    throw Error(where.text(), "stage name \"" + detail::shown(name) + "\"",
                "allowed: letters, digits, _ and -");
  for (const char* taken : {"input", "camera", "sun", "time", "output", "stage"})
    if (name == taken)
      throw Error(where.text(), "stage name \"" + name + "\"",
                  "a section is called that; give the stage another name");
}

void check_frames(const std::vector<double>& frames, const Location& where,
                  std::string_view owner) {
  if (frames.size() != 2 || !(frames[0] <= frames[1]))
    throw Error(where.text(), std::string(owner) + ".frames",
                "must be [first, last], first <= last");
}

void from_common(StageEntry& stage, const Settings& common) {
  StageCommon c;
  assign(c, std::span<const Value>(common.at(0)));
  check_frames(c.frames, common.values[common.find("frames")].where, stage.name);
  stage.enabled = c.enabled;
  stage.mask = c.mask;
  stage.mix = common.values[common.find("mix")];
  stage.first_frame = c.frames[0];
  stage.last_frame = c.frames[1];
}

StageEntry read_stage(const Node& n, const std::string& source,
                      const StageSpecs& specs_for) {
  const Location here{source, n.line, n.column};
  if (n.is != Node::Is::table)
    throw Error(here.text(), "stage = " + detail::shown(n),
                "stages are written [[stage]]");
  const Node* type = n.find("type");
  if (!type)
    throw Error(here.text(), "a stage without a type", "write type = \"height_fog\"");
  const Location type_at{source, type->line, type->column};
  if (type->is != Node::Is::text || type->text.empty())
    throw Error(type_at.text(), "stage type = " + detail::shown(*type),
                "must be the name of a stage in quotes");
  StageEntry stage;
  stage.where = here;
  stage.type = type->text;
  stage.params = Settings::defaults(specs_for(stage.type, type_at));

  // The name stands in every later message, so it comes first.
  const Node* name = n.find("name");
  stage.name = name && name->is == Node::Is::text ? name->text : stage.type;
  check_name(stage.name, name ? Location{source, name->line, name->column} : type_at);

  Settings common = Settings::defaults(specs_of<StageCommon>());
  for (const Node& item : n.items) {
    if (item.key == "type") continue;
    const bool is_common = common.find(item.key) >= 0;
    Settings& to = is_common ? common : stage.params;
    const int i = to.find(item.key);
    if (i < 0) {
      std::vector<ParamSpec> all = stage.params.specs;
      all.insert(all.end(), common.specs.begin(), common.specs.end());
      detail::no_such_parameter(stage.name, item.key, all, key_at(item, source));
    }
    to.values[i] = detail::read_setting(to.specs[i], item, source, stage.name);
  }
  from_common(stage, common);
  return stage;
}

void read_stages(SceneFile& scene, const Node& list, const std::string& source,
                 const StageSpecs& specs_for) {
  if (list.is != Node::Is::list)
    throw Error(key_at(list, source).text(), "stage is one table",
                "stages are written [[stage]]");
  constexpr std::size_t kMost = 65536;  // a scene, not an attack
  if (list.items.size() > kMost)
    throw Error(key_at(list, source).text(),
                std::to_string(list.items.size()) + " stages",
                "allowed: up to " + std::to_string(kMost));
  std::set<std::string> names;
  for (const Node& n : list.items) {
    StageEntry stage = read_stage(n, source, specs_for);
    if (!names.insert(stage.name).second) {
      const Node* name = n.find("name");
      const Node& at = name ? *name : *n.find("type");
      throw Error(Location{source, at.line, at.column}.text(),
                  "a second stage called " + stage.name,
                  name ? "names must differ" : "give it a name = \"...\"");
    }
    scene.stages.push_back(std::move(stage));
  }
}

void put_top(SceneFile& scene, std::string_view key, const Value& v) {
  if (key == "version")
    scene.version = int(v.numbers[0]);
  else if (key == "tolerance")
    scene.tolerance = v.numbers[0];
  else
    scene.colorspace = v.text;
}

void read_top(SceneFile& scene, const Node& n, const std::string& source) {
  // A file of a later brume is told apart from a typing error.
  if (n.key == "version" && n.is == Node::Is::integer && n.integer > kSceneVersion)
    throw Error(Location{source, n.line, n.column}.text(),
                "version = " + std::to_string(n.integer),
                "this brume knows scenes up to version " + std::to_string(kSceneVersion) +
                    "; it takes a newer one");
  Settings top = Settings::defaults(specs_of<TopSection>());
  const int i = top.find(n.key);
  top.values[i] = detail::read_setting(top.specs[i], n, source, "");
  put_top(scene, n.key, top.values[i].at(0));
}

std::vector<std::string> known_keys() {
  std::vector<std::string> names{"stage"};
  for (const ParamSpec& s : specs_of<TopSection>()) names.push_back(s.name);
  for (const auto& section : kSceneSections) names.push_back(section.name);
  return names;
}

}  // namespace

namespace detail {

Settings common_of(const StageEntry& stage) {
  Settings common = Settings::defaults(specs_of<StageCommon>());
  const auto put = [&](const char* name, Value v) {
    Setting& s = common.values[common.find(name)];
    s.keys = {{0, std::move(v)}};
    s.where = stage.where;
  };
  put("name", {.text = stage.name});
  put("enabled", {.numbers = {stage.enabled ? 1.0 : 0.0}});
  put("mask", {.text = stage.mask});
  put("frames", {.numbers = {stage.first_frame, stage.last_frame}});
  common.values[common.find("mix")] = stage.mix;
  return common;
}

}  // namespace detail

SceneFile empty_scene() {
  SceneFile scene;
  scene.input = Settings::defaults(specs_of<InputSection>());
  scene.camera = Settings::defaults(specs_of<CameraSection>());
  scene.sun = Settings::defaults(specs_of<SunSection>());
  scene.time = Settings::defaults(specs_of<TimeSection>());
  scene.output = Settings::defaults(specs_of<OutputSection>());
  return scene;
}

SceneFile parse_scene(std::string_view toml, const std::string& source,
                      const StageSpecs& specs_for) {
  SceneFile scene = empty_scene();
  const Node root = toml_tree::parse(toml, source);
  // The version says how to read the rest.
  if (const Node* version = root.find("version")) read_top(scene, *version, source);
  for (const Node& n : root.items) {
    if (n.key == "version") continue;
    if (n.key == "tolerance" || n.key == "colorspace") {
      read_top(scene, n, source);
      continue;
    }
    if (n.key == "stage") {
      read_stages(scene, n, source, specs_for);
      continue;
    }
    const auto section = std::find_if(kSceneSections.begin(), kSceneSections.end(),
                                      [&](const auto& s) { return n.key == s.name; });
    if (section == kSceneSections.end())
      throw Error(key_at(n, source).text(),
                  detail::shown(n.key) + ": no such " +
                      (n.is == Node::Is::table ? "section" : "key"),
                  detail::hint_for(n.key, known_keys()));
    if (n.is != Node::Is::table)
      throw Error(Location{source, n.line, n.column}.text(),
                  n.key + " = " + detail::shown(n), "it is a section: [" + n.key + "]");
    read_table(scene.*section->settings, n, source, section->name);
    if (section->given) scene.*section->given = true;
  }
  refuse_two_aims(scene.camera);
  return scene;
}

SceneFile read_scene(const std::filesystem::path& path, const StageSpecs& specs_for) {
  const std::string source = path.string();
  std::error_code failed;
  if (std::filesystem::is_directory(path, failed))
    throw Error(source, "is a directory", "a scene is a TOML file");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Error(source, std::string("cannot be opened: ") + std::strerror(errno));
  // Read with a bound, not by the file's size: a pipe or a device has none.
  std::string text;
  for (char part[1 << 14]; file && text.size() <= toml_tree::kLongest;) {
    file.read(part, sizeof part);
    text.append(part, std::size_t(file.gcount()));
  }
  if (file.bad()) throw Error(source, "cannot be read");
  if (text.size() <= toml_tree::kLongest && text.find('\0') != text.npos)
    throw Error(source, "is no text", "a scene is a TOML file; SCENE comes before IN");
  SceneFile scene = parse_scene(text, source, specs_for);
  scene.path = path;
  return scene;
}

void set(SceneFile& scene, std::string_view assignment, const StageSpecs&) {
  const Location where{"--set", 0, 0};
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos)
    throw Error("--set " + detail::shown(assignment),
                "no =", "write name.parameter=value");
  const auto trimmed = [](std::string_view s) {
    const std::size_t a = s.find_first_not_of(" \t");
    return a == std::string_view::npos ? std::string_view()
                                       : s.substr(a, s.find_last_not_of(" \t") - a + 1);
  };
  const std::string_view key = trimmed(assignment.substr(0, equals));
  const std::string_view value = assignment.substr(equals + 1);
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) {
    if (key != "tolerance" && key != "colorspace")
      throw Error("--set " + detail::shown(key), "no such key",
                  "write name.parameter=value, or tolerance=1e-3");
    Settings top = Settings::defaults(specs_of<TopSection>());
    top.set(key, value, where, "");
    put_top(scene, key, top.values[top.find(key)].at(0));
    return;
  }
  const std::string_view owner = key.substr(0, dot), name = key.substr(dot + 1);
  for (const auto& section : kSceneSections) {
    if (owner != section.name) continue;
    Settings& settings = scene.*section.settings;
    settings.set(name, value, where, owner);
    if (section.given) scene.*section.given = true;
    // The last word on where the camera looks holds.
    if (section.given == &SceneFile::has_camera &&
        (name == "look_at" || name == "rotation")) {
      const int other = settings.find(name == "look_at" ? "rotation" : "look_at");
      settings.values[other] = Settings::defaults({settings.specs[other]}).values.front();
    }
    return;
  }
  for (StageEntry& stage : scene.stages) {
    if (owner != stage.name) continue;
    if (name == "name" || name == "type")
      throw Error("--set " + std::string(key), "cannot be set here",
                  "change it in the scene file");
    Settings common = detail::common_of(stage);
    if (common.find(name) >= 0) {
      common.set(name, value, where, owner);
      from_common(stage, common);
    } else
      stage.params.set(name, value, where, owner);
    return;
  }
  std::vector<std::string> names;
  for (const auto& section : kSceneSections) names.push_back(section.name);
  for (const StageEntry& stage : scene.stages) names.push_back(stage.name);
  throw Error("--set " + detail::shown(key), "no such section or stage",
              detail::hint_for(owner, names));
}

}  // namespace brume
