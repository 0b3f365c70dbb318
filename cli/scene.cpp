#include "scene.h"

#include "num/error.h"

namespace brume::cli {

namespace {

// "T,L" as a TOML list of texts.
std::string list_text(const std::string& comma_separated) {
  std::string out = "[";
  std::size_t at = 0;
  while (at < comma_separated.size()) {
    const std::size_t end =
        std::min(comma_separated.find(',', at), comma_separated.size());
    if (end > at) {
      if (out.size() > 1) out += ", ";
      out += "'" + comma_separated.substr(at, end - at) + "'";
    }
    at = end + 1;
  }
  return out + "]";
}

}  // namespace

LoadedScene load_scene(const SceneArguments& a) {
  Registry::Options options;
  for (const std::string& file : a.plugins) options.files.emplace_back(file);
  LoadedScene loaded;
  loaded.registry = std::make_unique<Registry>(options);
  const StageSpecs specs = [&](const std::string& type, const Location& where) {
    return loaded.registry->specs(type, where);
  };
  loaded.scene = read_scene(a.scene, specs);
  const auto change = [&](const std::string& assignment) {
    try {
      set(loaded.scene, assignment, specs);
    } catch (const Error& e) {
      throw UsageError(e.what());
    }
  };
  if (a.aovs) change("output.aovs=" + list_text(*a.aovs));
  if (!a.compression.empty()) change("output.compression=" + a.compression);
  for (const std::string& assignment : a.set) change(assignment);
  return loaded;
}

}  // namespace brume::cli
