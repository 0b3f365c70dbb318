// Edited copies: what passes through keeps its bits; what channels, parts and headers
// become.

#include <gtest/gtest.h>

#include "image/copy_support.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

TEST(Copy, UnchangedChannelsKeepEveryBitInTouchedChunks) {
  // NaN payloads, infinities, denormals, uints beyond float's precision.
  for (const Compression c : {Compression::none, Compression::rle, Compression::zips,
                              Compression::zip, Compression::piz}) {
    SCOPED_TRACE(name(c));
    const Spec s = base(c);
    const Made f(s, 44, true);
    copy_edited(*f.source, changes({"R"}), f.out.path, plus_one(s.data.width));
    const auto before = read_raw(f.in.path), after = read_raw(f.out.path);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (i != 3) {
        EXPECT_EQ(before[i], after[i]) << i;
      }
    EXPECT_NE(before[3], after[3]);
  }
}

TEST(Copy, AChangedChannelKeepsItsBitsWhereTheWorkLeavesThem) {
  const Spec s = base();
  const Made f(s, 45, true);
  copy_edited(*f.source, changes({"A", "B", "G", "R", "Z"}), f.out.path, [](Band&) {});
  const auto before = read_raw(f.in.path), after = read_raw(f.out.path);
  EXPECT_EQ(before, after);
}

TEST(Copy, ChannelsAreAddedAndLeftOutAndRetyped) {
  const Spec s = base();
  const Made f(s, 46);
  Edit e = changes({"T.R", "R"});
  e.retype = true;
  e.read = {f.source->header().find("Z")};
  const auto work = [&](Band& b) {
    for (std::int64_t i = 0; i < std::int64_t(b.rows) * s.data.width; ++i) {
      EXPECT_EQ(b.out[0][i], 0);
      b.out[0][i] = b.in[0][i] * 3;
    }
  };
  copy_edited(*f.source, e, f.out.path, work);
  const Image before = read_image(f.in.path);
  Image after = read_image(f.out.path);
  ASSERT_EQ(after.header.channels.size(), 8u);
  const int t = after.header.find("T.R"), r = after.header.find("R");
  EXPECT_EQ(after.header.channels[t].type, PixelType::float32);
  EXPECT_EQ(after.header.channels[r].type, PixelType::float32);
  EXPECT_TRUE(same_bits(after.planes[r], before.planes[3]));
  for (std::size_t i = 0; i < after.planes[t].size(); ++i)
    EXPECT_EQ(after.planes[t][i], before.planes[4][i] * 3);

  e.only_these = true;
  copy_edited(*f.source, e, f.out.path, work);
  after = read_image(f.out.path);
  ASSERT_EQ(after.header.channels.size(), 2u);
  EXPECT_EQ(after.header.channels[0].name, "R");
  EXPECT_EQ(after.header.channels[1].name, "T.R");
}

TEST(Copy, CompressionChangesAndAttributesAreSet) {
  const Spec s = base();
  const Made f(s, 47, true);
  for (const Compression c : kAllCompressions) {
    SCOPED_TRACE(name(c));
    Edit e;
    e.compression = c;
    e.dwa_level = 20.0f;
    e.attributes["brume/version"] = Attribute::from_text("1");
    e.attributes["comment"] = Attribute::from_text("another");
    copy_edited(*f.source, e, f.out.path, {});
    auto expected = attribute_bytes(f.in.path), got = attribute_bytes(f.out.path);
    expected["compression"] = std::string("compression:") + static_cast<char>(c);
    expected["brume/version"] = "string:1";
    expected["comment"] = "string:another";
    expected["dwaCompressionLevel"] = got["dwaCompressionLevel"];
    EXPECT_EQ(got, expected);
    EXPECT_EQ(read_headers(f.out.path)[0].dwa_level, 20.0f);
    if (c <= Compression::piz) {
      EXPECT_EQ(read_raw(f.in.path), read_raw(f.out.path));
    }
  }
  Edit e;
  e.attributes["dataWindow"] = Attribute::from_text("1");
  EXPECT_THROW(copy_edited(*f.source, e, f.out.path, {}), Error);
}

