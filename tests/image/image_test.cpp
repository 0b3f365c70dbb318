// Windows, attributes and names: the vocabulary of image.h; and the sample frames.

#include "image/image.h"

#include <gtest/gtest.h>

#include "image/io.h"
#include "image/oracle.h"
#include "image/support.h"

namespace brume {
namespace {

TEST(Windows, IntersectAndUnite) {
  const Window a{0, 0, 10, 10}, b{-5, 4, 8, 100}, far{50, 50, 3, 3};
  EXPECT_EQ(intersect(a, b), (Window{0, 4, 3, 6}));
  EXPECT_EQ(intersect(b, a), intersect(a, b));
  EXPECT_TRUE(intersect(a, far).empty());
  EXPECT_EQ(intersect(a, far).pixels(), 0);
  EXPECT_EQ(unite(a, b), (Window{-5, 0, 15, 104}));
  EXPECT_EQ(unite(a, Window{}), a);
  EXPECT_EQ(unite(Window{}, a), a);
  EXPECT_EQ((Window{0, 0, 100000, 100000}.pixels()), 10000000000);
}

TEST(Attributes, NumbersComeOutAsTheyWentIn) {
  EXPECT_EQ(Attribute::from_float(2.5f).number(), 2.5);
  EXPECT_EQ(Attribute::from_text("Nebel").text(), "Nebel");
  EXPECT_FALSE(Attribute::from_text("1").number());
  EXPECT_FALSE(Attribute::from_float(1).text());
  const std::vector<float> m = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  const auto back = Attribute::from_floats("m44f", m).numbers();
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, std::vector<double>(m.begin(), m.end()));
  EXPECT_FALSE(Attribute::from_floats("m44f", m).number());
  EXPECT_FALSE(Attribute::from_floats("m33f", m).numbers());  // 16 are not 9
  EXPECT_EQ(Attribute::from_floats("floatvector", m).numbers()->size(), 16u);
  EXPECT_FALSE(Attribute::from_floats("preview", m).numbers());
  const Attribute ntsc{"rational", {0xc0, 0x5d, 0, 0, 0xe9, 3, 0, 0}};
  EXPECT_EQ(ntsc.number(), 24000.0 / 1001);
  const Attribute nothing{"rational", {1, 0, 0, 0, 0, 0, 0, 0}};
  EXPECT_FALSE(nothing.number());
  const Attribute negative{"int", {0xff, 0xff, 0xff, 0xff}};
  EXPECT_EQ(negative.number(), -1);
}

TEST(Compressions, HaveTheNamesThatUsersWrite) {
  for (const Compression c : kAllCompressions) EXPECT_EQ(compression_from(name(c)), c);
  EXPECT_FALSE(compression_from("ZIP2"));
  EXPECT_FALSE(compression_from(""));
}

TEST(Compressions, AreLossyWhereOpenExrChangesValues) {
  // Half values, so that types that hold them lose nothing by themselves.
  const TempFolder folder("lossy");
  const std::filesystem::path file = folder.path / "file.exr";
  for (const Compression compression : kAllCompressions)
    for (const PixelType type : {PixelType::half, PixelType::float32}) {
      Image image;
      image.header.compression = compression;
      image.header.data_window = image.header.display_window = {0, 0, 48, 64};
      for (const char* name : {"A", "B", "BY", "G", "R", "RY", "T.A", "T.B", "T.G", "T.R",
                               "Y", "Z", "id", "mask.r", "position.X", "position.Y"})
        image.header.channels.push_back({name, type});
      for (std::size_t k = 0; k < image.header.channels.size(); ++k) {
        auto& plane = image.planes.emplace_back(48 * 64);
        for (std::size_t i = 0; i < plane.size(); ++i)
          plane[i] = float((i * 37 + i / 48 * 11 + k) % 1021) / 1024;
      }
      write_image(image, file);
      const Image back = read_image(file);
      for (std::size_t k = 0; k < image.planes.size(); ++k) {
        float most = 0;
        for (std::size_t i = 0; i < image.planes[k].size(); ++i)
          most = std::max(most, std::abs(back.planes[k][i] - image.planes[k][i]));
        const Channel& channel = back.header.channels[k];
        EXPECT_EQ(is_lossy(compression, channel), most > 1e-5f)
            << name(compression) << " " << channel.name << " " << most;
      }
    }
}

TEST(SampleFrames, AreReadAsOpenExrReadsThem) {
  const std::filesystem::path data = std::string(BRUME_SOURCE_DIR) + "/data";
  for (const char* file : {"valley_seq/valley.1001.exr", "valley_validation_480x270.exr",
                           "edges_point_480x270.exr", "edges_aa_480x270.exr"}) {
    SCOPED_TRACE(file);
    const Image ours = read_image(data / file);
    const oracle::Planes theirs = oracle::read(data / file);
    ASSERT_EQ(ours.planes.size(), theirs.size());
    for (std::size_t i = 0; i < theirs.size(); ++i)
      EXPECT_TRUE(same_bits(ours.planes[i], theirs[i]));
    const Attributes& all = ours.header.attributes;
    EXPECT_EQ(all.at("worldToCamera").numbers()->size(), 16u);
    EXPECT_EQ(all.at("chromaticities").numbers()->size(), 8u);
    EXPECT_TRUE(all.at("nearClip").number());
  }
}

}  // namespace
}  // namespace brume
