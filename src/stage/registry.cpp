// Where stages are found.

#include "stage/registry.h"

#include <algorithm>
#include <set>
#include <utility>

#include "num/error.h"
#include "num/modules.h"

namespace brume {
namespace fs = std::filesystem;
namespace {

struct Linked {
  std::string name;
  brume_plugin_fn entry;
};

// Filled before main, when other files' statics may not exist yet.
std::vector<Linked>& linked_plugins() {
  static std::vector<Linked> all;
  return all;
}

constexpr std::string_view kPrefix = "brume_", kSuffix = ".so";

std::vector<fs::path> search_folders(const Registry::Options& options) {
  std::vector<fs::path> out = options.folders;
  for (const fs::path& p : module_folders(options.use_environment, options.use_trees))
    if (std::find(out.begin(), out.end(), p) == out.end()) out.push_back(p);
  return out;
}

std::vector<std::string> stages_in(const fs::path& folder) {
  std::vector<std::string> out;
  std::error_code gone;  // a folder that is absent or may not be read holds nothing
  for (fs::directory_iterator it(folder, gone), end; !gone && it != end;
       it.increment(gone)) {
    const std::string file = it->path().filename().string();
    if (file.size() > kPrefix.size() + kSuffix.size() && file.starts_with(kPrefix) &&
        file.ends_with(kSuffix))
      out.push_back(
          file.substr(kPrefix.size(), file.size() - kPrefix.size() - kSuffix.size()));
  }
  return out;
}

std::string joined_names(const std::vector<StageType>& types) {
  std::string out;
  for (const StageType& t : types) out += (out.empty() ? "" : ", ") + t.name;
  return out;
}

}  // namespace

LinkedPlugin::LinkedPlugin(const char* name, brume_plugin_fn entry) {
  linked_plugins().push_back({name, entry});
}

Registry::Registry(Options options) : folders_(search_folders(options)) {
  for (const fs::path& file : options.files)
    for (StageType& t : open_module(file)) {
      if (const StageType* other = known(t.name))
        throw Error(t.from, "carries a stage " + t.name,
                    other->from + " carries one too");
      types_.push_back(std::move(t));
    }
  if (!options.use_linked) return;
  const std::size_t by_hand = types_.size();
  for (const Linked& l : linked_plugins())
    for (StageType& t : read_plugin(l.entry, "linked in as " + l.name)) {
      const StageType* other = known(t.name);
      if (!other) {
        types_.push_back(std::move(t));
        continue;
      }
      const bool replaced =
          std::any_of(types_.begin(), types_.begin() + std::ptrdiff_t(by_hand),
                      [&](const StageType& hand) { return &hand == other; });
      if (!replaced)
        throw Error(t.from, "carries a stage " + t.name,
                    other->from + " carries one too");
    }
}

const StageType* Registry::known(std::string_view name) const {
  for (const StageType& t : types_)
    if (t.name == name) return &t;
  return nullptr;
}

fs::path Registry::file_of(const std::string& name) const {
  // A name that is no name (a path, say) is no file of ours.
  for (char c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_')) return {};
  for (const fs::path& folder : folders_) {
    const fs::path file = folder / (std::string(kPrefix) + name + std::string(kSuffix));
    std::error_code absent;
    if (fs::exists(file, absent)) return file;
  }
  return {};
}

const StageType& Registry::find(const std::string& name, const Location& where) {
  const std::lock_guard lock(mutex_);
  if (const StageType* t = known(name)) return *t;
  const fs::path file = name.empty() ? fs::path() : file_of(name);
  if (file.empty()) {
    const std::vector<std::string> all = [&] {
      std::set<std::string> found;
      for (const StageType& t : types_) found.insert(t.name);
      for (const fs::path& folder : folders_)
        for (std::string& s : stages_in(folder)) found.insert(std::move(s));
      return std::vector<std::string>(found.begin(), found.end());
    }();
    const std::string near = nearest_name(name, all);
    std::string hint;
    if (!near.empty()) {
      hint = "did you mean " + near + "?";
    } else if (!all.empty()) {
      for (const std::string& s : all) hint += (hint.empty() ? "known: " : ", ") + s;
    } else {
      for (const fs::path& folder : folders_)
        hint += (hint.empty() ? "no plugin in " : ", ") + folder.string();
    }
    throw Error(where.source.empty() ? "stage" : where.text(),
                "no stage \"" + name + "\"", hint);
  }
  std::vector<StageType> types = open_module(file);
  // The other stages that a module carries are found through files of their own names.
  for (StageType& t : types)
    if (t.name == name) return types_.emplace_back(std::move(t));
  throw Error(file.string(), "carries no stage " + name,
              "it carries " + joined_names(types));
}

std::vector<std::string> Registry::names() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> found;
  for (const StageType& t : types_) found.insert(t.name);
  for (const fs::path& folder : folders_)
    for (std::string& s : stages_in(folder)) found.insert(std::move(s));
  return {found.begin(), found.end()};
}

std::vector<const StageType*> Registry::all(std::vector<std::string>* broken) {
  std::vector<const StageType*> out;
  for (const std::string& name : names()) {
    try {
      out.push_back(&find(name));
    } catch (const Error& e) {
      if (broken) broken->push_back(e.what());
    }
  }
  return out;
}

}  // namespace brume
