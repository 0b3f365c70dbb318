// What the registry finds and in which order, and what it says of a name that it does not
// know.

#include "stage/registry.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <thread>

#include "num/error.h"
#include "stage/instance.h"
#include "stage/stage.h"

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

// A stage in C++ whose declaration and failures go through the C table and back.
struct Toy : Stage {
  static constexpr StageAbout about{"toy", "A toy.", BRUME_AIR};
  double number = 2;
  int whole = 3;
  bool flag = true;
  Rgb rgb{1, 2, 3};
  RgbOr sky{{}, "sky"};
  Vec3 vec{4, 5, 6};
  std::vector<double> list{7, 8};
  Matrix4 matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::string text = "hello", choice = "b";
  double far = std::numeric_limits<double>::infinity();
  template <class V>
  void describe(V& v) {
    v("number", number, {.unit = "m", .doc = "A number.", .minimum = 0, .maximum = 9});
    v("whole", whole, {.doc = "Whole.", .knob = true});
    v("flag", flag, {.animatable = false});
    v("rgb", rgb, {});
    v("sky", sky, {.words = {"sky", "sun"}});
    v("vec", vec, {});
    v("list", list, {});
    v("matrix", matrix, {});
    v("text", text, {});
    v("choice", choice, {.words = {"a", "b"}});
    v("far", far, {.infinite = true});
  }
  void prepare(const Shared& shared) override {
    if (text == "no table")
      shared.table<int>("toy:none", []() -> std::unique_ptr<int> {
        throw std::runtime_error("the table cannot be");
      });
    table = &shared.table<double>("toy:" + text,
                                  [&] { return std::make_unique<double>(number); });
  }
  void publish(const brume_frame&, Publisher& world) override {
    brume_medium m = new_medium();
    m.extinction[0] = number;
    m.extinction[1] = whole + flag;
    m.extinction[2] = *table;
    world.medium(m);
    if (choice == "a") throw std::logic_error("a is not for publishing");
  }
  const double* table = nullptr;
};

const brume_plugin_info* toy_plugin() { return detail::plugin_info<Toy>("2.1"); }

TEST(CxxStage, ItsDeclarationComesBackUnchangedThroughTheCTable) {
  const std::vector<StageType> types = read_plugin(toy_plugin, "toys");
  ASSERT_EQ(types.size(), 1u);
  EXPECT_EQ(types[0].version, "2.1");
  EXPECT_EQ(types[0].specs, specs_of<Toy>());
}

TEST(CxxStage, ValuesReachItsMembersAndTablesAreShared) {
  const std::vector<StageType> types = read_plugin(toy_plugin, "toys");
  StageCache cache;
  Settings s = Settings::defaults(types[0].specs);
  s.set("number", "5", {}, "toy");
  World world;
  StageInstance first(types[0], "first", s.at(0), cache);
  s.set("number", "6", {}, "toy");
  StageInstance second(types[0], "second", s.at(0), cache);
  first.publish({}, 0, world);
  second.publish({}, 1, world);
  ASSERT_EQ(world.media.size(), 2u);
  EXPECT_EQ(world.media[0].what.extinction[0], 5);
  EXPECT_EQ(world.media[1].what.extinction[0], 6);
  EXPECT_EQ(world.media[1].what.extinction[1], 4);
  EXPECT_EQ(world.media[1].what.extinction[2], 5);  // the table that the first one built
}

TEST(CxxStage, WhatItThrowsIsItsMessage) {
  const std::vector<StageType> types = read_plugin(toy_plugin, "toys");
  StageCache cache;
  Settings s = Settings::defaults(types[0].specs);
  const auto error = [&] {
    try {
      World world;
      StageInstance i(types[0], "toy", s.at(0), cache);
      i.publish({}, 0, world);
      return std::string();
    } catch (const Error& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(error(), "");
  s.set("choice", "a", {}, "toy");
  EXPECT_EQ(error(), "toys: toy: publish: a is not for publishing");
  s.set("text", "no table", {}, "toy");
  EXPECT_EQ(error(), "toys: toy: create: the table cannot be");
}

}  // namespace
