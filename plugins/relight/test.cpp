// Facts about light on surfaces, against the laws at points.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "../../tests/stage/generated.h"
#include "frames_test.h"
#include "num/error.h"
#include "truth/shown.h"
#include "truth/truth.h"

namespace {

using namespace relight::test;
using brume::test::kInf;
using relight::oracle::irradiance;

// ---- lamps ----------------------------------------------------------------------------

TEST_F(Relight, APlaneIsLitAsLambertSays) {
  // Normals and points from depth: 1e-7 of the distance each, over a pixel of 1e-2 rad:
  // 4e-5 rad, and that much of E's change with angle, here less than 10 E / rad.
  const Geometry tilted = plane({0, 12, 0}, {.2, -.3, 1});
  Frame f = frame_of(tilted, {.head = kFine});
  const Lamp lamp = {{1, 9, 3}, {5, 3, 2}, 0};
  const Out out = run(f, kRelight + stage_of(lamp, "a"));
  int pixels = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i)) continue;
    const auto E = irradiance(lamp, f.point(i), f.truth[i].n, {});
    for (std::size_t c = 0; c < 3; ++c) {
      const double want = kAlbedo[c] / M_PI * E[c];
      ASSERT_NEAR(added(out, f, kChannels[c], i), want, 4e-4 * want + 1e-7) << i;
    }
    ++pixels;
  }
  EXPECT_GT(pixels, 3000);
}

TEST_F(Relight, ColouredFogDimsTheLampOnItsWayToTheSurface) {
  // C = T (C0 + rho/pi E e^(-sigma r)): the fog before the surface, too, is exact.
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const OracleRgb sigma = {.05, .2, .8};
  const Lamp lamp = {{1, 9, 3}, {5, 3, 2}, .1};
  const Out out = run(f, kRelight + stage_of(lamp, "a") +
                             "[[stage]]\ntype = \"height_fog\"\nfalloff = 0\ncolor = "
                             "0\ndensity = " +
                             list(sigma) + "\n");
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i)) continue;
    const auto E = irradiance(lamp, f.point(i), f.truth[i].n, sigma);
    for (std::size_t c = 0; c < 3; ++c) {
      const double T = std::exp(-sigma[c] * f.truth[i].t);
      const double want = T * (.1 + kAlbedo[c] / M_PI * E[c]);
      ASSERT_NEAR(out[kChannels[c]][i], want, 4e-4 * want + 1e-7) << i;
    }
  }
}

TEST_F(Relight, FogThatThinsWithHeightDimsItAsTheTruthSays) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const Lamp lamp = {{1, 9, 3}, {5, 3, 2}, .1};
  const std::string scene = kRelight + stage_of(lamp, "a") +
                            "[[stage]]\ntype = \"height_fog\"\ncolor = 0\ndensity = "
                            "[0.1, 0.3, 2]\nfalloff = 0.7\n"
                            "[[stage]]\ntype = \"fog_volume\"\ncenter = [0, 8, 1]\nhalf "
                            "= [1, 2, 1]\ndensity = 0.5\ncolor = 0\n";
  const Out out = run(f, "[output]\naovs = [\"S\"]\nwhite = 1e-3\n" + scene);
  Session session(brume::test::scene_of(registry, f.camera + scene), registry);
  const PreparedFrame prepared = session.prepare(source_of(f));
  World dark = prepared.impl().world;
  dark.lights.clear();
  for (int y = 20; y < f.height; y += 7)
    for (int x = 3; x < f.width; x += 11) {
      const std::size_t i = f.at(x, y);
      const dvec3 at = f.point(i), way = lamp.position - at;
      const auto E = irradiance(lamp, at, f.truth[i].n, {});
      const auto T = truth::along(dark, at, glm::normalize(way), glm::length(way), {}).T;
      for (std::size_t c = 0; c < 3; ++c) {
        const double want = .1 + kAlbedo[c] / M_PI * E[c] * T[int(c)];
        ASSERT_NEAR(out[std::string("S.") + kChannels[c]][i], want, 4e-4 * want) << i;
      }
    }
}

TEST_F(Relight, SpotlightsHaveTheirConesToTheEdge) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  for (const double cone : {10., 45., 90.})
    for (const bool ratio : {false, true}) {
      const Lamp lamp = {{.5, 9, 3},        {8, 8, 8},      0,    {.3, -.2, -1},
                         cone * M_PI / 180, 8 * M_PI / 180, ratio};
      const Out out = run(f, kRelight + stage_of(lamp, "a"));
      int dark = 0, lit = 0;
      for (std::size_t i = 0; i < f.truth.size(); ++i) {
        if (!f.covered(i)) continue;
        const double E = irradiance(lamp, f.point(i), f.truth[i].n, {})[1];
        const double got = added(out, f, "G", i), want = .4 / M_PI * E;
        if (E == 0) {
          EXPECT_EQ(got, 0) << i;
        }
        // At the edge: positions to 3e-6 m, an edge over 8 degrees.
        ASSERT_NEAR(got, want, 4e-4 * want + 2e-5) << i << ", cone " << cone;
        (E > 0 ? lit : dark)++;
      }
      EXPECT_GT(lit, 30);
      if (cone < 90) {
        EXPECT_GT(dark, 100);
      }
    }
}

