// Facts about the sun's light and the sky's on surfaces.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "frames_test.h"
#include "truth/shown.h"

namespace {

using namespace relight::test;
using relight::oracle::irradiance;

TEST_F(Relight, SkyLightIsTheHemisphereAboutTheNormal) {
  Frame f = frame_of(nearest({sphere({0, 10, 2}, 2), plane({0, 0, 0}, {0, 0, 1})}));
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    for (int k = 0; k < 3; ++k)
      f.planes["N." + std::string(1, "XYZ"[k])].push_back(float(f.truth[i].n[k]));
  for (const double elevation : {50., 4.}) {
    const std::string sky = "[sun]\nelevation = " + number(elevation) +
                            "\nazimuth = 200\n[[stage]]\ntype = \"sky\"\n";
    const std::string scene =
        "[output]\naovs = [\"S\"]\n[[stage]]\ntype = \"relight\"\nlamps = false\nsky = "
        "true\nalbedo = 1\n";
    const Out out = run(f, scene + sky);
    Session session(brume::test::scene_of(registry, f.camera + scene + sky), registry);
    const PreparedFrame prepared = session.prepare(source_of(f));
    const auto& lights = prepared.impl().world.lights;
    const auto light = std::ranges::find_if(
        lights, [](const auto& l) { return l.what.kind == BRUME_SKY_LIGHT; });
    ASSERT_NE(light, lights.end());
    const auto radiance = [&](const dvec3& d) {
      const float v[3] = {float(d.x), float(d.y), float(d.z)};
      const brume_rays one = {1, nullptr, nullptr, nullptr, v, v + 1, v + 2};
      float L[3];
      light->what.radiance(light->what.self, &one, L, L + 1, L + 2);
      return OracleRgb{L[0], L[1], L[2]};
    };
    std::vector<std::size_t> pixels;
    std::vector<dvec3> normals;
    for (int y = 8; y < f.height; y += 8)
      for (int x = 24; x < 72; x += 6)
        if (f.covered(f.at(x, y))) {
          pixels.push_back(f.at(x, y));
          normals.push_back(f.truth[pixels.back()].n);
        }
    // Seen from 4 m the horizon lies a little below the eye.
    const auto E = irradiance(radiance, normals, (90 - 200) * M_PI / 180,
                              -std::acos(6360e3 / (6360e3 + 4)));
    double brightest = 0, worst = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) {
        const double got = out[std::string("S.") + kChannels[c]][pixels[k]] - .1;
        brightest = std::max(brightest, E[k][c]);
        worst = std::max(worst, std::abs(M_PI * got - E[k][c]));
      }
    std::printf("sky, sun at %g degrees: off by %.1e of the brightest\n", elevation,
                worst / brightest);
    EXPECT_LT(worst / brightest, 1e-4);  // README, "Error"; the oracle's cells: 5e-5
  }
}

TEST_F(Relight, SkyLightIsAsGoodAsItPromises) {
  // White surfaces of any normal: worst beside the bright rim of the sky, where normals
  // lean from up or down by as little as the rim is wide, and by a low sun's glow.
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  std::vector<dvec3> normals;
  for (int i = 0; i < 120; ++i) {
    const double z = -1 + 2 * i / 119., phi = 2.399963 * i,  // the golden angle
        lean = std::pow(10., -4 + i / 30.), s = std::sqrt(1 - z * z);
    normals.push_back({s * std::cos(phi), s * std::sin(phi), z});
    if (lean < .4)
      normals.push_back({std::sin(lean) * std::cos(phi), std::sin(lean) * std::sin(phi),
                         (i % 2 ? -1 : 1) * std::cos(lean)});
  }
  double worst = 0, promised = 0;
  struct {
    double elevation, height;
  } const cases[] = {{50, 4}, {12, 500}, {4, 4}, {1, 2e4}, {12, 4e5}};
  for (const auto& [elevation, height] : cases) {
    std::string camera = f.camera;
    camera.replace(camera.find("[0, 0, 4]"), 9, list(dvec3(0, 0, height)));
    const std::string scene =
        "[sun]\nelevation = " + number(elevation) +
        "\n[[stage]]\ntype = \"relight\"\nalbedo = 1\nlamps = false\nsky = true\n"
        "[[stage]]\ntype = \"sky\"\n";
    const Session session(brume::test::scene_of(registry, camera + scene), registry);
    const PreparedFrame prepared = session.prepare(source_of(f));
    promised = prepared.plan().knobs.at(0).promised;
    ASSERT_EQ(prepared.plan().knobs[0].name, "relight");
    const World& w = prepared.impl().world;
    const truth::Shown shown(w);
    std::size_t k = 0;
    while (w.lights[k].what.kind != BRUME_SKY_LIGHT) ++k;
    double here = 0, brightest = 0;
    for (const dvec3& normal : normals) {
      const float o[] = {0, 0, 0},
                  n[] = {float(normal.x), float(normal.y), float(normal.z)};
      float E[3], right[3];
      float* const to[] = {E, E + 1, E + 2};
      float* const truth[] = {right, right + 1, right + 2};
      const brume_rays one = {1, o, o + 1, o + 2, n, n + 1, n + 2};
      shown.table().irradiance(&shown.table(), k, &one, truth);
      prepared.impl().air.irradiance(int(k),
                                     {1, o, o + 1, o + 2, n, n + 1, n + 2, nullptr}, to);
      for (int c = 0; c < 3; ++c) {
        here =
            std::max(here, double(std::abs(E[c] - right[c])) / (M_PI + double(right[c])));
        brightest = std::max(brightest, double(right[c]) / M_PI);
      }
    }
    std::printf(
        "white under the sky, sun at %g degrees, eye at %g m: |dC| <= %.1e (1 + "
        "|C|), C up to %.2g\n",
        elevation, height, here, brightest);
    worst = std::max(worst, here);
  }
  EXPECT_LE(worst, promised);
}

TEST_F(Relight, SunAndSkyAreLeftAloneUnlessAsked) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const std::string sun =
      "[[stage]]\ntype = \"sun_light\"\ndirection = [0, 1, -1]\nirradiance = 2\n";
  const Out idle = run(f, kRelight + sun);
  EXPECT_FALSE(idle.plan.stages[0].runs);
  EXPECT_EQ(idle.plan.stages[0].reason, "no lights: the scene has no lamp");
  EXPECT_TRUE(idle.plan.changes_nothing);
  const Out out = run(f, kRelight + "sun = true\n" + sun);
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    if (f.covered(i)) {
      ASSERT_NEAR(added(out, f, "B", i), .8 / M_PI * 2 * std::sqrt(.5), 3e-4);
    }
}

}  // namespace
