// A broken module is one line that names the file, what was found and what was expected.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "num/error.h"
#include "stage/registry.h"

namespace {

using namespace brume;
namespace fs = std::filesystem;

Registry::Options only(const fs::path& folder) {
  return {.files = {},
          .use_environment = false,
          .use_linked = false,
          .use_trees = false,
          .folders = {folder}};
}

// The error that naming a stage gives; "" when it is found.
std::string error_of(Registry& registry, const std::string& stage) {
  try {
    registry.find(stage);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(BrokenModule, IsAnErrorThatNamesFileFoundAndExpected) {
  struct Case {
    const char *module, *says;
  };
  const Case cases[] = {
      {"wrong_abi", "built for plugin interface 43; this brume has 2"},
      {"no_symbol", "no symbol brume_plugin; a stage plugin exports it"},
      {"null_info", "brume_plugin returned no table"},
      {"small_info", "brume_plugin_info of 24 bytes; expected at least"},
      {"empty_info", "brume_plugin_info of 0 bytes; expected at least"},
      {"no_list", "a plugin with 1 stages and no list of them"},
      {"no_stages", "a plugin with 0 stages"},
      {"null_stage", "a stage that is null"},
      {"small_stage", "brume_stage of 16 bytes; expected at least"},
      {"other_stage", "carries no stage other_stage; it carries another"},
      {"stage_name", "a stage named \"../../etc/passwd\"; a name is a-z, 0-9 and _"},
      {"stage_twice", "carries two stages named stage_twice"},
      {"stage_role", "stage stage_role: role 9 is none of brume_role"},
      {"no_create", "stage no_create has no function create"},
      {"no_publish", "stage no_publish has no function publish"},
      {"no_run", "stage no_run has no function run"},
      {"param_reserved", "param_reserved.mix: the name is taken by every stage"},
      {"param_name", "stage param_name has a parameter named \"Not a name\""},
      {"param_kind", "param_kind.amount: kind 77 is none of brume_kind"},
      {"param_range", "param_range.amount: its range is empty"},
      {"param_count", "the default of param_count.amount is not allowed"},
      {"param_size", "stage param_size: parameters of different sizes"},
      {"param_twice", "stage param_twice has two parameters named amount"},
      {"param_default",
       "the default of param_default.other is not allowed; "
       "param_default.other = 1"},
      {"param_curve", "param_curve.amount: its curve makes no sense at 2.0"},
      {"throwing_entry", "brume_plugin threw an exception; it must return a table"},
  };
  Registry registry(only(BROKEN_FOLDER));
  for (const Case& c : cases) {
    const std::string error = error_of(registry, c.module);
    EXPECT_NE(error.find(std::string("brume_") + c.module + ".so: "), std::string::npos)
        << c.module << ": " << error;
    EXPECT_NE(error.find(c.says), std::string::npos) << c.module << ": " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(BrokenModule, TheSameModuleWithNothingBrokenIsFound) {
  Registry registry(only(BROKEN_FOLDER));
  const StageType& t = registry.find("nothing");
  EXPECT_EQ(t.version, "0.1");
  // Its structs are larger than ours, as a newer plugin's would be.
  ASSERT_EQ(t.specs.size(), 2u);
  EXPECT_EQ(t.specs[1].name, "other");
  EXPECT_EQ(t.specs[1].maximum, 1);
}

TEST(BrokenModule, AnOlderOneLacksWhatCameLater) {
  Registry registry(only(BROKEN_FOLDER));
  const StageType& t = registry.find("older");
  EXPECT_EQ(t.specs.size(), 2u);
  EXPECT_EQ(t.table.baseline_name, nullptr);  // beyond the size that it states
  EXPECT_EQ(t.baseline, "");
}

TEST(BrokenModule, ListingAllStagesLeavesTheBrokenOutAndNamesThem) {
  Registry registry(only(BROKEN_FOLDER));
  std::vector<std::string> broken;
  const auto all = registry.all(&broken);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0]->name, "misbehaves");
  EXPECT_EQ(all[1]->name, "nothing");
  EXPECT_EQ(all[2]->name, "older");
  EXPECT_EQ(broken.size(), 26u);  // as many as there are cases above
}

TEST(BrokenModule, AFileThatIsNoSharedObject) {
  const fs::path folder =
      fs::temp_directory_path() / ("brume_text_" + std::to_string(getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "brume_text.so") << "this is text";
  std::ofstream(folder / "brume_empty.so");
  fs::create_directories(folder / "brume_folder.so");
  fs::create_symlink("nowhere", folder / "brume_dangling.so");
  Registry registry(only(folder));
  EXPECT_NE(
      error_of(registry, "text").find("brume_text.so: cannot be opened as a plugin; "),
      std::string::npos);
  EXPECT_NE(error_of(registry, "empty").find("cannot be opened as a plugin"),
            std::string::npos);
  EXPECT_NE(error_of(registry, "folder").find("cannot be opened as a plugin"),
            std::string::npos);
  EXPECT_NE(error_of(registry, "dangling"), "");
  fs::remove_all(folder);
}

TEST(BrokenModule, GivenByHandItFailsAtOnce) {
  Registry::Options options = only("/nonexistent");
  options.files = {fs::path(BROKEN_FOLDER) / "brume_wrong_abi.so"};
  EXPECT_THROW(Registry{options}, Error);
  options.files = {"/nonexistent/brume_sky.so"};
  EXPECT_THROW(Registry{options}, Error);
}

}  // namespace
