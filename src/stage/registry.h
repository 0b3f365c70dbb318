#pragma once
// Which stages there are, and where each is found. A module is opened only when a scene
// names its stage.
//
// A stage "sky" is looked for in this order:
//   1. the files given by hand (--plugin x.so),
//   2. plugins linked into the program,
//   3. brume_sky.so in the folders of num/modules.h.
// The first found is taken; if it is broken that is an error, and the search ends.

#include <deque>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "params/params.h"
#include "stage/module.h"

namespace brume {

/// Makes a linked-in plugin known for the life of the process; constructed before main by
/// a table that brume_link_plugins (src/brume.cmake) writes.
struct LinkedPlugin {
  LinkedPlugin(const char* name, brume_plugin_fn entry);
};

class Registry {
 public:
  struct Options {
    std::vector<std::filesystem::path> files;  ///< opened at once; their stages go first
    bool use_environment = true;               ///< BRUME_PLUGIN_PATH
    bool use_linked = true;
    bool use_trees = true;  ///< build and install tree
    std::vector<std::filesystem::path> folders =
        {};  ///< searched before all other folders
  };

  /// Opens the files. Throws Error when one is broken, or two carry stages of one name.
  explicit Registry(Options);
  Registry() : Registry(Options{}) {}
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// The stage type of this name, opened if need be. Thread-safe; the reference holds as
  /// long as the registry. Throws Error{where} for an unknown name (with the nearest
  /// known one, and where was looked), Error{file} for a broken module.
  const StageType& find(const std::string& name, const Location& where = {});

  /// Its parameters: what the scene's parser asks (StageSpecs).
  std::vector<ParamSpec> specs(const std::string& name, const Location& where = {}) {
    return find(name, where).specs;
  }

  /// Names of all stages that can be found, sorted; opens nothing.
  std::vector<std::string> names() const;

  /// All stages that can be found, opened, by name; modules that are broken are left out
  /// and named in `broken` with the reason.
  std::vector<const StageType*> all(std::vector<std::string>* broken = nullptr);

 private:
  const StageType* known(std::string_view name) const;
  std::filesystem::path file_of(const std::string& name) const;

  std::vector<std::filesystem::path> folders_;
  mutable std::mutex mutex_;
  std::deque<StageType> types_;  // addresses stay
};

}  // namespace brume
