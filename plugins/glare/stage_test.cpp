// Facts about glare through the product's own path.

#include <gtest/gtest.h>

#include <numbers>

#include "../../tests/pipeline/frames.h"
#include "../../tests/stage/generated.h"
#include "oracle.h"
#include "patterns_test.h"
#include "stage/instance.h"

namespace brume::glare {
namespace {

using test::Pixels;

class GlareStage : public testing::Test {
 protected:
  Registry registry;
  Pixels pixels = test::make_pixels(83, 47);

  test::Result run(const std::string& parameters) {
    Session session(test::scene_of(registry, "[[stage]]\ntype = \"glare\"\n" +
                                                 parameters + test::kCamera),
                    registry);
    const PreparedFrame frame = session.prepare(test::source_of(pixels, pixels.window));
    reason = frame.plan().stages.at(0).reason;
    return test::apply_whole(frame, pixels, pixels.window);
  }
  std::string reason;
};

TEST_F(GlareStage, AddsLightWhereThereIsNoCoverage) {
  const test::Result out = run("strength = 0.5\n");
  int outside = 0;
  for (std::size_t i = 0; i < pixels.a.size(); ++i) {
    if (pixels.a[i] == 0) outside += out["G"][i] > 0;
    ASSERT_GE(out["G"][i], 0);
  }
  EXPECT_GT(outside, 1000);
  for (const std::string& name : out.names)
    EXPECT_NE(name, "A") << "coverage is not light";
}

TEST_F(GlareStage, IsTheDirectSumThroughTheWholeProduct) {
  const test::Result out = run("strength = 0.5\npixel_angle = 0.03\n");
  PatternSettings s;
  s.pixel = 0.03 * std::numbers::pi / 180;
  s.reach = 20 * std::numbers::pi / 180;
  const Kernel k = make_kernel(s, 83, 47);
  const auto want = direct(pixels.g, 83, 47, k, 1, 0.5);
  for (std::size_t i = 0; i < want.size(); ++i)
    ASSERT_NEAR(out["G"][i], double(want[i]), 1e-5 * double(want[i]));
}

TEST_F(GlareStage, GivesToNeighboursWhateverTheCentreKeeps) {
  // Pixels of 1800 lambda / D: next to nothing leaves one, but of 1e38 that is seen.
  pixels.g[20 * 83 + 40] = 1e38f;
  const float before = pixels.g[20 * 83 + 41];
  const test::Result out = run(
      "pattern = \"aperture\"\naperture = 1000\nstrength = 1\npixel_angle = 0.0573\n");
  EXPECT_GT(out["G"][20 * 83 + 41], 1e20f) << "was " << before;
}

TEST_F(GlareStage, BelowTheThresholdNothingGlares) {
  // Only green has pixels over 10; a pixel's colour counts as a whole.
  const test::Result out = run("strength = 0.5\nthreshold = 2000\nknee = 0\n");
  for (std::size_t i = 0; i < pixels.g.size(); ++i) ASSERT_EQ(out["G"][i], pixels.g[i]);
  const test::Result some = run("strength = 0.5\nthreshold = 100\nknee = 0.5\n");
  for (std::size_t i = 0; i < pixels.g.size(); ++i)
    ASSERT_TRUE(pixels.g[i] > 50 || some["G"][i] >= pixels.g[i]) << "gave light";
}

TEST_F(GlareStage, SetsInWithoutAStep) {
  // One pixel, brighter and brighter: what it gives grows from 0 at (1 - knee) threshold,
  // with a slope that never jumps.
  double last = 0, slope = 0;
  for (double v = 0.4; v < 2; v += 0.01) {
    for (auto* plane : {&pixels.r, &pixels.g, &pixels.b})
      std::fill(plane->begin(), plane->end(), 0.f);
    pixels.g[20 * 83 + 40] = float(v);
    const double given =
        v - run("strength = 1\nthreshold = 1\nknee = 0.5\n")["G"][20 * 83 + 40];
    if (v > 0.405) {
      // d(part)/dv = (over + k) / (2 k): it grows by .01 in a step of .01 at k = .5;
      // twice that for the parabola's own bend; 1e-4 of light is left out as unseen.
      EXPECT_LE(std::abs((given - last) / 0.01 - slope), 0.02 + 0.011) << v;
      slope = (given - last) / 0.01;
    }
    last = given;
  }
}

TEST_F(GlareStage, LeavesItselfOut) {
  run("strength = 0\n");
  EXPECT_NE(reason.find("strength is 0"), std::string::npos) << reason;
  run("tint = 0\n");
  EXPECT_NE(reason.find("tint is 0"), std::string::npos) << reason;
  // Less light than anyone can see, with the scene's tolerance: the same bits.
  const test::Result out = run("strength = 1e-9\n");
  for (std::size_t i = 0; i < pixels.g.size(); ++i) ASSERT_EQ(out["G"][i], pixels.g[i]);
}

TEST_F(GlareStage, TellsWhatIsWrongWithAnImage) {
  EXPECT_THROW(run("pattern = \"image\"\n"), std::exception);
  EXPECT_THROW(run("pattern = \"image\"\nimage = \"/nowhere.exr\"\n"), std::exception);
  run("pattern = \"image\"\nimage = \"" + pattern_image() + "\"\n");
}

TEST_F(GlareStage, ItsParametersAreInItsReadme) {
  test::expect_generated("plugins/glare/README.md", "parameters",
                         markdown_table(registry.specs("glare")));
}

}  // namespace
}  // namespace brume::glare
