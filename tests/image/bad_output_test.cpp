// What cannot be written is refused on one line, and leaves what was there: never a
// half-written file.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <atomic>

#include "image/bad_files.h"
#include "image/io.h"
#include "image/support.h"
#include "num/error.h"

namespace brume {
namespace {

using namespace oracle;

/// Changes every channel of a file so that all is packed anew.
CopyReport make(const std::filesystem::path& in, const std::filesystem::path& out,
                const CopyOptions& options = {}) {
  Edit e;
  e.channels = {{"R"}, {"Z"}};
  return copy_edited(
      *open_image(in), e, out, [](Band&) {}, options);
}

std::string error_of(auto&& what) {
  try {
    what();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(BadOutput, OutputsThatCannotBeAreRefusedAndLeaveNothing) {
  const TempFolder folder("out");
  const TempFile in("in.exr");
  write(small(Compression::zip, false), in.path, 66);
  std::filesystem::create_directory(folder.path / "folder.exr");
  EXPECT_NE(
      error_of([&] { make(in.path, folder.path / "folder.exr"); }).find("is a directory"),
      std::string::npos);
  EXPECT_NE(error_of([&] {
              make(in.path, folder.path / "no/such/a.exr");
            }).find("No such file"),
            std::string::npos);
  EXPECT_NE(error_of([&] { make(in.path, "/dev/full.exr/x.exr"); }), "");
  EXPECT_NE(
      error_of([&] { make(in.path, folder.path / "noextension"); }).find("extension"),
      std::string::npos);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"folder.exr"});
}

TEST(BadOutput, AnErrorAnywhereLeavesTheOldFileAndNoOther) {
  const TempFolder folder("old");
  const TempFile in("in.exr");
  Spec s = small(Compression::zip, false);
  s.data.height = 400;
  write(s, in.path, 67);
  const auto out = folder.path / "a.exr";
  write_bytes(out, std::string("old"));
  Edit e;
  e.channels = {{"R"}};
  const auto source = open_image(in.path);
  for (const int threads : {1, 2}) {
    CopyOptions options;
    options.threads = threads;
    // Thrown by the work, in a later band.
    EXPECT_THROW(copy_edited(
                     *source, e, out,
                     [](Band& b) {
                       if (b.y >= 300) throw Error("work", "went wrong");
                     },
                     options),
                 Error);
    EXPECT_EQ(bytes_of(out), (std::vector<char>{'o', 'l', 'd'}));
    EXPECT_EQ(folder.names().size(), 1u);
    // Cancelled.
    std::atomic<bool> cancel = false;
    options.cancel = &cancel;
    const std::string what = error_of([&] {
      copy_edited(
          *source, e, out, [&](Band& b) { cancel = b.y >= 200 || cancel; }, options);
    });
    EXPECT_NE(what.find("interrupted"), std::string::npos) << what;
    EXPECT_EQ(bytes_of(out), (std::vector<char>{'o', 'l', 'd'}));
    EXPECT_EQ(folder.names().size(), 1u);
  }
  // A source that turns out to be cut short.
  std::vector<char> bytes = bytes_of(in.path);
  const TempFile cut("cut.exr");
  write_bytes(cut.path, std::span(bytes).first(bytes.size() - 10));
  EXPECT_THROW(make(cut.path, out), Error);
  EXPECT_EQ(bytes_of(out), (std::vector<char>{'o', 'l', 'd'}));
  EXPECT_EQ(folder.names().size(), 1u);
}

TEST(BadOutput, AFullDiskIsAnErrorAndLeavesNothing) {
  const TempFolder folder("full");
  const TempFile in("in.exr");
  Spec s = small(Compression::none, false);
  s.data = {0, 0, 200, 200};
  write(s, in.path, 68);
  // The limit on file size stands for the disk's end: write() then fails with EFBIG.
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  rlimit low = old;
  low.rlim_cur = 100000;
  setrlimit(RLIMIT_FSIZE, &low);
  const std::string what = error_of([&] { make(in.path, folder.path / "a.exr"); });
  setrlimit(RLIMIT_FSIZE, &old);
  ::signal(SIGXFSZ, handler);
  EXPECT_NE(what.find("too large"), std::string::npos) << what;
  EXPECT_TRUE(folder.names().empty());
}

TEST(BadOutput, PlanesThatDoNotFitTheirHeaderAreRefused) {
  const TempFolder folder("planes");
  Image image;
  image.header.data_window = image.header.display_window = {0, 0, 4, 4};
  image.header.channels = {{"Y"}};
  EXPECT_THROW(write_image(image, folder.path / "a.exr"), Error);
  image.planes = {std::vector<float>(15)};
  EXPECT_THROW(write_image(image, folder.path / "a.exr"), Error);
  image.planes = {std::vector<float>(16)};
  write_image(image, folder.path / "a.exr");
  image.header.data_window.width = 0;
  image.planes = {{}};
  EXPECT_THROW(write_image(image, folder.path / "b.exr"), Error);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.exr"});
}

TEST(BadOutput, LinksAreFollowedAndRightsKept) {
  const TempFolder folder("link");
  const TempFile in("in.exr");
  write(small(Compression::zip, false), in.path, 69);
  write_bytes(folder.path / "real.exr", std::string("old"));
  ::chmod((folder.path / "real.exr").c_str(), 0640);
  std::filesystem::create_symlink("real.exr", folder.path / "link.exr");
  make(in.path, folder.path / "link.exr");
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path / "link.exr"));
  read_image(folder.path / "real.exr");
  struct stat info {};
  ::stat((folder.path / "real.exr").c_str(), &info);
  EXPECT_EQ(info.st_mode & 07777, 0640u);
}

}  // namespace
}  // namespace brume
