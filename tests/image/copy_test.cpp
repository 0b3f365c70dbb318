// Edited copies: what changes is changed, all else passes through by its bits.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "image/exr_format.h"
#include "image/io.h"
#include "image/oracle.h"
#include "image/support.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

Spec base(Compression c = Compression::zip) {
  Spec s;
  s.channels = all_types();
  s.compression = c;
  s.data = {-5, 7, 61, 77};
  s.attributes = {{"comment", "string", "made for a test"},
                  {"studio/thing", "a_type_nobody_knows", std::string("\0\1\2\377", 4)},
                  {"an_attribute_name_longer_than_thirty_one_letters", "string", "x"}};
  return s;
}

/// Adds 1 to the channels; the rest of the edit as given.
Edit changes(std::initializer_list<const char*> names) {
  Edit e;
  for (const char* n : names) e.channels.push_back({n, PixelType::float32});
  return e;
}
auto plus_one(int width) {
  return [width](Band& b) {
    for (float* plane : b.out)
      for (std::int64_t i = 0; i < std::int64_t(b.rows) * width; ++i) plane[i] += 1;
  };
}

std::map<std::string, std::string> attribute_bytes(const std::filesystem::path& path,
                                                   int part = 0) {
  std::map<std::string, std::string> all;
  const exr::File file(path);
  for (const exr::NamedAttribute& a : file.parts()[part].attributes)
    all[a.name] =
        a.value.type + ":" + std::string(a.value.bytes.begin(), a.value.bytes.end());
  return all;
}

struct Layout {
  const char* name;
  bool tiled;
  int line_order;
};
constexpr Layout kLayouts[] = {{"scanline", false, 0},
                               {"scanline descending", false, 1},
                               {"tiled", true, 0},
                               {"tiled descending", true, 1},
                               {"tiled random", true, 2}};

TEST(Copy, AChangedChannelChangesAndKeepsItsType) {
  for (const Compression c : kAllCompressions)
    for (const Layout& layout : kLayouts)
      for (const bool whole : {false, true}) {
        SCOPED_TRACE(std::string(name(c)) + " " + layout.name + (whole ? " whole" : ""));
        Spec s = base(c);
        s.tiled = layout.tiled;
        s.line_order = layout.line_order;
        const TempFile in("in.exr"), out("out.exr");
        write(s, in.path, 40);
        const auto source = open_image(in.path);
        CopyOptions options;
        options.whole_frame = whole;
        copy_edited(*source, changes({"R", "Z", "id"}), out.path, plus_one(s.data.width),
                    options);
        const Image before = read_image(in.path), after = read_image(out.path);
        EXPECT_EQ(after.header.channels, before.header.channels);
        EXPECT_EQ(attribute_bytes(out.path), attribute_bytes(in.path));
        const Planes theirs = read(out.path);
        for (std::size_t i = 0; i < theirs.size(); ++i)
          EXPECT_TRUE(same_bits(after.planes[i], theirs[i])) << i;
        if (c > Compression::piz) continue;  // lossy: what the codec makes of it
        for (std::size_t i = 0; i < before.planes.size(); ++i) {
          const std::string& channel = before.header.channels[i].name;
          if (channel != "R" && channel != "Z" && channel != "id") {
            EXPECT_TRUE(same_bits(before.planes[i], after.planes[i])) << channel;
            continue;
          }
          // Rounded once to the channel's type: half 2^-11, uint as float 2^-24 and once
          // more to an integer below 2^24 exactly.
          const float step =
              channel == "R" ? std::ldexp(1.0f, -11) : std::ldexp(1.0f, -23);
          for (std::size_t k = 0; k < before.planes[i].size(); ++k) {
            const float want = before.planes[i][k] + 1;
            EXPECT_NEAR(after.planes[i][k], want, step * std::fabs(want));
          }
        }
      }
}