TEST_F(Relight, WhatFacesAwayGetsNothing) {
  // A lamp under the plane, and one behind a sphere: the terminator.
  Frame below = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const Out dark = run(below, kRelight + stage_of({{0, 9, -1}, {50, 50, 50}}, "a"));
  for (std::size_t i = 0; i < below.truth.size(); ++i)
    ASSERT_EQ(dark["R"][i], below.planes["R"][i]);

  Frame ball = frame_of(sphere({0, 10, 2}, 2), {.head = kFine});
  const Lamp lamp = {{9, 9, 6}, {90, 90, 90}};
  const Out out = run(ball, kRelight + stage_of(lamp, "a"));
  int lit = 0, unlit = 0;
  for (std::size_t i = 0; i < ball.truth.size(); ++i) {
    if (!ball.covered(i)) continue;
    const double mu =
        glm::dot(glm::normalize(lamp.position - ball.point(i)), ball.truth[i].n);
    // Normals of this ball are off by less than .05 (NormalsOfASphere).
    unlit += mu < -.05;
    lit += mu > .05;
    const double gained = added(out, ball, "R", i);
    if (mu < -.05) {
      EXPECT_EQ(gained, 0);
    }
    if (mu > .05) {
      EXPECT_GT(gained, 0);
    }
  }
  EXPECT_GT(lit, 100);
  EXPECT_GT(unlit, 100);
}

TEST_F(Relight, ALampAtThePixelIsFinite) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const std::size_t i = f.at(50, 40);
  const dvec3 x = f.point(i);
  for (const double height : {0., 1e-7, 1e-4}) {
    const Out out =
        run(f, kRelight + stage_of({x + dvec3(0, 0, height), {1, 1, 1}}, "a"));
    for (const char* c : kChannels)
      for (const float v : out[c]) ASSERT_TRUE(std::isfinite(v));
    // No more than from half a pixel away.
    const double half = f.truth[i].t * .5 / 90;  // 64 rows of 35 degrees
    EXPECT_LE(added(out, f, "G", i), .4 / M_PI / (half * half));
  }
  // With a radius it is the lamp's own.
  const Lamp round = {x + dvec3(0, 0, .2), {1, 1, 1}, .5};
  const Out out = run(f, kRelight + stage_of(round, "a"));
  EXPECT_NEAR(added(out, f, "G", i), .4 / M_PI / .25, 1e-3);
}

TEST_F(Relight, ALampBehindTheCameraLightsWhatItSees) {
  Frame f = frame_of(plane({0, 20, 0}, {0, -1, 0}), {.head = kFine});
  const Lamp lamp = {{0, -5, 6}, {900, 900, 900}};
  const Out out = run(f, kRelight + stage_of(lamp, "a"));
  for (std::size_t i = 0; i < f.truth.size(); i += 97) {
    if (!f.covered(i)) continue;
    const double want = .4 / M_PI * irradiance(lamp, f.point(i), f.truth[i].n, {})[1];
    ASSERT_NEAR(added(out, f, "G", i), want, 4e-4 * want);
  }
}

TEST_F(Relight, LightsAddUpInAnyOrder) {
  Frame f = frame_of(nearest({plane({0, 0, 0}, {0, 0, 1}), sphere({1, 9, 1}, 1)}),
                     {.head = kFine});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-5, 5);
  std::vector<std::string> lamps;
  std::vector<Out> alone;
  for (int k = 0; k < 12; ++k) {
    lamps.push_back(stage_of({{u(random), 9 + u(random), 5.5 + u(random)}, {1, 2, 3}},
                             "l" + std::to_string(k)));
    alone.push_back(run(f, kRelight + lamps.back()));
  }
  std::string up = kRelight, down;
  for (const auto& l : lamps) up += l, down = l + down;
  const Out a = run(f, up), b = run(f, down + kRelight);
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    double sum = 0;
    for (const Out& one : alone) sum += added(one, f, "B", i);
    // 12 roundings of 0.1 + ..., and the cutoff's 1e-8.
    ASSERT_NEAR(added(a, f, "B", i), sum, 3e-7 * (1 + sum) * 12);
    for (const char* c : kChannels)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a[c][i]),
                std::bit_cast<std::uint32_t>(b[c][i]));
  }
}

