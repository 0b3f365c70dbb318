// Facts about what counts as a surface, its albedo, and what the stage asks for.

#include <gtest/gtest.h>

#include <random>

#include "../../tests/stage/generated.h"
#include "frames_test.h"
#include "num/error.h"

namespace {

using namespace relight::test;
using brume::test::kInf;
using relight::oracle::irradiance;

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
  // The sky's 1e-4 of the albedo: with all of it within the default tolerance.
  const std::string sky =
      "sky = true\n[[stage]]\ntype = \"sky\"\n[sun]\nelevation = 30\n";
  EXPECT_NEAR(promised(layer, kRelight + sky), 1e-4 + 1e-4 * .8, 1e-12);
  EXPECT_LT(promised(f, "[[stage]]\ntype = \"relight\"\nalbedo = 1\n" + sky), 1e-3);
}

TEST(RelightReadme, ListsItsParameters) {
  Registry registry;
  brume::test::expect_generated("plugins/relight/README.md", "parameters",
                                markdown_table(registry.specs("relight")));
}

}  // namespace
