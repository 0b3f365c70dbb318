// Facts about noise fog, asked of the product's own path (registry, module, stage, World,
// integrator).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "../../tests/stage/generated.h"
#include "fogs_test.h"
#include "scene/scene_file.h"
#include "truth/truth.h"

namespace {

using namespace brume;
using namespace brume::test;

TEST(NoiseFog, SmoothFogIsHeightFog) {
  ThroughAir noise, height;
  noise.add("noise_fog", {{"contrast", "0"}, {"color", "1"}}).compile();
  height.add("height_fog", {{"density", "0.004"}, {"color", "1"}}).compile();
  Random r(3);
  for (int i = 0; i < 300; ++i) {
    const Ray ray = toward(unit(r, .1), i % 9 ? std::pow(10, r.uniform(0, 5)) : kInf);
    for (int c = 0; c < 3; ++c) {
      // Two closed forms of some ten roundings each.
      EXPECT_NEAR(noise(ray).T[c], height(ray).T[c], 10 * kEps);
      EXPECT_NEAR(noise(ray).L[c], height(ray).L[c], 10 * kEps);
    }
  }
}

Set drifting(double wind = 0) {
  return {{"density", "0.004"},      {"falloff", "0.01"}, {"size", "80"},
          {"octaves", "4"},          {"contrast", "0.9"}, {"color", "1"},
          {"wind", text(wind, 0, 0)}};
}

TEST(NoiseFog, StaysPutInTheWorldWhenTheCameraMoves) {
  // Two views: what the second sees between two places of the world, the first sees
  // between them too.
  FrameInfo first = eye_at(100, -40, 30), second = eye_at(400, -40, 30);
  first.pixel_footprint = second.pixel_footprint = 1e-6;  // the pixel blurs nothing
  ThroughAir a(first), b(second);
  a.add("noise_fog", drifting()).compile(1e-4);
  b.add("noise_fog", drifting()).compile(1e-4);
  double moved = 0;
  for (int i = 1; i <= 40; ++i) {
    const double T =
        a(toward({1, 0, 0}, 300 + 20. * i)).T[1] / double(a(toward({1, 0, 0}, 300)).T[1]);
    EXPECT_NEAR(b(toward({1, 0, 0}, 20. * i)).T[1], T, 6e-4) << i;  // 3 answers, T > .3
    moved = std::max(moved, std::abs(double(a(toward({1, 0, 0}, 20. * i)).T[1]) - T));
  }
  EXPECT_GT(moved, 0.02);  // fog that went along with the camera would not be told
}

TEST(NoiseFog, MovesWithTheWind) {
  FrameInfo later = eye_at(0, 0, 30);
  later.time = 20;
  ThroughAir now(eye_at(60, 0, 30)), blown(later);
  now.add("noise_fog", drifting()).compile(1e-4);
  blown.add("noise_fog", drifting(-3)).compile(1e-4);
  for (int i = 1; i <= 20; ++i) {
    const Ray ray = toward({0.6, 0.8, 0}, 50. * i);
    EXPECT_NEAR(now(ray).T[0], blown(ray).T[0], 2e-4) << i;
  }
}

TEST(NoiseFog, AgreesWithTheTruthAloneAndAmongOthers) {
  Random r(31);
  double worst = 0;
  for (int scene = 0; scene < 6; ++scene) {
    FrameInfo frame =
        eye_at(r.uniform(-1e3, 1e3), r.uniform(-1e3, 1e3), r.uniform(2, 60));
    frame.pixel_footprint = 1e-3;
    ThroughAir air(frame);
    Set set = drifting();
    set.push_back({"seed", std::to_string(scene)});
    if (scene == 1) set.push_back({"clearing", "20"});
    if (scene == 2) set.push_back({"max_opacity", "0.5"});
    if (scene == 3) set.push_back({"start", "100"});
    air.add("noise_fog", set);
    if (scene >= 4)
      air.add("height_fog", {{"density", "0.003"}, {"color", "0.1,0.2,0.9"}});
    air.compile(1e-3);
    for (int i = 0; i < 8; ++i) {
      Point d = unit(r, .2);
      d = rounded(d);
      const Ray ray = toward(d, std::pow(10, r.uniform(1.5, 3)));
      const auto got = air(ray);
      const auto want = truth::along(air.world(), frame.eye, {d[0], d[1], d[2]}, ray.t,
                                     {.tolerance = 1e-6});
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(got.T[c], want.T[c], kTolerance) << scene << ", " << i;
        EXPECT_NEAR(got.L[c], want.L[c], kTolerance * (1 + want.L[c]))
            << scene << ", " << i;
        worst = std::max(worst, std::abs(got.L[c] - want.L[c]));
      }
    }
  }
  std::printf("6 scenes against the truth: largest error of L %.1e\n", worst);
}

