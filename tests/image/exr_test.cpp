// EXR files of every kind, with OpenEXR's C++ library as the other opinion: what it
// writes we read, what we write it reads.

#include <gtest/gtest.h>

#include <random>

#include "image/io.h"
#include "image/oracle.h"
#include "image/support.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

void expect_same(const std::vector<std::vector<float>>& ours, const Planes& theirs) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < theirs.size(); ++i)
    EXPECT_TRUE(same_bits(ours[i], theirs[i])) << "channel " << i;
}

std::vector<Channel> subsampled() {
  return {{"BY", PixelType::half, 2, 2},
          {"RY", PixelType::half, 2, 2},
          {"Y", PixelType::half},
          {"Z", PixelType::float32, 4, 1},
          {"row", PixelType::uint32, 1, 2}};
}

/// One kind of file, and its name for messages.
struct Kind {
  std::string name;
  Spec spec;
};

/// Every compression with scanlines and tiles, windows in all places, subsampled
/// channels, line orders and very wide or low images.
std::vector<Kind> kinds() {
  std::vector<Kind> all;
  for (const Compression c : kAllCompressions) {
    auto add = [&](const char* what, auto&& change) {
      Spec s;
      s.compression = c;
      s.channels = all_types();
      change(s);
      all.push_back({std::string(name(c)) + " " + what, s});
    };
    add("plain", [](Spec&) {});
    add("window outside", [](Spec& s) { s.data = {-37, -1001, 41, 300}; });
    add("window inside", [](Spec& s) { s.data = {20, 30, 17, 9}; });
    add("one pixel", [](Spec& s) { s.data = {5, 5, 1, 1}; });
    add("one row", [](Spec& s) { s.data = {0, 0, 999, 1}; });
    add("one column", [](Spec& s) { s.data = {0, 0, 1, 100}; });
    add("descending", [](Spec& s) { s.line_order = 1; });
    add("subsampled", [](Spec& s) {
      s.channels = subsampled();
      s.data = {-4, -6, 64, 70};
    });
    add("tiled", [](Spec& s) { s.tiled = true; });
    add("tiled window", [](Spec& s) {
      s.tiled = true;
      s.data = {-37, -101, 141, 60};
      s.tile_width = 33;
      s.tile_height = 40;
    });
    add("tiled descending", [](Spec& s) { s.tiled = true, s.line_order = 1; });
    add("tiled random", [](Spec& s) { s.tiled = true, s.line_order = 2; });
    add("tile larger than image", [](Spec& s) {
      s.tiled = true;
      s.tile_width = s.tile_height = 300;
    });
    add("long name", [](Spec& s) {
      s.channels = {
          {"a_layer_whose_name_is_longer_than_thirty_one_letters.R", PixelType::half},
          {"b", PixelType::half}};
    });
  }
  return all;
}

TEST(Exr, ReadsTheBitsThatOpenExrReads) {
  unsigned seed = 100;
  for (const Kind& kind : kinds())
    for (const bool special : {false, true}) {
      // Any bit pattern may be a pixel, but only lossless codecs keep NaN comparable.
      if (special && kind.spec.compression > Compression::piz) continue;
      SCOPED_TRACE(kind.name + " seed " + std::to_string(++seed));
      const TempFile file("read.exr");
      write(kind.spec, file.path, seed, special);
      const Image ours = read_image(file.path);
      EXPECT_EQ(ours.header.data_window, kind.spec.data);
      EXPECT_EQ(ours.header.display_window, kind.spec.display);
      EXPECT_EQ(ours.header.channels, kind.spec.channels);
      EXPECT_EQ(ours.header.compression, kind.spec.compression);
      expect_same(ours.planes, read(file.path));
    }
}