TEST(Copy, ManyThreadsAndOneAndTheWholeFrameGiveTheSameBytes) {
  for (const Layout& layout : kLayouts) {
    SCOPED_TRACE(layout.name);
    Spec s = base(Compression::zips);
    s.data.height = 500;
    s.tiled = layout.tiled;
    s.line_order = layout.line_order;
    const TempFile in("in.exr"), out("out.exr");
    write(s, in.path, 41);
    const auto source = open_image(in.path);
    std::set<std::vector<char>> results;
    for (const int threads : {1, 2, 7})
      for (const bool whole : {false, true}) {
        CopyOptions options;
        options.threads = threads;
        options.whole_frame = whole;
        copy_edited(*source, changes({"R", "new"}), out.path, plus_one(s.data.width),
                    options);
        results.insert(bytes_of(out.path));
      }
    EXPECT_EQ(results.size(), 1u);
  }
}

TEST(Copy, AWholeFrameTooLargeToHoldTwiceIsTheSame) {
  Spec s;
  s.channels = {{"R", PixelType::float32}, {"S", PixelType::float32}};
  s.compression = Compression::none;
  s.data = {0, 0, 3000, 2900};  // 70 MB: beyond what is held unpacked
  const TempFile in("in.exr"), out("out.exr"), whole("whole.exr");
  write(s, in.path, 55);
  const auto source = open_image(in.path);
  CopyOptions options;
  copy_edited(*source, changes({"R"}), out.path, plus_one(s.data.width), options);
  options.whole_frame = true;
  copy_edited(*source, changes({"R"}), whole.path, plus_one(s.data.width), options);
  EXPECT_TRUE(bytes_of(out.path) == bytes_of(whole.path));
}

TEST(Copy, NothingChangedIsTheSameFile) {
  for (const Compression c : kAllCompressions)
    for (const Layout& layout : kLayouts) {
      SCOPED_TRACE(std::string(name(c)) + " " + layout.name);
      Spec s = base(c);
      s.tiled = layout.tiled;
      s.line_order = layout.line_order;
      const TempFile in("in.exr"), out("out.exr");
      write(s, in.path, 42, true);
      const auto source = open_image(in.path);
      CopyReport r = copy_edited(*source, {}, out.path, {});
      EXPECT_EQ(r.chunks_copied, r.chunks);
      if (layout.line_order != 2) {
        EXPECT_EQ(bytes_of(in.path), bytes_of(out.path));
      }
      // An edit whose work touches nothing, said before and after unpacking.
      CopyOptions options;
      r = copy_edited(*source, changes({"R"}), out.path,
                      [](Band& b) { b.touched = false; });
      EXPECT_EQ(r.chunks_copied, r.chunks);
      if (layout.line_order != 2) {
        EXPECT_EQ(bytes_of(in.path), bytes_of(out.path));
      }
      options.touches = [](int, int) { return false; };
      r = copy_edited(
          *source, changes({"R"}), out.path, [](Band&) { FAIL(); }, options);
      EXPECT_EQ(r.chunks_copied, r.chunks);
      if (layout.line_order != 2) {
        EXPECT_EQ(bytes_of(in.path), bytes_of(out.path));
      }
    }
}

TEST(Copy, OnlyTouchedBandsArePackedAnew) {
  Spec s = base();
  s.data.height = 160;
  const TempFile in("in.exr"), out("out.exr");
  write(s, in.path, 43, true);
  const auto source = open_image(in.path);
  const int edge = s.data.y + 64;
  const CopyReport r = copy_edited(*source, changes({"R"}), out.path, [&](Band& b) {
    b.touched = b.y < edge;
    if (b.touched) plus_one(s.data.width)(b);
  });
  EXPECT_EQ(r.chunks, 10u);
  EXPECT_EQ(r.chunks_copied, 6u);
  const Image before = read_image(in.path), after = read_image(out.path);
  const std::size_t rest = 64u * s.data.width;
  EXPECT_TRUE(same_bits(before.plane(3).subspan(rest), after.plane(3).subspan(rest)));
  EXPECT_FALSE(same_bits(before.plane(3).first(rest), after.plane(3).first(rest)));
}

