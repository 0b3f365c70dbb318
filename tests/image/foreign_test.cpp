// Formats other than EXR, through the image_io module of this build.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "image/io.h"
#include "image/oracle.h"
#include "image/support.h"
#include "num/error.h"

namespace brume {
namespace {

using oracle::TempFile;

bool has_module() {
  return std::filesystem::exists(std::string(BRUME_BUILD_DIR) + "/plugins/image_io.so");
}

Image picture(PixelType type) {
  Image image;
  image.header.data_window = image.header.display_window = {0, 0, 37, 23};
  for (const char* n : {"A", "B", "G", "R"}) image.header.channels.push_back({n, type});
  for (int c = 0; c < 4; ++c) {
    image.planes.emplace_back(37 * 23);
    for (int i = 0; i < 37 * 23; ++i)
      image.planes[c][i] = float((i * (c + 3)) % 256) / 255.0f;
  }
  // Premultiplied: no colour above alpha.
  for (int i = 0; i < 37 * 23; ++i) {
    image.planes[0][i] = std::max(image.planes[0][i], 0.25f);
    for (int c = 1; c < 4; ++c)
      image.planes[c][i] = std::min(image.planes[c][i], image.planes[0][i]);
  }
  return image;
}

class Foreign : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_module()) GTEST_SKIP() << "built without BRUME_WITH_OIIO";
  }
};

TEST_F(Foreign, IntegersKeepTheirStepAndOrder) {
  for (const char* file : {"a.png", "a.tga", "a.bmp"}) {
    SCOPED_TRACE(file);
    const TempFile out(file);
    const Image image = picture(PixelType::half);
    write_image(image, out.path);
    const Image back = read_image(out.path);
    EXPECT_EQ(back.header.data_window, image.header.data_window);
    for (const Channel& c : back.header.channels) {
      const int i = image.header.find(c.name), k = back.header.find(c.name);
      ASSERT_GE(i, 0) << c.name;
      for (std::size_t p = 0; p < back.planes[k].size(); ++p)
        // Half a step each for the colour and its quotient by alpha (1e-6: float).
        ASSERT_NEAR(back.planes[k][p], image.planes[i][p], 1.0 / 255 + 1e-6)
            << c.name << p;
    }
    EXPECT_GE(back.header.channels.size(), 3u);
  }
}

TEST_F(Foreign, FloatChannelsGetSixteenBits) {
  const TempFile out("b.png");
  Image image = picture(PixelType::float32);
  for (float& v : image.planes[0]) v = 1;
  for (float& v : image.planes[1]) v = std::sqrt(v);
  write_image(image, out.path);
  const Image back = read_image(out.path);
  for (int c = 0; c < 4; ++c)
    for (std::size_t p = 0; p < back.planes[c].size(); ++p)
      // Half a step of 1/65535, and the float's rounding.
      ASSERT_NEAR(back.planes[c][p], image.planes[c][p], 0.51 / 65535);
}

TEST_F(Foreign, TiffKeepsFloatsAndEveryChannel) {
  const TempFile out("c.tif");
  Image image = picture(PixelType::float32);
  image.header.channels.push_back({"Z", PixelType::float32});
  image.planes.emplace_back(37 * 23, 1e10f);
  image.planes[0][5] = -3.25f;
  write_image(image, out.path);
  const Image back = read_image(out.path);
  ASSERT_EQ(back.planes.size(), 5u);
  for (int c = 0; c < 4; ++c)
    EXPECT_TRUE(same_bits(back.planes[c], image.planes[c])) << c;
  EXPECT_EQ(back.planes[4][0], 1e10f);
}

TEST_F(Foreign, ExrAndOthersAreMadeFromEachOther) {
  const TempFile in("d.exr"), png("d.png"), back("e.exr");
  write_image(picture(PixelType::half), in.path);
  Edit edit;
  edit.channels = {{"R"}};
  const auto source = open_image(in.path);
  EXPECT_TRUE(source->streams());
  copy_edited(*source, edit, png.path, [](Band& b) {
    for (int i = 0; i < b.rows * 37; ++i) b.out[0][i] *= 0.5f;
  });
  const auto read = open_image(png.path);
  EXPECT_FALSE(read->streams());
  copy_edited(*read, {}, back.path, {});
  const Image before = read_image(in.path), after = read_image(back.path);
  for (std::size_t p = 0; p < 37 * 23; ++p) {
    // Half a step of 1/255 each for colour, alpha and their quotient; half's own 2^-11.
    const double close = 1.5 / 255 + std::ldexp(1.0, -11);
    ASSERT_NEAR(after.planes[3][p], 0.5f * before.planes[3][p], close);
    ASSERT_NEAR(after.planes[2][p], before.planes[2][p], close);
  }
}

TEST_F(Foreign, WhatCannotBeIsRefusedAndLeavesNothing) {
  const TempFolder folder("foreign");
  EXPECT_THROW(write_image(picture(PixelType::half), folder.path / "a.nosuchformat"),
               Error);
  Image odd = picture(PixelType::half);
  for (Channel& c : odd.header.channels) c.name = "x" + c.name;
  EXPECT_THROW(write_image(odd, folder.path / "a.png"), Error);
  EXPECT_TRUE(folder.names().empty());
  write_bytes(folder.path / "text.png", std::string("no picture at all"));
  EXPECT_THROW(read_headers(folder.path / "text.png"), Error);
  // (A PNG would do, but libpng makes OpenImageIO leak and prints a line itself.)
  write_image(picture(PixelType::half), folder.path / "b.tga");
  const auto whole = bytes_of(folder.path / "b.tga");
  write_bytes(folder.path / "b.tga", std::span(whole).first(whole.size() / 2));
  EXPECT_THROW(read_image(folder.path / "b.tga"), Error);
}

TEST(ForeignAbsent, WithoutTheModuleTheMessageSaysSo) {
  if (has_module()) GTEST_SKIP() << "the module is there";
  const TempFolder folder("absent");
  write_bytes(folder.path / "a.png", std::string("\x89PNG"));
  try {
    read_headers(folder.path / "a.png");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(e.hint.find("BRUME_WITH_OIIO"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace brume
