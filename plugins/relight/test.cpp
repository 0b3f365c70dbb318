// Facts about the light of lamps on surfaces, against the laws at points.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

#include "frames_test.h"
#include "truth/truth.h"

namespace {

using namespace relight::test;
using relight::oracle::irradiance;

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

}  // namespace
