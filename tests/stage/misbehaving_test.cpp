// A plugin that fails when it is called: one Error that names place, stage, function and
// cause; nothing of it in the World.

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "num/error.h"
#include "stage/instance.h"
#include "stage/registry.h"

namespace {

using namespace brume;

class Misbehaving : public testing::Test {
 protected:
  Misbehaving()
      : registry_({.files = {std::string(BROKEN_FOLDER) + "/brume_misbehaves.so"},
                   .use_environment = false,
                   .use_linked = false,
                   .use_trees = false}) {}

  StageInstance make(const std::string& stage, const std::string& how) {
    const std::vector<Value> values{{.text = how}};
    return {registry_.find(stage), "toy", values, cache_, {"shot.toml", 12, 3}};
  }

  // Runs the stage's whole life; the error, or "".
  std::string life(const std::string& stage, const std::string& how) {
    try {
      StageInstance i = make(stage, how);
      i.needs({});
      i.publish({}, 0, world_);
      if (i.type().role != BRUME_AIR) {
        brume_tile tile{};
        tile.size = sizeof tile;
        i.run(tile);
      }
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }

  static int alive() {
    void* module = dlopen(BROKEN_FOLDER "/brume_misbehaves.so", RTLD_NOW | RTLD_NOLOAD);
    const auto count = reinterpret_cast<int (*)()>(dlsym(module, "misbehaving_alive"));
    const int n = count();
    dlclose(module);
    return n;
  }

  Registry registry_;
  StageCache cache_;
  World world_;
};

TEST_F(Misbehaving, EveryWayToFailInEveryFunctionIsOneClearLine) {
  struct Way {
    const char *how, *says;
  };
  const Way ways[] = {
      {"says why", "out of cheese"},
      {"silent", "failed and did not say why"},
      {"null message", "failed and did not say why"},
      {"twice", "the cause"},
      {"not utf-8", "bad ?? bytes and a line"},
      {"fails but returns ok", "said to fail"},
      {"garbage status", "returned status 1234567, which is none of brume_status"},
      {"negative status", "returned status -1, which is none of brume_status"},
      {"no memory", "no memory"},
      {"throws", "threw thrown over the border"},
      {"throws bad_alloc", "no memory"},
      {"throws int", "threw something that is no std::exception"},
  };
  const std::pair<const char*, const char*> places[] = {{"misbehaves", "create"},
                                                        {"misbehaves", "needs"},
                                                        {"misbehaves", "publish"},
                                                        {"spoils", "run"}};
  for (const auto& [stage, function] : places)
    for (const Way& w : ways) {
      const std::string error = life(stage, std::string(function) + " " + w.how);
      EXPECT_EQ(error, "shot.toml:12:3: toy (" + std::string(stage) + "): " + function +
                           ": " + w.says +
                           "; the plugin is " BROKEN_FOLDER "/brume_misbehaves.so");
    }
  // Nothing of a stage that failed, not even the good medium it published before.
  EXPECT_TRUE(world_.media.empty());
  EXPECT_EQ(alive(), 0);  // what was created was destroyed, what was not was not
}

TEST_F(Misbehaving, AMessageOfMegabytesIsCut) {
  const std::string error = life("misbehaves", "publish long message");
  EXPECT_LT(error.size(), 1000u);
  EXPECT_NE(error.find("xxx..."), std::string::npos);
}

TEST_F(Misbehaving, NonsensePublishedIsNamedAndKeptOut) {
  struct Case {
    const char *how, *says;
  };
  const std::string medium = "published a brume_medium that makes no sense: ";
  const Case cases[] = {
      {"null medium", "published a brume_medium that makes no sense: null"},
      {"small medium", "brume_medium of 8 bytes; expected at least"},
      {"nan extinction", "\"mist\": extinction 1 is nan; expected 0 to"},
      {"negative extinction", "extinction 1 is -1; expected 0 to"},
      {"infinite extinction", "extinction 2 is inf; expected 0 to"},
      {"albedo above 1", "albedo 0 is 1.5; expected 0 to 1"},
      {"g of 1", "g is 1; expected -1 < g < 1"},
      {"opacity above 1", "max_opacity is 1.01; expected 0 to 1"},
      {"nan start", "start is nan; expected 0 to inf"},
      {"unknown shape", "shape is -3; expected 0 to 3"},
      {"unknown profile", "profile is 99; expected 0 to 3"},
      {"unknown source", "source is 99; expected 0 to 2"},
      {"unknown phase", "phase is 3; expected 0 to 2"},
      {"direction no unit vector", "direction has length 0.5; expected 1"},
      {"nan falloff", "falloff is nan"},
      {"negative lorentzian", "falloff is -1; expected 0 to"},
      {"nan bounds", "local_from_world 7 is nan"},
      {"custom profile without functions",
       "no function integral; a custom profile needs it"},
      {"custom source without functions",
       "no function source_at; a custom source needs it"},
      {"wavelengths without functions",
       "no function spectral_point; a medium of wavelengths needs it"},
      {"absurd wavelengths", "wavelengths is 1.07374182e+09; expected 0 to 4096"},
      {"negative power", "brume_light that makes no sense: power 0 is -1"},
      {"cone wider than pi", "cone is 4; expected 0 to 3.14"},
      {"unknown light", "kind is 17; expected 0 to 3"},
      {"sun without direction", "direction has length 0; expected 1"},
      {"lamp nowhere", "position 1 is inf"},
      {"hollow shadower", "no function optical_depth; a shadower needs it"},
      {"hollow interface", "no function hit; an interface needs it"},
      {"hollow background", "no function radiance; a background needs it"},
  };
  for (const Case& c : cases) {
    const std::string error = life("misbehaves", c.how);
    EXPECT_NE(error.find(c.says), std::string::npos) << c.how << ": " << error;
    EXPECT_NE(error.find("toy (misbehaves): publish: published a brume_"),
              std::string::npos)
        << c.how << ": " << error;
  }
  EXPECT_TRUE(world_.media.empty());
  EXPECT_TRUE(world_.lights.empty());
  EXPECT_TRUE(world_.shadowers.empty());
}

TEST_F(Misbehaving, NeedsThatMakeNoSense) {
  struct Case {
    const char *how, *says;
  };
  const Case cases[] = {
      {"counts without a list", "channels: a count of 3 and no list"},
      {"absurd count", "channels: a count of 18446744073709551615"},
      {"null channel", "channels: a channel without name"},
      {"negative rows", "rows_around is -1"},
      {"nan distance", "nearest is nan"},
      {"farthest before nearest", "farthest is 5; expected 10 to inf"},
      {"nan promise", "promise is nan"},
  };
  for (const Case& c : cases)
    EXPECT_NE(
        life("misbehaves", c.how)
            .find(std::string("toy (misbehaves): needs: its answer makes no sense: ") +
                  c.says),
        std::string::npos)
        << c.how << ": " << life("misbehaves", c.how);
}

TEST_F(Misbehaving, AStageThatBehavesIsHeard) {
  StageInstance i = make("misbehaves", "idle");
  EXPECT_EQ(i.needs({}).idle, "it is Sunday");
  i.publish({}, 3, world_);
  ASSERT_EQ(world_.media.size(), 1u);
  EXPECT_EQ(world_.media[0].stage, 3);
  EXPECT_EQ(world_.media[0].name, "toy/mist");
}

TEST_F(Misbehaving, ANameOfGarbageIsCleaned) {
  EXPECT_EQ(life("misbehaves", "name of garbage"), "");
  ASSERT_EQ(world_.media.size(), 2u);
  EXPECT_EQ(world_.media[1].name,
            "toy/?"
            "?(");
}

TEST_F(Misbehaving, AnExceptionInDestroyGoesNowhere) {
  EXPECT_EQ(life("misbehaves", "throws in destroy"), "");
  EXPECT_EQ(alive(), 0);
}

TEST_F(Misbehaving, WithoutASceneTheFileStandsInFront) {
  const std::vector<Value> values{{.text = "create says why"}};
  try {
    StageInstance i(registry_.find("misbehaves"), "misbehaves", values, cache_);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(),
                 BROKEN_FOLDER "/brume_misbehaves.so: misbehaves: create: out of cheese");
  }
}

}  // namespace
