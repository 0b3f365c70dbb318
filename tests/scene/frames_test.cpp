// Frame lists, and which file is a frame's.

#include "scene/frames.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <random>

namespace brume {
namespace {

using Frames = std::vector<int>;

template <class Do>
std::string refusal(Do run) {
  try {
    run();
  } catch (const Error& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Frames, AListIsAscendingAndEachFrameOnce) {
  EXPECT_EQ(parse_frames("7"), Frames{7});
  EXPECT_EQ(parse_frames("1-5"), (Frames{1, 2, 3, 4, 5}));
  EXPECT_EQ(parse_frames("1-10x3,200"), (Frames{1, 4, 7, 10, 200}));
  EXPECT_EQ(parse_frames("9,3,1-4,3"), (Frames{1, 2, 3, 4, 9}));
  EXPECT_EQ(parse_frames("-5--3,-1-1"), (Frames{-5, -4, -3, -1, 0, 1}));
  EXPECT_EQ(parse_frames("3-3"), Frames{3});
  EXPECT_EQ(parse_frames("1-2x999999999"), Frames{1});
  EXPECT_EQ(parse_frames("1-1000000").size(), 1000000u);
}

TEST(Frames, AWrongListIsNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "ends where a number should be"},
      {"1,", "ends where a number should be"},
      {"1-", "ends where a number should be"},
      {"a", "a number should be at \"a\""},
      {"1 2", "\" 2\" is no frame"},
      {"1.5", "\".5\" is no frame"},
      {"10-1", "10-1 runs backwards"},
      {"1-9x0", "a step must be at least 1"},
      {"1-9x-2", "a step must be at least 1"},
      {"1x2", "\"x2\" is no frame"},
      {"1-1000001", "more than 1000000 frames"},
      {"1-600000,1-600000", "more than 1000000 frames"},
      {"-999999999-999999999", "more than 1000000 frames"},
      {"1000000000", "a number beyond 999999999"},
      {"99999999999999999999", "a number beyond 999999999"},
  };
  for (const auto& [text, what] : cases)
    EXPECT_EQ(
        refusal([&] { parse_frames(text); }),
        "--frames " + std::string(text) + ": " + what + "; write frames as 1-100x2,200");
}

TEST(Frames, TheTextOfAListGivesTheListAgain) {
  std::mt19937 rng(1);
  for (int i = 0; i < 2000; ++i) {
    Frames f;
    for (unsigned n = rng() % 30; n > 0; --n) f.push_back(int(rng() % 60) - 20);
    std::sort(f.begin(), f.end());
    f.erase(std::unique(f.begin(), f.end()), f.end());
    if (f.empty()) continue;
    EXPECT_EQ(parse_frames(frames_text(f)), f) << "seed 1: " << frames_text(f);
  }
  EXPECT_EQ(frames_text(Frames{1, 3, 5, 7, 200}), "1-7x2,200");
  EXPECT_EQ(frames_text(Frames{-2, -1, 0, 5}), "-2-0,5");
  EXPECT_EQ(frames_text(Frames{1, 3, 10}), "1,3,10");
  EXPECT_EQ(frames_text(Frames{}), "");
}

TEST(FramePattern, APaddedFrameHasAtLeastItsDigits) {
  EXPECT_EQ(FramePattern("a/shot.####.exr").path(7), "a/shot.0007.exr");
  EXPECT_EQ(FramePattern("shot.%04d.exr").path(1001), "shot.1001.exr");
  EXPECT_EQ(FramePattern("shot.#.exr").path(12), "shot.12.exr");
  EXPECT_EQ(FramePattern("shot.%d.exr").path(12), "shot.12.exr");
  EXPECT_EQ(FramePattern("shot.####.exr").path(123456), "shot.123456.exr");
  EXPECT_EQ(FramePattern("%03d/shot.###.exr").path(5), "005/shot.005.exr");
}

TEST(FramePattern, NegativeFramesAreWrittenAsPrintfDoes) {
  for (const int width : {1, 2, 4, 6})
    for (const int frame : {-1000000, -12345, -10, -5, -1, 0, 3, 99, 12345}) {
      char wanted[64];
      std::snprintf(wanted, sizeof wanted, "s.%0*d.exr", width, frame);
      EXPECT_EQ(
          FramePattern("s." + std::string(std::size_t(width), '#') + ".exr").path(frame),
          wanted);
    }
}

TEST(FramePattern, APathWithoutTokensIsTheOneFile) {
  for (const char* plain : {"shot.exr", "100%.exr", "50%-grey.exr", "a%4d.exr", "%x", "%",
                            "", "%0d.exr", "%05f.exr"}) {
    EXPECT_FALSE(is_frame_pattern(plain)) << plain;
    EXPECT_EQ(FramePattern(plain).path(3), plain);
    EXPECT_FALSE(FramePattern(plain).frame_of(plain));
    EXPECT_TRUE(FramePattern(plain).existing().empty());
  }
  for (const char* pattern : {"#", "a.##.exr", "%d", "%03d.exr", "%V.exr", "%v/a.exr"})
    EXPECT_TRUE(is_frame_pattern(pattern)) << pattern;
}

TEST(FramePattern, ViewsAreNamedWholeOrByTheirLetter) {
  const FramePattern p("%V/shot_%v.####.exr");
  EXPECT_TRUE(p.has_view());
  EXPECT_EQ(p.path(1, "left"), "left/shot_l.0001.exr");
  EXPECT_EQ(p.path(1, "right"), "right/shot_r.0001.exr");
  EXPECT_EQ(p.frame_of("right/shot_r.0012.exr", "right"), 12);
  EXPECT_FALSE(p.frame_of("right/shot_r.0012.exr", "left"));
  for (const char* bad : {"", "..", "a/b"})
    EXPECT_THROW((void)p.path(1, bad), Error) << bad;
}

TEST(FramePattern, AFrameBelongsOnlyWhereThePatternWritesThatName) {
  const FramePattern p("d/shot.####.exr");
  EXPECT_EQ(p.frame_of("d/shot.1001.exr"), 1001);
  EXPECT_EQ(p.frame_of("d/shot.12345.exr"), 12345);
  EXPECT_EQ(p.frame_of("d/shot.-005.exr"), -5);
  for (const char* other :
       {"d/shot.001.exr", "d/shot.01001.exr", "d/shot..exr", "d/shot.100a.exr",
        "d/shot.1001.exr2", "e/shot.1001.exr", "shot.1001.exr", "", "d/shot.-0005.exr",
        "d/shot.99999999999.exr", "d/shot.+001.exr", "d/shot.-000.exr"})
    EXPECT_FALSE(p.frame_of(other)) << other;
  EXPECT_EQ(FramePattern("a#2.exr").frame_of("a122.exr"), 12)
      << "digits behind the token";
  EXPECT_EQ(FramePattern("##/a.##.exr").frame_of("07/a.07.exr"), 7);
  EXPECT_FALSE(FramePattern("##/a.##.exr").frame_of("07/a.08.exr"));
}

TEST(FramePattern, EveryFrameIsFoundAgainInItsPath) {
  std::mt19937 rng(2);
  const char* const parts[] = {"shot.", "#",  "%03d", "####", "_v2.",
                               "/",     "%V", "12",   "-"};
  for (int i = 0; i < 5000; ++i) {
    std::string text;
    int width = 0;
    for (unsigned n = 1 + rng() % 5; n > 0; --n) {
      const char* part = parts[rng() % 9];
      if (part[0] == '#' || part[1] == '0') {
        if (width != 0 || (!text.empty() && text.back() == '#')) continue;
        width = 1;
      }
      text += part;
    }
    const FramePattern p(text);
    if (!p.has_frame()) continue;
    const int frame = int(rng() % 200000) - 100000;
    const auto path = p.path(frame, "left");
    const auto found = p.frame_of(path, "left");
    ASSERT_TRUE(found) << "seed 2: " << text << " " << frame;
    EXPECT_EQ(p.path(*found, "left"), path);
  }
}

TEST(FramePattern, ImpossibleTokensAreNamed) {
  EXPECT_THROW(FramePattern("##########.exr"), Error);
  EXPECT_THROW(FramePattern("%010d.exr"), Error);
  EXPECT_THROW(FramePattern("%0999999999999999999d.exr"), Error);
  EXPECT_THROW(FramePattern("##/a.####.exr"), Error);
  EXPECT_THROW(FramePattern(std::string(5000, '#')), Error);
  EXPECT_THROW(FramePattern(std::string("a\0b", 3)), Error);
}

TEST(FramePattern, TheFramesOnDiskAreFound) {
  char folder[] = "/tmp/brume_frames_XXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::filesystem::path in = folder;
  const auto touch = [&](const std::string& name) {
    std::filesystem::create_directories((in / name).parent_path());
    std::ofstream(in / name) << "x";
  };
  for (const char* name :
       {"shot.0003.exr", "shot.0001.exr", "shot.-002.exr", "shot.12345.exr",
        "shot.03.exr", "shot.0005.png", "shot.exr", "0001/a.0001.exr", "0002/a.0002.exr",
        "0003/a.0004.exr", "left/s.0001.exr", "right/s.0002.exr"})
    touch(name);
  const auto existing = [&](const char* pattern, const char* view = "") {
    return FramePattern((in / pattern).string()).existing(view);
  };
  EXPECT_EQ(existing("shot.####.exr"), (Frames{-2, 1, 3, 12345}));
  EXPECT_EQ(existing("shot.##.exr"), (Frames{3, 12345}));
  EXPECT_EQ(existing("####/a.####.exr"), (Frames{1, 2}));
  EXPECT_EQ(existing("%V/s.%04d.exr", "left"), Frames{1});
  EXPECT_EQ(existing("%V/s.%04d.exr", "right"), Frames{2});
  EXPECT_EQ(existing("none.####.exr"), Frames{});
  EXPECT_NE(refusal([&] {
              existing("absent/a.####.exr");
            }).find("absent/: cannot be read: No such file or directory"),
            std::string::npos);
  std::filesystem::remove_all(in);
}

TEST(FramePattern, AFileTellsItsFrame) {
  EXPECT_EQ(frame_in_name("a/shot.1001.exr"), 1001);
  EXPECT_EQ(frame_in_name("shot_0007.exr"), 7);
  EXPECT_EQ(frame_in_name("shot-0007.exr"), 7);
  EXPECT_EQ(frame_in_name("shot.-005.exr"), -5);
  EXPECT_EQ(frame_in_name("0012.exr"), 12);
  EXPECT_EQ(frame_in_name("-0012.exr"), -12);
  for (const char* none :
       {"shot.exr", "shot_v02.exr", "", "shot.99999999999.exr", "1.2.3/a"})
    EXPECT_FALSE(frame_in_name(none)) << none;
}

TEST(FramePattern, OutputsMustHoldWhatInputsName) {
  const auto said = [](const char* in, const char* out, std::size_t frames,
                       std::size_t views = 1) {
    return refusal(
        [&] { check_output(FramePattern(in), FramePattern(out), frames, views); });
  };
  EXPECT_EQ(said("in.####.exr", "out.####.exr", 24), "accepted");
  EXPECT_EQ(said("in.exr", "out.exr", 1), "accepted");
  EXPECT_EQ(said("in.####.exr", "out.exr", 1), "accepted");
  EXPECT_EQ(said("in.####.exr", "d/out.exr", 24),
            "-o d/out.exr: 24 frames into one file; write out.####.exr");
  EXPECT_EQ(said("%V.exr", "out.exr", 1, 2),
            "-o out.exr: 2 views into one file; write out.%V.exr");
  EXPECT_EQ(said("in.exr", "./in.exr", 1),
            "-o ./in.exr: is the input itself; write to "
            "another name");
}

}  // namespace
}  // namespace brume
