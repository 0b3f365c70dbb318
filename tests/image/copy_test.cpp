// Edited copies: what changes is changed, however it is cut, threaded or held.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "image/copy_support.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

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
        const Made f(s, 40);
        CopyOptions options;
        options.whole_frame = whole;
        copy_edited(*f.source, changes({"R", "Z", "id"}), f.out.path,
                    plus_one(s.data.width), options);
        const Image before = read_image(f.in.path), after = read_image(f.out.path);
        EXPECT_EQ(after.header.channels, before.header.channels);
        EXPECT_EQ(attribute_bytes(f.out.path), attribute_bytes(f.in.path));
        const Planes theirs = read(f.out.path);
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
    const Made f(s, 41);
    std::set<std::vector<char>> results;
    for (const int threads : {1, 2, 7})
      for (const bool whole : {false, true}) {
        CopyOptions options;
        options.threads = threads;
        options.whole_frame = whole;
        copy_edited(*f.source, changes({"R", "new"}), f.out.path, plus_one(s.data.width),
                    options);
        results.insert(bytes_of(f.out.path));
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
      const Made f(s, 42, true);
      CopyReport r = copy_edited(*f.source, {}, f.out.path, {});
      EXPECT_EQ(r.chunks_copied, r.chunks);
      if (layout.line_order != 2) {
        EXPECT_EQ(bytes_of(f.in.path), bytes_of(f.out.path));
      }
      // An edit whose work touches nothing, said before and after unpacking.
      CopyOptions options;
      r = copy_edited(*f.source, changes({"R"}), f.out.path,
                      [](Band& b) { b.touched = false; });
      EXPECT_EQ(r.chunks_copied, r.chunks);
      if (layout.line_order != 2) {
        EXPECT_EQ(bytes_of(f.in.path), bytes_of(f.out.path));
      }
      options.touches = [](int, int) { return false; };
      r = copy_edited(
          *f.source, changes({"R"}), f.out.path, [](Band&) { FAIL(); }, options);
      EXPECT_EQ(r.chunks_copied, r.chunks);
      if (layout.line_order != 2) {
        EXPECT_EQ(bytes_of(f.in.path), bytes_of(f.out.path));
      }
    }
}

TEST(Copy, OnlyTouchedBandsArePackedAnew) {
  Spec s = base();
  s.data.height = 160;
  const Made f(s, 43, true);
  const int edge = s.data.y + 64;
  const CopyReport r = copy_edited(*f.source, changes({"R"}), f.out.path, [&](Band& b) {
    b.touched = b.y < edge;
    if (b.touched) plus_one(s.data.width)(b);
  });
  EXPECT_EQ(r.chunks, 10u);
  EXPECT_EQ(r.chunks_copied, 6u);
  const Image before = read_image(f.in.path), after = read_image(f.out.path);
  const std::size_t rest = 64u * s.data.width;
  EXPECT_TRUE(same_bits(before.plane(3).subspan(rest), after.plane(3).subspan(rest)));
  EXPECT_FALSE(same_bits(before.plane(3).first(rest), after.plane(3).first(rest)));
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
  const Made f(s, 53);
  const int z = f.source->header().find("Z");
  copy_edited(*f.source, changes({"sum"}), f.out.path, [&](Band& b) {
    std::vector<float> rows(std::size_t(s.data.width) * s.data.height);
    float* to = rows.data();
    f.source->read(s.data.y, s.data.height, std::span(&z, 1), std::span(&to, 1));
    for (std::int64_t i = 0; i < std::int64_t(b.rows) * s.data.width; ++i)
      b.out[0][i] = rows[std::size_t(b.y - s.data.y) * s.data.width + i];
  });
  const Image after = read_image(f.out.path);
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
