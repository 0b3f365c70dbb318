// What is broken is refused on one line: an Error that names the file, or pixels that
// are right; never a crash, a hang or a large allocation.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <random>

#include "image/bad_files.h"
#include "image/io.h"
#include "image/support.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

/// Reads everything that can be read of it; the message of the Error, or "".
std::string try_all(const std::filesystem::path& path) {
  try {
    const auto headers = read_headers(path);
    for (std::size_t p = 0; p < headers.size(); ++p)
      read_image(path, static_cast<int>(p));
    const TempFile out("copy.exr");
    copy_edited(*open_image(path), {}, out.path, {});
    return "";
  } catch (const Error& e) {
    const std::string what = e.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_NE(what.find(path.string()), std::string::npos) << what;
    return what;
  }
}

/// A header attribute replaced in a file's bytes: finds name, type, size; writes `value`.
void patch(std::vector<char>& bytes, const std::string& name, const std::string& type,
           std::size_t at, std::span<const char> value) {
  const std::string key = name + '\0' + type + '\0';
  const auto found = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
  ASSERT_NE(found, bytes.end()) << name;
  std::copy(value.begin(), value.end(),
            found + static_cast<std::ptrdiff_t>(key.size() + 4 + at));
}
void patch_ints(std::vector<char>& bytes, const std::string& name,
                const std::string& type, std::size_t at,
                std::initializer_list<std::int32_t> values) {
  patch(bytes, name, type, at,
        {reinterpret_cast<const char*>(values.begin()), values.size() * 4});
}

TEST(BadInput, EveryTruncationIsRefused) {
  for (const Compression c : kAllCompressions)
    for (const bool tiled : {false, true}) {
      const TempFile file("cut.exr");
      write(small(c, tiled), file.path, 60);
      const std::vector<char> whole = bytes_of(file.path);
      const std::size_t step = std::max<std::size_t>(1, whole.size() / 200);
      for (std::size_t n = 0; n < whole.size(); n += step) {
        write_bytes(file.path, std::span(whole).first(n));
        EXPECT_NE(try_all(file.path), "")
            << name(c) << " " << n << " of " << whole.size();
      }
    }
}

TEST(BadInput, FlippedBytesAreRefusedOrRead) {
  const unsigned seed = 61;
  std::mt19937 random(seed);
  int refused = 0, read = 0;
  for (const Compression c : kAllCompressions)
    for (const bool tiled : {false, true}) {
      const TempFile file("flip.exr");
      write(small(c, tiled), file.path, seed);
      const std::vector<char> whole = bytes_of(file.path);
      for (int i = 0; i < 150; ++i) {
        std::vector<char> bytes = whole;
        // Half of them in the header and the table, where they hurt most.
        const std::size_t range =
            i % 2 ? bytes.size() : std::min<std::size_t>(600, bytes.size());
        const int flips = 1 + i % 3;
        for (int k = 0; k < flips; ++k)
          bytes[random() % range] = static_cast<char>(random());
        write_bytes(file.path, bytes);
        (try_all(file.path).empty() ? read : refused)++;
      }
    }
  EXPECT_GT(refused, 300);
  EXPECT_GT(read, 100);
}

TEST(BadInput, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  const TempFile file("absurd.exr");
  struct Case {
    Compression compression;
    std::initializer_list<std::int32_t> window;
    const char* says;
  };
  const Case cases[] = {
      {Compression::zip, {0, 0, 999999999, 999999999}, "large"},
      {Compression::zip, {0, 0, 999, 999999999}, "offset table"},
      {Compression::zip, {0, 0, 999999999, 15}, "larg"},
      {Compression::zip, {0, 0, 9999999, 15}, "cannot hold the declared size"},
      {Compression::dwab, {0, 0, 999999, 999}, "larg"},
      {Compression::none, {0, 0, 4000, 39}, "cannot hold the declared size"},
      {Compression::rle, {-1073741823, 0, 1073741822, 39}, "larg"},
      {Compression::zip, {0, 0, 2147483647, 39}, "reaches to"},
      {Compression::zip, {-2147483647, 0, 1, 39}, "reaches to"},
      {Compression::zip, {0, 0, -1, 39}, "empty"},
      {Compression::zip, {0, 10, 29, 9}, "empty"},
  };
  rusage before{};
  getrusage(RUSAGE_SELF, &before);
  for (const Case& c : cases) {
    write(small(c.compression, false), file.path, 62);
    std::vector<char> bytes = bytes_of(file.path);
    patch_ints(bytes, "dataWindow", "box2i", 0, c.window);
    write_bytes(file.path, bytes);
    const std::string what = try_all(file.path);
    EXPECT_NE(what.find(c.says), std::string::npos) << what;
  }
  rusage after{};
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss,
            64 * 1024);  // KB: nothing large was taken
}

