#pragma once
// Where modules lie, and what they export: stages, formats other than EXR, OpenEXR's
// codecs, drawing. Each is opened when it is first needed, so that nobody waits at the
// start for libraries that his frames never use.

#include <filesystem>
#include <span>
#include <vector>

namespace brume {

/// The folders that are searched, each once, in this order:
///   1. those of BRUME_PLUGIN_PATH (colons between them), if `environment`;
///   2. if `trees`: in the build tree, plugins/ beside the program or the library or
///      bundle that holds this code; in the install tree, ../<libdir>/brume,
///      ../lib/brume,
///      ../lib64/brume from there, and brume/ beside the library.
std::vector<std::filesystem::path> module_folders(bool environment = true,
                                                  bool trees = true);

/// A symbol of the first module of that name in the folders (by default the above); the
/// module stays open as long as the process. Null where none of them holds it. Throws
/// Error{file, why} where it cannot be opened or has no such symbol.
void* module_symbol(const char* module, const char* symbol,
                    std::span<const std::filesystem::path> folders);
void* module_symbol(const char* module, const char* symbol);

}  // namespace brume
