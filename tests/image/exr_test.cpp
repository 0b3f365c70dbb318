// EXR files of every kind, with OpenEXR's C++ library as the other opinion: what it
// writes we read, what we write it reads.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>

#include "image/io.h"
#include "image/oracle.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

constexpr Compression kAll[] = {Compression::none, Compression::rle,  Compression::zips,
                                Compression::zip,  Compression::piz,  Compression::pxr24,
                                Compression::b44,  Compression::b44a, Compression::dwaa,
                                Compression::dwab};

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

Spec spec(Compression c) {
  Spec s;
  s.compression = c;
  s.channels = {{"A", PixelType::half},    {"B", PixelType::half},
                {"G", PixelType::half},    {"R", PixelType::half},
                {"Z", PixelType::float32}, {"id", PixelType::uint32}};
  return s;
}

TEST(Exr, ReadsWhatOpenExrReads) {
  for (const Compression c : kAll) {
    SCOPED_TRACE(name(c));
    const TempFile file("read.exr");
    write(spec(c), file.path, 7);
    const Image ours = read_image(file.path);
    const Planes theirs = read(file.path);
    ASSERT_EQ(ours.planes.size(), theirs.size());
    for (std::size_t i = 0; i < theirs.size(); ++i)
      EXPECT_TRUE(same_bits(ours.planes[i], theirs[i])) << ours.header.channels[i].name;
  }
}

TEST(Exr, OpenExrReadsWhatWeWrite) {
  for (const Compression c : kAll) {
    SCOPED_TRACE(name(c));
    const TempFile file("read.exr"), out("write.exr");
    write(spec(Compression::none), file.path, 8);
    Image image = read_image(file.path);
    image.header.compression = c;
    write_image(image, out.path);
    const Image ours = read_image(out.path);
    const Planes theirs = read(out.path);
    for (std::size_t i = 0; i < theirs.size(); ++i)
      EXPECT_TRUE(same_bits(ours.planes[i], theirs[i])) << ours.header.channels[i].name;
    const bool lossless = c <= Compression::piz;
    for (std::size_t i = 0; i < theirs.size() && lossless; ++i)
      EXPECT_TRUE(same_bits(image.planes[i], theirs[i])) << ours.header.channels[i].name;
  }
}

}  // namespace
}  // namespace brume
