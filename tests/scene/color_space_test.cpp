// Colours of a scene file, in the primaries of a frame.

#include "scene/color_space.h"

#include <gtest/gtest.h>

#include "params/describe.h"

namespace brume {
namespace {

constexpr Chromaticities kAcesCg{.713, .293, .165, .830, .128, .044, .32168, .33767};
constexpr Chromaticities kRec2020{.708, .292, .170, .797, .131, .046, .3127, .3290};

void expect_near(const glm::dvec3& got, const glm::dvec3& want, double tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], tolerance) << "channel " << c;
}

TEST(ColorSpace, WhiteIsWhiteAndBlackBlackInAnyPrimaries) {
  for (const std::string& name : color_space_names())
    for (const Chromaticities& frame : {kRec709, kAcesCg, kRec2020}) {
      SCOPED_TRACE(name);
      expect_near(to_frame(name, frame, {1, 1, 1}), {1, 1, 1}, 1e-12);
      expect_near(to_frame(name, frame, {0, 0, 0}), {0, 0, 0}, 0);
    }
}

TEST(ColorSpace, TheFrameItselfKeepsEveryBit) {
  const glm::dvec3 odd{.1, -.7, 1e30};
  EXPECT_EQ(to_frame("frame", kAcesCg, odd), odd);
  EXPECT_EQ(to_frame("rec709", kRec709, odd), odd);
}

// The matrix of ITU-R BT.2087-0 (Rec.709 to Rec.2020), given to 4 decimals.
TEST(ColorSpace, Rec709InRec2020) {
  expect_near(to_frame("rec709", kRec2020, {1, 0, 0}), {.6274, .0691, .0164}, 5.1e-5);
  expect_near(to_frame("rec709", kRec2020, {0, 1, 0}), {.3293, .9195, .0880}, 5.1e-5);
  expect_near(to_frame("rec709", kRec2020, {0, 0, 1}), {.0433, .0114, .8956}, 5.1e-5);
}

// AP1 to linear sRGB as the ACES output transforms have it (Bradford, D60 to D65), to
// 4 decimals; their D65 differs from Rec.709's in the fifth.
TEST(ColorSpace, AcesCgInRec709) {
  expect_near(to_frame("acescg", kRec709, {1, 0, 0}), {1.7051, -.1303, -.0240}, 3e-4);
  expect_near(to_frame("acescg", kRec709, {0, 1, 0}), {-.6218, 1.1408, -.1290}, 3e-4);
  expect_near(to_frame("acescg", kRec709, {0, 0, 1}), {-.0833, -.0105, 1.1530}, 3e-4);
}

TEST(ColorSpace, SrgbIsDecoded) {
  // IEC 61966-2-1: 0.5 and the end of the straight part.
  expect_near(to_frame("srgb", kRec709, {.5, .04045, -.5}),
              {.21404114, .04045 / 12.92, -.21404114}, 1e-8);
}

struct Fog {
  Rgb density{1, 2, 3}, color{0, 0, 1}, albedo{0, 0, 1};
  RgbOr source{{}, "sky"};
  double g = .5;
  template <class V>
  void describe(V& v) {
    v("density", density, {.unit = "1/m", .minimum = 0});
    v("color", color, {.minimum = -9, .maximum = 9});
    v("albedo", albedo, {.minimum = 0, .maximum = 1});
    v("source", source, {.words = {"sky"}});
    v("g", g, {});
  }
};

TEST(ColorSpace, OfAStageColoursAreTakenAndCoefficientsNot) {
  const auto specs = specs_of<Fog>();
  std::vector<Value> values;
  for (const auto& s : specs)
    values.push_back(
        {.numbers = s.default_text.empty() ? s.default_numbers : std::vector<double>{},
         .text = s.default_text});
  to_frame("acescg", kRec709, specs, values);
  EXPECT_EQ(values[0].numbers, (std::vector<double>{1, 2, 3}));
  EXPECT_NEAR(values[1].numbers[0], -.0833, 3e-4);
  // What is not to be had in the range is at its end.
  EXPECT_EQ(values[2].numbers, (std::vector<double>{0, 0, 1}));
  EXPECT_EQ(values[3].text, "sky");
  EXPECT_EQ(values[4].numbers, (std::vector<double>{.5}));
}

}  // namespace
}  // namespace brume
