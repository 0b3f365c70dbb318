// A whole study of a small frame: a stage with a knob and a source, fog beside it, what
// is left out, and a truth that finds each setting as wrong as it is.

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "image/io.h"
#include "num/error.h"
#include "scene/scene_file.h"
#include "stage/registry.h"
#include "stage/stage.h"
#include "study/prepared.h"
#include "study/report.h"
#include "study/study.h"

namespace {

// Even fog that is a part 1/4^fineness too thick, and whose source has half of it. Only
// at its default it is right; so it is its own known error.
struct Coarse : brume::Stage {
  static constexpr brume::StageAbout about{"coarse", "Fog with a knob.", BRUME_AIR,
                                           BRUME_BACKGROUND_STEP, "Nobody 1900"};
  int fineness = 16;
  double density = 0.01;
  template <class V>
  void describe(V& v) {
    v("fineness", fineness, {.minimum = 1, .maximum = 16, .knob = true});
    v("density", density, {.unit = "1/m", .minimum = 0, .maximum = 1});
  }
  void needs(const brume_frame&, brume::StageNeeds& n) override {
    n.depth = true;
    if (density == 0) n.idle = "density is 0";
  }
  void publish(const brume_frame&, brume::Publisher& world) override {
    brume_medium m = brume::new_medium();
    const double off = fineness < 16 ? std::pow(4., -fineness) : 0;
    for (int c = 0; c < 3; ++c) m.extinction[c] = density * (1 + off), m.color[c] = 1;
    world.medium(m);
  }
  void baseline(const brume_rays& rays, const float* t1, float* const L[3],
                float* const T[3]) const override {
    for (std::size_t i = 0; i < rays.n; ++i)
      for (int c = 0; c < 3; ++c) {
        T[c][i] = float(std::exp(-0.5 * density * double(t1[i])));
        L[c][i] = 1 - T[c][i];
      }
  }
};

struct Tint : brume::Stage {
  static constexpr brume::StageAbout about{"tint", "A lens.", BRUME_LENS};
  template <class V>
  void describe(V&) {}
  void run(const brume_tile&) const override {}
};

// A grey filter that is wrong by a part of what it lets through, the tolerance; its
// document has none at all.
struct Dim : brume::Stage {
  static constexpr brume::StageAbout about{
      "dim", "A grey filter.", BRUME_LENS, BRUME_BACKGROUND_STEP, "Nobody 1901", true};
  double off = 0;
  template <class V>
  void describe(V&) {}
  void needs(const brume_frame& f, brume::StageNeeds& n) override {
    off = f.tolerance;
    n.laws = BRUME_LINEAR;
  }
  static void scale(const brume_tile& t, double by) {
    for (float* plane : {t.r, t.g, t.b})
      for (int y = 0; y < t.height; ++y)
        for (int x = 0; x < t.width; ++x) plane[y * t.row_stride + x] *= float(by);
  }
  void run(const brume_tile& t) const override { scale(t, 0.5 * (1 + off)); }
  void run_baseline(const brume_tile&) const override {}
  void truth(const brume_tile& t, std::span<const int> xy, double* rgb) const override {
    const float* const planes[3] = {t.r, t.g, t.b};
    for (std::size_t k = 0; k < xy.size() / 2; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * k + c] =
            0.5 * double(planes[c][xy[2 * k + 1] * t.row_stride + xy[2 * k]]);
  }
};

// Adds the lamps' light to faces that look back; too bright likewise.
struct Torch : Dim {
  static constexpr brume::StageAbout about{"torch",          "Adds 1.", BRUME_SURFACE,
                                           BRUME_LIGHT_STEP, nullptr,   true};
  void run(const brume_tile& t) const override {
    for (float* plane : {t.r, t.g, t.b})
      for (int y = 0; y < t.height; ++y)
        for (int x = 0; x < t.width; ++x) plane[y * t.row_stride + x] += float(1 + off);
  }
  void truth(const brume_tile& t, std::span<const int> xy, double* rgb) const override {
    for (std::size_t k = 0; k < xy.size() / 2; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * k + c] = 1 + double(t.r[xy[2 * k + 1] * t.row_stride + xy[2 * k]]);
  }
};

// The same filter, whose truth takes a millisecond a pixel.
struct Slow : Dim {
  static constexpr brume::StageAbout about{
      "slow", "A grey filter.", BRUME_LENS, BRUME_BACKGROUND_STEP, nullptr, true};
  void truth(const brume_tile& t, std::span<const int> xy, double* rgb) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds(xy.size() / 2));
    Dim::truth(t, xy, rgb);
  }
};

}  // namespace

#define brume_plugin brume_plugin_study_toys
BRUME_STAGES(Coarse, Tint, Dim, Torch, Slow)
#undef brume_plugin

