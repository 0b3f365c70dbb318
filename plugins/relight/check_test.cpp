// What --check says of this stage: its own truth holds it, and finds what is wrong.

#include "truth/check.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "frames_test.h"
#include "image/io.h"

namespace {

using namespace relight::test;
namespace fs = std::filesystem;

// "relight_more": relight, but that it adds a hundredth too much.
const brume_stage& honest() {
  static Registry own({{}, true, false});
  return own.find("relight").table;
}

brume_status run_more(void* self, const brume_host* host, const brume_tile* tile) {
  const std::vector<float> before[3] = {{tile->r, tile->r + tile->width},
                                        {tile->g, tile->g + tile->width},
                                        {tile->b, tile->b + tile->width}};
  const brume_status status = honest().run(self, host, tile);
  float* const C[3] = {tile->r, tile->g, tile->b};
  for (int c = 0; c < 3; ++c)
    for (int x = 0; x < tile->width; ++x)
      C[c][x] += .01f * (C[c][x] - before[c][std::size_t(x)]);
  return status;
}

extern "C" const brume_plugin_info* more_plugin() {
  static brume_stage stage = honest();
  stage.name = "relight_more";
  stage.run = run_more;  // tiles of one row, as the pipeline's are
  static const brume_stage* const stages[] = {&stage};
  static const brume_plugin_info info = {sizeof info, BRUME_ABI, "1", stages, 1};
  return &info;
}
const brume::LinkedPlugin kLinked{"more", more_plugin};

class RelightCheck : public Relight {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("brume_relight_" + std::to_string(getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  truth::Check check(Frame f, const std::string& stages) {
    Image image;
    image.header = source_of(f).header;
    std::ranges::sort(image.header.channels, {}, &Channel::name);
    for (const Channel& c : image.header.channels)
      image.planes.push_back(f.planes.at(c.name));
    write_image(image, folder / "in.exr");
    const Session session(brume::test::scene_of(registry, f.head + f.camera + stages),
                          registry);
    return truth::check_frame(session, 1, folder / "in.exr", 300);
  }
  fs::path folder;
};

const std::string kLamp = stage_of({{1, 9, 3}, {50, 30, 20}, .1}, "a"),
                  kFog = "[[stage]]\ntype = \"height_fog\"\ndensity = 0.03\n";

TEST_F(RelightCheck, KeepsTheToleranceOfTheWholeScene) {
  // A ball on a plane: edges, sky, shaded sides; normals from depth.
  const Frame f =
      frame_of(nearest({plane({0, 0, 0}, {.1, 0, 1}), sphere({0, 10, 2}, 1.5)}));
  const truth::Check c = check(f, kRelight + kFog + kLamp);
  EXPECT_TRUE(c.kept()) << c.worst;
  EXPECT_TRUE(c.unproven.empty());
  EXPECT_EQ(c.unconverged, 0);
  // Open are pixels on the ball's edge, and a few where the plane's tangents tie.
  EXPECT_LT(c.undecided, c.pixels / 10);
  EXPECT_LT(c.truth_error, .5);
}

TEST_F(RelightCheck, FindsAHundredthTooMuch) {
  const Frame f = frame_of(plane({0, 0, 0}, {.1, 0, 1}));
  const truth::Check right = check(f, kRelight + kFog + kLamp);
  EXPECT_LT(right.worst, .2);
  const std::string more =
      "[[stage]]\ntype = \"relight_more\"\nalbedo = [0.2, 0.4, 0.8]\n";
  const truth::Check wrong = check(f, more + kFog + kLamp);
  EXPECT_FALSE(wrong.kept());
  // S = 0.1 + E': a hundredth of E' is off, dimmed by the fog before it. Some pixels are
  // of the brightest.
  const Out out = run(f, kRelight + kLamp);
  double dS = 0, dC = 0, most = 0;
  for (const auto& k : wrong.classes) dS = std::max(dS, k.dS), dC = std::max(dC, k.dC);
  for (const char* c : kChannels)
    for (std::size_t i = 0; i < f.truth.size(); ++i)
      most = std::max(most, added(out, f, c, i));
  EXPECT_LE(dS, .0101 * most);
  EXPECT_GT(dS, .0075 * most);
  EXPECT_LT(dC, dS);
  EXPECT_GT(dC, .6 * dS);  // fog of 0.03/m over 10 m
}

TEST_F(RelightCheck, CountsMaskMixAndSeveralInARow) {
  Frame f = frame_of(plane({0, 0, 0}, {.1, 0, 1}));
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    f.planes["M"].push_back(float(i % 5) / 4);
  const std::string own =
      "[[stage]]\ntype = \"relight\"\nname = \"b\"\nalbedo = "
      "\"color\"\nmask = \"M\"\nmix = 0.6\n";
  const truth::Check c = check(f, kRelight + "mix = 0.5\n" + own + kFog + kLamp);
  EXPECT_TRUE(c.kept()) << c.worst;
  EXPECT_LT(c.worst, .2);
  for (const auto& k : c.classes) EXPECT_LT(k.dS, 3e-4) << k.name;
}

TEST_F(RelightCheck, NormalsOfALayerLeaveNothingOpen) {
  Frame f = frame_of(nearest({plane({0, 0, 0}, {.1, 0, 1}), sphere({0, 10, 2}, 1.5)}));
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    for (int k = 0; k < 3; ++k)
      f.planes["N." + std::string(1, "XYZ"[k])].push_back(float(f.truth[i].n[k]));
  const truth::Check c = check(f, kRelight + kFog + kLamp);
  EXPECT_TRUE(c.kept()) << c.worst;
  EXPECT_EQ(c.undecided, 0);
  EXPECT_LT(c.truth_error, .02);
}

}  // namespace
