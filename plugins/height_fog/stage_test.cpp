// Height fog as a stage: its needs, its module and the same linked in, its example and
// its README.

#include <gtest/gtest.h>

#include <cstring>

#include "../../tests/stage/generated.h"
#include "fog_air_test.h"

namespace height_fog {
namespace {

TEST(HeightFog, HasNothingToDoWithoutDensityOrOpacity) {
  const StageType& type = FogAir::registry().find("height_fog");
  StageCache cache;
  const auto idle = [&](const char* name, const char* value) {
    Settings s = Settings::defaults(type.specs);
    s.set(name, value, {}, "height_fog");
    return StageInstance(type, "height_fog", s.at(0), cache).needs({}).idle;
  };
  EXPECT_EQ(idle("density", "0"), "density is 0");
  EXPECT_EQ(idle("max_opacity", "0"), "max_opacity is 0");
  EXPECT_EQ(idle("density", "0,0,1e-30"), "");
}

TEST(HeightFog, OnlyUniformFogDoesWithoutACamera) {
  const StageType& type = FogAir::registry().find("height_fog");
  StageCache cache;
  Settings s = Settings::defaults(type.specs);
  EXPECT_TRUE(StageInstance(type, "height_fog", s.at(0), cache).needs({}).camera);
  s.set("falloff", "0", {}, "height_fog");
  s.set("start", "12", {}, "height_fog");
  const StageNeeds n = StageInstance(type, "height_fog", s.at(0), cache).needs({});
  EXPECT_FALSE(n.camera);
  EXPECT_TRUE(n.depth);
  EXPECT_EQ(n.nearest, 12);
}

TEST(HeightFog, AsModuleAndLinkedInItGivesTheSameBits) {
  const Set set = {{"density", "0.001,0.02,0.3"}, {"height", "12"},  {"falloff", "0.07"},
                   {"color", "0.1,0.2,0.3"},      {"albedo", "0.5"}, {"g", "0.3"},
                   {"max_opacity", "0.9"},        {"start", "3"}};
  const FogAir module(set, at(30), false), linked(set, at(30), true);
  EXPECT_NE(FogAir::registry().find("height_fog").from,
            FogAir::inside().find("height_fog").from);
  const brume_medium &a = module.world().media[0].what, &b = linked.world().media[0].what;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(a.extinction[i], b.extinction[i]);
    EXPECT_EQ(a.albedo[i], b.albedo[i]);
    EXPECT_EQ(a.color[i], b.color[i]);
    EXPECT_EQ(a.origin[i], b.origin[i]);
  }
  std::vector<Ray> rays;
  for (int i = 0; i < 200; ++i) rays.push_back(climbing(i / 100.0 - 1, i * i / 10.0));
  const auto x = module(rays), y = linked(rays);
  EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(Answer)), 0);
}

TEST(HeightFog, TakesItsSourceFromTheSkyWhenAsked) {
  const FogAir fog({{"color", "sky"}}, at(0));
  EXPECT_EQ(fog.world().media[0].what.source, BRUME_SOURCE_SKY);
}

TEST(HeightFog, ItsExampleIsAScene) {
  const SceneFile scene = test::example_of("height_fog");
  ASSERT_EQ(scene.stages.size(), 1u);
  EXPECT_EQ(scene.stages[0].type, "height_fog");
}

TEST(HeightFog, ItsReadmeIsFresh) {
  const std::string file = "plugins/height_fog/README.md";
  test::expect_generated(file, "parameters",
                         markdown_table(FogAir::registry().specs("height_fog")));
  char rows[512];
  std::snprintf(rows, sizeof rows,
                "| of | bound |\n|---|---|\n"
                "| T, absolute | %.0e + eps abs(c dz) / e |\n"
                "| 1 - T, relative | %.0e + eps abs(c dz) |\n",
                kErrorT, kErrorOpacity);
  test::expect_generated(file, "errors", rows);
}

}  // namespace
}  // namespace height_fog