TEST(Copy, UnchangedChannelsKeepEveryBitInTouchedChunks) {
  // NaN payloads, infinities, denormals, uints beyond float's precision.
  for (const Compression c : {Compression::none, Compression::rle, Compression::zips,
                              Compression::zip, Compression::piz}) {
    SCOPED_TRACE(name(c));
    const Spec s = base(c);
    const TempFile in("in.exr"), out("out.exr");
    write(s, in.path, 44, true);
    const auto source = open_image(in.path);
    copy_edited(*source, changes({"R"}), out.path, plus_one(s.data.width));
    const auto before = read_raw(in.path), after = read_raw(out.path);
    for (std::size_t i = 0; i < before.size(); ++i)
      if (i != 3) {
        EXPECT_EQ(before[i], after[i]) << i;
      }
    EXPECT_NE(before[3], after[3]);
  }
}

TEST(Copy, AChangedChannelKeepsItsBitsWhereTheWorkLeavesThem) {
  const Spec s = base();
  const TempFile in("in.exr"), out("out.exr");
  write(s, in.path, 45, true);
  const auto source = open_image(in.path);
  copy_edited(*source, changes({"A", "B", "G", "R", "Z"}), out.path, [](Band&) {});
  const auto before = read_raw(in.path), after = read_raw(out.path);
  EXPECT_EQ(before, after);
}

TEST(Copy, ChannelsAreAddedAndLeftOutAndRetyped) {
  const Spec s = base();
  const TempFile in("in.exr"), out("out.exr");
  write(s, in.path, 46);
  const auto source = open_image(in.path);
  Edit e = changes({"T.R", "R"});
  e.retype = true;
  e.read = {source->header().find("Z")};
  const auto work = [&](Band& b) {
    for (std::int64_t i = 0; i < std::int64_t(b.rows) * s.data.width; ++i) {
      EXPECT_EQ(b.out[0][i], 0);
      b.out[0][i] = b.in[0][i] * 3;
    }
  };
  copy_edited(*source, e, out.path, work);
  const Image before = read_image(in.path);
  Image after = read_image(out.path);
  ASSERT_EQ(after.header.channels.size(), 8u);
  const int t = after.header.find("T.R"), r = after.header.find("R");
  EXPECT_EQ(after.header.channels[t].type, PixelType::float32);
  EXPECT_EQ(after.header.channels[r].type, PixelType::float32);
  EXPECT_TRUE(same_bits(after.planes[r], before.planes[3]));
  for (std::size_t i = 0; i < after.planes[t].size(); ++i)
    EXPECT_EQ(after.planes[t][i], before.planes[4][i] * 3);

  e.only_these = true;
  copy_edited(*source, e, out.path, work);
  after = read_image(out.path);
  ASSERT_EQ(after.header.channels.size(), 2u);
  EXPECT_EQ(after.header.channels[0].name, "R");
  EXPECT_EQ(after.header.channels[1].name, "T.R");
}

TEST(Copy, CompressionChangesAndAttributesAreSet) {
  const Spec s = base();
  const TempFile in("in.exr"), out("out.exr");
  write(s, in.path, 47, true);
  const auto source = open_image(in.path);
  for (const Compression c : kAllCompressions) {
    SCOPED_TRACE(name(c));
    Edit e;
    e.compression = c;
    e.dwa_level = 20.0f;
    e.attributes["brume/version"] = Attribute::from_text("1");
    e.attributes["comment"] = Attribute::from_text("another");
    copy_edited(*source, e, out.path, {});
    auto expected = attribute_bytes(in.path), got = attribute_bytes(out.path);
    expected["compression"] = std::string("compression:") + static_cast<char>(c);
    expected["brume/version"] = "string:1";
    expected["comment"] = "string:another";
    expected["dwaCompressionLevel"] = got["dwaCompressionLevel"];
    EXPECT_EQ(got, expected);
    EXPECT_EQ(read_headers(out.path)[0].dwa_level, 20.0f);
    if (c <= Compression::piz) {
      EXPECT_EQ(read_raw(in.path), read_raw(out.path));
    }
  }
  Edit e;
  e.attributes["dataWindow"] = Attribute::from_text("1");
  EXPECT_THROW(copy_edited(*source, e, out.path, {}), Error);
}

