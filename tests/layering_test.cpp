// Who may include whom (src/README.md): each folder only those listed for it.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path kRoot = BRUME_SOURCE_DIR;

// Every include of ours names plugin.h, a file beside it, or a folder in `allowed`.
void check_file(const fs::path& file, const Names& allowed) {
  static const std::regex include("^\\s*#\\s*include\\s*\"([^\"]+)\"");
  std::ifstream in(file);
  std::smatch found;
  for (std::string line; std::getline(in, line);) {
    if (!std::regex_search(line, found, include)) continue;
    const fs::path named = found[1].str();
    const bool beside =
        !named.has_parent_path() && fs::exists(file.parent_path() / named);
    EXPECT_TRUE(beside || named == "plugin.h" || allowed.contains(*named.begin()))
        << fs::relative(file, kRoot) << " includes " << named;
  }
}

bool is_source(const fs::path& p) {
  return p.extension() == ".h" || p.extension() == ".cpp" || p.extension() == ".c";
}

TEST(layering, a_folder_of_the_library_uses_only_those_below_it) {
  const Names below_stage = {"num", "image", "params", "scene", "air", "stage"};
  std::map<std::string, Names> may = {
      {"picture", {"num", "image"}}, {"pipeline", below_stage}, {"truth", below_stage}};
  may["stress"] = may["study"] = below_stage;
  Names below;
  for (const char* name : {"num", "image", "params", "scene", "air", "stage"}) {
    below.insert(name);
    may[name] = below;
  }
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "src")) {
    if (!is_source(entry.path())) continue;
    const std::string folder = *fs::relative(entry.path(), kRoot / "src").begin();
    if (folder == "plugin.h") continue;
    ASSERT_TRUE(may.contains(folder)) << folder << " has no place in the order";
    Names allowed = may[folder];
    allowed.insert(folder);
    // Truth takes from the pipeline what is planned, and from the product nothing else.
    if (folder == "truth") allowed.insert("pipeline");
    // Stress shows surface stages a world as the pipeline does.
    if (folder == "stress") allowed.insert({"pipeline", "truth"});
    // Study compares the product with the truth, and shows it.
    if (folder == "study") allowed.insert({"pipeline", "truth", "picture"});
    check_file(entry.path(), allowed);
  }
}

TEST(layering, plugin_h_needs_nothing_of_ours) { check_file(kRoot / "src/plugin.h", {}); }

// Truth and pipeline meet plugins only through the registry. (Tests may look anywhere.)
TEST(layering, a_plugin_uses_the_library_and_no_other_plugin) {
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "plugins")) {
    const std::string stem = entry.path().stem().string();
    if (!is_source(entry.path()) || stem == "test" || stem.ends_with("_test")) continue;
    check_file(entry.path(), {"num", "image", "params", "scene", "air", "stage"});
  }
}