TEST(NoiseFog, InAnOrthographicViewPixelsAreNoWiderFarAway) {
  // 2 m wide, a fifth of the finest cells: an octave keeps e^(-10 x 0.01) of itself. Read
  // as an angle it would be a pixel of a kilometre at 500 m.
  FrameInfo flat = eye_at(100, 50, 10), fine = flat;
  flat.projection = Projection::orthographic;
  flat.pixel_footprint = 2;
  fine.pixel_footprint = 1e-6;
  FrameInfo angle = flat;
  angle.projection = Projection::perspective;
  ThroughAir a(flat), b(fine), c(angle);
  for (ThroughAir* air : {&a, &b, &c}) air->add("noise_fog", drifting()).compile(1e-4);
  double near = 0, far = 0;
  for (int i = 1; i <= 20; ++i) {
    const Ray ray = toward({0.6, 0.8, 0}, 50. * i);
    near = std::max(near, std::abs(double(a(ray).T[0]) - b(ray).T[0]));
    far = std::max(far, std::abs(double(c(ray).T[0]) - b(ray).T[0]));
  }
  EXPECT_LE(near, far / 10);
  EXPECT_GE(far, 0.02);  // or it said nothing
}

TEST(NoiseFog, ALampGlowsInItAsTheTruthSays) {
  FrameInfo frame = eye_at(0, 0, 10);
  frame.pixel_footprint = 1e-3;
  ThroughAir air(frame);
  Set set = drifting();
  set.push_back({"albedo", "0.9"});
  set.push_back({"g", "0.3"});
  air.add("noise_fog", set);
  air.add("point_light",
          {{"position", "60,0,12"}, {"power", "800,600,300"}, {"radius", "0.2"}});
  air.compile(1e-3);
  for (const Point& d : {Point{1, 0, 0}, Point{.995, .0998749, 0}, Point{.6, .8, 0}}) {
    const Ray ray = toward(d, 150);
    const auto got = air(ray);
    const auto want = truth::along(air.world(), frame.eye, {ray.d[0], ray.d[1], ray.d[2]},
                                   ray.t, {.tolerance = 1e-5});
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(got.L[c], want.L[c], kTolerance * (1 + want.L[c])) << d[1];
  }
}

TEST(NoiseFog, TheOrderOfStagesChangesNoBit) {
  const Set other = {{"density", "0.01"}, {"color", "0.9,0.1,0.1"}};
  ThroughAir ab, ba;
  ab.add("noise_fog", drifting()).add("height_fog", other).compile();
  ba.add("height_fog", other).add("noise_fog", drifting()).compile();
  std::vector<Ray> rays;
  for (int i = 0; i < 37; ++i)
    rays.push_back(toward({std::cos(.1 * i), std::sin(.1 * i), 0}, 30. * i));
  EXPECT_TRUE(same_bits(ab(rays), ba(rays)));
}

TEST(NoiseFog, HasNothingToDoWithoutDensityOrOpacity) {
  ThroughAir air;
  air.add("noise_fog", {{"density", "0"}}).add("noise_fog", {{"max_opacity", "0"}});
  EXPECT_EQ(air.needs(0).idle, "density is 0");
  EXPECT_EQ(air.needs(1).idle, "max_opacity is 0");
}

TEST(NoiseFog, ItsReadmeIsFresh) {
  expect_generated("plugins/noise_fog/README.md", "parameters",
                   markdown_table(ThroughAir::registry().specs("noise_fog")));
}

}  // namespace