namespace {

const brume::LinkedPlugin kToys{"coarse", brume_plugin_study_toys};

using namespace brume;
using namespace brume::study;
namespace fs = std::filesystem;

class Run : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("brume_study_test_" + std::to_string(getpid()));
    fs::create_directories(folder);
    Image image;
    image.header.data_window = image.header.display_window = {0, 0, 48, 20};
    for (const char* name : {"B", "G", "R", "Z", "m"})
      image.header.channels.push_back({.name = name, .type = PixelType::float32});
    image.planes.assign(5, std::vector<float>(48 * 20, 0.25f));
    for (std::size_t i = 0; i < image.planes[3].size(); ++i)
      image.planes[3][i] = 1 + float(i % 480);  // planar depth [m]
    write_image(image, frame());
    options.seconds = 2;
    options.repeats = 3;
    options.pixels = 200;
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path frame() const { return folder / "frame.exr"; }

  Study study(const std::string& toml) {
    const SceneFile scene = parse_scene(
        toml, "test.toml", [&](const std::string& type, const Location& where) {
          return registry.specs(type, where);
        });
    return study::run(scene, registry, frame(), options);
  }

  fs::path folder;
  study::Options options;
  Registry registry;
};

const Method* method(const Subject& s, const std::string& name) {
  for (const Method& m : s.methods)
    if (m.name == name) return &m;
  return nullptr;
}

TEST_F(Run, FindsEverySettingAsWrongAsItIs) {
  const Study s = study("[[stage]]\ntype = \"coarse\"\n");
  ASSERT_EQ(s.subjects.size(), 1u);
  const Subject& fog = s.whole();
  EXPECT_EQ(fog.name, "coarse");
  EXPECT_EQ(fog.grid_width * fog.grid_height <= 200, true);
  const Method* knob = method(fog, "brume, coarse.fineness");
  ASSERT_NE(knob, nullptr);
  ASSERT_EQ(knob->points.size(), 4u);  // 1, 2, 4, 8; at 16 it is what any tolerance gives
  EXPECT_EQ(knob->points[1].set, std::vector<std::string>{"coarse.fineness=2"});
  for (std::size_t k = 0; k < 4; ++k) {
    // d(e^-tau) = tau e^-tau 4^-n, at most 4^-n / e. The frame has pixels at tau near 1.
    const double most = std::pow(4., -std::pow(2., double(k))) * std::exp(-1);
    EXPECT_LE(knob->points[k].T.max, most + 3e-7) << k;
    EXPECT_GE(knob->points[k].T.max, 0.85 * most - 3e-7) << k;
  }
  const Method* ours = method(fog, "brume");
  ASSERT_NE(ours, nullptr);
  EXPECT_EQ(ours->points.front().setting, "any tolerance");
  EXPECT_LT(ours->points.front().color.max, 3e-7);  // float's rounding of T and L
  const Method* source = method(fog, "Nobody 1900");
  ASSERT_NE(source, nullptr);
  EXPECT_NEAR(source->points[0].T.max, 0.25, 0.01);  // of e^-x/2 - e^-x, at x = 2 ln 2
  const Method* steps = method(fog, "even steps");
  ASSERT_NE(steps, nullptr);
  for (std::size_t k = 1; k < steps->points.size(); ++k)
    EXPECT_LT(steps->points[k].color.max, steps->points[k - 1].color.max);
  for (const Method& m : fog.methods)
    for (const Point& p : m.points) {
      EXPECT_GT(p.seconds, 0);
      EXPECT_LE(p.per_pixel.low, p.per_pixel.median);
      EXPECT_LE(p.per_pixel.median, p.per_pixel.high);
      EXPECT_EQ(p.map.size(), std::size_t(fog.grid_width * fog.grid_height));
    }
  // And so it chooses.
  EXPECT_EQ(choose_by_error(s, 1e-6).point->color.max <= 1e-6, true);
  EXPECT_EQ(choose_by_time(s, 1e-12).point, nullptr);
}

TEST_F(Run, StudiesEachStageAloneAndAllTogetherAndSaysWhatItLeavesOut) {
  const Study s = study(
      "[[stage]]\ntype = \"coarse\"\n[[stage]]\ntype = \"coarse\"\nname = \"other\"\n"
      "density = 0.002\nmask = \"m\"\n[[stage]]\ntype = \"coarse\"\nname = \"none\"\n"
      "density = 0\n[[stage]]\ntype = \"tint\"\n");
  ASSERT_EQ(s.subjects.size(), 3u);
  EXPECT_EQ(s.subjects[0].name, "coarse");
  EXPECT_EQ(s.subjects[1].name, "other");
  EXPECT_TRUE(s.whole().whole);
  ASSERT_EQ(s.notes.size(), 2u);
  EXPECT_EQ(s.notes[0], "none: density is 0");
  EXPECT_EQ(s.notes[1].substr(0, 5), "tint:");
  // Another stage's knob is none of its business; in the scene both are.
  EXPECT_EQ(method(s.subjects[0], "brume, other.fineness"), nullptr);
  EXPECT_NE(method(s.whole(), "brume, other.fineness"), nullptr);
  // Masked, a source has no answer; the mask itself counts: T^(1/4) at tau = 0.002 t.
  EXPECT_EQ(method(s.subjects[1], "Nobody 1900"), nullptr);
  ASSERT_EQ(s.subjects[1].notes.size(), 1u);
  EXPECT_LT(method(s.subjects[1], "brume")->points[0].T.max, 3e-7);
  EXPECT_NE(method(s.whole(), "one painted over the other"), nullptr);
}

