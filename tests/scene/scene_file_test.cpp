// What a scene file says, and what is said about a wrong one.

#include "scene/scene_file.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <cstdlib>
#include <fstream>

#include "json_reader.h"
#include "zoo.h"

namespace brume {
namespace {

std::vector<ParamSpec> specs_for(const std::string& type, const Location& where) {
  static const std::vector<std::string> known{"zoo", "height_fog"};
  for (const std::string& k : known)
    if (type == k) return specs_of<Zoo>();
  const std::string near = nearest_name(type, known);
  throw Error(where.text(), type + ": no such stage",
              near.empty() ? "" : "did you mean " + near + "?");
}

SceneFile parse(const std::string& toml) {
  return parse_scene(toml, "valley.toml", specs_for);
}

std::string refusal(const std::string& toml) {
  try {
    parse(toml);
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

const Setting& setting(const Settings& s, const char* name) {
  return s.values[s.find(name)];
}

TEST(SceneFile, AnEmptyFileIsASceneOfDefaults) {
  const SceneFile s = parse("");
  EXPECT_EQ(s.version, 1);
  EXPECT_EQ(s.tolerance, 1e-3);
  EXPECT_FALSE(s.has_camera);
  EXPECT_FALSE(s.has_sun);
  EXPECT_TRUE(s.stages.empty());
  const auto input = SceneFile::section<InputSection>(s.input, 0);
  EXPECT_EQ(input.background_distance, std::numeric_limits<double>::infinity());
  EXPECT_EQ(input.depth_kind, "planar");
  EXPECT_EQ(SceneFile::section<CameraSection>(s.camera, 0).focal, 35);
}

TEST(SceneFile, SectionsAndStagesAreReadAsWritten) {
  const SceneFile s = parse(R"(
version = 1
tolerance = 1e-4
[input]
depth = "depth.####.exr:Z"
metres = 0.01
[camera]
focal = { frames = [1001, 1003], values = [35, 55] }
[sun]
elevation = 12.0
time = 2024-06-21T18:30:00+02:00
[output]
aovs = ["T", "L"]
[[stage]]
type = "height_fog"
tint = 0.5
[[stage]]
type = "height_fog"
name = "far"
color = "sky"
mask = "fogmask.R"
mix = 0.5
enabled = false
frames = [1001, inf]
)");
  EXPECT_EQ(s.tolerance, 1e-4);
  EXPECT_EQ(SceneFile::section<InputSection>(s.input, 0).depth, "depth.####.exr:Z");
  EXPECT_EQ(SceneFile::section<InputSection>(s.input, 0).metres, 0.01);
  EXPECT_EQ(SceneFile::section<CameraSection>(s.camera, 1002).focal, 45);
  EXPECT_TRUE(s.has_camera);
  EXPECT_TRUE(s.has_sun);
  EXPECT_EQ(SceneFile::section<SunSection>(s.sun, 0).time, "2024-06-21T18:30:00+02:00");
  EXPECT_EQ(SceneFile::section<OutputSection>(s.output, 0).aovs,
            (std::vector<std::string>{"T", "L"}));
  ASSERT_EQ(s.stages.size(), 2u);
  EXPECT_EQ(s.stages[0].name, "height_fog");
  EXPECT_EQ(s.stages[0].mix.at(0).numbers[0], 1);
  EXPECT_TRUE(s.stages[0].enabled);
  EXPECT_EQ(setting(s.stages[0].params, "tint").at(0).numbers,
            (std::vector<double>{0.5, 0.5, 0.5}));
  const StageEntry& far = s.stages[1];
  EXPECT_EQ(far.name, "far");
  EXPECT_EQ(far.mask, "fogmask.R");
  EXPECT_EQ(far.mix.at(0).numbers[0], 0.5);
  EXPECT_FALSE(far.enabled);
  EXPECT_EQ(far.first_frame, 1001);
  EXPECT_EQ(far.last_frame, std::numeric_limits<double>::infinity());
  EXPECT_EQ(setting(far.params, "color").at(0).text, "sky");
  EXPECT_EQ(setting(far.params, "color").where.text(), "valley.toml:20:9");
  EXPECT_EQ(far.where.line, 17);
}

struct Case {
  const char *toml, *message;
};

TEST(SceneFile, AMistakeIsNamedWithItsPlaceAndTheNearestName) {
  const std::string fog = "[[stage]]\ntype = \"height_fog\"\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {fog + "  densty = 1",
       "3:3: height_fog.densty: no such parameter; did you mean "
       "density?"},
      {fog + "density = -3", "3:11: height_fog.density = -3; allowed 0 to 10 per m"},
      {fog + "tint = [1,\n 2, -3]", "4:5: height_fog.tint = -3; allowed at least 0"},
      {fog + "name = \"a\"\ndensity = \"x\"",
       "4:11: a.density = \"x\"; must be a number"},
      {fog + "on = 1", "3:6: height_fog.on = 1; must be true or false"},
      {fog + "tint = [1, 2]", "3:8: height_fog.tint has 2 numbers; needs 3"},
      {fog + "end = nan", "3:7: height_fog.end = nan; allowed at least 0 m"},
      {fog + "mix = 2", "3:7: height_fog.mix = 2; allowed 0 to 1"},
      {fog + "maks = \"m\"",
       "3:1: height_fog.maks: no such parameter; did you mean mask?"},
      {fog + "frames = [3, 1]",
       "3:10: height_fog.frames; must be [first, last], first <= last"},
      {fog + "enabled = { frames = [1], values = [true] }",
       "3:11: height_fog.enabled has keyframes; it cannot be animated"},
      {fog + fog, "4:8: a second stage called height_fog; give it a name = \"...\""},
      {fog + "name = \"x\"\n" + fog + "name = \"x\"",
       "6:8: a second stage called x; names must differ"},
      {fog + "name = \"sun\"",
       "3:8: stage name \"sun\"; a section is called that; give the stage another name"},
      {fog + "name = \"a.b\"",
       "3:8: stage name \"a.b\"; allowed: letters, digits, _ and -"},
      {fog + "name = 3", "3:8: height_fog.name = 3; must be text in quotes"},
      {"[[stage]]\ntype = \"hight_fog\"",
       "2:8: hight_fog: no such stage; did you mean height_fog?"},
      {"[[stage]]\nname = \"x\"",
       "1:1: a stage without a type; write type = "
       "\"height_fog\""},
      {"[[stage]]\ntype = 3",
       "2:8: stage type = 3; must be the name of a stage in quotes"},
      {"[stage]\ntype = \"zoo\"",
       "1:2: stage is one table; stages are written [[stage]]"},
      {"stage = [1]", "1:10: stage = 1; stages are written [[stage]]"},
      {"[sn]", "1:2: sn: no such section; did you mean sun?"},
      {"tolerence = 1", "1:1: tolerence: no such key; did you mean tolerance?"},
      {"tolerance = 0", "1:13: tolerance = 0; allowed 1e-09 to 1"},
      {"sun = 3", "1:7: sun = 3; it is a section: [sun]"},
      {"version = 2\n[from_the_future]",
       "1:11: version = 2; this brume knows scenes up to version 1; it takes a newer "
       "one"},
      {"[later]\n[sun]\n[[x]]\n",
       "1:2: later: no such section; known: stage, version, "
       "tolerance, colorspace, input, camera, sun, time, output"},
      {"[sun]\nelevation = 100\nazimuth = 1e9",
       "2:13: sun.elevation = 100; allowed -90 to 90 degrees"},  // the first in the text
      {"version = 0", "1:11: version = 0; allowed 1 to 1"},
      {"version = \"1\"", "1:11: version = \"1\"; must be a whole number"},
      {"[camera]\nlook_at = [0, 0, 0]\nrotation = [0, 0, 0]",
       "3:12: camera.rotation and camera.look_at are both given; leave one out"},
      {"[input]\nup = \"y\"\nup = \"z\"", "3:6: not TOML: "},
      {"[sun]\nelevation = { frames = [1, 2], values = [1,\n 91] }",
       "3:2: sun.elevation = 91; allowed -90 to 90 degrees"},
  };
  for (const auto& [toml, message] : cases) {
    const std::string wanted = "valley.toml:" + message, said = refusal(toml);
    if (message.size() > 6 && message.substr(message.size() - 6) == "TOML: ")
      EXPECT_EQ(said.substr(0, wanted.size()), wanted);
    else
      EXPECT_EQ(said, wanted) << toml;
  }
}

TEST(SceneFile, GarbageIsRefusedOnOneLine) {
  const auto repeat = [](const char* s, int n) {
    std::string out;
    while (n-- > 0) out += s;
    return out;
  };
  const std::string garbage[] = {
      std::string("\0\0\0\0", 4),
      std::string("a = 1\0", 6),
      "\xff\xfe\x00",
      "x = \"\xc3\x28\"",
      "\x89PNG\r\n\x1a\n",
      "v/1\x01\x02",
      "<scene><stage/></scene>",
      "a = ",
      "[[stage",
      "a = \"never closed",
      "a = \"\"\"never closed",
      repeat("[", 100000),
      "a = " + repeat("[", 100000),
      "a = " + repeat("{ a = ", 100000),
      repeat("a.", 100000) + "a = 1",
      repeat("\"=\".", 100000) + "a = 1",
      repeat("'#'.", 100000) + "a = 1",
      "a = '''" + repeat("x", 1000) + "\n" + repeat("b.", 100000) + "b",
      "[" + repeat("a . ", 100000) + "a]",
      repeat("#", 100) + "\n" + repeat("x", 5 << 20),
      std::string(5 << 20, ' '),
      "a = 99999999999999999999999999",
      "a = 1e99999",
      "[stage]\n[[stage]]",
      repeat("[[stage]]\n", 100000),
  };
  for (const std::string& g : garbage) {
    const std::string said = refusal(g);
    EXPECT_EQ(said.substr(0, 11), "valley.toml") << g.substr(0, 40);
    EXPECT_EQ(said.find_first_of(std::string_view("\n\r\0", 3)), said.npos) << said;
    EXPECT_LT(said.size(), 500u);
  }
}

TEST(SceneFile, SevereFilesAreRefusedWithTheirCause) {
  char folder[] = "/tmp/brume_scene_XXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::filesystem::path in = folder;
  const auto said = [](const std::filesystem::path& p) -> std::string {
    try {
      read_scene(p, specs_for);
    } catch (const Error& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_EQ(said(in), in.string() + ": is a directory; a scene is a TOML file");
  const auto absent = in / "absent.toml";
  EXPECT_EQ(said(absent),
            absent.string() + ": cannot be opened: No such file or directory");
  EXPECT_EQ(said("/dev/zero"), "/dev/zero: longer than 4 MiB; not a scene file?");
  EXPECT_EQ(said("/dev/null"), "accepted");
  const auto big = in / "big.toml";
  std::ofstream(big) << "a";
  std::filesystem::resize_file(big, 100'000'000);  // sparse
  EXPECT_EQ(said(big), big.string() + ": longer than 4 MiB; not a scene file?");
  const auto good = in / "good.toml";
  std::ofstream(good) << "tolerance = 0.5\n";
  EXPECT_EQ(read_scene(good, specs_for).tolerance, 0.5);
  EXPECT_EQ(read_scene(good, specs_for).path, good);
  std::filesystem::remove_all(in);
}

const char* const kTwoFogs =
    "[[stage]]\ntype = \"height_fog\"\n[[stage]]\ntype = \"zoo\"\nname = \"far\"\n";

TEST(SceneFile, TheCommandLineHasTheLastWord) {
  SceneFile s = parse(kTwoFogs);
  set(s, "tolerance=1e-5", specs_for);
  set(s, "far.density = 0.5", specs_for);
  set(s, "far.enabled=false", specs_for);
  set(s, "far.mix={ frames = [1, 3], values = [0, 1] }", specs_for);
  set(s, "far.mask=fog.exr:R", specs_for);
  set(s, "far.frames=1,10", specs_for);
  set(s, "sun.elevation=-3", specs_for);
  set(s, "output.aovs=T,far.L", specs_for);
  set(s, "input.depth=depth.exr:a=b.Z", specs_for);
  EXPECT_EQ(s.tolerance, 1e-5);
  const StageEntry& far = s.stages[1];
  EXPECT_EQ(setting(far.params, "density").at(0).numbers[0], 0.5);
  EXPECT_EQ(setting(s.stages[0].params, "density").at(0).numbers[0], 0.002);
  EXPECT_FALSE(far.enabled);
  EXPECT_EQ(far.mix.at(2).numbers[0], 0.5);
  EXPECT_EQ(far.mask, "fog.exr:R");
  EXPECT_EQ(far.first_frame, 1);
  EXPECT_EQ(far.last_frame, 10);
  EXPECT_TRUE(s.has_sun);
  EXPECT_EQ(SceneFile::section<OutputSection>(s.output, 0).aovs[1], "far.L");
  EXPECT_EQ(SceneFile::section<InputSection>(s.input, 0).depth, "depth.exr:a=b.Z");
}

TEST(SceneFile, TheLastWordOnWhereTheCameraLooksHolds) {
  SceneFile s = parse("[camera]\nlook_at = [1, 2, 3]\n");
  set(s, "camera.rotation=10,0,0", specs_for);
  EXPECT_TRUE(setting(s.camera, "look_at").is_default);
  EXPECT_FALSE(setting(s.camera, "rotation").is_default);
  const SceneFile again = parse(print(s));
  EXPECT_TRUE(setting(again.camera, "look_at").is_default);
  EXPECT_FALSE(setting(again.camera, "rotation").is_default);
}

TEST(SceneFile, AWrongAssignmentIsNamedAndLeavesTheSceneAsItWas) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"far.densty=1", "--set far.densty: no such parameter; did you mean density?"},
      {"far.density=-3", "--set: far.density = -3; allowed 0 to 10 per m"},
      {"far.mix=3", "--set: far.mix = 3; allowed 0 to 1"},
      {"far.frames=3,1", "--set: far.frames; must be [first, last], first <= last"},
      {"faar.density=1",
       "--set faar.density: no such section or stage; did you mean far?"},
      {"tolerance=0", "--set: tolerance = 0; allowed 1e-09 to 1"},
      {"version=1",
       "--set version: no such key; write name.parameter=value, or "
       "tolerance=1e-3"},
      {"far.name=near",
       "--set far.name: cannot be set here; change it in the scene file"},
      {"far.density", "--set far.density: no =; write name.parameter=value"},
      {"", "--set : no =; write name.parameter=value"},
      {"=", "--set : no such key; write name.parameter=value, or tolerance=1e-3"},
  };
  SceneFile s = parse(kTwoFogs);
  const std::string before = print(s);
  for (const auto& [assignment, message] : cases) {
    try {
      set(s, assignment, specs_for);
      ADD_FAILURE() << assignment << " accepted";
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()), message);
    }
    EXPECT_EQ(print(s), before) << assignment;
  }
}

TEST(SceneFile, AKnobThatNobodyGaveStillFollowsToleranceWhenReadBack) {
  SceneFile s = parse(kTwoFogs);
  EXPECT_TRUE(setting(parse(print(s)).stages[1].params, "steps").is_default);
  set(s, "far.steps=8", specs_for);
  EXPECT_FALSE(setting(parse(print(s)).stages[1].params, "steps").is_default);
}

TEST(SceneFile, TheSchemaOfAllScenesIsJson) {
  const std::vector<StageSchema> types{{"zoo", "All kinds.", specs_of<Zoo>()},
                                       {"height_fog", "Fog.", specs_of<Zoo>()}};
  const std::string schema = scene_json_schema(types);
  EXPECT_TRUE(is_json(schema));
  for (const char* key : {"\"input\"", "\"camera\"", "\"const\": \"height_fog\"",
                          "\"tolerance\"", "\"elevation\"", "\"mask\""})
    EXPECT_NE(schema.find(key), std::string::npos) << key;
  EXPECT_TRUE(is_json(scene_json_schema({})));
}

}  // namespace
}  // namespace brume
