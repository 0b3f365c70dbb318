// What every stage does, whoever wrote it: the modules beside this program, and those
// named in BRUME_CONFORMANCE_PLUGINS (files, colons between them).

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "num/error.h"
#include "pipeline/frames.h"
#include "stress/stress.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;

Registry::Options options() {
  Registry::Options o;
  if (const char* files = std::getenv("BRUME_CONFORMANCE_PLUGINS")) {
    std::istringstream list(files);
    for (std::string file; std::getline(list, file, ':');) o.files.emplace_back(file);
  }
  return o;
}

Registry& registry() {
  static Registry all(options());
  return all;
}

// A stage's example: the file of its folder that names it.
std::string example_of(const std::string& stage) {
  for (const auto& folder : fs::directory_iterator(BRUME_SOURCE_DIR "/plugins")) {
    std::ifstream in(folder.path() / "example.toml");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (text.find("type = \"" + stage + "\"") != text.npos) return text;
  }
  return {};
}

// The example before a small frame, with camera and sun unless it brings its own.
std::string scene_before(std::string text) {
  std::string more;
  if (text.find("[camera]") == text.npos) more += kCamera;
  if (text.find("[sun]") == text.npos) more += "[sun]\nelevation = 20\nazimuth = 40\n";
  const auto at = text.find("[[stage]]");
  return text.insert(at == text.npos ? text.size() : at, more + "\n");
}

class Conformance : public testing::TestWithParam<std::string> {
 protected:
  const StageType& type() { return registry().find(GetParam()); }
  const Window display{0, 0, 61, 37};
  const Pixels pixels = make_pixels(61, 37);

  // What the stage's example makes of the frame; false where there is none to go by.
  bool prepare(const std::string& scene) {
    session_ = std::make_unique<Session>(scene_of(registry(), scene), registry());
    frame_ =
        std::make_unique<PreparedFrame>(session_->prepare(source_of(pixels, display)));
    return true;
  }
  bool from_frame() const {
    for (const InputChannel& c : frame_->inputs())
      if (!c.file.empty() || c.channel.size() != 1) return false;
    return true;
  }
  std::unique_ptr<Session> session_;
  std::unique_ptr<PreparedFrame> frame_;
};

void expect_same(const Result& a, const Result& b, const Window& part, int width) {
  for (std::size_t k = 0; k < b.planes.size(); ++k)
    for (int y = 0; y < part.height; ++y)
      for (int x = 0; x < part.width; ++x) {
        const float got = b.planes[k][std::size_t(y * part.width + x)];
        const float want = a.planes[k][std::size_t((y + part.y) * width + x + part.x)];
        ASSERT_EQ(std::bit_cast<std::uint32_t>(got), std::bit_cast<std::uint32_t>(want))
            << b.names[k] << " at " << x + part.x << ", " << y + part.y << ": " << got
            << ", in the whole frame " << want;
      }
}

TEST_P(Conformance, DefaultsLieWithinTheirOwnRanges) {
  for (const ParamSpec& spec : type().specs) {
    EXPECT_LE(spec.minimum, spec.maximum) << spec.name;
    EXPECT_NO_THROW(check(spec, default_value(spec), {}, GetParam())) << spec.name;
    EXPECT_FALSE(spec.doc.empty()) << spec.name;
  }
}

TEST_P(Conformance, ItsExampleParsesAndPrintsAndParsesBack) {
  const std::string text = example_of(GetParam());
  if (text.empty()) GTEST_SKIP() << "no example.toml names it";
  const std::string once = print(scene_of(registry(), text));
  EXPECT_EQ(print(scene_of(registry(), once)), once);
}

TEST_P(Conformance, ItsExampleRendersTheSameHoweverCut) {
  const std::string text = example_of(GetParam());
  if (text.empty()) GTEST_SKIP() << "no example.toml names it";
  prepare(scene_before(text));
  if (!from_frame()) GTEST_SKIP() << "wants channels of its own";
  const Result whole = apply_whole(*frame_, pixels, display);
  for (const auto& plane : whole.planes)
    for (const float x : plane) ASSERT_TRUE(std::isfinite(x));
  expect_same(whole, apply_whole(*frame_, pixels, display), display, display.width);
  if (frame_->plan().whole_frame) return;
  // Uneven tiles, two threads at once.
  const Window parts[] = {
      {0, 0, 61, 1}, {60, 0, 1, 37}, {3, 5, 17, 11}, {20, 16, 41, 21}};
  Result cut[4];
  std::thread other([&] {
    for (int k : {0, 1}) cut[k] = apply_whole(*frame_, pixels, parts[k]);
  });
  for (int k : {2, 3}) cut[k] = apply_whole(*frame_, pixels, parts[k]);
  other.join();
  for (int k = 0; k < 4; ++k) expect_same(whole, cut[k], parts[k], display.width);
}

TEST_P(Conformance, IdleMeansNoChange) {
  // At its defaults, or with each number in turn at its least.
  for (int at = -1; at < int(type().specs.size()); ++at) {
    std::string text = "version = 1\n[[stage]]\ntype = \"" + GetParam() + "\"\n";
    if (at >= 0) {
      const ParamSpec& spec = type().specs[std::size_t(at)];
      if ((spec.kind != Kind::number && spec.kind != Kind::rgb) || spec.minimum != 0)
        continue;
      text += spec.name + " = 0\n";
    }
    try {
      prepare(scene_before(text));
    } catch (const Error&) {
      continue;  // it asks for what this frame has not
    }
    if (frame_->plan().stages[0].runs || !from_frame()) continue;
    EXPECT_FALSE(frame_->plan().stages[0].reason.empty());
    EXPECT_TRUE(frame_->plan().changes_nothing) << text;
  }
}

TEST_P(Conformance, ChannelsItDidNotDeclareAreNotRead) {
  const std::string text = example_of(GetParam());
  if (text.empty()) GTEST_SKIP() << "no example.toml names it";
  session_ =
      std::make_unique<Session>(scene_of(registry(), scene_before(text)), registry());
  const PreparedFrame f = session_->prepare(
      source_of(pixels, display, {"A", "B", "G", "R", "Z", "junk.nan", "zz"}));
  for (const InputChannel& c : f.inputs()) {
    EXPECT_NE(c.channel, "junk.nan");
    EXPECT_NE(c.channel, "zz");
  }
}

// A short run of `brume stress`; the truth has its own, longer ones.
TEST_P(Conformance, KeepsTheLawsOfItsKind) {
  StageCache cache;
  const stress::Report r = stress::run(GetParam(), stress::maker_of(type(), cache),
                                       {.cases = 1280, .seed = 2, .seconds = 4});
  EXPECT_GT(r.cases, 0u);
  for (int k = 0; k < stress::kLaws; ++k) {
    const stress::Law law = stress::Law(k);
    if (law == stress::Law::truth_T || law == stress::Law::truth_L) continue;
    EXPECT_EQ(r.of(law).broken, 0u)
        << stress::name(law) << ", seed 2, case " << r.of(law).worst_case;
  }
}

std::vector<std::string> stages() {
  std::vector<std::string> names, broken;
  for (const StageType* type : registry().all(&broken)) names.push_back(type->name);
  for (const std::string& why : broken) ADD_FAILURE() << why;
  return names;
}

INSTANTIATE_TEST_SUITE_P(Stages, Conformance, testing::ValuesIn(stages()),
                         [](const auto& of) { return of.param; });

}  // namespace
}  // namespace brume::test
