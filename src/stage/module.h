#pragma once
// One plugin: opened, its table checked, its stages copied out as values.

#include <filesystem>
#include <string>
#include <vector>

#include "params/params.h"
#include "plugin.h"

namespace brume {

/// A stage as the registry knows it. Its address stays the same as long as the registry;
/// the code behind it as long as the process.
struct StageType {
  std::string name, summary;
  brume_role role = BRUME_AIR;
  brume_surface_step step = BRUME_BACKGROUND_STEP;
  std::vector<ParamSpec> specs;
  std::string version;   ///< the plugin's own
  std::string baseline;  ///< the source's way to do it, "" without one
  std::string from;      ///< the module's file, or "linked in"
  brume_stage table{};   ///< its functions; fields that its plugin does not know are null
};

/// Opens a module (RTLD_NOW, RTLD_LOCAL) and reads its table. It stays open: tables and
/// worlds may hold its functions. Throws Error naming the file, what was found and what
/// was expected: not a shared object, no symbol brume_plugin, another ABI, no stages, a
/// table that makes no sense.
std::vector<StageType> open_module(const std::filesystem::path&);

/// Reads the table of a plugin that is already in memory; `from` stands in errors.
std::vector<StageType> read_plugin(brume_plugin_fn, const std::string& from);

}  // namespace brume
