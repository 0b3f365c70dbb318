// Image files compared: every way to differ, and the traps of others.

#include "truth/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "image/io.h"
#include "num/error.h"

namespace brume {
namespace {

namespace fs = std::filesystem;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class DifferenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("brume_diff_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    a_ = folder_ / "a.exr", b_ = folder_ / "b.exr";
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Image image(int w, int h, float value = 0) {
    Image i;
    i.header.data_window = i.header.display_window = {0, 0, w, h};
    for (const char* name : {"B", "G", "R", "Z"}) {
      i.header.channels.push_back({.name = name, .type = PixelType::float32});
      i.planes.emplace_back(std::size_t(w) * std::size_t(h), value);
    }
    return i;
  }
  Difference compare(const Image& a, const Image& b, const DifferenceOptions& o = {}) {
    write_image(a, a_);
    write_image(b, b_);
    return compare_files(a_, b_, o);
  }

  fs::path folder_, a_, b_;
};

TEST_F(DifferenceTest, EqualFilesAreTheSame) {
  const Difference d = compare(image(70, 40, 2), image(70, 40, 2));
  EXPECT_EQ(d.verdict, Verdict::same);
  EXPECT_EQ(d.parts[0].channels.size(), 4u);
  EXPECT_EQ(d.parts[0].channels[0].samples, 2800u);
}

TEST_F(DifferenceTest, OneSampleInAnyPlaceIsFound) {
  for (const int at : {0, 63, 64, 69, 70 * 39, 70 * 40 - 1}) {
    Image b = image(70, 40, 2);
    b.planes[2][std::size_t(at)] = 2.5f;
    const Difference d = compare(image(70, 40, 2), b);
    EXPECT_EQ(d.verdict, Verdict::differ);
    const ChannelDifference& c = d.parts[0].channels[2];
    EXPECT_EQ(c.different, 1u);
    EXPECT_EQ(c.max, .5);
    EXPECT_EQ(c.x, at % 70);
    EXPECT_EQ(c.y, at / 70);
    EXPECT_EQ(c.a, 2);
    EXPECT_EQ(c.b, 2.5f);
    EXPECT_DOUBLE_EQ(c.bias, .5 / 2800);
    EXPECT_EQ(d.parts[0].channels[0].verdict, Verdict::same);
  }
}

// idiff 2.4 with -warn 0.1 -fail 1 let a difference of 0.5 pass without a word.
TEST_F(DifferenceTest, ADifferenceBetweenWarnAndFailWarns) {
  Image b = image(4, 4);
  b.planes[2][5] = .5f;
  DifferenceOptions o;
  o.warn = {{"*", .1}};
  o.fail = {{"*", 1}};
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::warn);
  b.planes[2][5] = 1.5f;
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::differ);
  b.planes[2][5] = .05f;
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::same);
}

// idiff 2.4 found a black 4x4 and a black 5x4 to be the same.
TEST_F(DifferenceTest, BlackPicturesOfDifferentSizeDoNotMatch) {
  EXPECT_EQ(compare(image(4, 4), image(5, 4)).verdict, Verdict::mismatch);
  EXPECT_EQ(compare(image(4, 4), image(4, 5)).verdict, Verdict::mismatch);
  Image moved = image(4, 4);
  moved.header.data_window.x = 1;
  EXPECT_EQ(compare(image(4, 4), moved).verdict, Verdict::mismatch);
}

TEST_F(DifferenceTest, AChannelThatOneLacksDoesNotMatchUnlessIgnored) {
  Image b = image(4, 4);
  b.header.channels.pop_back();
  b.planes.pop_back();
  DifferenceOptions o;
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::mismatch);
  EXPECT_EQ(compare(b, image(4, 4), o).verdict, Verdict::mismatch);
  o.ignore_channels = {"Z*"};
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::same);
}

TEST_F(DifferenceTest, AttributesCountUnlessIgnored) {
  Image b = image(4, 4);
  b.header.attributes["brume/report"] = Attribute::from_text("x");
  DifferenceOptions o;
  const Difference d = compare(image(4, 4), b, o);
  EXPECT_EQ(d.verdict, Verdict::differ);
  EXPECT_EQ(d.parts[0].attributes.size(), 1u);
  o.ignore_attributes = {"brume/*"};
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::same);
}

TEST_F(DifferenceTest, LimitsAreByChannelAndTheLastThatFitsHolds) {
  Image b = image(4, 4);
  b.planes[0][3] = .5f, b.planes[3][3] = 5;
  DifferenceOptions o;
  o.fail = {{"*", .6}, {"Z", 6}};
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::same);
  o.fail = {{"Z", 6}, {"*", .6}};
  EXPECT_EQ(compare(image(4, 4), b, o).verdict, Verdict::differ);
}

TEST_F(DifferenceTest, SomePercentMayFailButNoneHard) {
  Image b = image(10, 10);
  for (std::size_t i = 0; i < 5; ++i) b.planes[1][i] = .2f;
  DifferenceOptions o;
  o.fail = {{"*", .1}};
  o.fail_percent = 5;
  EXPECT_EQ(compare(image(10, 10), b, o).verdict, Verdict::same);
  o.fail_percent = 4.9;
  EXPECT_EQ(compare(image(10, 10), b, o).verdict, Verdict::differ);
  o.fail_percent = 5, o.hard_fail = .15;
  EXPECT_EQ(compare(image(10, 10), b, o).verdict, Verdict::differ);
}