TEST(BadInput, HeadersThatMakeNoSenseAreRefused) {
  const TempFile file("header.exr");
  auto refused = [&](bool tiled, auto&& change, const char* says) {
    write(small(Compression::zip, tiled), file.path, 63);
    std::vector<char> bytes = bytes_of(file.path);
    change(bytes);
    write_bytes(file.path, bytes);
    const std::string what = try_all(file.path);
    EXPECT_NE(what.find(says), std::string::npos) << says << " but: " << what;
  };
  using Bytes = std::vector<char>;
  refused(
      false, [](Bytes& b) { b[4] = 3; }, "version 3");
  refused(
      false, [](Bytes& b) { b[6] = 1; }, "flags");
  refused(
      false, [](Bytes& b) { b[0] = 'x'; }, "");
  refused(
      false,
      [](Bytes& b) { patch(b, "compression", "compression", 0, std::span("\x63", 1)); },
      "compression 99");
  refused(
      false, [](Bytes& b) { patch(b, "lineOrder", "lineOrder", 0, std::span("\7", 1)); },
      "line order 7");
  refused(
      false, [](Bytes& b) { patch_ints(b, "channels", "chlist", 2, {9}); }, "type 9");
  refused(
      false,
      [](Bytes& b) {
        patch_ints(b, "channels", "chlist", 10, {0, 1});
      },
      "sampling 0");
  refused(
      false,
      [](Bytes& b) {
        patch_ints(b, "channels", "chlist", 10, {7, 1});
      },
      "divide");
  refused(
      true,
      [](Bytes& b) {
        patch_ints(b, "channels", "chlist", 10, {2, 1});
      },
      "subsampled");
  refused(
      false, [](Bytes& b) { patch(b, "channels", "chlist", 0, std::span("\0", 1)); },
      "no channels");
  refused(
      true, [](Bytes& b) { patch_ints(b, "tiles", "tiledesc", 0, {0}); }, "tiles of");
  refused(
      true, [](Bytes& b) { patch_ints(b, "tiles", "tiledesc", 0, {-1}); }, "tiles of");
  refused(
      false, [](Bytes& b) { patch_ints(b, "pixelAspectRatio", "float", 0, {0}); },
      "aspect");
  refused(
      false,
      [](Bytes& b) { patch_ints(b, "dataWindow", "box2i", std::size_t(-4), {-1}); },
      "dataWindow");
  refused(
      false,
      [](Bytes& b) {
        patch(b, "dataWindow", "box2i", std::size_t(-11), std::span("X", 1));
      },
      "dataWindow");
}

/// Where the table of n offsets lies, right before the first chunk that it points to; 0:
/// nowhere.
std::size_t table_at(const std::vector<char>& bytes, std::size_t n) {
  for (std::size_t at = 8; at + 8 < bytes.size(); ++at) {
    std::uint64_t first = 0;
    std::memcpy(&first, &bytes[at], 8);
    if (first == at + 8 * n) return at;
  }
  return 0;
}

TEST(BadInput, AMissingChunkIsNamed) {
  const TempFile file("missing.exr");
  write(small(Compression::zip, false), file.path, 64);
  std::vector<char> bytes = bytes_of(file.path);
  const std::size_t table = table_at(bytes, 3);
  ASSERT_NE(table, 0u);
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(table + 8), 8, '\0');
  write_bytes(file.path, bytes);
  const std::string what = try_all(file.path);
  EXPECT_NE(what.find("rows 16 to 31: missing"), std::string::npos) << what;
}

TEST(BadInput, OffsetsThatPointElsewhereAreRefused) {
  for (const bool tiled : {false, true}) {
    const TempFile file("swapped.exr");
    write(small(Compression::none, tiled), file.path, 70);
    std::vector<char> bytes = bytes_of(file.path);
    const std::size_t table = table_at(bytes, tiled ? 4 : 40);
    ASSERT_NE(table, 0u);
    for (int i = 0; i < 8; ++i) std::swap(bytes[table + i], bytes[table + 8 + i]);
    write_bytes(file.path, bytes);
    const std::string what = try_all(file.path);
    EXPECT_NE(what.find("the chunk there is another one"), std::string::npos) << what;
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(table), 7, '\x7f');
    write_bytes(file.path, bytes);
    EXPECT_NE(try_all(file.path).find("beyond the file's end"), std::string::npos);
  }
}

TEST(BadInput, DeepFilesAreRefusedClearly) {
  const TempFile file("deep.exr");
  write_deep(file.path);
  EXPECT_EQ(read_headers(file.path).size(), 1u);
  EXPECT_TRUE(read_headers(file.path)[0].deep);
  const std::string what = try_all(file.path);
  EXPECT_NE(what.find("deep files are not supported yet"), std::string::npos) << what;
}

TEST(BadInput, FilesThatAreNone) {
  const TempFolder folder("none");
  const auto refused = [&](const char* name, const char* says) {
    const std::string what = try_all(folder.path / name);
    EXPECT_NE(what.find(says), std::string::npos) << what;
  };
  refused("absent.exr", "No such file");
  refused("", "directory");
  write_bytes(folder.path / "empty.exr", {});
  refused("empty.exr", "");
  write_bytes(folder.path / "text.exr", std::string("this is no image at all, but text"));
  refused("text.exr", "");
  if (::geteuid() != 0) {
    write(small(Compression::zip, false), folder.path / "secret.exr", 65);
    ::chmod((folder.path / "secret.exr").c_str(), 0);
    refused("secret.exr", "Permission denied");
  }
}

}  // namespace
}  // namespace brume