TEST(Copy, HalfOverflowIsTheLargestHalfAndCounted) {
  const Spec s = base();
  const Made f(s, 48);
  const CopyReport r =
      copy_edited(*f.source, changes({"G", "Z"}), f.out.path, [&](Band& b) {
        b.out[0][3] = 1e6f;
        b.out[0][4] = -70000;
        b.out[1][3] = 1e30f;
      });
  const int bands = (s.data.height + 15) / 16;
  EXPECT_EQ(r.half_overflows, std::uint64_t(2 * bands));
  const Image after = read_image(f.out.path);
  EXPECT_EQ(after.planes[2][3], 65504);
  EXPECT_EQ(after.planes[2][4], -65504);
  EXPECT_EQ(after.planes[4][3], 1e30f);
}

TEST(Copy, OtherPartsPassAsTheyAre) {
  for (const int chosen : {0, 1, 2}) {
    SCOPED_TRACE(chosen);
    Spec left = base(), right = base(Compression::dwaa), tiles = base(Compression::piz);
    left.part_name = "l", left.view = "left", right.part_name = "r", right.view = "right";
    tiles.part_name = "t", tiles.tiled = true;
    const TempFile in("in.exr"), out("out.exr");
    write(std::vector{left, right, tiles}, in.path, 49, false);
    const auto source = open_image(in.path, chosen);
    Edit e = changes({"R"});
    e.compression = Compression::zips;
    copy_edited(*source, e, out.path, plus_one(left.data.width));
    for (int p = 0; p < 3; ++p) {
      const auto before = read_raw(in.path, p), after = read_raw(out.path, p);
      for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_EQ(p != chosen || i != 3, before[i] == after[i]) << p << " " << i;
      if (p != chosen) {
        EXPECT_EQ(attribute_bytes(in.path, p), attribute_bytes(out.path, p));
      }
    }
  }
}

TEST(Copy, SubsampledChannelsPassByTheirBits) {
  for (const Compression c : kAllCompressions) {
    SCOPED_TRACE(name(c));
    Spec s = base(c);
    s.channels = {{"BY", PixelType::half, 2, 2},
                  {"RY", PixelType::half, 2, 2},
                  {"Y", PixelType::half}};
    s.data = {-6, -2, 60, 70};
    const Made f(s, 50, c <= Compression::piz);
    copy_edited(*f.source, changes({"Y", "extra"}), f.out.path, plus_one(s.data.width));
    const auto before = read_raw(f.in.path), after = read_raw(f.out.path);
    if (c <= Compression::piz) {
      EXPECT_EQ(before[0], after[0]);
      EXPECT_EQ(before[1], after[1]);
    }
    EXPECT_EQ(read_image(f.out.path).header.channels.size(), 4u);
    // And changed: one value for each sample.
    copy_edited(*f.source, changes({"RY"}), f.out.path, plus_one(s.data.width));
    const Image image = read_image(f.out.path);
    const Planes theirs = read(f.out.path);
    for (std::size_t i = 0; i < theirs.size(); ++i)
      EXPECT_TRUE(same_bits(image.planes[i], theirs[i]));
  }
}

TEST(Copy, LevelsAreCopiedOrRefused) {
  for (const int levels : {1, 2})
    for (const int rounding : {0, 1}) {
      Spec s = base();
      s.tiled = true;
      s.levels = levels;
      s.rounding = rounding;
      s.data = {3, 4, 100, 37};
      const Made f(s, 51);
      const Image image = read_image(f.in.path);
      const Planes theirs = read(f.in.path);
      for (std::size_t i = 0; i < theirs.size(); ++i)
        EXPECT_TRUE(same_bits(image.planes[i], theirs[i]));
      Edit e;
      e.attributes["comment"] = Attribute::from_text("only this");
      copy_edited(*f.source, e, f.out.path, {});
      EXPECT_EQ(read_raw(f.in.path), read_raw(f.out.path));
      EXPECT_EQ(exr::File(f.out.path).parts()[0].tiles->levels,
                exr::Tiles::Levels(levels));
      EXPECT_THROW(copy_edited(*f.source, changes({"R"}), f.out.path, {}), Error);
      EXPECT_EQ(read_raw(f.in.path), read_raw(f.out.path));  // the old file stays
    }
}

}  // namespace
}  // namespace brume