TEST_F(DifferenceTest, NaNIsEqualByChoiceAndNeverToANumber) {
  Image a = image(4, 4), b = image(4, 4);
  a.planes[0][7] = b.planes[0][7] = kNaN;
  DifferenceOptions o;
  o.fail = {{"*", 1e30}};
  o.fail_percent = 100;
  EXPECT_EQ(compare(a, b, o).verdict, Verdict::differ);
  o.nan_equal = true;
  EXPECT_EQ(compare(a, b, o).verdict, Verdict::same);
  b.planes[0][7] = 1;
  EXPECT_EQ(compare(a, b, o).verdict, Verdict::differ);
  a.planes[0][7] = b.planes[0][7] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(compare(a, b, o).verdict, Verdict::same);
}

TEST_F(DifferenceTest, MeansAreOfNumbersAndSayOfHowMany) {
  Image a = image(4, 4), b = image(4, 4);
  for (std::size_t i = 0; i < 16; ++i) b.planes[0][i] = a.planes[0][i] + .5f;
  for (std::size_t i = 0; i < 12; ++i) b.planes[0][i] = kNaN;
  const Difference part = compare(a, b, {});
  const ChannelDifference& some = part.parts[0].channels[0];
  EXPECT_EQ(some.samples, 16u);
  EXPECT_EQ(some.broken, 12u);
  EXPECT_EQ(some.numbers(), 4u);
  EXPECT_EQ(some.rms, .5);
  EXPECT_EQ(some.bias, .5);
  EXPECT_TRUE(std::isinf(some.max) && std::isinf(some.p99));
  b.planes[0].assign(16, kNaN);
  const Difference whole = compare(a, b, {});
  const ChannelDifference& none = whole.parts[0].channels[0];
  EXPECT_EQ(none.numbers(), 0u);
  for (const double x : {none.rms, none.mean, none.bias, none.psnr})
    EXPECT_TRUE(std::isnan(x));
}

TEST_F(DifferenceTest, RelativeDifferencesHaveAFloor) {
  Image a = image(4, 4, 100), b = image(4, 4, 101);
  a.planes[0].assign(16, 1e-9f), b.planes[0].assign(16, 2e-9f);
  DifferenceOptions o;
  o.relative = 1e-3;
  o.fail = {{"*", .01}};
  EXPECT_EQ(compare(a, b, o).verdict, Verdict::same);  // 1/101, 1e-9/1e-3
  o.relative = 1e-12;
  EXPECT_EQ(compare(a, b, o).verdict, Verdict::differ);
}

TEST_F(DifferenceTest, OtherMetricsHaveLimitsOfTheirOwn) {
  Image a = image(32, 32, .5f), b = a;
  for (std::size_t i = 0; i < 1024; ++i) b.planes[1][i] += i % 2 ? .01f : -.01f;
  const auto verdict = [&](Metric m, double fail) {
    DifferenceOptions o;
    o.metric = m;
    o.fail = {{m == Metric::flip ? "" : "*", fail}};
    return compare(a, b, o).verdict;
  };
  EXPECT_EQ(verdict(Metric::rms, .011), Verdict::same);
  EXPECT_EQ(verdict(Metric::rms, .009), Verdict::differ);
  EXPECT_EQ(verdict(Metric::psnr, 39), Verdict::same);  // 40 dB
  EXPECT_EQ(verdict(Metric::psnr, 41), Verdict::differ);
  EXPECT_EQ(verdict(Metric::ssim, .5), Verdict::same);
  EXPECT_EQ(verdict(Metric::ssim, .999), Verdict::differ);
  EXPECT_EQ(verdict(Metric::flip, .5), Verdict::same);
  EXPECT_EQ(verdict(Metric::flip, 1e-4), Verdict::differ);
}

TEST_F(DifferenceTest, TypesOfChannelsAreANoteOnly) {
  Image b = image(4, 4, .5f);
  for (Channel& c : b.header.channels) c.type = PixelType::half;
  const Difference d = compare(image(4, 4, .5f), b);
  EXPECT_EQ(d.verdict, Verdict::same);
  EXPECT_EQ(d.parts[0].notes.size(), 4u);
}

TEST_F(DifferenceTest, PicturesOfTheDifference) {
  Image a = image(8, 8, .5f), b = image(8, 8, .25f);
  compare(a, b);
  const Image d = difference_picture(a_, b_, DifferencePicture::difference, {});
  EXPECT_EQ(d.planes[0][0], -.25f);
  EXPECT_EQ(difference_picture(a_, b_, DifferencePicture::absolute, {}).planes[3][9],
            .25f);
  const Image f = difference_picture(a_, b_, DifferencePicture::flip, {});
  EXPECT_GT(f.planes[2][0], 0);
}

TEST_F(DifferenceTest, PatternsStandForText) {
  EXPECT_TRUE(fits("*", ""));
  EXPECT_TRUE(fits("T.*", "T.R"));
  EXPECT_FALSE(fits("T.*", "L.R"));
  EXPECT_TRUE(fits("*.R", "height_fog.L.R"));
  EXPECT_FALSE(fits("", "R"));
}

TEST_F(DifferenceTest, WhatCannotBeReadIsAnError) {
  write_image(image(4, 4), a_);
  EXPECT_THROW(compare_files(a_, folder_ / "none.exr", {}), Error);
}

}  // namespace
}  // namespace brume