TEST(Copy, HalfOverflowIsTheLargestHalfAndCounted) {
  const Spec s = base();
  const TempFile in("in.exr"), out("out.exr");
  write(s, in.path, 48);
  const auto source = open_image(in.path);
  const CopyReport r = copy_edited(*source, changes({"G", "Z"}), out.path, [&](Band& b) {
    b.out[0][3] = 1e6f;
    b.out[0][4] = -70000;
    b.out[1][3] = 1e30f;
  });
  const int bands = (s.data.height + 15) / 16;
  EXPECT_EQ(r.half_overflows, std::uint64_t(2 * bands));
  const Image after = read_image(out.path);
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
    const TempFile in("in.exr"), out("out.exr");
    write(s, in.path, 50, c <= Compression::piz);
    const auto source = open_image(in.path);
    copy_edited(*source, changes({"Y", "extra"}), out.path, plus_one(s.data.width));
    const auto before = read_raw(in.path), after = read_raw(out.path);
    if (c <= Compression::piz) {
      EXPECT_EQ(before[0], after[0]);
      EXPECT_EQ(before[1], after[1]);
    }
    EXPECT_EQ(read_image(out.path).header.channels.size(), 4u);
    // And changed: one value for each sample.
    copy_edited(*source, changes({"RY"}), out.path, plus_one(s.data.width));
    const Image image = read_image(out.path);
    const Planes theirs = read(out.path);
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
      const TempFile in("in.exr"), out("out.exr");
      write(s, in.path, 51);
      const auto source = open_image(in.path);
      const Image image = read_image(in.path);
      const Planes theirs = read(in.path);
      for (std::size_t i = 0; i < theirs.size(); ++i)
        EXPECT_TRUE(same_bits(image.planes[i], theirs[i]));
      Edit e;
      e.attributes["comment"] = Attribute::from_text("only this");
      copy_edited(*source, e, out.path, {});
      EXPECT_EQ(read_raw(in.path), read_raw(out.path));
      EXPECT_EQ(exr::File(out.path).parts()[0].tiles->levels, exr::Tiles::Levels(levels));
      EXPECT_THROW(copy_edited(*source, changes({"R"}), out.path, {}), Error);
      EXPECT_EQ(read_raw(in.path), read_raw(out.path));  // the old file stays
    }
}

TEST(Copy, OntoItselfWorks) {
  const Spec s = base();
  const TempFile in("in.exr");
  write(s, in.path, 52);
  const Image before = read_image(in.path);
  copy_edited(*open_image(in.path), changes({"Z"}), in.path, plus_one(s.data.width));
  const Image after = read_image(in.path);
  EXPECT_EQ(after.planes[4][5], before.planes[4][5] + 1);
}

TEST(Copy, WorkReadsOtherChannelsAndRowsThroughTheReader) {
  const Spec s = base(Compression::dwab);
  const TempFile in("in.exr"), out("out.exr");
  write(s, in.path, 53);
  const auto source = open_image(in.path);
  const int z = source->header().find("Z");
  copy_edited(*source, changes({"sum"}), out.path, [&](Band& b) {
    std::vector<float> rows(std::size_t(s.data.width) * s.data.height);
    float* to = rows.data();
    source->read(s.data.y, s.data.height, std::span(&z, 1), std::span(&to, 1));
    for (std::int64_t i = 0; i < std::int64_t(b.rows) * s.data.width; ++i)
      b.out[0][i] = rows[std::size_t(b.y - s.data.y) * s.data.width + i];
  });
  const Image after = read_image(out.path);
  EXPECT_TRUE(same_bits(after.plane(after.header.find("sum")),
                        after.plane(after.header.find("Z"))));
}

TEST(Copy, ProgressReachesOne) {
  const TempFile in("in.exr"), out("out.exr");
  write(base(), in.path, 54);
  double last = 0;
  CopyOptions options;
  options.progress = [&](double f) {
    EXPECT_GT(f, last);
    last = f;
  };
  copy_edited(
      *open_image(in.path), changes({"R"}), out.path, [](Band&) {}, options);
  EXPECT_EQ(last, 1);
}

}  // namespace
}  // namespace brume
