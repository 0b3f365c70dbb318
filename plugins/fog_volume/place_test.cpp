// Where a fog volume is: by centre, half extents and turns, by a matrix, by keyframes.

#include <gtest/gtest.h>

#include "num/error.h"
#include "scene/scene_file.h"
#include "volumes_test.h"

namespace fog_volume {
namespace {

TEST(FogVolume, AMatrixPlacesItAsCenterHalfAndRotationDo) {
  const Volume v{.box = false,
                 .center = {1, 2, 30},
                 .half = {2, 0.5L, 7},
                 .degrees = {10, 20, 30},
                 .density = 0.3L};
  const auto R = rotation({10, 20, 30});
  std::string m;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) m += text(R[r][c] * double(v.half[c])) + ",";
    m += text(double(v.center[r])) + ",";
  }
  ThroughAir parts, matrix;
  parts.add("fog_volume", settings(v)).compile();
  matrix
      .add("fog_volume", {{"shape", "ellipsoid"},
                          {"matrix", m + "0,0,0,1"},
                          {"density", "0.3"},
                          {"color", "1"}})
      .compile();
  for (int i = -20; i <= 20; ++i) {
    const Ray r = toward({0, 0, 0}, {1 + i * 0.1L, 2, 30});
    // Two double inverses, rounded to float each: the chord near its rim is the worst.
    EXPECT_NEAR(parts(r).L[0], matrix(r).L[0], 1e-5) << i;
  }
}

TEST(FogVolume, SaysWhichMatrixHasNoInverse) {
  const auto message = [](const std::string& matrix) -> std::string {
    try {
      ThroughAir().add("fog_volume", {{"matrix", matrix}});
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1").find("no inverse"),
            std::string::npos);
  EXPECT_NE(message("1,2,0,0, 2,4,0,0, 0,0,1,0, 0,0,0,1").find("no inverse"),
            std::string::npos);
  EXPECT_NE(message("1,0,0,0, 0,1,0,0, 0,0,1,0, 3,2,1,1").find("last row"),
            std::string::npos);
  EXPECT_EQ(message("1e6,0,0,9, 0,1e-6,0,9, 0,0,1,9, 0,0,0,1"), "");
}

TEST(FogVolume, TurnsAboutXThenYThenZ) {
  // A rod along local x. About z by 90 degrees it lies along world y; about x first
  // nothing happens to it, about y by 90 it would point down.
  const auto R = rotation({90, 0, 90});
  const double x[3][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(R[r][c], x[r][c]) << r << c;
  const auto once = rotation({0, 450, 0}), back = rotation({0, -270, 0});
  EXPECT_EQ(once, back);
  EXPECT_EQ(once[2][0], -1);
}

TEST(FogVolume, KeyframesMoveTurnAndScaleIt) {
  // Halfway between two keys of center, half and rotation it is the volume of their
  // means.
  const StageType& type = ThroughAir::registry().find("fog_volume");
  const SceneFile scene = parse_scene(
      "version = 1\n[[stage]]\ntype = \"fog_volume\"\ncolor = 1\nsoftness = 0.3\n"
      "center = { frames = [1, 11], values = [[0, 0, 20], [4, 2, 30]] }\n"
      "half = { frames = [1, 11], values = [[5, 5, 5], [1, 9, 5]] }\n"
      "rotation = { frames = [1, 11], values = [[0, 0, 0], [0, 60, 0]] }\n",
      "keys.toml", [&](const std::string&, const Location&) { return type.specs; });
  ThroughAir half_way;
  half_way.add("fog_volume", {{"center", "2,1,25"},
                              {"half", "3,7,5"},
                              {"rotation", "0,30,0"},
                              {"softness", "0.3"},
                              {"color", "1"}});
  half_way.compile();
  StageCache cache;
  FrameInfo frame = eye_at(0, 0, 0);
  frame.frame = 6;
  const auto values = scene.stages[0].params.at(6);
  StageInstance at_6(type, "fog_volume", values, cache);
  World world;
  at_6.publish(frame, 0, world);
  const brume_medium &a = world.media[0].what, &b = half_way.world().media[0].what;
  for (int i = 0; i < 12; ++i)
    EXPECT_NEAR(a.local_from_world[i], b.local_from_world[i], 1e-12) << i;
}

}  // namespace
}  // namespace fog_volume
