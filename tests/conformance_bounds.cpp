// What every stage leaves alone, to the bit: pixels where it is not, whatever says so
// (its bounds, a mask, a distance, mix), and channels that it did not name.

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "conformance.h"
#include "image/io.h"
#include "pipeline/frame_file.h"

namespace brume::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Examples stand some way north of where the world begins, near the ground.
const char* const kCloser = R"(
[camera]
position = [0, -60, 8]
look_at = [0, 20, 2]
focal = 30
)";

class Untouched : public Conformance {
 protected:
  void SetUp() override {
    text_ = example_of(GetParam());
    has_example_ = !text_.empty();
    if (!has_example_) text_ = kHead + "type = \"" + GetParam() + "\"\n";
  }

  // The frame as floats.
  Image image() const {
    Image image;
    image.header = source_of(pixels, display).header;
    for (Channel& c : image.header.channels) {
      c.type = PixelType::float32;
      image.planes.push_back(plane_of(pixels, c.name));
    }
    return image;
  }
  static void add(Image& to, const std::string& name, std::vector<float> plane) {
    to.header.channels.push_back({name, PixelType::float32});
    to.planes.push_back(std::move(plane));
  }

  // Through files: all channels of what comes out, those that nobody named too.
  Image apply(const std::string& scene, const Image& in) {
    const fs::path folder = testing::TempDir();
    const fs::path from = folder / ("untouched_" + GetParam() + "_in.exr"),
                   to = folder / ("untouched_" + GetParam() + "_out.exr");
    write_image(in, from);
    session_ = std::make_unique<Session>(scene_of(registry(), scene), registry());
    plan_ = apply_frame(*session_, 1, from, to, {}).plan;
    return read_image(to);
  }

  // The example with a line more in each [[stage]]; `others` in those of other types.
  std::string example_with(const std::string& line, std::string others = {}) const {
    std::string text = text_;
    if (text.find("[camera]") == text.npos) text.insert(text.find(kHead), kCloser);
    text = scene_before(text);
    if (others.empty()) others = line;
    for (auto at = text.find(kHead); at != text.npos; at = text.find(kHead, at + 1)) {
      const std::string stage = text.substr(at, text.find(kHead, at + 1) - at);
      const bool it = stage.find("type = \"" + GetParam() + "\"") != stage.npos;
      text.insert(at + kHead.size(), (it ? line : others) + "\n");
    }
    return text;
  }
  const std::string kHead = "[[stage]]\n";

  // R, G, B and A at the pixels that `where` names; how many those are.
  template <class F>
  int expect_untouched(const Image& in, const Image& out, F&& where) {
    int count = 0;
    for (int i = 0; i < display.width * display.height; ++i) {
      if (!where(i)) continue;
      ++count;
      for (const char* name : {"R", "G", "B", "A"}) {
        const float was = in.planes[std::size_t(in.header.find(name))][std::size_t(i)],
                    is = out.planes[std::size_t(out.header.find(name))][std::size_t(i)];
        EXPECT_EQ(std::bit_cast<std::uint32_t>(was), std::bit_cast<std::uint32_t>(is))
            << name << " at " << i % display.width << ", " << i / display.width << " was "
            << was << ", is " << is;
        if (HasFailure()) return count;
      }
    }
    return count;
  }
  static bool differ(const Image& in, const Image& out) {
    for (const char* name : {"R", "G", "B"})
      if (in.planes[std::size_t(in.header.find(name))] !=
          out.planes[std::size_t(out.header.find(name))])
        return true;
    return false;
  }

  bool has_example_ = false;
  std::string text_;
  Plan plan_;
};

TEST_P(Untouched, PixelsBeyondWhereThePlanSaysItMatters) {
  const Image in = image(), out = apply(example_with(""), in);
  const Window& active = plan_.active;
  const int outside = expect_untouched(in, out, [&](int i) {
    const int x = i % display.width, y = i / display.width;
    return !active.empty() &&
           (x < active.x || x >= active.right() || y < active.y || y >= active.bottom());
  });
  EXPECT_TRUE(outside == 0 || !has_example_ || differ(in, out)) << "it is nowhere";
  std::printf("%d pixels outside its bounds\n", outside);
}

TEST_P(Untouched, PixelsThatAMaskLeavesOut) {
  Image in = image();
  std::vector<float> mask(in.planes[0].size());
  for (std::size_t i = 0; i < mask.size(); ++i)
    mask[i] = i % 7 < 3 || i / 61 % 5 == 0 ? 0.f : float(i % 3 + 1) / 3;
  add(in, "mask", mask);
  const Image out = apply(example_with("mask = \"mask\""), in);
  EXPECT_GT(expect_untouched(in, out, [&](int i) { return mask[std::size_t(i)] == 0; }),
            500);
  EXPECT_TRUE(differ(in, out) || !has_example_)
      << "it does nothing where the mask is 1 either";
}

TEST_P(Untouched, AFrameThatIsMixedWithNoneOfIt) {
  const Image in = image();
  expect_untouched(in, apply(example_with("mix = 0"), in), [](int) { return true; });
}

TEST_P(Untouched, WhatLiesBeforeItsStart) {
  const auto& specs = type().specs;
  if (std::ranges::none_of(
          specs, [](const ParamSpec& s) { return s.name == "start" && s.unit == "m"; }))
    GTEST_SKIP() << "starts everywhere";
  const Image in = image(), out = apply(example_with("start = 1000", "mix = 0"), in);
  // Rays of this camera are less than 1.3 times as long as they are deep.
  EXPECT_GT(expect_untouched(in, out,
                             [&](int i) {
                               const std::size_t k = std::size_t(i);
                               return pixels.a[k] == 1 && 1.3f * pixels.z[k] < 1000;
                             }),
            100);
}

TEST_P(Untouched, ChannelsItDidNotNameWhateverTheyHold) {
  // NaN and infinities in them show nowhere else, and stay.
  const Image plain = image();
  Image in = plain;
  std::vector<float> junk(in.planes[0].size(), kNan);
  for (std::size_t i = 0; i < junk.size(); i += 3) junk[i] = i % 2 ? kInf : -kInf;
  for (const char* name : {"beauty.R", "id", "zz.Z"}) add(in, name, junk);
  const std::string scene = example_with("");
  const Image without = apply(scene, plain), with = apply(scene, in);
  for (const std::string& read : plan_.channels_read)
    for (const char* name : {"beauty.R", "id", "zz.Z"}) EXPECT_NE(read, name);
  ASSERT_EQ(with.planes.size(), without.planes.size() + 3);
  for (std::size_t k = 0; k < with.planes.size(); ++k) {
    const std::string& name = with.header.channels[k].name;
    const int there = without.header.find(name);
    const std::vector<float>& want =
        there >= 0 ? without.planes[std::size_t(there)] : junk;
    for (std::size_t i = 0; i < want.size(); ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(with.planes[k][i]),
                std::bit_cast<std::uint32_t>(want[i]))
          << name << " at " << i % 61 << ", " << i / 61;
  }
}

BRUME_EVERY_STAGE(Untouched);

}  // namespace
}  // namespace brume::test
