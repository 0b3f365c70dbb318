// What the registry finds and in which order, and what it says of a name that it does not
// know.

#include "stage/registry.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <thread>

#include "num/error.h"
#include "stage/instance.h"

namespace {

using namespace brume;
namespace fs = std::filesystem;

Registry::Options trees_only() {
  return {.files = {}, .use_environment = false, .use_linked = false};
}

std::string error_of(Registry& r, const std::string& name) {
  try {
    r.find(name, {"shot.toml", 3, 8});
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

TEST(Registry, FindsABuiltStageBesideTheProgram) {
  Registry r(trees_only());
  const StageType& t = r.find("height_fog");
  EXPECT_EQ(t.name, "height_fog");
  EXPECT_EQ(fs::path(t.from).filename(), "brume_height_fog.so");
  EXPECT_EQ(&t, &r.find("height_fog"));
}

TEST(Registry, OpensNothingBeforeItIsNamed) {
  Registry r({.files = {},
              .use_environment = false,
              .use_linked = false,
              .use_trees = false,
              .folders = {BROKEN_FOLDER}});
  // Every one of these modules would fail.
  EXPECT_GT(r.names().size(), 20u);
}

TEST(Registry, AnUnknownStageGivesTheNearestName) {
  Registry r(trees_only());
  EXPECT_EQ(error_of(r, "hieght_fog"),
            "shot.toml:3:8: no stage \"hieght_fog\"; did you mean height_fog?");
  EXPECT_NE(error_of(r, "xylophone").find("known: "), std::string::npos);
  EXPECT_NE(error_of(r, "../plugins/brume_null"), "");
  EXPECT_NE(error_of(r, ""), "");
  EXPECT_NE(error_of(r, std::string(1 << 20, 'x')), "");
  Registry nothing({.files = {},
                    .use_environment = false,
                    .use_linked = false,
                    .use_trees = false,
                    .folders = {"/nonexistent"}});
  EXPECT_EQ(error_of(nothing, "fog"),
            "shot.toml:3:8: no stage \"fog\"; no plugin in /nonexistent");
}

TEST(Registry, AFileGivenByHandGoesBeforeTheSearch) {
  const fs::path copy =
      fs::temp_directory_path() / ("brume_by_hand_" + std::to_string(getpid()) + ".so");
  fs::copy_file(Registry(trees_only()).find("null").from, copy,
                fs::copy_options::overwrite_existing);
  Registry::Options options = trees_only();
  options.files = {copy};
  Registry r(options);
  EXPECT_EQ(r.find("null").from, copy.string());
  // Twice the same stage by hand: which one is meant?
  options.files = {copy, Registry(trees_only()).find("null").from};
  try {
    Registry twice(options);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("carries a stage null; " + copy.string() +
                                         " carries one too"),
              std::string::npos)
        << e.what();
  }
  fs::remove(copy);
}

TEST(Registry, ThreadsThatNameTheSameStageGetTheSameType) {
  Registry r(trees_only());
  std::vector<const StageType*> got(8);
  std::vector<std::thread> threads;
  for (auto& g : got) threads.emplace_back([&] { g = &r.find("height_fog"); });
  for (auto& t : threads) t.join();
  for (const auto* g : got) EXPECT_EQ(g, got[0]);
}

}  // namespace