TEST_F(Run, HoldsTheIntegratorToWhatTheProductHoldsItTo) {
  // The integrator has a part of the tolerance alone, and makes more of it than it is
  // told: at 1e-3 it is told less than half.
  const SceneFile scene =
      parse_scene("tolerance = 1e-3\n[[stage]]\ntype = \"coarse\"\n", "test.toml",
                  [&](const std::string& type, const Location& where) {
                    return registry.specs(type, where);
                  });
  const FrameFiles files(scene, {}, frame());
  const Prepared given = Preparer(scene, registry, files).given();
  double told = 0;
  for (const KnobPlan& knob : given.made->plan().knobs)
    if (knob.name == "air") told = knob.value;
  EXPECT_GT(told, 0);
  EXPECT_LT(told, 5e-4);
  EXPECT_EQ(given.tolerance, told);
}

TEST_F(Run, HoldsALensAgainstItsOwnTruth) {
  const Study s = study("[[stage]]\ntype = \"dim\"\n");
  ASSERT_EQ(s.subjects.size(), 1u);
  const Subject& lens = s.subjects[0];
  EXPECT_EQ(lens.name, "dim");
  const Method* ours = method(lens, "brume");
  ASSERT_NE(ours, nullptr);
  ASSERT_EQ(ours->points.size(),
            5u);  // tolerances 0.1 to 1e-5; the scene's is among them
  double tolerance = 0.1;
  for (const Point& p : ours->points) {
    // 0.25 in, 0.125 wanted, error relative to 1 + that; float rounds 1e-8 of it.
    EXPECT_NEAR(p.color.max, 0.125 * tolerance / 1.125, 2e-8) << p.setting;
    EXPECT_NEAR(p.color.mean, p.color.max, 2e-8);
    EXPECT_GE(p.seconds, 0);
    tolerance /= 10;
  }
  const Method* source = method(lens, "Nobody 1901");
  ASSERT_NE(source, nullptr);
  EXPECT_NEAR(source->points[0].color.max, 0.125 / 1.125, 1e-7);
  const Method* windows = method(lens, "its pattern summed over a window");
  ASSERT_NE(windows,
            nullptr);  // one pixel's pattern is that pixel; 1e-3 off, as the scene
  EXPECT_NEAR(windows->points[0].color.max, 0.125 * 1e-3 / 1.125, 1e-7);
  EXPECT_NE(choose_by_error(s, 1e-3).point, nullptr);
}

TEST_F(Run, StudiesAirAndPixelsOfOneScene) {
  const Study s = study(
      "[camera]\nposition = [0, 0, 50]\nlook_at = [0, 1000, 20]\nfocal = 30\n"
      "[[stage]]\ntype = \"coarse\"\n[[stage]]\ntype = \"torch\"\n[[stage]]\n"
      "type = \"dim\"\n");
  ASSERT_EQ(s.subjects.size(), 3u);
  EXPECT_EQ(s.subjects[0].name, "torch");
  EXPECT_EQ(s.subjects[1].name, "dim");
  EXPECT_TRUE(s.whole().whole);
  // 1 + t on 0.25, of 1.25.
  EXPECT_NEAR(s.subjects[0].methods[0].points[1].color.max, 0.01 / 2.25, 2e-7);
  EXPECT_NE(csv(s).find("\"dim\",source,\"Nobody 1901\""), std::string::npos);
}

TEST_F(Run, TakesTheSecondsItIsGivenAndMakesUseOfThem) {
  // All 960 pixels would take a truth of half a second to a second.
  options.pixels = 960;
  options.pictures = false;
  std::size_t held[2] = {};
  for (const bool more : {false, true}) {
    options.seconds = more ? 6 : 0.6;
    const Study s = study("[[stage]]\ntype = \"slow\"\n");
    EXPECT_LT(s.seconds, options.seconds + 0.6) << options.seconds;
    held[more] = s.whole().rays;
  }
  EXPECT_LT(held[0], 960u);
  EXPECT_GE(held[1], 960u);
  std::printf("%zu pixels, and %zu\n", held[0], held[1]);
}

TEST_F(Run, RefusesASceneWithoutAir) {
  EXPECT_THROW(study("[[stage]]\ntype = \"tint\"\n"), Error);
  EXPECT_THROW(study("version = 1\n"), Error);
}

}  // namespace