TEST_F(Relight, WhatDistantLampsAreLeftOutIsATenthOfTheTolerance) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  std::string lamps;
  for (int k = 0; k < 30; ++k)
    lamps += stage_of({{k * 4. - 60, 10. + 3 * k, 2}, {.02, .02, .02}},
                      "l" + std::to_string(k));
  const Out fast = run(f, kRelight + lamps);
  Frame exact = f;
  exact.head = kFine;
  const Out all = run(exact, kRelight + lamps);
  double worst = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    worst = std::max(worst, double(std::abs(all["B"][i] - fast["B"][i])));
  EXPECT_GT(worst, 0) << "nothing was left out";
  EXPECT_LE(worst, 1e-4);  // a tenth of 1e-3 x white
}

TEST_F(Relight, ItsLayerIsWhatItAddsToTheSurfaces) {
  // Behind fog C = T (C0 + relight) + L: without it the fog alone is left.
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  const std::string fog = "[[stage]]\ntype = \"height_fog\"\ndensity = 0.03\n",
                    lamp = stage_of({{1, 9, 3}, {5, 3, 2}}, "a");
  Frame layers = f;
  layers.head += "aovs = [\"T\", \"relight\"]\n";
  const Out out = run(layers, kRelight + "mix = 0.7\n" + fog + lamp),
            without = run(f, fog + lamp);
  double most = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    for (const std::string c : {"R", "G", "B"}) {
      const double adds = double(out["relight." + c][i]);
      most = std::max(most, adds);
      ASSERT_NEAR(out[c][i] - out["T." + c][i] * adds, without[c][i], 2e-6);
    }
  EXPECT_GT(most, 0.03);
}

// ---- sun and sky ----------------------------------------------------------------------

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
    EXPECT_LT(worst / brightest, elevation > 10 ? 4e-4 : 1.1e-3);  // README, "Error"
  }
}

TEST_F(Relight, ItsPromiseIsInThePlan) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const auto promised = [&](const Frame& frame, const std::string& stages) {
    double all = 0;
    for (const KnobPlan& k : run(frame, stages).plan.knobs)
      if (k.name == "relight") all += k.promised;
    return all;
  };
  const std::string lamp = stage_of({{0, 9, 3}}, "a");
  // A tenth of 1e-3, and 4e-7 over pixels of 36 mm / 30 mm / 96 rad.
  EXPECT_NEAR(promised(f, kRelight + lamp), 1e-4 + 4e-7 * 96 * 30 / 36, 1e-8);
  EXPECT_EQ(promised(f, kRelight), 0) << "no lamp: it does not run";
  Frame layer = f;
  for (const char* c : {"N.X", "N.Y", "N.Z"}) layer.planes[c] = f.planes["R"];
  EXPECT_NEAR(promised(layer, kRelight + lamp), 1e-4, 1e-12);
}

TEST_F(Relight, SkyLightIsAsGoodAsItPromises) {
  // White surfaces of any normal, from two heights: worst beside the bright rim of the
  // sky and a low sun's glow.
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  double worst = 0, promised = 0;
  for (const double elevation : {50., 12., 4., 1.})
    for (const double height : {4., 500.}) {
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
      for (int i = 0; i < 400; ++i) {
        const double z = -1 + 2 * i / 399., phi = 2.399963 * i,  // the golden angle
            s = std::sqrt(1 - z * z);
        const float o[] = {0, 0, 0},
                    n[] = {float(s * std::cos(phi)), float(s * std::sin(phi)), float(z)};
        float E[3], right[3];
        float* const to[] = {E, E + 1, E + 2};
        float* const truth[] = {right, right + 1, right + 2};
        const brume_rays one = {1, o, o + 1, o + 2, n, n + 1, n + 2};
        shown.table().irradiance(&shown.table(), k, &one, truth);
        prepared.impl().air.irradiance(
            int(k), {1, o, o + 1, o + 2, n, n + 1, n + 2, nullptr}, to);
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst,
                           double(std::abs(E[c] - right[c])) / (M_PI + double(right[c])));
      }
    }
  std::printf("white surfaces under the sky: |dC| <= %.1e (1 + |C|)\n", worst);
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

// ---- what it is for surfaces ----------------------------------------------------------

