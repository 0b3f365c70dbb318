// The tutorial plugin, built as a stranger would: one header, one C compiler.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "../../tests/stage/generated.h"
#include "num/error.h"
#include "stage/instance.h"
#include "stage/registry.h"

namespace {

using namespace brume;
namespace fs = std::filesystem;

class Outside : public testing::Test {
 protected:
  Outside()
      : folder_(fs::temp_directory_path() / ("brume_out_" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "include/brume");
    fs::copy_file(BRUME_SOURCE_DIR "/src/plugin.h", folder_ / "include/brume/plugin.h");
    fs::copy_file(BRUME_SOURCE_DIR "/plugins/null/stage.c", folder_ / "null.c");
  }
  ~Outside() override {
    unsetenv("BRUME_PLUGIN_PATH");
    fs::remove_all(folder_);
  }
  // The command of plugins/null/README.md, with every warning an error.
  int compile(const std::string& more) const {
    const std::string f = folder_.string();
    return std::system(
        (C_COMPILER " -std=c99 -Wall -Wextra -Wpedantic -Werror -shared -fPIC "
                    "-I" +
         f + "/include " + f + "/null.c -o " + f + "/brume_null.so " + more)
            .c_str());
  }
  fs::path folder_;
};

TEST_F(Outside, NullBuildsWithTheHeaderAloneAndIsFoundInThePluginPath) {
  ASSERT_EQ(compile(""), 0);
  setenv("BRUME_PLUGIN_PATH", ("/nonexistent::" + folder_.string()).c_str(), 1);
  Registry registry({.files = {}, .use_linked = false});
  const StageType& t = registry.find("null");
  EXPECT_EQ(t.from, (folder_ / "brume_null.so").string());  // before the build tree's own

  StageCache cache;
  Settings s = Settings::defaults(t.specs);
  World world;
  StageInstance clear(t, "null", s.at(1), cache);
  EXPECT_EQ(clear.needs({}).idle, "density is 0");

  s.set("density", "0.25", {}, "null");
  StageInstance mist(t, "null", s.at(1), cache);
  EXPECT_EQ(mist.needs({}).idle, "");
  mist.publish({}, 0, world);
  ASSERT_EQ(world.media.size(), 1u);
  EXPECT_EQ(world.media[0].what.profile, BRUME_UNIFORM);
  EXPECT_EQ(world.media[0].what.extinction[2], 0.25);
}

TEST_F(Outside, TheHeaderIsCxxToo) {
  std::ofstream(folder_ / "use.cpp") << "#include <brume/plugin.h>\nint main() {}\n";
  const std::string f = folder_.string();
  EXPECT_EQ(std::system((C_COMPILER " -x c++ -std=c++11 -Wall -Wextra -Wpedantic -Werror "
                                    "-fsyntax-only -I" +
                         f + "/include " + f + "/use.cpp")
                            .c_str()),
            0);
}

TEST(Null, ItsReadmeListsItsParameters) {
  Registry registry;
  test::expect_generated("plugins/null/README.md", "parameters",
                         markdown_table(registry.specs("null")));
}

}  // namespace
