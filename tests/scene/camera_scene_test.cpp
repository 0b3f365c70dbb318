// Cameras from [camera]: keys, .chan and JSON files, over frames.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "camera_scenes.h"
#include "scene/camera.h"
#include "scene/sun.h"

namespace brume {
namespace {

using namespace test;
const Film kFilm{{0, 0, 1920, 1080}, 1};
const std::string kData = std::string(BRUME_SOURCE_DIR) + "/data/";

SceneFile scene(const std::string& toml) {
  return parse_scene(
      toml, "test.toml",
      [](const std::string& type, const Location& at) -> std::vector<ParamSpec> {
        throw Error(at.text(), "no stage " + type);
      });
}
View view(const std::string& toml, double frame = 1) {
  return *find_view(header(1920, 1080), scene(toml), frame, "test.exr");
}
void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LT(glm::length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(CameraKeys, LookAtKeepsTheHorizonLevel) {
  const View v = view("[camera]\nposition=[1,2,3]\nlook_at=[1,12,3]");
  expect_near(v.forward, {0, 1, 0});
  expect_near(v.right, {1, 0, 0});
  expect_near(v.up, {0, 0, 1});
  expect_near(v.eye, {1, 2, 3});
  EXPECT_NEAR(glm::length(v.across) * 1920, 36. / 35, 1e-12);  // the default lens
  const View y_up = view("[input]\nup='y'\n[camera]\nlook_at=[0,0,-5]");
  expect_near(y_up.right, {1, 0, 0});
  expect_near(y_up.up, {0, 1, 0});
}
TEST(CameraKeys, StraightDownHasNorthAtTheTop) {
  const View v = view("[camera]\nposition=[0,0,9]\nlook_at=[0,0,0]");
  expect_near(v.forward, {0, 0, -1});
  expect_near(v.up, {0, 1, 0});
  expect_near(v.right, {1, 0, 0});
}
TEST(CameraKeys, RotationTurnsACameraThatLooksDownMinusZ) {
  // Level towards +x: up by 90 degrees about x, then right by 90 about z.
  const View v = view("[camera]\nrotation=[90,0,-90]");
  expect_near(v.forward, {1, 0, 0});
  expect_near(v.up, {0, 0, 1});
  expect_near(v.right, {0, -1, 0});
  // No turn at all is a turn that was given.
  expect_near(view("[camera]\nrotation=[0,0,0]").forward, {0, 0, -1});
  // In another order another camera.
  const View zxy = view("[camera]\nrotation=[90,0,-90]\nrotation_order='zxy'");
  expect_near(zxy.forward, {0, 1, 0});
}
TEST(CameraKeys, RollTurnsThePictureTheOtherWay) {
  const View v = view("[camera]\nlook_at=[0,9,0]\nroll=90");
  expect_near(v.up, {1, 0, 0});  // the camera's top falls to the right
  expect_near(v.right, {0, 0, -1});
}
TEST(CameraKeys, WindowOffsetsCountHalfWindowsAndScaleWidens) {
  const View v = view(
      "[camera]\nlook_at=[0,1,0]\nfocal=18\naperture_width=36\naperture_height=18\n"
      "window=[1,-1,0.5]");
  // Half a window to the right and down, half the size: x in 0..1, y in -1/2..0.
  const glm::dvec3 top_left = v.ray(0, 0).direction,
                   bottom_right = v.ray(1920, 1080).direction;
  expect_near(top_left / top_left.y, {0, 1, 0});
  expect_near(bottom_right / bottom_right.y, {1, 1, -0.5});
}
TEST(CameraKeys, OrthographicAndLatlong) {
  const View o =
      view("[camera]\nlook_at=[0,1,0]\nprojection='orthographic'\northo_width=48");
  EXPECT_EQ(o.projection, Projection::orthographic);
  expect_near(o.ray(0, 540).origin, {-24, 0, 0});
  expect_near(o.ray(960, 0).origin, {0, 0, 13.5});
  const View l = view("[camera]\nlook_at=[0,1,0]\nprojection='latlong'");
  expect_near(l.ray(960, 540).direction, {0, 1, 0});
  expect_near(l.ray(1440, 540).direction, {1, 0, 0});
}
TEST(CameraKeys, BetweenKeysThePositionIsLinearAndTheTurnTakesTheShorterWay) {
  const std::string toml =
      "[camera]\nposition={frames=[1,3],values=[[0,0,0],[10,0,0]]}\n"
      "rotation={frames=[1,3],values=[[90,0,170],[90,0,-170]]}";
  const View v = view(toml, 2);
  expect_near(v.eye, {5, 0, 0});
  expect_near(v.forward, {0, -1, 0});  // through 180 degrees, not through 0
  expect_near(view(toml, 0).eye, {0, 0, 0});
}
TEST(CameraKeys, APrintedSceneHasTheSameCamera) {
  for (const char* keys : {"look_at=[3,9,1]", "rotation=[0,0,0]", "rotation=[80,5,-40]",
                           "position=[1,2,3]"}) {
    const SceneFile once = scene(std::string("[camera]\n") + keys);
    const View a = *find_view(header(1920, 1080), once, 1, "test.exr");
    const View b = view(print(once));
    expect_near(a.forward, b.forward);
    expect_near(a.up, b.up);
    expect_near(a.eye, b.eye);
  }
}
TEST(CameraKeys, WhatIsWrongIsSaid) {
  EXPECT_THROW(view("[camera]\nposition=[1,1,1]\nlook_at=[1,1,1]"), Error);
  EXPECT_THROW(view("[camera]\nlook_at=[0,1,0]\nwindow=[0,0,0]"), Error);
  EXPECT_THROW(view("[camera]\nfile='nowhere.json'"), Error);
  EXPECT_THROW(view("[camera]\nfile='nowhere.abc'"), Error);
}

// ---- .chan

TEST(Chan, ALevelCameraInAYUpWorldIsALevelCameraInAZUpOne) {
  const auto track =
      read_chan("# shot\n1 1 2 -3 0 0 0 60\n2 1 2 -5 0 -90 0 60\n", "a.chan");
  ASSERT_TRUE(track.y_up);
  Pose p = track.at(1, kFilm);
  turn_y_up_to(p, {0, 0, 1});
  expect_near(p.eye, {1, 3, 2});
  expect_near(p.forward, {0, 1, 0});
  expect_near(p.up, {0, 0, 1});
  EXPECT_NEAR(p.height, 2 * std::tan(glm::radians(30.)), 1e-12);
  EXPECT_NEAR(p.width, p.height * 16 / 9, 1e-12);
  // Half way of a pan to the right.
  p = track.at(1.5, kFilm);
  turn_y_up_to(p, {0, 0, 1});
  expect_near(p.eye, {1, 4, 2});
  expect_near(p.forward, glm::normalize(glm::dvec3(1, 1, 0)));
}
TEST(Chan, RotationIsRollThenTiltThenPan) {
  const Pose p = read_chan("1 0 0 0 30 90 0 60", "a.chan").at(1, kFilm);
  // Tilted up by 30 degrees, then panned left by 90: towards -x.
  expect_near(p.forward, {-std::cos(glm::radians(30.)), 0.5, 0});
}
TEST(Chan, TheThirdAngleRollsThePictureAboutTheViewAxis) {
  const Pose p = read_chan("1 0 0 0 0 90 30 60", "a.chan").at(1, kFilm);
  // Rolled before it is panned left: the axis stays, the top leans to the camera's left,
  // which is +z now.
  expect_near(p.forward, {-1, 0, 0});
  expect_near(p.up, {0, std::cos(glm::radians(30.)), 0.5});
}
TEST(Chan, EastAndNorthStayWhatTheyAreInEveryWorld) {
  for (const glm::dvec3 up : {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}}) {
    Pose p = read_chan("1 0 0 0 30 -70 0 60", "a.chan").at(1, kFilm);
    turn_y_up_to(p, up);
    expect_near(p.forward, direction_to_sun(30, 70, up));
    EXPECT_LT(glm::dot(p.right, glm::cross(p.up, p.forward)), 0);  // not mirrored
  }
}
TEST(Chan, WhatIsWrongIsSaidWithItsLine) {
  const auto message = [](const char* text) -> std::string {
    try {
      read_chan(text, "a.chan");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message("1 2 3\n").find("a.chan:1"), std::string::npos);
  EXPECT_NE(message("1 0 0 0 0 0 0 60\n2 0 x 0 0 0 0 60").find("a.chan:2"),
            std::string::npos);
  EXPECT_NE(message("2 0 0 0 0 0 0 60\n1 0 0 0 0 0 0 60").find("a.chan:2"),
            std::string::npos);
  EXPECT_NE(message("1 0 0 0 0 0 0 180"), "");
  EXPECT_NE(message(""), "");
  EXPECT_THROW(read_chan("1 0 0 0 0 0 0 60", "a.chan").at(2, kFilm), Error);
}

// ---- JSON

TEST(CameraJson, SimpleForms) {
  const auto at = [](const std::string& json, double frame = 1) {
    return read_camera_json(json, kFilm, "a.json").at(frame, kFilm);
  };
  const Pose look = at(R"({"position":[1,2,3],"look_at":[1,9,3],"focal":18})");
  expect_near(look.forward, {0, 1, 0});
  EXPECT_NEAR(look.width, 2, 1e-12);
  const Pose turned = at(R"({"position":[1,2,3],"rotation":[90,0,-90],"hfov_deg":90})");
  expect_near(turned.forward, {1, 0, 0});
  expect_near(turned.eye, {1, 2, 3});
  const Pose rows = at(R"({"world_from_camera":[1,0,0,4, 0,0,-1,5, 0,1,0,6, 0,0,0,1],
                           "ortho_width":12})");
  expect_near(rows.eye, {4, 5, 6});
  expect_near(rows.forward, {0, 1, 0});
  EXPECT_EQ(rows.projection, Projection::orthographic);
  const std::string moving = R"({"frames":[
    {"frame":1002,"position":[2,0,0],"look_at":[2,1,0],"focal":36},
    {"frame":1001,"position":[0,0,0],"look_at":[1,0,0],"focal":18}]})";
  const Pose mid = at(moving, 1001.5);
  expect_near(mid.eye, {1, 0, 0});
  expect_near(mid.forward, glm::normalize(glm::dvec3(1, 1, 0)));
  EXPECT_NEAR(mid.width, 1.5, 1e-12);
  EXPECT_THROW(at(moving, 1003), Error);
}
TEST(CameraJson, GarbageIsRefusedWithItsPlace) {
  for (const char* text :
       {"", "{", "[]", "3", "{}", R"({"frames":[]})", R"({"frames":[{}]})",
        R"({"frames":[7]})", R"({"position":[1,2],"look_at":[0,0,0],"focal":1})",
        R"({"position":[1,2,3],"focal":1})", R"({"position":[1,2,3],"look_at":[0,0,0]})",
        R"({"position":[1,2,3],"look_at":[1,2,3],"focal":1})",
        R"({"position":[1,2,3],"look_at":[0,0,0],"focal":0})",
        R"({"position":[1,2,3],"look_at":[1,2,9],"focal":1})",
        R"({"worldToNDC":[1,2,3]})",
        R"({"frames":[{"frame":1,"position":[0,0,0],"look_at":[1,0,0],"focal":9},
                      {"frame":1,"position":[0,0,0],"look_at":[1,0,0],"focal":9}]})"})
    EXPECT_THROW(read_camera_json(text, kFilm, "a.json"), Error) << text;
}
TEST(CameraJson, TheSampleFramesOwnFilesAgreeWithTheirPlainWords) {
  // Matrices in double against position and corner rays in the same file: 1e-7, because
  // the corner rays were made from floats.
  for (const char* name : {"valley_validation_480x270", "street_960x540"}) {
    const std::string toml = "[camera]\nfile='" + kData + name + ".json'";
    const View v = *find_view(header(480, 270), scene(toml), 7, "test.exr");
    const auto track =
        load_camera_file(kData + name + std::string(".json"), {{0, 0, 480, 270}, 1});
    EXPECT_TRUE(track->any_frame);
    EXPECT_NEAR(glm::length(v.forward), 1, 1e-12);
    if (std::string(name).starts_with("valley")) {
      expect_near(v.eye, {-22, -112, 45}, 1e-9);
      expect_near(v.corner, {-0.6408996665798108, 1.000901831963607, 0.3625854345475233},
                  1e-7);
      expect_near(v.corner + 480. * v.across + 270. * v.down,
                  {0.6448135515622775, 0.9990933996648113, -0.36062850649178985}, 1e-7);
    }
  }
}
TEST(CameraJson, AMoveOfOneCameraPerFrame) {
  const Film film{{0, 0, 480, 270}, 1};
  const auto track = load_camera_file(kData + "valley_seq/valley_seq.json", film);
  EXPECT_EQ(track->keys.size(), 24u);
  expect_near(track->at(1001, film).eye, {-22, -112, 45}, 1e-9);
  const Pose a = track->at(1010, film), b = track->at(1011, film);
  expect_near(track->at(1010.5, film).eye, 0.5 * (a.eye + b.eye), 1e-9);
  EXPECT_THROW(track->at(1025, film), Error);
}
TEST(CameraFile, AChangedFileIsReadAgainAndUnitsBecomeMetres) {
  const auto path = std::filesystem::temp_directory_path() / "brume_camera_test.chan";
  const auto write = [&](const char* text, int seconds) {
    std::ofstream(path) << text;
    std::filesystem::last_write_time(path, std::filesystem::file_time_type::clock::now() +
                                               std::chrono::seconds(seconds));
  };
  const std::string toml = "[input]\nmetres=0.01\n[camera]\nfile='" + path.string() + "'";
  write("1 100 200 300 0 0 0 60\n", 0);
  expect_near(view(toml).eye, {1, -3, 2});
  write("1 500 200 300 0 0 0 60\n", 10);
  expect_near(view(toml).eye, {5, -3, 2});
  std::filesystem::remove(path);
}

TEST(Sun, ElevationAndAzimuthClockwiseFromNorth) {
  expect_near(direction_to_sun(0, 90, {0, 0, 1}), {1, 0, 0});
  expect_near(direction_to_sun(90, 123, {0, 1, 0}), {0, 1, 0});
  // The sample valley's sun, as its file gives it in floats.
  expect_near(direction_to_sun(12, 285, {0, 0, 1}),
              {-0.9448180198669434, 0.25316321849823, 0.2079116851091385}, 1e-7);
}

}  // namespace
}  // namespace brume
