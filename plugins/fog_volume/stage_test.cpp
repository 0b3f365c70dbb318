// Fog volumes in the air, beside nothing and beside each other, and as a stage.

#include <gtest/gtest.h>

#include <random>

#include "../../tests/stage/generated.h"
#include "truth/truth.h"
#include "volumes_test.h"

namespace fog_volume {
namespace {

TEST(FogVolume, OutsideItNothingChanges) {
  const Volume v{.center = {0, 0, 50}, .half = {5, 5, 5}, .density = 1000};
  ThroughAir air;
  air.add("fog_volume", settings(v)).compile();
  for (const Ray& r : {toward({0, 0, 0}, {50, 0, 50}), toward({0, 0, 0}, {0, 0, -50}),
                       toward({0, 0, 0}, {0, 0, 50}, 44.9)}) {
    const Answer a = air(r);
    EXPECT_EQ(a.T[1], 1);
    EXPECT_EQ(a.L[1], 0);
  }
}

TEST(FogVolume, TwoThatOverlapAgreeWithTheTruth) {
  const unsigned seed = 20080304;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  for (int scene = 0; scene < 60; ++scene) {
    ThroughAir air;
    for (int k = 0; k < 2; ++k)
      air.add("fog_volume",
              {{"shape", uniform(0, 1) < .5 ? "box" : "ellipsoid"},
               {"center", text(uniform(-2, 2), uniform(-2, 2), uniform(15, 25))},
               {"half", text(uniform(2, 12), uniform(2, 12), uniform(2, 12))},
               {"rotation", text(uniform(0, 360), uniform(0, 360), uniform(0, 360))},
               {"density", text(uniform(.01, .5), uniform(.01, .5), uniform(.01, .5))},
               {"gradient", text(uniform(-1, 1), uniform(-1, 1), 1)},
               {"falloff", text(uniform(0, .4))},
               {"color", text(uniform(0, 1), uniform(0, 1), uniform(0, 1))}});
    air.compile(1e-3);
    std::vector<Ray> rays;
    for (int i = 0; i < 5; ++i)
      rays.push_back(toward({0, 0, 0}, {uniform(-9, 9), uniform(-9, 9), 20},
                            i % 2 ? kInf : uniform(5, 40)));
    const auto got = air(rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto t = truth::along(air.world(), {0, 0, 0},
                                  {rays[i].d[0], rays[i].d[1], rays[i].d[2]}, rays[i].t);
      for (std::size_t c = 0; c < 3; ++c) {
        const double error = std::abs(got[i].L[c] - t.L[c]);
        worst = std::max(worst, error);
        EXPECT_LE(error, 1e-3) << "seed " << seed << ", scene " << scene << ", ray " << i;
        EXPECT_NEAR(got[i].T[c], t.T[c], kError) << scene << ", ray " << i;
      }
    }
  }
  std::printf("60 scenes, seed %u: largest error of L %.1e at tolerance 1e-3\n", seed,
              worst);
}

TEST(FogVolume, TheOrderOfStagesChangesNoBit) {
  const Set one = {{"center", "0,0,20"}, {"half", "5,5,5"}, {"color", "1,0.5,0.2"}};
  const Set two = {{"center", "1,1,22"},
                   {"half", "4,3,6"},
                   {"color", "0,0.3,0.9"},
                   {"shape", "ellipsoid"}};
  ThroughAir ab, ba;
  ab.add("fog_volume", one).add("fog_volume", two).compile();
  ba.add("fog_volume", two).add("fog_volume", one).compile();
  std::vector<Ray> rays;
  for (int i = -30; i <= 30; ++i)
    rays.push_back(toward({0, 0, 0}, {i * .2L, i * .1L, 20}));
  EXPECT_TRUE(same_bits(ab(rays), ba(rays)));
}

TEST(FogVolume, EndsWhereItHidesMaxOpacityAndBeginsAtStart) {
  ThroughAir capped, late;
  capped.add("fog_volume", {{"center", "0,0,20"},
                            {"half", "5,5,5"},
                            {"density", "9"},
                            {"color", "1"},
                            {"max_opacity", "0.6"}});
  late.add("fog_volume", {{"center", "0,0,20"},
                          {"half", "5,5,5"},
                          {"density", "0.1"},
                          {"color", "1"},
                          {"start", "22"}});
  const Ray r = toward({0, 0, 0}, {0, 0, 20});
  // Its end is a float near 15.1 m: eps / 2 of that, times density and what T is there.
  EXPECT_NEAR(capped.compile()(r).L[0], 0.6, kEps / 2 * 15.2 * 9 * 0.4);
  EXPECT_NEAR(late.compile()(r).L[0], -std::expm1(-0.3), 1e-6);  // 22 m to 25 m
}

TEST(FogVolume, HasNothingToDoWithoutDensityOrOpacity) {
  ThroughAir air;
  air.add("fog_volume", {{"density", "0"}}).add("fog_volume", {{"max_opacity", "0"}});
  EXPECT_EQ(air.needs(0).idle, "density is 0");
  EXPECT_EQ(air.needs(1).idle, "max_opacity is 0");
}

TEST(FogVolume, ItsExampleIsAScene) {
  const SceneFile scene = example_of("fog_volume");
  ASSERT_GE(scene.stages.size(), 1u);
  EXPECT_EQ(scene.stages[0].type, "fog_volume");
}

TEST(FogVolume, ItsReadmeIsFresh) {
  expect_generated("plugins/fog_volume/README.md", "parameters",
                   markdown_table(ThroughAir::registry().specs("fog_volume")));
}

}  // namespace
}  // namespace fog_volume
