// A stage written as a class is the C table, and comes back from it unchanged.

#include "stage/stage.h"

#include <gtest/gtest.h>

#include "num/error.h"
#include "stage/instance.h"
#include "stage/module.h"

namespace {

using namespace brume;

// A stage in C++ whose declaration and failures go through the C table and back.
struct Toy : Stage {
  static constexpr StageAbout about{"toy", "A toy.", BRUME_AIR, BRUME_BACKGROUND_STEP,
                                    "Toymaker 1999"};
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
    v("whole", whole, {.doc = "Whole.", .knob = true, .curve = {2, 0.1, 4, 0.02}});
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
  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    if (whole == 7) throw std::domain_error("seven is too much");
    for (std::size_t i = 0; i < rays.n; ++i)
      for (int c = 0; c < 3; ++c) L[c][i] = float(number) * t1[i], T[c][i] = rays.dx[i];
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

TEST(CxxStage, ItsBaselineAnswersAndFailsThroughTheCTable) {
  const std::vector<StageType> types = read_plugin(toy_plugin, "toys");
  EXPECT_EQ(types[0].baseline, "Toymaker 1999");
  StageCache cache;
  Settings s = Settings::defaults(types[0].specs);
  const float d[2] = {0.25f, 0.5f}, t1[2] = {10, 100};
  float L[3][2], T[3][2];
  float* const to_L[3] = {L[0], L[1], L[2]};
  float* const to_T[3] = {T[0], T[1], T[2]};
  const brume_rays rays{2, nullptr, nullptr, nullptr, d, d, d};
  StageInstance(types[0], "toy", s.at(0), cache).baseline(rays, t1, to_L, to_T);
  EXPECT_EQ(L[2][1], 200);
  EXPECT_EQ(T[0][0], 0.25f);
  s.set("whole", "7", {}, "toy");
  try {
    StageInstance(types[0], "toy", s.at(0), cache).baseline(rays, t1, to_L, to_T);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "toys: toy: baseline: seven is too much");
  }
}

// A lens with a truth and a source; it promises both laws.
struct Half : Stage {
  static constexpr StageAbout about{
      "half", "Half the light.", BRUME_LENS, BRUME_BACKGROUND_STEP, "Nobody 1900", true};
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame&, StageNeeds& n) override {
    n.laws = BRUME_LINEAR | BRUME_KEEPS_LIGHT;
  }
  void run(const brume_tile& t) const override { t.r[0] *= 0.5f; }
  void run_baseline(const brume_tile& t) const override {
    if (t.width > 1) throw std::domain_error("one pixel at a time");
    t.r[0] = 7;
  }
  void truth(const brume_tile& t, std::span<const int> xy, double* rgb) const override {
    for (std::size_t k = 0; k < xy.size() / 2; ++k) rgb[3 * k] = t.r[xy[2 * k]] / 2.;
  }
};

TEST(CxxStage, APixelStagesTruthAndSourceAnswerThroughTheCTable) {
  const std::vector<StageType> types =
      read_plugin([] { return detail::plugin_info<Half, Toy>("1"); }, "toys");
  EXPECT_EQ(types[0].baseline, "Nobody 1900");
  EXPECT_EQ(types[0].table.baseline, nullptr);
  EXPECT_EQ(types[1].table.baseline_run, nullptr);  // air has rays
  EXPECT_EQ(types[1].table.truth, nullptr);
  StageCache cache;
  StageInstance half(types[0], "half", {}, cache);
  EXPECT_EQ(half.needs({}).laws, BRUME_LINEAR | BRUME_KEEPS_LIGHT);
  float r[2] = {3, 5};
  brume_tile tile{};
  tile.width = 1, tile.height = 1, tile.r = r;
  const int xy[] = {1, 0, 0, 0};
  double rgb[6] = {};
  half.truth(tile, xy, rgb);
  EXPECT_EQ(rgb[0], 2.5);
  EXPECT_EQ(rgb[3], 1.5);
  half.run_baseline(tile);
  EXPECT_EQ(r[0], 7);
  tile.width = 2;
  EXPECT_THROW(half.run_baseline(tile), Error);
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
