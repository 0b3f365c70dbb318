// Facts about lamps, asked of the product's own path; their truth is src/truth, and by
// hand where that is possible.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../tests/stage/generated.h"
#include "../../tests/stage/through_air.h"
#include "num/error.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using namespace brume::test;

constexpr float kInf = std::numeric_limits<float>::infinity();

Set fog() {
  return {{"center", "0,0,20"}, {"half", "15,10,18"}, {"density", "0.01,0.02,0.05"},
          {"color", "0"},       {"albedo", "0.9"},    {"g", "0.4"}};
}

Ray ray_to(double x, double y, double z, float t) {
  const double n = std::sqrt(x * x + y * y + z * z);
  return {{0, 0, 0}, {float(x / n), float(y / n), float(z / n)}, t};
}

void expect_truth(const ThroughAir& air, const std::vector<Ray>& rays,
                  const std::string& where, double& worst) {
  const auto got = air(rays);
  truth::Options options;
  options.tolerance = 1e-6;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto t =
        truth::along(air.world(), {0, 0, 0}, {rays[i].d[0], rays[i].d[1], rays[i].d[2]},
                     rays[i].t, options);
    for (std::size_t c = 0; c < 3; ++c) {
      const double error = std::abs(got[i].L[c] - t.L[c]) / (1 + t.L[c]);
      worst = std::max(worst, error);
      EXPECT_LE(error, 1e-3) << where << ", ray " << i << ": " << got[i].L[c] << ", not "
                             << t.L[c];  // the tolerance asked for
    }
  }
}

TEST(Lamps, GlowInABoxOfFogAsTheTruthSays) {
  const unsigned seed = 20080811;
  std::mt19937 random(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  double worst = 0;
  for (int scene = 0; scene < 12; ++scene) {
    Set lamp = {{"position", text(uniform(-8, 8), uniform(-8, 8), uniform(-4, 35))},
                {"power", "300,200,100"},
                {"radius", scene % 3 ? "0.1" : "0"}};
    const bool spot = scene % 2;
    if (spot) {
      lamp.push_back({"direction", text(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))});
      lamp.push_back({"cone", text(uniform(5, 90))});
      lamp.push_back({"cone_soft", text(uniform(1, 30))});
      lamp.push_back({"falloff", scene % 4 == 1 ? "smooth" : "ratio"});
    }
    ThroughAir air;
    air.add("fog_volume", fog()).add(spot ? "spotlight" : "point_light", lamp).compile();
    std::vector<Ray> rays;
    for (int i = 0; i < 3; ++i)
      rays.push_back(
          ray_to(uniform(-9, 9), uniform(-9, 9), 20, i ? float(uniform(5, 60)) : kInf));
    expect_truth(air, rays,
                 "seed " + std::to_string(seed) + ", scene " + std::to_string(scene),
                 worst);
  }
  std::printf("12 scenes, seed %u: largest error %.1e of 1 + L at tolerance 1e-3\n", seed,
              worst);
}

TEST(Lamps, AThinFogGlowsAsTheAirlightIntegralSays) {
  // tau -> 0, g = 0: L = power sigma albedo / (4 pi) Int dt / (h^2 + (t - tc)^2), here
  // from end to end of a long box: pi / h less the ends' 2 h / half.
  const double sigma = 1e-7, h = 2, half = 1e4;
  ThroughAir air;
  air.add("fog_volume", {{"center", "0,0,10000"},
                         {"half", "100,100,10000"},
                         {"density", text(sigma)},
                         {"color", "0"},
                         {"albedo", "1"}})
      .add("point_light", {{"position", "2,0,10000"}, {"power", "1"}})
      .compile(1e-5);
  const double L = sigma / (4 * M_PI) * (2 * std::atan(half / h) / h);
  // tau is 2e-3 along and 1e-3 to the lamp's foot: T of the peak is known.
  EXPECT_NEAR(air(Ray{{0, 0, 0}, {0, 0, 1}, kInf}).L[0] / (L * std::exp(-sigma * 1e4)), 1,
              1e-3);
}

TEST(Lamps, ASpotlightLeavesDarkWhatIsOutsideItsCone) {
  ThroughAir air;
  air.add("fog_volume", fog())
      .add("spotlight", {{"position", "0,5,20"},
                         {"direction", "0,1,0"},
                         {"cone", "30"},
                         {"power", "100"}})
      .compile();
  EXPECT_EQ(air(ray_to(0, 0, 1, kInf)).L[0], 0);   // below it, and it shines up
  EXPECT_GT(air(ray_to(0, 8, 20, kInf)).L[0], 0);  // through its cone
}

TEST(Lamps, ASunIsTheSameEverywhereAndDimmedByTheFog) {
  double worst = 0;
  ThroughAir air;
  air.add("fog_volume", fog())
      .add("sun_light", {{"direction", "1,-2,-1"}, {"irradiance", "3,2,1"}})
      .compile();
  EXPECT_GT(air.world().lights[0].what.direction[1], 0.8);  // toward it
  expect_truth(air, {ray_to(0, 0, 1, kInf), ray_to(5, 3, 20, 30)}, "sun", worst);
}

TEST(Lamps, TheOrderOfStagesChangesNoBit) {
  const Set a = {{"position", "0,5,20"}, {"power", "100"}},
            b = {{"position", "3,2,9"}, {"power", "50,20,5"}, {"cone", "60"}};
  ThroughAir one, two;
  one.add("fog_volume", fog()).add("point_light", a).add("spotlight", b).compile();
  two.add("spotlight", b).add("point_light", a).add("fog_volume", fog()).compile();
  std::vector<Ray> rays;
  for (int i = -10; i <= 10; ++i) rays.push_back(ray_to(i * .5, i * .2, 20, kInf));
  EXPECT_TRUE(same_bits(one(rays), two(rays)));
}

TEST(Lamps, WithoutPowerTheyHaveNothingToDo) {
  ThroughAir air;
  air.add("point_light", {{"power", "0"}}).add("sun_light", {{"irradiance", "0"}});
  EXPECT_EQ(air.needs(0).idle, "power is 0");
  EXPECT_EQ(air.needs(1).idle, "irradiance is 0");
}

TEST(Lamps, ADirectionOfNoLengthIsAnError) {
  EXPECT_THROW(ThroughAir().add("spotlight", {{"direction", "0,0,0"}}), Error);
}

TEST(Lamps, TheirExampleIsAScene) {
  const SceneFile scene = example_of("lamps");
  EXPECT_EQ(scene.stages.size(), 3u);
}

TEST(Lamps, TheirReadmeIsFresh) {
  for (const char* stage : {"point_light", "spotlight", "sun_light"})
    expect_generated("plugins/lamps/README.md", stage,
                     markdown_table(ThroughAir::registry().specs(stage)));
}

}  // namespace