TEST_F(Relight, AlbedoComesFromItsLayerPremultiplied) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}), {.head = kFine});
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    f.planes["A"][i] *= i % 3 ? 1.f : .5f;
    for (const char* c : {"albedo.R", "albedo.G", "albedo.B"})
      f.planes[c].push_back(i % 7 == 0   ? std::nanf("")
                            : i % 7 == 1 ? 2.f  // more than all
                                         : .3f * f.planes["A"][i]);
  }
  const Lamp lamp = {{1, 9, 3}, {5, 5, 5}};
  const std::string light = stage_of(lamp, "a");
  const Out layer = run(f, kRelight + light);
  const Out plain = run(f, kRelight + "albedo_layer = \"none\"\n" + light);
  const Out own = run(f,
                      "[[stage]]\ntype = \"relight\"\nalbedo_layer = \"none\"\nalbedo = "
                      "\"color\"\n" +
                          light);
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (!f.covered(i)) continue;
    const double a = double(f.planes["A"][i]),
                 E = irradiance(lamp, f.point(i), f.truth[i].n, {})[0];
    const double rho = i % 7 == 0 ? 0 : i % 7 == 1 ? a : .3 * a;
    ASSERT_NEAR(added(layer, f, "R", i), rho / M_PI * E, 4e-4 * E + 1e-7);
    ASSERT_NEAR(added(plain, f, "R", i), a * .2 / M_PI * E, 4e-4 * E + 1e-7);
    ASSERT_NEAR(added(own, f, "R", i), .1 / M_PI * E, 4e-4 * E + 1e-7);
  }
}

TEST_F(Relight, BackgroundIsNotLit) {
  Frame f = frame_of(sphere({0, 10, 2}, 2), {.head = kFine});
  const std::string light = stage_of({{0, 4, 4}, {90, 90, 90}}, "a");
  const Out out = run(f, kRelight + light);
  // A plate's pixels at infinity are no surface, wherever the air takes them to be.
  Frame plate = f;
  plate.head += "[input]\nbackground = \"plate\"\nbackground_distance = 30\n";
  const Out before_plate = run(plate, kRelight + light);
  int there = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i) {
    if (f.covered(i)) {
      there += added(before_plate, f, "R", i) > 0;
      EXPECT_EQ(before_plate["R"][i], out["R"][i]);
      continue;
    }
    EXPECT_EQ(out["R"][i], 0);
    EXPECT_EQ(before_plate["R"][i], 0);
  }
  EXPECT_GT(there, 200);
}

TEST_F(Relight, HasNothingToDoWithout) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  const std::string lamp = stage_of({{0, 9, 3}}, "a");
  const auto reason = [&](const std::string& scene) {
    return run(f, scene).plan.stages[0].reason;
  };
  EXPECT_EQ(reason(kRelight), "no lights: the scene has no lamp");
  EXPECT_EQ(reason("[[stage]]\ntype = \"relight\"\nalbedo = 0\n" + lamp), "albedo is 0");
  EXPECT_EQ(reason(kRelight + "lamps = false\n" + lamp), "lamps, sun and sky are off");
  EXPECT_EQ(reason(kRelight + "[[stage]]\ntype = \"point_light\"\npower = 0\n"),
            "no lights: the scene has no lamp");
  EXPECT_EQ(reason(kRelight + lamp), "on the surface");
  f.camera.clear();
  try {
    run(f, kRelight + lamp);
    FAIL() << "without a camera";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("no camera, and relight needs"),
              std::string::npos)
        << e.what();
  }
}

TEST_F(Relight, ALayerThatIsNotThereIsAnError) {
  Frame f = frame_of(plane({0, 0, 0}, {0, 0, 1}));
  EXPECT_THROW(run(f, kRelight + "normals = \"Nx\"\n" + stage_of({{0, 9, 3}}, "a")),
               Error);
}

TEST_F(Relight, PixelsAreTheSameHoweverCut) {
  // More columns than a run, edges without depth, fog.
  Frame f = frame_of(nearest({sphere({0, 10, 2}, 2), sphere({3, 8, 3}, 1)}),
                     {.width = 600, .height = 24});
  std::mt19937 random(3);
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    if (random() % 5 == 0 && f.covered(i))
      f.planes["Z"][i] = kInf, f.planes["A"][i] = .4f;
  const std::string scene = kRelight + stage_of({{2, 5, 6}, {9, 9, 9}}, "a") +
                            "[[stage]]\ntype = \"height_fog\"\ndensity = 0.01\n";
  const Out whole = run(f, scene);
  for (const Window& w : {Window{0, 0, 300, 5}, Window{250, 7, 40, 10},
                          Window{511, 0, 89, 24}, Window{299, 12, 1, 1}}) {
    const Out part = run(f, scene, w);
    for (const char* c : kChannels)
      for (int y = 0; y < w.height; ++y)
        for (int x = 0; x < w.width; ++x)
          ASSERT_EQ(part[c][std::size_t(y * w.width + x)],
                    whole[c][f.at(w.x + x, w.y + y)])
              << w.x + x << ", " << w.y + y;
  }
}

TEST(RelightReadme, ListsItsParameters) {
  Registry registry;
  brume::test::expect_generated("plugins/relight/README.md", "parameters",
                                markdown_table(registry.specs("relight")));
}

}  // namespace
