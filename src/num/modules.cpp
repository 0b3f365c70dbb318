#include "num/modules.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>

#include "num/error.h"

namespace brume {
namespace fs = std::filesystem;
namespace {

// The folders of the file that holds this code and of the running program, without links.
std::vector<fs::path> own_folders() {
  std::vector<fs::path> out;
  std::error_code ignored;
  Dl_info here;
  if (dladdr(reinterpret_cast<void*>(&own_folders), &here) && here.dli_fname) {
    const fs::path p = fs::canonical(here.dli_fname, ignored);
    if (!p.empty()) out.push_back(p.parent_path());
  }
  const fs::path program = fs::canonical("/proc/self/exe", ignored);
  if (!program.empty()) out.push_back(program.parent_path());
  return out;
}

}  // namespace

std::vector<fs::path> module_folders(bool environment, bool trees) {
  std::vector<fs::path> out;
  const auto add = [&](const fs::path& p) {
    if (std::find(out.begin(), out.end(), p) == out.end()) out.push_back(p);
  };
  const char* given = environment ? std::getenv("BRUME_PLUGIN_PATH") : nullptr;
  std::string_view left = given ? given : "";
  while (!left.empty()) {
    const std::string_view one = left.substr(0, left.find(':'));
    if (!one.empty()) add(one);
    left.remove_prefix(std::min(left.size(), one.size() + 1));
  }
  if (!trees) return out;
  const std::vector<fs::path> own = own_folders();
  for (const fs::path& p : own) add(p / "plugins");
  for (const fs::path& p : own) {
    for (const char* lib : {BRUME_INSTALL_LIBDIR, "lib", "lib64"})
      add(p.parent_path() / lib / "brume");
    add(p / "brume");  // the library itself lies in libdir
  }
  return out;
}

void* module_symbol(const char* module, const char* symbol,
                    std::span<const fs::path> folders) {
  for (const fs::path& folder : folders) {
    const fs::path file = folder / module;
    std::error_code absent;
    if (!fs::exists(file, absent)) continue;
    // RTLD_NOW: what is missing shows here and not in the middle of a frame.
    void* handle = dlopen(fs::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
    void* found = handle ? dlsym(handle, symbol) : nullptr;
    if (!found) throw Error(file.string(), "cannot be opened", dlerror());
    return found;
  }
  return nullptr;
}

void* module_symbol(const char* module, const char* symbol) {
  return module_symbol(module, symbol, module_folders());
}

}  // namespace brume
