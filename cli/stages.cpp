// brume stages: what there is to put into a scene.

#include <fmt/format.h>

#include <cstdio>

#include "commands.h"
#include "json.h"
#include "num/error.h"
#include "params/params.h"
#include "stage/registry.h"
#include "table.h"

namespace brume::cli {

namespace {

const char* role_name(brume_role role) {
  switch (role) {
    case BRUME_SURFACE:
      return "surface";
    case BRUME_AIR:
      return "air";
    default:
      return "lens";
  }
}

const char* kind_name(Kind kind) {
  static const char* const names[] = {"number",  "integer", "flag", "rgb",    "vec3",
                                      "numbers", "matrix",  "text", "choice", "texts"};
  return names[int(kind)];
}

std::string words_text(const ParamSpec& p) {
  std::string out;
  for (const std::string& w : p.words) out += (out.empty() ? "" : ", ") + w;
  return out;
}

// What may stand there: "0 to 10 per m", or the words.
std::string allowed(const ParamSpec& p) {
  if (p.kind == Kind::choice) return words_text(p);
  std::string text = range_text(p);
  if (text.empty()) text = p.unit.empty() ? "any" : "any, " + p.unit;
  if (!p.words.empty()) text += ", or " + words_text(p);
  return text;
}

void print_params(const StageType& stage) {
  fmt::print("{} ({}): {}\n", stage.name, role_name(stage.role), stage.summary);
  fmt::print("from {}{}\n\n", stage.from,
             stage.version.empty() ? "" : ", version " + stage.version);
  std::vector<std::vector<std::string>> rows = {{"parameter", "default", "allowed", ""}};
  for (const ParamSpec& p : stage.specs)
    rows.push_back({p.name, print(p, default_value(p)), allowed(p),
                    p.doc + (p.knob ? " (accuracy: follows `tolerance`)" : "") +
                        (p.animatable ? "" : " (no keyframes)")});
  std::fputs(table(rows, 0).c_str(), stdout);
  std::fputs(
      "\nEvery stage also takes name, enabled, frames = [first, last], mask = "
      "\"channel\" "
      "and mix = 0 to 1.\n"
      "A value may be keyframed: { frames = [1, 24], values = [0, 1], "
      "interpolation = \"smooth\" }\n",
      stdout);
}

void write_json(Json& json, const StageType& stage) {
  json.object();
  json.key("name").value(stage.name).key("role").value(role_name(stage.role));
  json.key("summary").value(stage.summary).key("from").value(stage.from);
  json.key("version").value(stage.version).key("parameters").array();
  for (const ParamSpec& p : stage.specs) {
    json.object().key("name").value(p.name).key("kind").value(kind_name(p.kind));
    json.key("unit").value(p.unit).key("doc").value(p.doc);
    json.key("minimum").value(p.minimum).key("maximum").value(p.maximum);
    json.key("default");
    if (p.default_text.empty() && !p.default_numbers.empty())
      json.values(p.default_numbers);
    else
      json.value(p.default_text);
    json.key("words").values(p.words).key("knob").value(p.knob);
    json.key("keyframes").value(p.animatable).end();
  }
  json.end().end();
}

}  // namespace

int stages(const StagesArguments& a, const Terminal& terminal) {
  Registry::Options options;
  for (const std::string& file : a.plugins) options.files.emplace_back(file);
  Registry registry(options);
  if (a.names) {  // for the completion: opens nothing
    for (const std::string& name : registry.names()) fmt::print("{}\n", name);
    return kOk;
  }
  if (!a.name.empty()) {
    const StageType& stage = registry.find(a.name);
    if (a.schema) {
      fmt::print("{}\n", json_schema(stage.name, stage.specs));
    } else if (a.json) {
      Json json;
      write_json(json, stage);
      std::fputs(json.text().c_str(), stdout);
    } else {
      print_params(stage);
    }
    return kOk;
  }
  if (a.schema) throw UsageError("stages: --schema needs the name of a stage");
  std::vector<std::string> broken;
  const std::vector<const StageType*> all = registry.all(&broken);
  if (a.json) {
    Json json;
    json.array();
    for (const StageType* stage : all) write_json(json, *stage);
    std::fputs(json.end().text().c_str(), stdout);
  } else {
    std::vector<std::vector<std::string>> rows;
    for (const StageType* stage : all)
      rows.push_back({stage->name, role_name(stage->role), stage->summary});
    std::fputs(table(rows, 0).c_str(), stdout);
  }
  for (const std::string& why : broken) terminal.warning(why);
  return kOk;
}

}  // namespace brume::cli