TEST(Exr, OpenExrReadsTheBitsThatWeWrite) {
  unsigned seed = 500;
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name + " seed " + std::to_string(++seed));
    const TempFile file("read.exr"), out("write.exr");
    Spec plain = kind.spec;
    plain.compression = Compression::none;
    write(plain, file.path, seed, kind.spec.compression <= Compression::piz);
    Image image = read_image(file.path);
    image.header.compression = kind.spec.compression;
    write_image(image, out.path);
    const Image back = read_image(out.path);
    const Planes theirs = read(out.path);
    expect_same(back.planes, theirs);
    EXPECT_EQ(back.header.channels, image.header.channels);
    EXPECT_EQ(back.header.tiled, kind.spec.tiled);
    // Lossless codecs give the floats back.
    if (kind.spec.compression <= Compression::piz) expect_same(image.planes, theirs);
  }
}

TEST(Exr, RowsInAnyPiecesAreTheWhole) {
  unsigned seed = 900;
  std::mt19937 random(seed);
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name + " seed " + std::to_string(++seed));
    const TempFile file("rows.exr");
    write(kind.spec, file.path, seed);
    const Image whole = read_image(file.path);
    const auto reader = open_image(file.path);
    const Window& d = whole.header.data_window;
    const int channel = static_cast<int>(random() % whole.header.channels.size());
    for (int y = d.y; y < d.bottom();) {
      const int rows = std::min<int>(1 + static_cast<int>(random() % 40), d.bottom() - y);
      std::vector<float> out(std::size_t(rows) * d.width);
      float* to = out.data();
      reader->read(y, rows, std::span(&channel, 1), std::span(&to, 1));
      EXPECT_TRUE(same_bits(
          out, whole.plane(channel).subspan(std::size_t(y - d.y) * d.width, out.size())));
      y += rows;
    }
    float* none = nullptr;
    EXPECT_THROW(reader->read(d.y - 1, 1, std::span(&channel, 1), std::span(&none, 1)),
                 Error);
    EXPECT_THROW(reader->read(d.bottom(), 1, std::span(&channel, 1), std::span(&none, 1)),
                 Error);
  }
}

TEST(Exr, EveryPartOfAMultiPartFileIsRead) {
  for (const Compression c : kAllCompressions) {
    SCOPED_TRACE(name(c));
    Spec left, right, tiles;
    left.channels = right.channels = all_types();
    left.part_name = "left.beauty", left.view = "left", left.compression = c;
    right.part_name = "right.beauty", right.view = "right";
    tiles.channels = {{"Z", PixelType::float32}};
    tiles.part_name = "tiles", tiles.tiled = true, tiles.compression = c;
    tiles.data = {3, 3, 40, 40};
    const TempFile file("parts.exr");
    write(std::vector{left, right, tiles}, file.path, 31);
    const auto headers = read_headers(file.path);
    ASSERT_EQ(headers.size(), 3u);
    EXPECT_EQ(headers[0].view, "left");
    EXPECT_EQ(headers[1].part_name, "right.beauty");
    EXPECT_TRUE(headers[2].tiled);
    for (int p = 0; p < 3; ++p)
      expect_same(read_image(file.path, p).planes, read(file.path, p));
    EXPECT_THROW(read_image(file.path, 3), Error);
    EXPECT_THROW(read_image(file.path, -1), Error);
  }
}

TEST(Exr, NamedChannelsComeAlone) {
  const TempFile file("named.exr");
  Spec s;
  s.channels = all_types();
  write(s, file.path, 5);
  const Image all = read_image(file.path);
  const std::vector<std::string> names = {"Z", "R", "Z"};
  const Image some = read_image(file.path, 0, names);
  ASSERT_EQ(some.planes.size(), 2u);
  EXPECT_EQ(some.header.channels[0].name, "R");
  EXPECT_TRUE(same_bits(some.planes[0], all.planes[3]));
  EXPECT_TRUE(same_bits(some.planes[1], all.planes[4]));
  const std::vector<std::string> absent = {"depth.Z"};
  EXPECT_THROW(read_image(file.path, 0, absent), Error);
}

}  // namespace
}  // namespace brume
